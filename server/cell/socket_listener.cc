#include "server/cell/socket_listener.h"

#include <fcntl.h>
#include <grpcpp/server.h>
#include <grpcpp/server_posix.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/stat.h>
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
constexpr std::chrono::milliseconds kTriedAgainAfter{100};  // where no descriptor is free

// Empty: clients, for whom it is a URI, would look for another file.
std::string PathOf(const std::string& address) {
  std::string path = address.substr(std::string_view("unix:").size());
  if (path.find_first_of("?#%") != std::string::npos) return {};
  if (!path.starts_with("//")) return path;
  path.erase(0, 2);
  return path.starts_with('/') ? path : std::string();
}

int NewSocket() { return ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0); }

// Which file stands there.
std::optional<std::pair<std::uint64_t, std::uint64_t>> FileAt(const std::string& path) {
  struct stat facts {};
  if (::lstat(path.c_str(), &facts) != 0) return {};
  return std::pair<std::uint64_t, std::uint64_t>(facts.st_dev, facts.st_ino);
}

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
                  " characters, none of them ? # or %, and begins with / behind unix://");
  path.copy(name.sun_path, path.size());
  if (IsInUse(name)) return refuse("another server listens there");
  const int listening = NewSocket();
  if (listening < 0) return refuse(std::strerror(errno));
  std::unique_ptr<SocketListener> listener(new SocketListener(path, listening, users));
  struct stat left {};
  if (::lstat(path.c_str(), &left) == 0) {
    if (!S_ISSOCK(left.st_mode)) return refuse("there is a file that is no socket");
    if (::unlink(path.c_str()) != 0) return refuse(std::strerror(errno));
  }
  if (::bind(listening, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0)
    return refuse(std::strerror(errno));
  listener->file_ = FileAt(path);
  if (::listen(listening, kBacklog) != 0) return refuse(std::strerror(errno));
  return listener;
}

SocketListener::SocketListener(std::string path, int listening, SocketUsers& users)
    : path_(std::move(path)), listening_(listening), users_(users) {}

SocketListener::~SocketListener() {
  thread_.request_stop();
  ::shutdown(listening_, SHUT_RDWR);  // wakes it
  if (thread_.joinable()) thread_.join();
  // In this order: of a server that comes meanwhile the file is not taken.
  if (file_ && FileAt(path_) == file_) ::unlink(path_.c_str());
  ::close(listening_);
}

void SocketListener::Serve(grpc::Server& server) {
  // Its thread waits in accept().
  ::fcntl(listening_, F_SETFL, ::fcntl(listening_, F_GETFL) & ~O_NONBLOCK);
  thread_ = std::jthread([this, &server](const std::stop_token& stop) { Take(server, stop); });
}

void SocketListener::Take(grpc::Server& server, const std::stop_token& stop) {
  bool told = false;
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
      told = false;
      continue;
    }
    if (stop.stop_requested()) return;
    if (errno == ECONNABORTED || errno == EINTR) continue;
    if (!std::exchange(told, true))
      spdlog::warn("connections to {} wait: {}", path_, std::strerror(errno));
    std::this_thread::sleep_for(kTriedAgainAfter);
  }
}

}  // namespace rmlcell::server
