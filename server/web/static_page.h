#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/web/http_message.h"

namespace rmlcell::web {

// A file of clients/web that is built into the binary.
struct EmbeddedFile {
  std::string_view name;  // "index.html"
  std::string_view bytes;
};

// Implemented by a source file that CMake writes.
std::vector<EmbeddedFile> EmbeddedFiles();

// Another one when any of these files is another.
std::string PageEtag();

// The page and what belongs to it: "/" is index.html, "/NAME" the file of that name. There are only
// the names that are built in, so a path never reaches the file system; with a folder given, the
// bytes of these names are read from there at each request.
class StaticPage {
 public:
  explicit StaticPage(std::string web_dir = {});

  // 200, or 304 when the client has it; nothing when there is no such file.
  std::optional<HttpResponse> Find(const HttpRequest& request) const;

 private:
  struct File {
    std::string bytes;
    std::string etag;
  };
  std::string web_dir_;
  std::map<std::string, File, std::less<>> files_;
};

}  // namespace rmlcell::web
