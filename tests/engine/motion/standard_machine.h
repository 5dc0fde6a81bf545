#pragma once

#include <limits>

#include "engine/core/units.h"
#include "engine/motion/planner/planner.h"

namespace rmlcell::motion {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// The machine of motion.md section 1, as all figures of its section 12 assume it.
inline MachineLimits StandardMachine() {
  MachineLimits machine;
  machine.axes.speed = {500.0, 500.0, 500.0, kTurn, kTurn};
  machine.axes.acceleration = {2000.0, 2000.0, 2000.0, 20.0, 20.0};
  machine.axes.jerk = {40000.0, 40000.0, 40000.0, 400.0, 400.0};
  machine.axes.travel_min = {-600.0, -600.0, -1300.0, -12.6, -2.4};
  machine.axes.travel_max = {3600.0, 3100.0, 1100.0, 12.6, 2.4};
  return machine;
}

// Without a limit on jerk, and with axes that are no bound: all figures follow from two numbers,
// 100 mm/s and 1000 mm/s2.
inline MachineLimits PlainMachine() {
  MachineLimits machine;
  machine.tip_speed_mm_s = 100.0;
  machine.tip_acceleration_mm_s2 = 1000.0;
  machine.tip_jerk_mm_s3 = kNoLimit;
  machine.settling_s = 0.0;
  machine.axes.speed.fill(1e6);
  machine.axes.acceleration.fill(1e6);
  machine.axes.jerk.fill(kNoLimit);
  return machine;
}

}  // namespace rmlcell::motion
