#pragma once

#include <vector>

#include "engine/rml1/board/bitmap.h"

namespace rmlcell::rml1 {

// A number for each place of a grid, rows from the bottom up.
struct DistanceField {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<float> values;

  float at(std::size_t x, std::size_t y) const { return values[y * width + x]; }
};

// How far the centre of every pixel is from that of the nearest copper, in pixels, exactly
// (Felzenszwalb and Huttenlocher: the lower envelope of a parabola for each pixel of a row, linear
// in the pixels). `margin` pixels without copper are put around the picture. Without any copper:
// very far.
DistanceField DistanceToCopper(const Bitmap& bitmap, std::size_t margin);
inline constexpr float kVeryFar = 1e9F;

}  // namespace rmlcell::rml1
