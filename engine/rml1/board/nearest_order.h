#pragma once

#include <span>
#include <vector>

#include "engine/rml1/board/contours.h"

namespace rmlcell::rml1 {

// In which order places are visited when each time the nearest one comes next, from `from` on. By a
// grid of squares with about one place each, so that ten thousand places take no longer than they
// must.
std::vector<std::size_t> NearestOrder(std::span<const PlanePoint> places, const PlanePoint& from);

}  // namespace rmlcell::rml1
