#pragma once

#include <time.h>

#include <chrono>

#include "server/host/host_time.h"

// The clocks of the process that hosts a machine.
namespace rmlcell::server {

inline std::chrono::nanoseconds TimeBy(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

// Longer than a server is silent that is there: it answers four times a second, or about once where
// the machine stands.
inline constexpr std::chrono::seconds kServerSilent{2};

// It goes on while the computer sleeps.
inline std::chrono::nanoseconds SinceBoot() { return TimeBy(CLOCK_BOOTTIME); }

inline HostTime Now() {
  return {.steady = TimeBy(CLOCK_MONOTONIC),
          .wall = std::chrono::floor<std::chrono::microseconds>(std::chrono::system_clock::now())};
}

}  // namespace rmlcell::server
