#include "server/cell/socket_listener.h"

#include <fcntl.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "server/auth/socket_users.h"
#include "server/base/log.h"
#include "tests/server/no_descriptors.h"

namespace rmlcell::server {
namespace {

constexpr std::string_view kWrongSocketPath =
    "the path of a socket has 1 to 107 characters, none of them ? # or %, and begins with / behind "
    "unix://";

// RFC 9113 3.4: what a client says first, with SETTINGS of nothing; a server says SETTINGS.
constexpr std::string_view kClientPreface("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 33);

sockaddr_un NameOf(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  path.copy(name.sun_path, sizeof(name.sun_path) - 1);
  return name;
}

int NewClient() { return ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0); }

// Says its first words.
void Connect(int client, const std::string& path) {
  const sockaddr_un name = NameOf(path);
  EXPECT_EQ(::connect(client, reinterpret_cast<const sockaddr*>(&name), sizeof(name)), 0);
  EXPECT_EQ(::send(client, kClientPreface.data(), kClientPreface.size(), MSG_NOSIGNAL), 33);
}

int Connected(const std::string& path) {
  const int client = NewClient();
  Connect(client, path);
  return client;
}

// As soon as the server has said something, too.
bool IsAnswered(int client) {
  pollfd answer{.fd = client, .events = POLLIN, .revents = 0};
  char first = 0;
  return ::poll(&answer, 1, 60'000) == 1 && ::recv(client, &first, 1, MSG_DONTWAIT) == 1;
}

// Speaks the protocol, and has no methods.
std::unique_ptr<grpc::Server> ServerOf(grpc::CallbackGenericService& service) {
  grpc::ServerBuilder builder;
  builder.RegisterCallbackGenericService(&service);
  return builder.BuildAndStart();
}

// True as soon as more stands in the file, which is not opened for that.
bool IsLongerThan(std::uintmax_t bytes, const std::string& file) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::filesystem::file_size(file) <= bytes) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

// What a log says, without who says it when.
std::vector<std::string> MessagesIn(const std::string& file) {
  std::vector<std::string> messages;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    messages.push_back(line.substr(line.rfind("] ") + 2));
  return messages;
}

// As long as it lives this process has no standard input: what is opened next has number 0.
class NoInput {
 public:
  NoInput() : before_(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3)) { ::close(STDIN_FILENO); }
  ~NoInput() {
    if (before_ < 0) return;
    ::dup2(before_, STDIN_FILENO);
    ::close(before_);
  }
  NoInput(const NoInput&) = delete;
  NoInput& operator=(const NoInput&) = delete;

 private:
  const int before_;
};

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
  std::string refused;
  {
    const NoDescriptors none;
    refused = Refusal(folder_ + "/cell.sock");
  }
  EXPECT_EQ(refused, std::strerror(EMFILE));
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/cell.sock"));
}

// A service may be started without standard input.
TEST_F(SocketListenerTest, ASocketMayHaveNumber0) {
  const std::string path = folder_ + "/cell.sock";
  const auto first = SocketListener::Make("unix://" + path, users_);
  ASSERT_TRUE(first) << first.error().detail;
  std::string of_a_living_one;
  std::string of_none;
  {
    const NoInput none;
    of_a_living_one = Refusal(path);
    of_none = Refusal(folder_ + "/another.sock");
  }
  EXPECT_EQ(of_a_living_one, "another server listens there");
  EXPECT_EQ(of_none, "");
}

TEST_F(SocketListenerTest, AClientMayHaveNumber0) {
  grpc::CallbackGenericService service;
  const std::unique_ptr<grpc::Server> server = ServerOf(service);
  ASSERT_NE(server, nullptr);
  const std::string path = folder_ + "/cell.sock";
  auto made = SocketListener::Make("unix://" + path, users_);
  ASSERT_TRUE(made) << made.error().detail;
  std::unique_ptr<SocketListener> listener = *std::move(made);
  const int client = Connected(path);
  {
    const NoInput none;
    listener->Serve(*server);
    EXPECT_TRUE(IsAnswered(client));
    listener.reset();
    ::close(client);
    server->Shutdown(std::chrono::system_clock::now());
    server->Wait();
  }
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

// What a server that was killed has left there is taken away: nobody answers at it.
TEST_F(SocketListenerTest, ReplacesTheSocketOfADeadServer) {
  const std::string path = folder_ + "/cell.sock";
  const sockaddr_un name = NameOf(path);
  const int dead = NewClient();
  EXPECT_EQ(::bind(dead, reinterpret_cast<const sockaddr*>(&name), sizeof(name)), 0);
  ::close(dead);
  ASSERT_TRUE(std::filesystem::is_socket(path));
  EXPECT_EQ(Refusal(path), "");
  EXPECT_FALSE(std::filesystem::exists(path));
}

// socket_users.h: who is at the other end is known before anything of him is heard.
TEST_F(SocketListenerTest, KnowsWhoComes) {
  grpc::CallbackGenericService service;
  const std::unique_ptr<grpc::Server> server = ServerOf(service);
  ASSERT_NE(server, nullptr);
  const std::string path = folder_ + "/cell.sock";
  auto made = SocketListener::Make("unix://" + path, users_);
  ASSERT_TRUE(made) << made.error().detail;
  std::unique_ptr<SocketListener> listener = *std::move(made);
  listener->Serve(*server);
  const int client = Connected(path);
  EXPECT_TRUE(IsAnswered(client));
  std::vector<unsigned> known;
  for (int descriptor = 0; descriptor < 1'024; ++descriptor) {
    const auto user = users_.Of(std::string(SocketUsers::kPeer) + std::to_string(descriptor));
    if (user) known.push_back(*user);
  }
  EXPECT_EQ(known, std::vector<unsigned>{::getuid()});
  listener.reset();
  ::close(client);
  server->Shutdown(std::chrono::system_clock::now());
  server->Wait();
}

// Who comes while no descriptor is free waits, and the log says so, each time; there is one again,
// and it is served.
TEST_F(SocketListenerTest, AClientWaitsForADescriptor) {
  const std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
  ASSERT_TRUE(StartLog("cell-waits", "info", "text", folder_ + "/log"));
  grpc::CallbackGenericService service;
  const std::unique_ptr<grpc::Server> server = ServerOf(service);
  const std::string path = folder_ + "/cell.sock";
  auto made = SocketListener::Make("unix://" + path, users_);
  EXPECT_TRUE(made);
  if (server != nullptr && made) {
    std::unique_ptr<SocketListener> listener = *std::move(made);
    const int client = Connected(path);
    {
      const NoDescriptors none;
      listener->Serve(*server);
      EXPECT_TRUE(IsLongerThan(0, folder_ + "/log"));
    }
    EXPECT_TRUE(IsAnswered(client));
    const std::uintmax_t once = std::filesystem::file_size(folder_ + "/log");
    const int next = NewClient();
    {
      const NoDescriptors none;  // but for the one that is kept for whoever comes next
      Connect(next, path);
      EXPECT_TRUE(IsLongerThan(once, folder_ + "/log"));
    }
    EXPECT_TRUE(IsAnswered(next));
    listener.reset();
    ::close(client);
    ::close(next);
    server->Shutdown(std::chrono::system_clock::now());
    server->Wait();
  }
  spdlog::drop("cell-waits");
  spdlog::set_default_logger(before);
  const std::string waits = "connections to " + path + " wait: " + std::strerror(EMFILE);
  const std::vector<std::string> told = {waits, waits};
  EXPECT_EQ(MessagesIn(folder_ + "/log"), told);
}

}  // namespace
}  // namespace rmlcell::server
