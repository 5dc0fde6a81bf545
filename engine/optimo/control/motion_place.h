#pragma once

#include "engine/motion/path.h"

namespace rmlcell::optimo {

// Chains that are planned anew on the way go on from the middle of lines and arcs only.
bool LineOrArc(const motion::PathPiece& path);

// How far along `whole`, a line or an arc, the point of it lies, mm.
double PlaceOn(const motion::PathPiece& whole, const motion::Vec3& point);

}  // namespace rmlcell::optimo
