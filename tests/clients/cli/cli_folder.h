#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

// What several tests of the command need: files, and what goes to the streams.
namespace rmlcell::cli {

// A folder that is made empty and removed with all that is in it.
class CliFolder {
 public:
  CliFolder() {
    std::string path = (std::filesystem::temp_directory_path() / "rmlcell_cli_XXXXXX").string();
    if (::mkdtemp(path.data()) == nullptr) throw std::runtime_error("no folder " + path);
    path_ = path;
  }
  CliFolder(const CliFolder&) = delete;
  CliFolder& operator=(const CliFolder&) = delete;
  ~CliFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  std::string path() const { return path_.string(); }
  std::string File(const std::string& name) const { return (path_ / name).string(); }

  // Writes a file, with the folders above it. Returns its path.
  std::string Put(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return File(name);
  }
  std::string Read(const std::string& name) const {
    std::ifstream file(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.push_back(entry.path().filename().string());
    return names;
  }

 private:
  std::filesystem::path path_;
};

// What `act` writes, and the exit code that it gives.
struct Told {
  int exit_code = 0;
  std::string output;
  std::string errors;
};
inline Told Hear(const std::function<int()>& act) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Told told;
  told.exit_code = act();
  told.output = testing::internal::GetCapturedStdout();
  told.errors = testing::internal::GetCapturedStderr();
  return told;
}

}  // namespace rmlcell::cli
