#pragma once

#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::optimo {

// The way from a state of motion to a lower speed that is held: first the acceleration is brought
// to zero, then the speed down, if it is higher by then.
struct Lead {
  double length = 0.0;
  double speed = 0.0;  // at its end
};

Lead LeadFrom(const motion::PathState& state, const motion::PathLimits& limits, double speed);

}  // namespace rmlcell::optimo
