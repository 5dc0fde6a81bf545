#include "server/cell/socket_listener.h"

#include <fcntl.h>
#include <grpcpp/server.h>
#include <grpcpp/server_posix.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "server/auth/socket_users.h"

namespace rmlcell::server {
namespace {

constexpr int kBacklog = 128;
constexpr std::chrono::milliseconds kTriedAgainAfter{100};  // no descriptor was free

std::string PathOf(const std::string& address) {
  std::string path = address.substr(std::string_view("unix:").size());
  if (path.starts_with("//")) path.erase(0, 2);
  return path;
}

int NewSocket() { return ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0); }

// Only a file that a dead server left behind may be taken away.
bool IsInUse(const sockaddr_un& name) {
  const int probe = NewSocket();
  if (probe < 0) return false;
  const bool answers =
      ::connect(probe, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) == 0 ||
      errno == EAGAIN;
  ::close(probe);
  return answers;
}

}  // namespace

Result<std::unique_ptr<SocketListener>> SocketListener::Make(const std::string& address,
                                                             SocketUsers& users) {
  const auto refuse = [&](const std::string& why) {
    return Error{ErrorCode::kCellPortUsed, "cannot listen on " + address + ": " + why, {}};
  };
  const std::string path = PathOf(address);
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(name.sun_path))
    return refuse("the path of a socket has 1 to " + std::to_string(sizeof(name.sun_path) - 1) +
                  " characters");
  path.copy(name.sun_path, path.size());
  if (IsInUse(name)) return refuse("another server listens there");
  const int listening = NewSocket();
  if (listening < 0) return refuse(std::strerror(errno));
  // One that is no socket stays, and then there is no room for ours.
  std::unique_ptr<SocketListener> listener(new SocketListener(path, listening, users));
  if (const auto left = ::unlink(path.c_str()); left != 0 && errno != ENOENT)
    return refuse(std::strerror(errno));
  if (::bind(listening, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0 ||
      ::listen(listening, kBacklog) != 0)
    return refuse(std::strerror(errno));
  return listener;
}

SocketListener::SocketListener(std::string path, int listening, SocketUsers& users)
    : path_(std::move(path)), listening_(listening), users_(users) {}

SocketListener::~SocketListener() {
  ::shutdown(listening_, SHUT_RDWR);  // wakes the thread
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  ::close(listening_);
  ::unlink(path_.c_str());
}

void SocketListener::Serve(grpc::Server& server) {
  // Its thread waits in accept().
  ::fcntl(listening_, F_SETFL, ::fcntl(listening_, F_GETFL) & ~O_NONBLOCK);
  thread_ = std::jthread([this, &server] { Take(server); });
}

void SocketListener::Take(grpc::Server& server) {
  for (;;) {
    const int connection = ::accept4(listening_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (connection >= 0) {
      ucred who{};
      socklen_t size = sizeof(who);
      if (::getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0) {
        ::close(connection);
        continue;
      }
      users_.Note(connection, who.uid);
      grpc::AddInsecureChannelFromFd(&server, connection);
      continue;
    }
    if (errno == ECONNABORTED || errno == EINTR) continue;
    if (errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM) return;
    spdlog::warn("connections to {} wait: {}", path_, std::strerror(errno));
    std::this_thread::sleep_for(kTriedAgainAfter);
  }
}

}  // namespace rmlcell::server
