#pragma once

#include <vector>

#include "engine/rml1/board/distance_field.h"

namespace rmlcell::rml1 {

struct PlanePoint {
  double x = 0.0;
  double y = 0.0;

  bool operator==(const PlanePoint&) const = default;
};

// A closed line, without its first point again at the end.
using Loop = std::vector<PlanePoint>;

// The lines along which a field has a value, by marching squares with straight interpolation, in
// places of its grid. What is below the value lies to their left: loops around it are
// counterclockwise, loops around holes in it clockwise. Precondition: the field is not below the
// value at its edge, so that every line is closed.
std::vector<Loop> ContoursAt(const DistanceField& field, double level);

// Above 0: counterclockwise.
double SignedArea(const Loop& loop);

}  // namespace rmlcell::rml1
