#pragma once

#include "engine/rml1/board/contours.h"

namespace rmlcell::rml1 {

// A closed line with fewer points, none of which is left out by more than the tolerance (Douglas
// and Peucker), without recursion. It keeps the first point.
Loop Simplified(const Loop& loop, double tolerance);

}  // namespace rmlcell::rml1
