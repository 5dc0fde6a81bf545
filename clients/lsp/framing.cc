#include "clients/lsp/framing.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"

namespace rmlcell::lsp {
namespace {

constexpr std::string_view kMark = "Content-Length:";
constexpr std::size_t kFirstRoom = std::size_t{1} << 20;  // no more is taken on a promise alone

std::optional<std::size_t> ReadLength(std::string_view text) {
  const std::optional<long long> length = ParseInteger(text);
  if (!length || *length < 0) return std::nullopt;
  return static_cast<std::size_t>(*length);
}

// "application/vscode-jsonrpc; charset=utf-8": only UTF-8 is spoken here, under both its names.
bool IsUtf8(std::string_view content_type) {
  const std::string lower = LowerCase(content_type);
  const std::size_t at = lower.find("charset=");
  if (at == std::string::npos) return true;
  const std::string_view name = Trimmed(std::string_view(lower).substr(at + 8));
  return name.starts_with("utf-8") || name.starts_with("utf8") || name.starts_with("\"utf-8");
}

struct Header {
  std::size_t length = 0;
  std::string problem;
};

Header ReadHeader(std::string_view text) {
  Header header;
  bool found = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = Trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty()) continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return {0, "a header line without a colon"};
    const std::string_view name = Trimmed(line.substr(0, colon));
    const std::string_view value = Trimmed(line.substr(colon + 1));
    if (EqualIgnoringCase(name, "Content-Length")) {
      const std::optional<std::size_t> length = ReadLength(value);
      if (!length) return {0, "Content-Length is no number"};
      if (*length > kMessageBytesMax) {
        return {0, "a message of " + std::to_string(*length) + " bytes; at most " +
                       std::to_string(kMessageBytesMax) + " are read"};
      }
      if (found && *length != header.length) return {0, "two different Content-Length"};
      found = true;
      header.length = *length;
    } else if (EqualIgnoringCase(name, "Content-Type") && !IsUtf8(value)) {
      return {0, "a message that is not in UTF-8"};
    }
  }
  if (!found) header.problem = "a header without Content-Length";
  return header;
}

}  // namespace

void MessageReader::Feed(std::string_view bytes, std::vector<Frame>& to) {
  while (!bytes.empty()) {
    switch (state_) {
      case State::kHeader:
        FeedHeader(bytes, to);
        break;
      case State::kBody:
        FeedBody(bytes, to);
        break;
      case State::kLost:
        Seek(bytes);
        break;
    }
  }
}

void MessageReader::FeedHeader(std::string_view& bytes, std::vector<Frame>& to) {
  while (!bytes.empty()) {
    header_ += bytes.front();
    bytes.remove_prefix(1);
    if (header_.size() > kHeaderBytesMax) return Lose("a header that does not end", to);
    if (header_.ends_with("\r\n\r\n") || header_.ends_with("\n\n")) return EndHeader(to);
  }
}

void MessageReader::EndHeader(std::vector<Frame>& to) {
  Header header = ReadHeader(header_);
  if (!header.problem.empty()) return Lose(std::move(header.problem), to);
  header_.clear();
  body_.clear();
  wanted_ = header.length;
  body_.reserve(std::min(wanted_, kFirstRoom));
  if (wanted_ == 0) {
    to.push_back({});
    return;
  }
  state_ = State::kBody;
}

void MessageReader::FeedBody(std::string_view& bytes, std::vector<Frame>& to) {
  const std::size_t taken = std::min(wanted_ - body_.size(), bytes.size());
  body_ += bytes.substr(0, taken);
  bytes.remove_prefix(taken);
  if (body_.size() < wanted_) return;
  to.push_back({std::exchange(body_, {}), {}});
  state_ = State::kHeader;
}

void MessageReader::Lose(std::string problem, std::vector<Frame>& to) {
  to.push_back({{}, std::move(problem)});
  header_.clear();
  matched_ = 0;
  state_ = State::kLost;
}

// The first letter of the mark does not come again in it: after a mismatch only that letter counts.
void MessageReader::Seek(std::string_view& bytes) {
  while (!bytes.empty()) {
    const char c = bytes.front();
    bytes.remove_prefix(1);
    matched_ = c == kMark[matched_] ? matched_ + 1 : c == kMark[0] ? 1U : 0U;
    if (matched_ < kMark.size()) continue;
    header_ = kMark;
    state_ = State::kHeader;
    return;
  }
}

std::string Framed(std::string_view body) {
  std::string message = "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n";
  message += body;
  return message;
}

}  // namespace rmlcell::lsp
