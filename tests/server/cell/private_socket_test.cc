// Where the private socket of a server lies (server/cell/private_socket.h).
#include "server/cell/private_socket.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace rmlcell::server {
namespace {

class PrivateSocketTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(::mkdtemp(folder_.data()), nullptr); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  // A state directory whose name has so many characters.
  std::string StateOf(std::size_t characters) {
    std::string state = folder_ + "/";
    state.resize(characters, 's');
    std::filesystem::create_directories(state);
    return state;
  }
  static std::string FolderOf(const PrivateSocket& socket) {
    const std::string begin = "unix:";
    const std::string end = "/cell.sock";
    const std::string address = socket.address();
    EXPECT_EQ(address.substr(0, begin.size()), begin);
    EXPECT_EQ(address.substr(address.size() - end.size()), end);
    return address.substr(begin.size(), address.size() - begin.size() - end.size());
  }

  std::string folder_ = testing::TempDir() + "private_XXXXXX";
};

// A sockaddr_un has 107 characters: 89, and "/private/cell.sock".
TEST_F(PrivateSocketTest, LiesInTheStateDirectoryWhereItsPathFits) {
  const std::string state = StateOf(89);
  const auto made = PrivateSocket::Make(state);
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->address(), "unix:" + state + "/private/cell.sock");
}

TEST_F(PrivateSocketTest, LiesInTheTemporaryFolderElsewhere) {
  const std::string odd = folder_ + "/what?";
  std::filesystem::create_directories(odd);
  for (const std::string& state : {StateOf(90), odd, folder_ + "/no/such/folder"}) {
    std::string folder;
    {
      const auto made = PrivateSocket::Make(state);
      ASSERT_TRUE(made) << made.error().detail;
      folder = FolderOf(*made);
      EXPECT_EQ(folder.substr(0, folder.rfind('-')), "/tmp/rmlcell") << state;
      EXPECT_TRUE(std::filesystem::is_directory(folder)) << state;
      EXPECT_EQ(std::filesystem::status(folder).permissions(), std::filesystem::perms::owner_all);
    }
    EXPECT_FALSE(std::filesystem::exists(folder)) << state;
  }
}

// What a server that was killed left there is gone, and so is the folder at the end.
TEST_F(PrivateSocketTest, BeginsAndEndsWithNothing) {
  const std::string left = folder_ + "/private/left";
  std::filesystem::create_directories(left);
  {
    const auto made = PrivateSocket::Make(folder_);
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_FALSE(std::filesystem::exists(left));
    EXPECT_EQ(std::filesystem::status(folder_ + "/private").permissions(),
              std::filesystem::perms::owner_all);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/private"));
}

}  // namespace
}  // namespace rmlcell::server
