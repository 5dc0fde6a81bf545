#pragma once

#include <chrono>
#include <functional>

namespace rmlcell::server {

// Time that only goes forward, for intervals and patience. A parameter of what measures, so that
// tests move it themselves. May be called from several threads at once.
using SteadyClock = std::function<std::chrono::steady_clock::time_point()>;

inline std::chrono::steady_clock::time_point SteadyTime() {
  return std::chrono::steady_clock::now();
}

}  // namespace rmlcell::server
