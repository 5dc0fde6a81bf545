#pragma once

#include "engine/optimo/offline/offset_path.h"

namespace rmlcell::optimo {

// A straight leg with the tool along Z.
inline Leg FlatLeg(ProgramVector from, ProgramVector to) {
  Leg leg;
  leg.from = from;
  leg.to = to;
  leg.tool_from = leg.tool_to = leg.tool_via = {0, 0, 1};
  Prepare(leg);
  return leg;
}

}  // namespace rmlcell::optimo
