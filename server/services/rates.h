#pragma once

#include <chrono>

#include "engine/core/result.h"

namespace rmlcell::server {

// What stands for now is told at most so often, whatever a client asks for.
inline constexpr double kRateMax_hz = 20.0;

// The least time between two messages of a watch with this max_rate_hz; 0 and 20: none of its own.
// Error: CellInvalidArgument.
inline Result<std::chrono::microseconds> IntervalOf(double max_rate_hz) {
  if (max_rate_hz == 0.0 || max_rate_hz == kRateMax_hz) return std::chrono::microseconds(0);
  if (!(max_rate_hz >= 1.0 && max_rate_hz < kRateMax_hz))
    return InvalidArgument("max_rate_hz: allowed are 1 to 20");
  return std::chrono::microseconds(static_cast<std::int64_t>(1e6 / max_rate_hz));
}

}  // namespace rmlcell::server
