#include "engine/optimo/ride/lead.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::optimo {

Lead LeadFrom(const motion::PathState& state, const motion::PathLimits& limits, double speed) {
  const double a = state.acceleration;
  const double time = std::abs(a) / limits.jerk;  // zero where the jerk has no limit
  const double level = std::max(state.speed + 0.5 * a * time, 0.0);
  const double end = std::min(level, speed);
  return {.length = time * (state.speed + a * time / 3.0) + motion::RampLength(level, end, limits),
          .speed = end};
}

}  // namespace rmlcell::optimo
