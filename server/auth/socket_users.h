#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string_view>

namespace rmlcell::server {

// Who is at the other end of connections over unix sockets, as the kernel says: by the peer that
// gRPC names calls of such a connection with, "fd:17". Safe from any thread.
class SocketUsers {
 public:
  static constexpr std::string_view kPeer = "fd:";

  // A connection; an earlier one with this descriptor is gone.
  void Note(int descriptor, unsigned user);
  // Nothing: it is no such peer.
  std::optional<unsigned> Of(std::string_view peer) const;

 private:
  mutable std::mutex mutex_;
  std::map<int, unsigned> users_;
};

}  // namespace rmlcell::server
