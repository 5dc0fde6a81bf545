#include "tests/bench/bare_sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rmlcell::bench {

void RowMinimum(float* row, std::size_t count, float height) {
  for (std::size_t k = 0; k < count; ++k) row[k] = std::min(row[k], height);
}

long SweepFlat(BareMap& map, const BareMove& move, float radius) {
  const float by_cell = 1.0f / map.cell;
  const float dx = move.x1 - move.x0, dy = move.y1 - move.y0, length = std::sqrt(dx * dx + dy * dy);
  const float ux = length > 0.0f ? dx / length : 1.0f, uy = length > 0.0f ? dy / length : 0.0f;
  const auto first = [&](float place) { return static_cast<int>(std::ceil(place * by_cell)); };
  const auto last = [&](float place) { return static_cast<int>(std::floor(place * by_cell)); };
  const int begin = std::max(0, first(std::min(move.y0, move.y1) - radius));
  const int end = std::min(map.rows - 1, last(std::max(move.y0, move.y1) + radius));
  long cells = 0;
  for (int row = begin; row <= end; ++row) {
    const float y = static_cast<float>(row) * map.cell;
    float low = 1e30f, high = -1e30f;
    const auto include = [&](float a, float b) {
      low = std::min(low, a);
      high = std::max(high, b);
    };
    for (const auto& [cx, cy] : {std::pair{move.x0, move.y0}, std::pair{move.x1, move.y1}}) {
      const float half_2 = radius * radius - (y - cy) * (y - cy);
      if (half_2 >= 0.0f) include(cx - std::sqrt(half_2), cx + std::sqrt(half_2));
    }
    for (const float side : {-radius, radius}) {
      const float ax = move.x0 - uy * side, ay = move.y0 + ux * side;
      if (dy == 0.0f || (y - ay) * (y - ay - dy) > 0.0f) continue;
      const float x = ax + dx * (y - ay) / dy;
      include(x, x);
    }
    const int from = std::max(0, first(low)), to = std::min(map.columns - 1, last(high));
    if (to < from) continue;
    cells += to - from + 1;
    float* const heights =
        &map.heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns)];
    const float by_length_2 = length > 0.0f ? 1.0f / (length * length) : 0.0f;
    const float along_y = (y - move.y0) * dy, dz = move.z1 - move.z0;
    for (int column = from; column <= to; ++column) {
      const float along = (static_cast<float>(column) * map.cell - move.x0) * dx + along_y;
      const float share = std::min(1.0f, std::max(0.0f, along * by_length_2));
      heights[column] = std::min(heights[column], move.z0 + dz * share);
    }
  }
  return cells;
}

}  // namespace rmlcell::bench
