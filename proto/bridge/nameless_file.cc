#include "proto/bridge/nameless_file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <filesystem>
#include <system_error>

namespace rmlcell::bridge {

OpenFile NamelessFile() {
  std::error_code none;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(none);
  if (none) return nullptr;
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  return OpenFile(file < 0 ? std::tmpfile() : ::fdopen(file, "w+b"));
}

}  // namespace rmlcell::bridge
