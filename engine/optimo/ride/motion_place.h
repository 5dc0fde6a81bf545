#pragma once

#include <optional>

#include "engine/motion/geometry/path.h"

namespace rmlcell::optimo {

// Where a planned motion lies on the move that it is a part of.
struct PlaceOnMove {
  double begin = 0.0;  // its start, by the s of the move
  double scale = 1.0;  // s of the move per s of the motion: measures of COORD ROBOT may differ
};

// Nothing on curves of passages, nor where the head turns about a tip that stands: chains that are
// planned anew on the way do not go on from there.
std::optional<PlaceOnMove> PlaceOf(const motion::PathPiece& motion, const motion::PathPiece& move);

// What is left of the move from the place `s` of the motion on, measured as that is.
motion::PathPiece RestOfMove(const motion::PathPiece& move, const PlaceOnMove& place, double s);

}  // namespace rmlcell::optimo
