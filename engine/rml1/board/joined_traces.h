#pragma once

#include <cstddef>

#include "engine/rml1/board/distance_field.h"

namespace rmlcell::rml1 {

// Traces of a board, pieces of copper that touch nowhere, and how many of them lie with another one
// within the same line around them: no line parts these.
struct JoinedTraces {
  std::size_t traces = 0;
  std::size_t joined = 0;
};

// Copper is what is below `edge`, the line that parts it what ContoursAt(field, level) gives.
// Precondition: edge < level. Memory: some 16 bytes for each run of pixels in a row.
JoinedTraces CountJoined(const DistanceField& field, double edge, double level);

}  // namespace rmlcell::rml1
