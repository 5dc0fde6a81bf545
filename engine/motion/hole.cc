#include "engine/motion/hole.h"

#include <cmath>

#include "engine/core/number_text.h"
#include "engine/core/units.h"

namespace rmlcell::motion {
namespace {

constexpr double kNormalPointTooClose_mm = 1e-6;
constexpr double kOnAxis_mm = 1e-6;
constexpr double kNearlyParallel = 0.9;  // cosine between the hole axis and the program's X axis

Vec3 InPlane(const Vec3& v, const Vec3& normal) { return v - normal * Dot(v, normal); }

}  // namespace

Result<HolePath> HoleThrough(const HoleCommand& hole) {
  if (!(hole.radius_mm > 0.0)) {
    return Error{ErrorCode::kHoleRadiusZero, "radius is " + ShortestText(hole.radius_mm), {}};
  }
  const Vec3 axis = hole.normal_point - hole.centre.tip;
  const double axis_length = Norm(axis);
  if (!(axis_length > kNormalPointTooClose_mm)) {
    return Error{ErrorCode::kHoleNormalUndefined, "the normal point is the centre", {}};
  }
  const Vec3 normal = axis * (1.0 / axis_length);

  HolePath path;
  Vec3 outward = InPlane(hole.from.tip - hole.centre.tip, normal);
  path.starts_on_axis = Norm(outward) <= kOnAxis_mm;
  if (path.starts_on_axis) {
    const bool along_x = std::abs(Dot(normal, hole.program_x)) > kNearlyParallel;
    outward = InPlane(along_x ? hole.program_y : hole.program_x, normal);
  }
  outward = outward * (1.0 / Norm(outward));
  const Vec3 entry = hole.centre.tip + outward * hole.radius_mm;

  TipPose at_entry{entry, hole.centre.a_rad, hole.centre.b_rad};
  if (Distance(hole.from.tip, entry) <= kTipLengthZero_mm) {
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
