// Files that the server opens itself: whatever number they get, they are used and closed, and what
// it logs is there at once.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "server/base/config.h"
#include "server/base/log.h"
#include "server/base/secret.h"

namespace rmlcell::server {
namespace {

class FilesOfTheServer : public testing::Test {
 protected:
  FilesOfTheServer() { std::filesystem::create_directories(folder_); }
  ~FilesOfTheServer() override { std::filesystem::remove_all(folder_); }
  std::string File(const std::string& name) const { return folder_ + "/" + name; }

 private:
  const std::string folder_ =
      testing::TempDir() + "/rmlcell-server-files-" + std::to_string(::getpid());
};

std::ptrdiff_t OpenFiles() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                       std::filesystem::directory_iterator());
}

// A service may be started without standard input: then the first file that it opens is number 0.
TEST_F(FilesOfTheServer, ASecretIsKeptWithoutStandardInput) {
  const int input = ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
  ::close(STDIN_FILENO);
  const Result<std::string> made = KeptSecret(File("secret"));
  if (input >= 0) {
    ::dup2(input, STDIN_FILENO);
    ::close(input);
  }
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->size(), 32U);
  EXPECT_EQ(*KeptSecret(File("secret")), *made);
}

TEST_F(FilesOfTheServer, AreClosedAgain) {
  std::ofstream(File("a.toml")) << "[jobs]\nattempts = 7\n";
  const std::ptrdiff_t before = OpenFiles();
  Config config;
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(ReadConfigFile(File("a.toml"), config));
    ASSERT_TRUE(KeptSecret(File("secret" + std::to_string(round))));
  }
  EXPECT_EQ(OpenFiles(), before);
}

// Whoever looks into a log that is growing sees what has happened so far.
TEST_F(FilesOfTheServer, ALogIsWrittenAtOnce) {
  const std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
  ASSERT_TRUE(StartLog("cell-at-once", "debug", "text", File("log")));
  const auto lines = [this] {
    std::ifstream file(File("log"));
    int count = 0;
    for (std::string line; std::getline(file, line);) ++count;
    return count;
  };
  spdlog::info("begun");
  EXPECT_EQ(lines(), 1);
  spdlog::warn("a tool is missing");
  EXPECT_EQ(lines(), 2);
  spdlog::drop("cell-at-once");
  spdlog::set_default_logger(before);
}

}  // namespace
}  // namespace rmlcell::server
