#pragma once

#include <chrono>

#include "server/host/host_patience.h"

namespace rmlcell::server {

// How long a test waits for what must come; only one that fails waits that long.
inline constexpr std::chrono::minutes kComesWithin{1};

// Of a host in a test that is not about lateness: its disk and its servers may be slow.
inline HostPatience PatientHost() {
  return {.intent = kComesWithin,
          .durable = kComesWithin,
          .silence = kComesWithin,
          .keys = kComesWithin,
          .rest = kComesWithin,
          .line = {.last_words = kComesWithin}};
}

}  // namespace rmlcell::server
