#pragma once

#include <string>

#include "engine/core/result.h"

namespace rmlcell::server {

// Where the gateway of the web port and the server's own workers reach it, whatever it listens on
// for others: a unix socket in a folder that only its user may enter. Gone with this object.
class PrivateSocket {
 public:
  // In the state directory, which one server has at a time, so that a server that was killed leaves
  // nothing behind for ever; where its path is too long for a socket, in the temporary folder.
  // Error: CellPortUsed, where no folder can be made.
  static Result<PrivateSocket> Make(const std::string& state_directory);

  PrivateSocket(PrivateSocket&& other) noexcept;
  PrivateSocket& operator=(PrivateSocket&&) = delete;
  ~PrivateSocket();

  std::string address() const;  // "unix:/var/lib/rmlcell/private/cell.sock"

 private:
  explicit PrivateSocket(std::string folder) : folder_(std::move(folder)) {}
  std::string folder_;  // empty: moved away
};

}  // namespace rmlcell::server
