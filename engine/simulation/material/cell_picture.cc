#include "engine/simulation/material/cell_picture.h"

#include <algorithm>

#include "engine/simulation/material/png.h"

namespace rmlcell::simulation {

bool WriteCellPicture(const HeightField& field,
                      const std::function<Colour(std::size_t column, std::size_t row)>& colour,
                      const std::function<bool(std::string_view)>& sink) {
  const std::size_t longest = std::max(field.columns(), field.rows());
  const std::size_t square = (longest + kPicturePixelsMax - 1) / kPicturePixelsMax;
  const PngHeading heading{.width = (field.columns() + square - 1) / square,
                           .height = (field.rows() + square - 1) / square,
                           .form = PngHeading::Form::kColour8,
                           .pixel_mm = field.stock().cell * static_cast<double>(square),
                           .texts = {{"Software", "rmlcell"}}};
  return WritePng(
      heading,
      [&](std::size_t from_above, std::span<std::uint8_t> bytes) {
        const std::size_t end = field.rows() - from_above * square;
        const std::size_t begin = end - std::min(end, square);
        for (std::size_t pixel = 0; pixel < heading.width; ++pixel) {
          const std::size_t left = pixel * square;
          const std::size_t right = std::min(left + square, field.columns());
          Colour sum{};
          for (std::size_t row = begin; row < end; ++row) {
            for (std::size_t column = left; column < right; ++column) {
              const Colour one = colour(column, row);
              for (std::size_t k = 0; k < 3; ++k) sum[k] += one[k];
            }
          }
          const int cells = static_cast<int>((end - begin) * (right - left));
          for (std::size_t k = 0; k < 3; ++k)
            bytes[3 * pixel + k] = static_cast<std::uint8_t>((sum[k] + cells / 2) / cells);
        }
      },
      sink);
}

}  // namespace rmlcell::simulation
