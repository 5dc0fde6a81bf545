#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string_view>

#include "engine/simulation/material/height_field.h"

namespace rmlcell::simulation {

using Colour = std::array<int, 3>;  // 0 to 255 each

// The cells of a block as a picture (PNG), the greatest Y above. A pixel is a cell; of blocks with
// more than kPicturePixelsMax columns or rows a pixel is the mean of a square of cells. False when
// `sink` wants no more.
inline constexpr std::size_t kPicturePixelsMax = 2048;
bool WriteCellPicture(const HeightField& field,
                      const std::function<Colour(std::size_t column, std::size_t row)>& colour,
                      const std::function<bool(std::string_view)>& sink);

}  // namespace rmlcell::simulation
