#pragma once

#include <functional>
#include <string_view>

#include "engine/simulation/material/height_field.h"

namespace rmlcell::simulation {

// What is left of a block as a picture from above, the greatest Y above, lit from the upper left at
// 45 degrees: what no tool touched is the colour of wood, what was milled grey, the
// darker the deeper, and what was cut through dark blue. A pixel is a cell; of blocks with more
// than kReliefPixelsMax columns or rows a pixel is the mean of a square of cells. The bytes are
// valid during the call of `sink`; it returns false when it wants no more, and so does this.
bool WriteRelief(const HeightField& field, const std::function<bool(std::string_view)>& sink);

}  // namespace rmlcell::simulation
