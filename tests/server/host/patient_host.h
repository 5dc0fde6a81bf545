#pragma once

#include <chrono>

#include "server/host/host_patience.h"

namespace rmlcell::server {

// How long a test waits for what must come; only one that fails waits that long.
inline constexpr std::chrono::minutes kComesWithin{1};

// Longer than any test: what is over by then alone never is.
inline constexpr std::chrono::minutes kLongerThanATest = 10 * kComesWithin;

// Of a host in a test that is not about lateness: its disk and its servers may be slow.
inline HostPatience PatientHost() {
  return {.intent = kLongerThanATest,
          .durable = kLongerThanATest,
          .silence = kLongerThanATest,
          .keys = kLongerThanATest,
          .rest = kLongerThanATest,
          .line = {.last_words = kLongerThanATest}};
}

}  // namespace rmlcell::server
