#include "engine/motion/corner/axes_corner.h"

#include <algorithm>
#include <cmath>

#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr double kSameSpeed = 1e-6;  // of that of the axis: no more than a turn of 1e-6 rad

constexpr double kReversalCosine = -0.99619469809174555;  // 175 degrees

AxisValues Values(const PathDerivatives& d) {
  return {d.point.x(), d.point.y(), d.point.z(), d.a, d.b};
}

}  // namespace

AxesCorner::AxesCorner(const PathPiece& before, const PathPiece& after, double acceleration_share,
                       const MachineLimits& machine)
    : passage_(Passage::kThrough) {
  const AxisValues in = Values(before.First(before.length()));
  const AxisValues out = Values(after.First(0.0));
  double in_square = 0.0, out_square = 0.0, product = 0.0;
  const bool jerk_limited = std::isfinite(machine.tip_jerk_mm_s3);
  for (const std::size_t i : kAxes) {
    const double change = std::abs(out[i] - in[i]);
    if (change > kSameSpeed * machine.axes.speed[i]) passage_ = Passage::kBlend;
    by_acceleration_s_ =
        std::max(by_acceleration_s_, change / (acceleration_share * machine.axes.acceleration[i]));
    if (jerk_limited) {
      by_jerk_s2_ = std::max(by_jerk_s2_, change / (acceleration_share * machine.axes.jerk[i]));
    }
    const double per_speed = 1.0 / machine.axes.speed[i];
    in_square += in[i] * in[i] * per_speed * per_speed;
    out_square += out[i] * out[i] * per_speed * per_speed;
    product += in[i] * out[i] * per_speed * per_speed;
  }
  if (product < kReversalCosine * std::sqrt(in_square * out_square)) {
    passage_ = Passage::kStopReversal;
  }
}

// The curve lasts T_b = max(1.5 w by_acceleration, sqrt(6 w by_jerk)) and is w T_b long.
double AxesCorner::CutFor(double w) const {
  return 0.5 * w * std::max(1.5 * w * by_acceleration_s_, std::sqrt(6.0 * w * by_jerk_s2_));
}

// The jerk allows any speed where it has no limit.
double AxesCorner::SpeedFor(double cut) const {
  const double by_acceleration = std::sqrt(2.0 * cut / (1.5 * by_acceleration_s_));
  return std::min(by_acceleration, std::cbrt(4.0 * cut * cut / (6.0 * by_jerk_s2_)));
}

}  // namespace rmlcell::motion
