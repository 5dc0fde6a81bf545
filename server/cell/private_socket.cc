#include "server/cell/private_socket.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace rmlcell::server {
namespace {

constexpr std::string_view kSocketName = "/cell.sock";
constexpr std::size_t kSocketPathMax = sizeof(sockaddr_un::sun_path) - 1;

}  // namespace

Result<PrivateSocket> PrivateSocket::Make(const std::string& state_directory) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::absolute(state_directory, error) / "private";
  // An address of gRPC is a URI: some characters mean something else there.
  const bool plain = folder.string().find_first_of("?#%") == std::string::npos;
  if (!error && plain && folder.string().size() + kSocketName.size() <= kSocketPathMax) {
    fs::remove_all(folder, error);
    if (::mkdir(folder.c_str(), S_IRWXU) == 0) return PrivateSocket(folder.string());
  }
  std::string made = "/tmp/rmlcell-XXXXXX";
  if (::mkdtemp(made.data()) != nullptr) return PrivateSocket(std::move(made));
  return Error{ErrorCode::kCellPortUsed,
               std::string("no folder for the private socket: ") + std::strerror(errno),
               {}};
}

std::string PrivateSocket::address() const { return "unix:" + folder_ + std::string(kSocketName); }

PrivateSocket::PrivateSocket(PrivateSocket&& other) noexcept
    : folder_(std::exchange(other.folder_, {})) {}

PrivateSocket::~PrivateSocket() {
  if (folder_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace rmlcell::server
