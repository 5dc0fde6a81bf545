#include "server/base/secret.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace rmlcell::server {
namespace {

TEST(Secret, IsKnownToWhoGivesTheWholeOfIt) {
  EXPECT_TRUE(KnowsSecret("s3cret", "s3cret"));
  for (const std::string wrong : {"", "s", "s3cre", "s3creT", "S3cret", "s3cret ", "x3cret"})
    EXPECT_FALSE(KnowsSecret(wrong, "s3cret")) << wrong;
  using namespace std::string_view_literals;
  EXPECT_FALSE(KnowsSecret("a\0b"sv, "a\0c"sv));
  EXPECT_TRUE(KnowsSecret("a\0b"sv, "a\0b"sv));
}

TEST(Secret, AnEmptyOneIsKnownToNobody) {
  EXPECT_FALSE(KnowsSecret("", ""));
  EXPECT_FALSE(KnowsSecret("x", ""));
}

// 32 hexadecimal digits, each time others.
TEST(Secret, IsKeptInAFile) {
  const std::string path =
      testing::TempDir() + "/rmlcell-kept-secret-" + std::to_string(::getpid());
  std::filesystem::remove(path);
  const Result<std::string> made = KeptSecret(path);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->size(), 32U);
  EXPECT_EQ(made->find_first_not_of("0123456789abcdef"), std::string::npos) << *made;
  EXPECT_NE(*made, RandomText());
  EXPECT_EQ(*KeptSecret(path), *made);
  using std::filesystem::perms;
  EXPECT_EQ(std::filesystem::status(path).permissions(), perms::owner_read | perms::owner_write);
  EXPECT_FALSE(std::filesystem::exists(path + ".new"));
  // One that could be guessed is replaced.
  std::ofstream(path) << std::string(31, 'x');
  EXPECT_NE(*KeptSecret(path), std::string(31, 'x'));
  std::ofstream(path) << std::string(32, 'x');
  EXPECT_EQ(*KeptSecret(path), std::string(32, 'x'));
  std::filesystem::remove(path);
  const Result<std::string> nowhere = KeptSecret("/proc/no/such/file");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(nowhere.error().detail, "/proc/no/such/file: No such file or directory");
}

// An operator == ends at the first character that is wrong, and its time tells how many were right.
TEST(Secret, NoSourceComparesOneByItself) {
  for (const std::string name : {"server/auth/caller.cc", "server/jobs/dispatcher.cc"}) {
    std::ifstream file(std::string(RMLCELL_SOURCE_DIR) + "/" + name);
    std::stringstream text;
    text << file.rdbuf();
    ASSERT_NE(text.str().find("KnowsSecret("), std::string::npos) << name;
    for (const std::string compared : {"== web_secret_", "web_secret_ ==", "!= join_token_",
                                       "== join_token_", "join_token_ ==", "join_token_ !="})
      EXPECT_EQ(text.str().find(compared), std::string::npos) << name << ": " << compared;
  }
}

// What cannot be put in its place is no secret that is kept.
TEST(Secret, IsNoneWhereAFolderStands) {
  const std::string path =
      testing::TempDir() + "/rmlcell-folder-of-a-secret-" + std::to_string(::getpid());
  std::filesystem::create_directories(path);
  const Result<std::string> made = KeptSecret(path);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(made.error().detail, path + ": Is a directory");
  EXPECT_FALSE(std::filesystem::exists(path + ".new"));  // nothing of it stays behind
  std::filesystem::remove_all(path);
}

// On a disk without room (full(4)) no half of a secret is kept.
TEST(Secret, IsNoneWithoutRoomForIt) {
  const std::string path =
      testing::TempDir() + "/rmlcell-secret-without-room-" + std::to_string(::getpid());
  std::filesystem::create_symlink("/dev/full", path + ".new");
  const Result<std::string> made = KeptSecret(path);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(made.error().detail, path + ": No space left on device");
  EXPECT_FALSE(std::filesystem::exists(path));
  std::filesystem::remove(path + ".new");
}

}  // namespace
}  // namespace rmlcell::server
