#pragma once

#include <array>

#include "engine/motion/geometry/path.h"
#include "engine/motion/kinematics/kinematics.h"
#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion {

// What a path asks of the axes: first and second derivative of (column, A, B) by its variable s.
struct AxisDerivatives {
  AxisValues first{};
  AxisValues second{};
};
AxisDerivatives DerivativesAt(const PathPiece& path, const Head& head, double s);

// The same from the derivatives of the pose.
AxisDerivatives ThroughHead(const Head& head, const PathPose& pose, const PathDerivatives& first,
                            const PathDerivatives& second);

// `limits` lowered until no axis is asked for more than it can, anywhere on the piece: the last two
// lines of motion.md 5.1. Speeds of the axes count times `speed_share`, accelerations and jerks
// times `acceleration_share` (PTP; 1 on contours). Extremes along the piece are found to 1e-9.
struct AxisShares {
  double speed = 1.0;
  double acceleration = 1.0;
};
PathLimits WithinAxes(const PathPiece& path, const Head& head, const AxisLimits& axes,
                      const AxisShares& shares, PathLimits limits);

}  // namespace rmlcell::motion
