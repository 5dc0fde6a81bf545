#include "server/cell/socket_listener.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "server/auth/socket_users.h"

namespace rmlcell::server {
namespace {

class SocketListenerTest : public testing::Test {
 protected:
  std::string Refusal(const std::string& path) {
    const auto made = SocketListener::Make("unix://" + path, users_);
    if (made) return {};
    EXPECT_EQ(made.error().code, ErrorCode::kCellPortUsed);
    const std::string begin = "cannot listen on unix://" + path + ": ";
    EXPECT_EQ(made.error().detail.substr(0, begin.size()), begin);
    return made.error().detail.substr(begin.size());
  }

  void SetUp() override { ASSERT_NE(::mkdtemp(folder_.data()), nullptr); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string folder_ = testing::TempDir() + "listener_XXXXXX";
  SocketUsers users_;
};

// A sockaddr_un has 108 bytes, the last of them a 0.
TEST_F(SocketListenerTest, APathHas107Characters) {
  const std::string wrong =
      "the path of a socket has 1 to 107 characters, none of them ? # or %, and begins with / "
      "behind unix://";
  std::string longest = folder_ + "/";
  longest.resize(107, 's');
  EXPECT_EQ(Refusal(longest), "");
  EXPECT_EQ(Refusal(longest + "s"), wrong);
  EXPECT_EQ(Refusal(""), wrong);
}

TEST_F(SocketListenerTest, SaysWhyItCannotBeThere) {
  EXPECT_EQ(Refusal(folder_ + "/none/cell.sock"), std::strerror(ENOENT));
}

// Only the socket that a dead server left is taken away: not that of a living one, and no file.
TEST_F(SocketListenerTest, TakesNothingThatIsOfUse) {
  const std::string path = folder_ + "/cell.sock";
  {
    const auto first = SocketListener::Make("unix://" + path, users_);
    ASSERT_TRUE(first);
    EXPECT_EQ(Refusal(path), "another server listens there");
    EXPECT_TRUE(std::filesystem::is_socket(path));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  std::ofstream(path) << "kept";
  EXPECT_EQ(Refusal(path), "there is a file that is no socket");
  EXPECT_EQ(std::filesystem::file_size(path), 4U);
}

}  // namespace
}  // namespace rmlcell::server
