#pragma once

#include <chrono>

#include "server/host/host_clock.h"
#include "server/host/host_line.h"
#include "server/host/key_desk.h"

namespace rmlcell::server {

// How long a host waits for others before it goes on without them.
struct HostPatience {
  // For the disk: what is about to begin is refused then, what moves is held. LIVE-3.21
  std::chrono::nanoseconds intent{std::chrono::milliseconds(500)};
  std::chrono::nanoseconds durable{std::chrono::seconds(1)};
  std::chrono::nanoseconds silence{kServerSilent};          // of a server
  std::chrono::nanoseconds keys{KeyDesk::kPatience};        // that are missing. LIVE-7.04
  std::chrono::nanoseconds rest{std::chrono::seconds(10)};  // to which what moves comes, at the end
  LineTimes line{};
};

}  // namespace rmlcell::server
