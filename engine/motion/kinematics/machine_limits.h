#pragma once

#include <limits>

#include "engine/motion/kinematics/kinematics.h"

namespace rmlcell::motion {

// What the machine can do; motion.md section 1.
struct MachineLimits {
  double tip_speed_mm_s = 500.0;
  double tip_acceleration_mm_s2 = 2000.0;
  double tip_jerk_mm_s3 = 40000.0;  // infinite: trapezoids, and the jerk of the axes counts nowhere
  double curve_normal = 0.8;        // shares of the tip limits on curved pieces
  double curve_tangential = 0.6;
  double curve_jerk = 0.8;
  double settling_s = 0.048;  // after a move without /FLY
  // How a corner is passed: on a curve beside it (motion.md section 4), or through it. Then
  // polylines are kept exactly, and a vertex is passed at the speed at which no axis has to jump by
  // more than the junction jump (motion.md section 7).
  enum class Corners { kOnCurves, kThrough };
  Corners corners = Corners::kOnCurves;
  double junction_jump_mm_s = 0.0;
  // The same for the rotary axis A, where it turns in step with the tip.
  double junction_jump_a_rad_s = std::numeric_limits<double>::infinity();
  // Ramps run across the passages between moves (level 2 of motion.md 5.4). False: the acceleration
  // is zero at each of them (level 1, the reference); never faster.
  bool ramps_across_passages = true;
  AxisLimits axes;

  double normal_acceleration() const { return curve_normal * tip_acceleration_mm_s2; }
  double normal_jerk() const { return curve_jerk * tip_jerk_mm_s3; }
};

// Stands for "no limit" where a finite figure is needed.
inline constexpr double kLargest = 1e12;

}  // namespace rmlcell::motion
