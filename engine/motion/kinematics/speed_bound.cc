#include "engine/motion/kinematics/speed_bound.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/motion/kinematics/axes.h"
#include "engine/motion/kinematics/axis_demand.h"

namespace rmlcell::motion {
namespace {

constexpr double kBoundSampleAngle_rad = 0.05;
constexpr int kBoundIntervalsMin = 16;
constexpr int kBoundIntervalsMax = 1024;

// Half of an axis' acceleration is for the bend, the other half for changes of speed: 5.1.
constexpr double kBendShare = 0.5;

}  // namespace

SpeedBound TightestBound(const PathPiece& path, const Head& head, const MachineLimits& machine,
                         double enough) {
  SpeedBound tightest{.speed = enough};
  // What is not asked for anything allows any speed.
  const auto keep = [&tightest](SpeedBound::Cause cause, int axis, double speed) {
    if (speed < tightest.speed) tightest = {cause, axis, speed};
  };
  const bool arc = path.kind() == PathPiece::Kind::kArc;
  if (arc) {
    const double radius = path.radius_mm();
    keep(SpeedBound::Cause::kRadius, -1, std::sqrt(machine.normal_acceleration() * radius));
    if (std::isfinite(machine.tip_jerk_mm_s3)) {
      keep(SpeedBound::Cause::kRadius, -1, std::cbrt(machine.normal_jerk() * radius * radius));
    }
  }
  const double turning = std::abs(path.to().a_rad - path.from().a_rad) +
                         std::abs(path.to().b_rad - path.from().b_rad) +
                         (arc ? path.sweep_rad() : 0.0);
  const int intervals =
      turning > 0.0
          ? static_cast<int>(std::clamp(std::ceil(turning / kBoundSampleAngle_rad),
                                        double{kBoundIntervalsMin}, double{kBoundIntervalsMax}))
          : 1;
  for (int k = 0; k <= intervals; ++k) {
    const double s = path.length() * k / intervals;
    if (arc) {  // what the bend takes of the axes by itself; with a steady head all that is taken
      const MachineVector bend = path.Second(s).point;
      for (const auto& [axis, value] : {std::pair{0, bend.x()}, {1, bend.y()}, {2, bend.z()}}) {
        const double acceleration = machine.axes.acceleration[static_cast<std::size_t>(axis)];
        keep(SpeedBound::Cause::kRadius, -1,
             std::sqrt(kBendShare * acceleration / std::abs(value)));
      }
    }
    const AxisDerivatives q = DerivativesAt(path, head, s);
    for (const std::size_t i : kAxes) {
      const auto axis = static_cast<int>(i);
      keep(SpeedBound::Cause::kAxis, axis, machine.axes.speed[i] / std::abs(q.first[i]));
      keep(SpeedBound::Cause::kAxis, axis,
           std::sqrt(kBendShare * machine.axes.acceleration[i] / std::abs(q.second[i])));
    }
  }
  return tightest;
}

}  // namespace rmlcell::motion
