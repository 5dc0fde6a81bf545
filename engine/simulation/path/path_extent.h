#pragma once

#include <array>

#include "engine/machine/shape.h"
#include "engine/simulation/path/part_curve.h"

// How far a part of a path reaches, exactly: where a coordinate turns round is solved for, not
// sampled.
namespace rmlcell::simulation {

// What one coordinate does along a part of a path.
struct CoordinateSweep {
  double minimum = 0.0;
  double maximum = 0.0;
  double travel = 0.0;  // sum of what it moved, to and fro
  int turns = 0;        // times that it turned round on the way
  int first_sign = 0;   // direction at the start and at the end: -1, 0 (does not move), 1
  int last_sign = 0;
};
using PointSweep = std::array<CoordinateSweep, 3>;  // x y z

machine::Box BoxOf(const PointSweep& sweep);

class PartShape;  // part_shape.h: what these share

// Of the tip, machine frame. Once for each shape: PartShape::tip() keeps it.
PointSweep TipSweep(PartShape& shape);
// Of the column of a gantry.
PointSweep ColumnSweep(PartShape& shape);
// Of A and B.
std::array<CoordinateSweep, 2> RotarySweep(PartShape& shape);

// Length of the tip's way, mm; to 1e-9 where the tip bows because the head turns (COORD ROBOT).
double TipLength(PartShape& shape);

}  // namespace rmlcell::simulation
