#include "engine/motion/geometry/hole.h"

#include <cmath>

#include "engine/core/number_text.h"
#include "engine/core/units.h"

namespace rmlcell::motion {
namespace {

constexpr double kNormalPointTooClose_mm = 1e-6;
constexpr double kOnAxis_mm = 1e-6;
constexpr double kNearlyParallel = 0.9;  // cosine between the hole axis and the program's X axis

MachineVector InPlane(const MachineVector& v, const MachineVector& normal) {
  return v - normal * v.dot(normal);
}

}  // namespace

Result<HolePath> HoleThrough(const HoleCommand& hole) {
  if (!(hole.radius_mm > 0.0)) {
    return Error{ErrorCode::kCellHoleRadius,
                 "radius is " + Told("radius", hole.radius_mm, "mm", ShortestText(hole.radius_mm)),
                 {}};
  }
  const MachineVector axis = hole.normal_point - hole.centre.tip;
  const double axis_length = axis.norm();
  if (!(axis_length > kNormalPointTooClose_mm)) {
    return Error{ErrorCode::kCellHoleNormal, "the normal point is the centre", {}};
  }
  const MachineVector normal = axis * (1.0 / axis_length);

  HolePath path;
  MachineVector outward = InPlane(hole.from.tip - hole.centre.tip, normal);
  path.starts_on_axis = outward.norm() <= kOnAxis_mm;
  if (path.starts_on_axis) {
    const bool along_x = std::abs(normal.dot(hole.program_x)) > kNearlyParallel;
    outward = InPlane(along_x ? hole.program_y : hole.program_x, normal);
  }
  outward = outward * (1.0 / outward.norm());
  const MachineVector entry = hole.centre.tip + outward * hole.radius_mm;

  TipPose at_entry{entry, hole.centre.a_rad, hole.centre.b_rad};
  if ((hole.from.tip - entry).norm() <= kTipLengthZero_mm) {
    at_entry.a_rad = hole.from.a_rad;  // the head turns over the circle instead, OPT-2.32
    at_entry.b_rad = hole.from.b_rad;
  } else {
    path.lead = PathPiece::Line(hole.from, at_entry);
  }
  path.circle = PathPiece::Circle(at_entry, hole.centre.tip, normal, kTurn, hole.centre.a_rad,
                                  hole.centre.b_rad);
  return path;
}

}  // namespace rmlcell::motion
