#pragma once

#include <cstddef>
#include <vector>

namespace rmlcell::bench {

// What bounds each removal of material: the rows of the footprint known, nothing but a minimum over
// their cells. As the limits of the benches have it, with all that this machine can do.
void RowMinimum(float* row, std::size_t count, float height);

// What a straightforward program does: a map of heights over points, and a flat tool on a move over
// it, row by row, on a slope as high as its axis is over the point. Tells how many cells it came
// over.
struct BareMap {
  int columns = 0;
  int rows = 0;
  float cell = 0.1f;
  std::vector<float> heights{};
};
struct BareMove {
  float x0 = 0.0f, y0 = 0.0f, z0 = 0.0f;
  float x1 = 0.0f, y1 = 0.0f, z1 = 0.0f;
};
long SweepFlat(BareMap& map, const BareMove& move, float radius);

}  // namespace rmlcell::bench
