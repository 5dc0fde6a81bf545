#include "engine/optimo/ride/motion_place.h"

#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/kinematics/kinematics.h"

namespace rmlcell::optimo {
namespace {

using Kind = motion::PathPiece::Kind;

double PlaceOnArc(const motion::PathPiece& arc, const motion::MachinePoint& point) {
  const motion::MachineVector start = arc.from().point - arc.centre();
  const motion::MachineVector here = point - arc.centre();
  double angle = std::atan2(arc.normal().dot(start.cross(here)), start.dot(here));
  if (angle < 0.0) angle += kTurn;
  return angle * arc.radius_mm();
}

motion::AxisValues Values(const motion::AxisPose& pose) {
  return {pose.column.x(), pose.column.y(), pose.column.z(), pose.a_rad, pose.b_rad};
}

// By the axis that goes farthest.
PlaceOnMove PlaceInAxes(const motion::PathPiece& motion, const motion::PathPiece& move) {
  const motion::AxisValues from = Values(move.axes_from()), to = Values(move.axes_to());
  std::size_t widest = 0;
  for (std::size_t i = 1; i < motion::kAxisCount; ++i) {
    if (std::abs(to[i] - from[i]) > std::abs(to[widest] - from[widest])) widest = i;
  }
  const double begin = Values(motion.axes_from())[widest];
  const double rate = (to[widest] - from[widest]) / move.length();
  const double rate_of_motion = (Values(motion.axes_to())[widest] - begin) / motion.length();
  return {.begin = (begin - from[widest]) / rate, .scale = rate_of_motion / rate};
}

}  // namespace

std::optional<PlaceOnMove> PlaceOf(const motion::PathPiece& motion, const motion::PathPiece& move) {
  if (motion.kind() != move.kind() || !(motion.length() > 0.0)) return std::nullopt;
  switch (motion.kind()) {
    case Kind::kLine:
      return PlaceOnMove{.begin = (motion.from().point - move.from().point).norm()};
    case Kind::kArc:
      return PlaceOnMove{.begin = PlaceOnArc(move, motion.from().point)};
    case Kind::kJoint:
      return PlaceInAxes(motion, move);
    default:
      return std::nullopt;
  }
}

motion::PathPiece RestOfMove(const motion::PathPiece& move, const PlaceOnMove& place, double s) {
  motion::PathPiece rest = move.Part(place.begin + s * place.scale, move.length());
  if (rest.kind() == Kind::kJoint) rest.MeasureBy(rest.length() / place.scale);
  return rest;
}

}  // namespace rmlcell::optimo
