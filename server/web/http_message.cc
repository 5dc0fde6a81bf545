#include "server/web/http_message.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <ctime>

#include "engine/core/hex.h"
#include "engine/core/letters.h"

namespace rmlcell::web {
namespace {

bool IsControl(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7F;
}

// Calls `each` with every trimmed element of a comma-separated list until it returns true.
template <class Each>
bool AnyElement(std::string_view list, Each each) {
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    if (each(Trimmed(list.substr(0, comma), kBlanks))) return true;
    if (comma == std::string_view::npos) break;
    list.remove_prefix(comma + 1);
  }
  return false;
}

}  // namespace

std::string_view HttpRequest::Header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (key == name) return value;
  }
  return {};
}

std::size_t HttpRequest::CountOf(std::string_view name) const {
  std::size_t count = 0;
  for (const auto& header : headers) count += header.first == name ? 1U : 0U;
  return count;
}

std::string SerializeHead(const HttpResponse& response, Framing framing, std::size_t length,
                          bool keep_alive) {
  std::string out = "HTTP/1.1 " + std::to_string(response.status) + " " +
                    std::string(ReasonPhrase(response.status)) + "\r\n";
  for (const auto& [name, value] : response.headers) {
    out += name;
    out += ": ";
    std::ranges::replace_copy_if(value, std::back_inserter(out), IsControl, ' ');
    out += "\r\n";
  }
  if (framing == Framing::kLength) out += "Content-Length: " + std::to_string(length) + "\r\n";
  if (framing == Framing::kChunked) out += "Transfer-Encoding: chunked\r\n";
  out += keep_alive ? "Connection: keep-alive\r\n\r\n" : "Connection: close\r\n\r\n";
  return out;
}

std::string_view ReasonPhrase(int status) {
  switch (status) {
    case 100:
      return "Continue";
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 409:
      return "Conflict";
    case 412:
      return "Precondition Failed";
    case 413:
      return "Content Too Large";
    case 415:
      return "Unsupported Media Type";
    case 417:
      return "Expectation Failed";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 499:
      return "Client Closed Request";
    case 500:
      return "Internal Server Error";
    case 501:
      return "Not Implemented";
    case 503:
      return "Service Unavailable";
    case 504:
      return "Gateway Timeout";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Status";
  }
}

std::optional<std::string> PercentDecode(std::string_view text, bool plus_is_blank) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '+' && plus_is_blank) {
      out += ' ';
    } else if (text[i] != '%') {
      out += text[i];
    } else {
      if (text.size() - i < 3) return std::nullopt;
      const std::optional<unsigned> high = HexValue(text[i + 1]);
      const std::optional<unsigned> low = HexValue(text[i + 2]);
      if (!high || !low) return std::nullopt;
      out += static_cast<char>(*high * 16 + *low);
      i += 2;
    }
  }
  return out;
}

QueryValue QueryParameter(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    const std::string_view pair = query.substr(0, end);
    const std::size_t equals = pair.find('=');
    if (pair.substr(0, equals) == name) {
      const std::string_view raw =
          equals == std::string_view::npos ? std::string_view() : pair.substr(equals + 1);
      std::optional<std::string> value = PercentDecode(raw, true);
      return {.ok = value.has_value(), .value = std::move(value)};
    }
    if (end == std::string_view::npos) break;
    query.remove_prefix(end + 1);
  }
  return {};
}

std::string MediaType(std::string_view content_type) {
  return LowerCase(Trimmed(content_type.substr(0, content_type.find(';')), kBlanks));
}

bool Accepts(std::string_view accept, std::string_view media_type) {
  return AnyElement(accept, [&](std::string_view one) { return MediaType(one) == media_type; });
}

bool EtagMatches(std::string_view if_none_match, std::string_view etag) {
  return AnyElement(if_none_match, [&](std::string_view one) {
    if (one == "*") return true;
    if (one.substr(0, 2) == "W/") one.remove_prefix(2);
    return one.size() == etag.size() + 2 && one.front() == '"' && one.back() == '"' &&
           one.substr(1, etag.size()) == etag;
  });
}

std::string ContentDisposition(std::string_view kind, std::string_view file_name) {
  std::string plain;
  std::string encoded;
  for (const char c : file_name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool ascii = byte >= 0x20 && byte < 0x7F && c != '"' && c != '\\' && c != '%' && c != '/';
    plain += ascii ? c : '_';
    const bool safe = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '.' || c == '-' || c == '_';
    if (safe) {
      encoded += c;
    } else {
      encoded += '%' + HexByte(c);
    }
  }
  std::string out = std::string(kind) + "; filename=\"" + plain + "\"";
  if (plain != file_name) out += "; filename*=UTF-8''" + encoded;
  return out;
}

std::string HttpDate() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 40> text{};
  const std::size_t size =
      std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &utc);
  return std::string(text.data(), size);
}

std::string ChunkHead(std::size_t size) { return HexNumber(size) + "\r\n"; }

void SetTarget(std::string_view target, HttpRequest& request) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!target.starts_with(scheme)) continue;
    target.remove_prefix(scheme.size());
    const std::size_t path = std::min(target.find_first_of("/?"), target.size());
    request.host = std::string(target.substr(0, path));  // it stands above the Host header
    target.remove_prefix(path);
  }
  const std::size_t question = std::min(target.find('?'), target.size());
  request.path = std::string(target.substr(0, question));
  if (request.path.empty()) request.path = "/";
  if (question < target.size()) request.query = std::string(target.substr(question + 1));
}

}  // namespace rmlcell::web
