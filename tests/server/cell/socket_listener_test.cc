#include "server/cell/socket_listener.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "server/auth/socket_users.h"

namespace rmlcell::server {
namespace {

constexpr std::string_view kWrongSocketPath =
    "the path of a socket has 1 to 107 characters, none of them ? # or %, and begins with / behind "
    "unix://";

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
  std::string longest = folder_ + "/";
  longest.resize(107, 's');
  EXPECT_EQ(Refusal(longest), "");
  EXPECT_EQ(Refusal(longest + "s"), kWrongSocketPath);
  EXPECT_EQ(Refusal(""), kWrongSocketPath);
}

// For clients an address is a URI: what stands there for something else is no part of a path.
TEST_F(SocketListenerTest, APathReadsTheSameAsAUri) {
  for (const char* odd : {"?", "#", "%"})
    EXPECT_EQ(Refusal(folder_ + "/a" + odd + "b"), kWrongSocketPath) << odd;
  EXPECT_EQ(Refusal("no/path/of/the/root"), kWrongSocketPath);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  const std::string path = folder_ + "/plain.sock";
  const auto plain = SocketListener::Make("unix:" + path, users_);
  ASSERT_TRUE(plain) << plain.error().detail;
  EXPECT_TRUE(std::filesystem::is_socket(path));
}

TEST_F(SocketListenerTest, SaysWhyItCannotBeThere) {
  EXPECT_EQ(Refusal(folder_ + "/none/cell.sock"), std::strerror(ENOENT));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none = before;
  none.rlim_cur = 0;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string refused = Refusal(folder_ + "/cell.sock");
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(refused, std::strerror(EMFILE));
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/cell.sock"));
}

// What another server has put there meanwhile stays.
TEST_F(SocketListenerTest, TakesItsOwnFileAway) {
  const std::string path = folder_ + "/cell.sock";
  {
    const auto first = SocketListener::Make("unix://" + path, users_);
    ASSERT_TRUE(first) << first.error().detail;
    std::filesystem::rename(path, folder_ + "/moved.sock");
    std::ofstream(path) << "of another";
  }
  EXPECT_TRUE(std::filesystem::exists(path));
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/moved.sock"));
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
