#pragma once

namespace rmlcell::server {

// Of the line between a server and a host.
inline constexpr int kHostProtocol = 1;

// A server takes hosts of the version before its own, too: they live on while it is upgraded.
// LIVE-3.07
constexpr bool TakesHost(int protocol, int own = kHostProtocol) {
  return protocol >= 1 && (protocol == own || protocol == own - 1);
}

}  // namespace rmlcell::server
