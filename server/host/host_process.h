#pragma once

#include <atomic>
#include <string>

#include "server/host/host_patience.h"

namespace rmlcell::server {

// The host of one machine that lives: a process of its own, which outlives its server.
struct HostOptions {
  std::string server{};      // "unix:/path" or "host:port"
  std::string join_token{};  // of the server
  std::string machine{};     // "machines/mill-1"
  std::string journal{};     // path of its journal
  HostPatience patience{};
};

// Until it is to stop, or the machine is another host's: the exit code of the process.
int RunHost(const HostOptions& options, const std::atomic<bool>& stopping);

}  // namespace rmlcell::server
