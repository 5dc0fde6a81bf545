#pragma once

#include "engine/simulation/material/height_field.h"

namespace rmlcell::simulation {

// Edge of the cells of a block when nobody gave one, mm: 0.1, or a quarter of what the tool cuts at
// the least where that is less: the width of a flat or ball tool, the tip of a pointed one,
// and of a point without a tip its width 0.1 mm deep, for how deep a program goes nobody knows
// before it runs. It is not made finer than 0.1 beyond 4,194,304 cells (16 MiB). `block.cell` is
// not looked at. Precondition: the block is sound but for its cells, CheckTool is well.
double StandardCell(const Stock& block, const MillTool& tool);

}  // namespace rmlcell::simulation
