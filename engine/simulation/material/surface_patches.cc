#include "engine/simulation/material/surface_patches.h"

#include <cmath>

namespace rmlcell::simulation {
namespace {

constexpr std::size_t kLooksMax = 1 << 22;  // about 20 ms

// How far a patch is from the plane that its corners suggest.
struct Roughness {
  double height = 0.0;   // between two planes parallel to that one, with all vertices between them
  double along_x = 0.0;  // greatest step between two neighbours
  double along_y = 0.0;
};

Roughness RoughnessOf(const VertexGrid& grid, const Patch& patch, std::vector<double>& row_before) {
  const auto rise = [&](std::size_t column, std::size_t row) { return grid.z(column, row); };
  const double slope_x = (rise(patch.right, patch.front) + rise(patch.right, patch.back) -
                          rise(patch.left, patch.front) - rise(patch.left, patch.back)) /
                         (2.0 * (grid.x(patch.right) - grid.x(patch.left)));
  const double slope_y = (rise(patch.left, patch.back) + rise(patch.right, patch.back) -
                          rise(patch.left, patch.front) - rise(patch.right, patch.front)) /
                         (2.0 * (grid.y(patch.back) - grid.y(patch.front)));
  Roughness found;
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  row_before.resize(patch.right - patch.left + 1);
  for (std::size_t row = patch.front; row <= patch.back; ++row) {
    const double from_y = slope_y * (grid.y(row) - grid.y(patch.front));
    double before = 0.0;
    for (std::size_t column = patch.left; column <= patch.right; ++column) {
      const double from_x = slope_x * (grid.x(column) - grid.x(patch.left));
      const double here = grid.z(column, row) - from_x - from_y;
      double& below = row_before[column - patch.left];
      if (column > patch.left) found.along_x = std::max(found.along_x, std::abs(here - before));
      if (row > patch.front) found.along_y = std::max(found.along_y, std::abs(here - below));
      low = std::min(low, here);
      high = std::max(high, here);
      before = below = here;
    }
  }
  found.height = high - low;
  return found;
}

}  // namespace

SurfacePatches::SurfacePatches(const VertexGrid& grid, double tolerance_mm,
                               const std::function<bool()>& wanted)
    : grid_(grid), tolerance_(tolerance_mm), corners_(grid.columns() * grid.rows()) {
  Divide(Whole(), wanted);
}

std::pair<Patch, Patch> SurfacePatches::Halves(const Patch& patch, bool across_x) {
  Patch first = patch;
  Patch second = patch;
  if (across_x) {
    first.right = second.left = patch.left + (patch.right - patch.left) / 2;
  } else {
    first.back = second.front = patch.front + (patch.back - patch.front) / 2;
  }
  return {first, second};
}

void SurfacePatches::Divide(const Patch& whole, const std::function<bool()>& wanted) {
  std::vector<Patch> open{whole};
  std::vector<double> row_before;
  std::size_t looked_at = 0;  // vertices since it was asked
  while (!open.empty()) {
    const Patch patch = open.back();
    open.pop_back();
    const std::size_t width = patch.right - patch.left;
    const std::size_t depth = patch.back - patch.front;
    looked_at += (width + 1) * (depth + 1);
    if (looked_at > kLooksMax) {
      looked_at = 0;
      complete_ = wanted();
      if (!complete_) return;
    }
    Roughness rough;
    if (width > 1 || depth > 1) rough = RoughnessOf(grid_, patch, row_before);
    const bool halved = rough.height > tolerance_;
    const bool rougher_x = rough.along_x > rough.along_y;
    const bool equal = rough.along_x == rough.along_y;
    const bool across_x = depth == 1 || (width > 1 && (rougher_x || (equal && width >= depth)));
    decisions_.push_back(halved);
    decisions_.push_back(across_x);
    if (halved) {
      const auto [first, second] = Halves(patch, across_x);
      open.push_back(second);
      open.push_back(first);
      continue;
    }
    for (const std::size_t row : {patch.front, patch.back}) {
      for (const std::size_t column : {patch.left, patch.right})
        corners_[row * grid_.columns() + column] = true;
    }
  }
}

}  // namespace rmlcell::simulation
