#pragma once

#include "engine/motion/geometry/path.h"
#include "engine/motion/kinematics/machine_limits.h"

namespace rmlcell::motion {

// What keeps a contour from being passed at any speed: the third and fourth line of motion.md 5.1.
struct SpeedBound {
  // The radius of an arc counts, whether the tip or the axes could not take the bend; an axis,
  // where the head turns, or one that is slower than the tip.
  enum class Cause { kNone, kRadius, kAxis };
  Cause cause = Cause::kNone;
  int axis = -1;       // kAxis: 0..4, X Y Z A B
  double speed = 0.0;  // mm/s that it allows, to 1 % where the head turns
};

// The tightest of them on a line or an arc; kNone when it is above `enough`. For those who explain
// a plan: the planner itself finds the speed exactly, and not which axis it comes from.
// Precondition: `path` is not by sigma.
SpeedBound TightestBound(const PathPiece& path, const Head& head, const MachineLimits& machine,
                         double enough);

}  // namespace rmlcell::motion
