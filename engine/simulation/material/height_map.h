#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "engine/simulation/material/height_field.h"

namespace rmlcell::simulation {

// The heights of a block as a grey picture of 16 bits, a pixel a cell, the greatest Y above: black
// is the bottom of the block and white its top, linear between them. Its texts say where that is:
//   "Left mm", "Front mm"  least X and Y of the block, from the work origin
//   "Cell mm"              edge of a cell
//   "Bottom mm", "Top mm"  height of black and of white
//   "Step mm"              height of one grey value, for people
// All numbers have as many digits as bring them back. The bytes are valid during the call of
// `sink`; it returns false when it wants no more, and so does this.
bool WriteHeightMap(const HeightField& field, const std::function<bool(std::string_view)>& sink);

struct HeightMap {
  Stock stock{};
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<float> heights{};  // row by row, from y_min on
};

// Reads one. Errors: CellBadText for what is no such picture, lacks one of the texts, or describes
// a block that cannot be.
Result<HeightMap> ReadHeightMap(std::string_view bytes);

}  // namespace rmlcell::simulation
