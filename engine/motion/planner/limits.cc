#include <algorithm>
#include <cmath>

#include "engine/motion/kinematics/axes.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "engine/motion/planner/planner.h"

namespace rmlcell::motion {

bool LinesFollowTip(const MachineLimits& machine) {
  bool enough = true;
  for (const std::size_t i : kLinearAxes) {
    enough = enough && machine.axes.speed[i] >= machine.tip_speed_mm_s &&
             machine.axes.acceleration[i] >= machine.tip_acceleration_mm_s2 &&
             (machine.axes.jerk[i] >= machine.tip_jerk_mm_s3 || std::isinf(machine.tip_jerk_mm_s3));
  }
  return enough;
}

PathLimits LimitsOf(const MoveCommand& move, const MachineLimits& machine) {
  const double share = std::clamp(move.acceleration_fraction, 0.0, 1.0);
  const double speed_share = std::clamp(move.speed_fraction, 0.0, 1.0);
  const bool contour = move.kind == MoveCommand::Kind::kContour && !move.path.by_sigma();
  if (!contour) {
    // Positioning, and turning the head about a tip that stands: the axes alone set the limits.
    const double jerk = std::isinf(machine.tip_jerk_mm_s3) ? HUGE_VAL : kLargest;
    return WithinAxes(move.path, move.head, machine.axes, {speed_share, share},
                      {kLargest, kLargest, jerk});
  }
  PathLimits limits = TipLimits(move, machine);
  if (move.path.kind() == PathPiece::Kind::kArc) {
    const double radius = move.path.radius_mm();
    const double normal = machine.curve_normal * machine.tip_acceleration_mm_s2;
    limits.acceleration =
        std::min(limits.acceleration, machine.curve_tangential * machine.tip_acceleration_mm_s2);
    limits.speed = std::min(limits.speed, std::sqrt(normal * radius));
    if (std::isfinite(machine.tip_jerk_mm_s3)) {
      const double jerk = machine.curve_jerk * machine.tip_jerk_mm_s3;
      limits.speed = std::min(limits.speed, std::cbrt(jerk * radius * radius));
    }
  }
  return WithinAxes(move.path, move.head, machine.axes, {1.0, 1.0}, limits);
}

}  // namespace rmlcell::motion
