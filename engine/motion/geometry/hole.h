#pragma once

#include "engine/motion/geometry/path.h"

namespace rmlcell::motion {

// What PATH HOLE needs: everything in the machine frame.
struct HoleCommand {
  TipPose from;
  TipPose centre;  // its angles are those of the circle
  // The circle runs counter-clockwise seen from here; the distance has no effect.
  MachinePoint normal_point;
  double radius_mm = 0.0;
  // The axes of the program's frame: where a start on the axis enters.
  MachineVector program_x{1.0, 0.0, 0.0};
  MachineVector program_y{0.0, 1.0, 0.0};
};

// A hole as two motions: the lead ends at rest without settling, the circle ends where it began.
struct HolePath {
  PathPiece lead;               // length 0 when the start lies on the circle
  PathPiece circle;             // one full turn
  bool starts_on_axis = false;  // error 129 of the teach simulator, OPT-2.28
};

// motion.md 3.3; OPT-B.10 to B.14. Errors, in this order (OPT-B.15): CellHoleRadius,
// CellHoleNormal.
Result<HolePath> HoleThrough(const HoleCommand& hole);

}  // namespace rmlcell::motion
