#include "clients/lsp/document.h"

#include <algorithm>
#include <utility>

namespace rmlcell::lsp {
namespace {

bool IsAscii(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

}  // namespace

Document::Document(std::string uri, std::string language, std::int64_t version, std::string text,
                   Encoding encoding)
    : uri_(std::move(uri)),
      language_(std::move(language)),
      version_(version),
      text_(std::move(text)),
      lines_(text_),
      encoding_(encoding),
      ascii_(IsAscii(text_)) {}

void Document::ReplaceAll(std::string text) {
  text_ = std::move(text);
  lines_.Rebuild(text_);
  ascii_ = IsAscii(text_);
}

void Document::Replace(const Range& range, std::string_view text) {
  const std::size_t begin = OffsetOf(range.start);
  const std::size_t end = std::max(begin, OffsetOf(range.end));
  text_.replace(begin, end - begin, text);
  lines_.Replace(text_, begin, end, text.size());
  ascii_ = ascii_ && IsAscii(text);
}

std::size_t Document::OffsetOf(Position position) const {
  if (position.line >= lines_.count()) return text_.size();
  const std::size_t begin = lines_.Begin(position.line);
  const std::string_view line =
      std::string_view(text_).substr(begin, lines_.End(text_, position.line) - begin);
  if (ascii_) return begin + std::min<std::size_t>(position.character, line.size());
  return begin + BytesOfCharacters(line, position.character, encoding_);
}

Position Document::PositionOf(std::size_t offset) const { return PositionFinder(*this).At(offset); }

Position PositionFinder::At(std::size_t offset) {
  const LineTable& lines = document_.lines();
  const std::size_t line = lines.LineOf(offset);
  const std::size_t begin = lines.Begin(line);
  // A place between CR and LF is the end of its line.
  offset = std::min(offset, std::max(begin, lines.End(document_.text(), line)));
  Position position{static_cast<std::uint32_t>(line), 0};
  if (document_.ascii()) {
    position.character = static_cast<std::uint32_t>(offset - begin);
    return position;
  }
  std::size_t from = begin;
  if (position_.line == line && offset_ <= offset) {
    from = offset_;
    position.character = position_.character;
  }
  position.character += CharactersIn(std::string_view(document_.text()).substr(from, offset - from),
                                     document_.encoding());
  offset_ = offset;
  position_ = position;
  return position;
}

Range PositionFinder::Span(std::size_t begin, std::size_t end) {
  const Position start = At(begin);
  return {start, At(std::max(begin, end))};
}

}  // namespace rmlcell::lsp
