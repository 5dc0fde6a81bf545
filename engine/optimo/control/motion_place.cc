#include "engine/optimo/control/motion_place.h"

#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::optimo {

bool LineOrArc(const motion::PathPiece& path) {
  return path.kind() == motion::PathPiece::Kind::kLine ||
         path.kind() == motion::PathPiece::Kind::kArc;
}

double PlaceOn(const motion::PathPiece& whole, const motion::Vec3& point) {
  if (whole.kind() == motion::PathPiece::Kind::kLine) {
    return motion::Norm(point - whole.from().tip);
  }
  const motion::Vec3 start = whole.from().tip - whole.centre();
  const motion::Vec3 here = point - whole.centre();
  double angle =
      std::atan2(motion::Dot(whole.normal(), motion::Cross(start, here)), motion::Dot(start, here));
  if (angle < 0.0) angle += kTurn;
  return angle * whole.radius_mm();
}

}  // namespace rmlcell::optimo
