#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

#include "engine/core/result.h"

namespace grpc {
class Server;
}

namespace rmlcell::server {

class SocketUsers;

// A unix socket that clients of the server connect to. gRPC could listen itself, but would not say
// which user a call comes from; so each connection is taken here, asked for its user, and handed
// over.
class SocketListener {
 public:
  // `address`: "unix:/run/cell.sock". The socket that a dead server left behind is replaced, and no
  // other file. `users` outlives this. Error: CellPortUsed.
  static Result<std::unique_ptr<SocketListener>> Make(const std::string& address,
                                                      SocketUsers& users);
  // No more connections; the file is gone.
  ~SocketListener();
  SocketListener(const SocketListener&) = delete;
  SocketListener& operator=(const SocketListener&) = delete;

  // Once. `server` outlives this.
  void Serve(grpc::Server& server);

 private:
  SocketListener(std::string path, int listening, SocketUsers& users);
  void Take(grpc::Server& server, const std::stop_token& stop);

  const std::string path_;
  // Device and inode of our file; none: there is none.
  std::optional<std::pair<std::uint64_t, std::uint64_t>> file_;
  const int listening_;
  SocketUsers& users_;
  std::jthread thread_;
};

}  // namespace rmlcell::server
