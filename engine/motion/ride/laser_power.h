#pragma once

#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion {

// WORKDEF 1: power in proportion to the tip speed, on the line through the origin and (speed,
// power), never above 100 %. motion.md 8.1.
struct PowerLaw {
  double speed_percent = 100.0;  // of the highest tip speed; above 0
  double power_percent = 100.0;
  double tip_speed_max_mm_s = 500.0;

  double PercentAt(double tip_speed_mm_s) const;
};

// Energy in J that a laser of `rated_W` gives while the tip runs through `profile` (s in mm):
// exact, also where the power saturates on the way.
double EnergyOf(const SpeedProfile& profile, const PowerLaw& law, double rated_W);

}  // namespace rmlcell::motion
