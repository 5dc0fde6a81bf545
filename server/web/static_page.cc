#include "server/web/static_page.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>

#include "engine/core/hex.h"

namespace rmlcell::web {
namespace {

// Nothing from elsewhere, no inline script, not inside a frame of anybody else.
constexpr std::string_view kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

struct TypeOfEnding {
  std::string_view ending;
  std::string_view media_type;
};
constexpr std::array<TypeOfEnding, 4> kTypes = {{{".html", "text/html; charset=utf-8"},
                                                 {".js", "text/javascript; charset=utf-8"},
                                                 {".css", "text/css; charset=utf-8"},
                                                 {".svg", "image/svg+xml"}}};

std::string_view TypeOf(std::string_view name) {
  for (const auto& [ending, media_type] : kTypes) {
    if (name.ends_with(ending)) return media_type;
  }
  return "application/octet-stream";
}

// FNV-1a, 64 bits: tells versions of our own files apart, no more is asked of it.
std::string EtagOf(std::string_view bytes) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return HexNumber(hash);
}

std::optional<std::string> ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

}  // namespace

std::string PageEtag() {
  std::string all;
  for (const EmbeddedFile& file : EmbeddedFiles())
    all += std::string(file.name) + ' ' + EtagOf(file.bytes) + '\n';
  return EtagOf(all);
}

StaticPage::StaticPage(std::string web_dir) : web_dir_(std::move(web_dir)) {
  for (const EmbeddedFile& file : EmbeddedFiles()) {
    files_[std::string(file.name)] = {.bytes = std::string(file.bytes), .etag = EtagOf(file.bytes)};
  }
}

std::optional<HttpResponse> StaticPage::Find(const HttpRequest& request) const {
  const std::string_view name = request.path == "/" ? std::string_view("index.html")
                                                    : std::string_view(request.path).substr(1);
  const auto found = files_.find(name);
  if (found == files_.end()) return std::nullopt;
  File file = found->second;
  if (!web_dir_.empty()) {
    std::optional<std::string> bytes = ReadFile(web_dir_ + "/" + std::string(name));
    if (!bytes) return std::nullopt;
    file = {.bytes = *bytes, .etag = EtagOf(*bytes)};
  }
  HttpResponse response;
  response.headers.emplace_back("Content-Type", TypeOf(name));
  response.headers.emplace_back("ETag", '"' + file.etag + '"');
  response.headers.emplace_back("Cache-Control", "no-cache");
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  response.headers.emplace_back("Content-Security-Policy", kPagePolicy);
  response.headers.emplace_back("Referrer-Policy", "no-referrer");
  response.headers.emplace_back("Cross-Origin-Resource-Policy", "same-origin");
  response.headers.emplace_back("Cross-Origin-Opener-Policy", "same-origin");
  response.headers.emplace_back("X-Frame-Options", "DENY");
  if (EtagMatches(request.Header("if-none-match"), file.etag)) {
    response.status = 304;
  } else {
    response.body = std::move(file.bytes);
  }
  return response;
}

}  // namespace rmlcell::web
