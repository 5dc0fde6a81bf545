#include "engine/simulation/material/surface_patches.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace rmlcell::simulation {
namespace {

constexpr std::size_t kLooksMax = 1 << 22;  // about 20 ms

// How far a patch is from the plane that its corners suggest.
struct Roughness {
  double height = 0.0;   // between two planes parallel to that one, with all vertices between them
  double along_x = 0.0;  // greatest step between two neighbours
  double along_y = 0.0;
};

// Some columns of a patch, and of each what was found on the way along it, above a plane through
// the left one of the patch. Compilers compare several columns at a time, but not several vertices
// for one result.
class PatchColumns {
 public:
  static constexpr std::size_t kMost = 64;

  PatchColumns(const VertexGrid& grid, const Patch& patch, std::size_t first, double slope_x)
      : grid_(grid), before_first_(std::max(first, patch.left + 1) - 1), first_(first) {
    count_ = std::min(kMost, patch.right + 1 - first);
    const auto plane = [&](std::size_t column) {
      return slope_x * (grid.x(column) - grid.x(patch.left));
    };
    plane_[0] = plane(before_first_);
    for (std::size_t k = 0; k < count_; ++k) {
      plane_[k + 1] = plane(first + k);
      low_[k] = HUGE_VAL;
      high_[k] = -HUGE_VAL;
      along_x_[k] = along_y_[k] = 0.0;
    }
  }

  // The first row, and then some more at a time: what was found is less often put back.
  void Begin(std::size_t row) { Add<1, true>(row, {0.0}); }
  template <std::size_t kRows>
  void Add(std::size_t row, const std::array<double, kRows>& plane_y) {
    Add<kRows, false>(row, plane_y);
  }

  void TellTo(Roughness& found, double& low, double& high) const {
    for (std::size_t k = 0; k < count_; ++k) {
      low = std::min(low, low_[k]);
      high = std::max(high, high_[k]);
      found.along_x = std::max(found.along_x, along_x_[k]);
      found.along_y = std::max(found.along_y, along_y_[k]);
    }
  }

 private:
  template <std::size_t kRows, bool kFirst>
  void Add(std::size_t row, const std::array<double, kRows>& plane_y) {
    std::array<std::array<float, kMost + 1>, kRows> heights;
    for (std::size_t r = 0; r < kRows; ++r) {
      grid_.Heights(first_, count_, row + r, &heights[r][1]);
      heights[r][0] = before_first_ < first_ ? grid_.Height(before_first_, row + r) : heights[r][1];
    }
    const double bottom = grid_.bottom();
    const auto above = [&](std::size_t r, std::size_t k) {
      return std::max(static_cast<double>(heights[r][k]), bottom) - plane_[k] - plane_y[r];
    };
    for (std::size_t k = 0; k < count_; ++k) {
      double before = kFirst ? above(0, k + 1) : before_[k];
      for (std::size_t r = 0; r < kRows; ++r) {
        const double here = above(r, k + 1);
        along_x_[k] = std::max(along_x_[k], std::abs(here - above(r, k)));
        along_y_[k] = std::max(along_y_[k], std::abs(here - before));
        low_[k] = std::min(low_[k], here);
        high_[k] = std::max(high_[k], here);
        before = here;
      }
      before_[k] = before;
    }
  }

  using Values = std::array<double, kMost>;
  const VertexGrid& grid_;
  std::size_t before_first_;  // for the step from there; the same where there is none
  std::size_t first_;
  std::size_t count_;
  std::array<double, kMost + 1> plane_;  // from the one before the first on
  Values before_;                        // those of the row before
  Values low_;
  Values high_;
  Values along_x_;
  Values along_y_;
};

Roughness RoughnessOf(const VertexGrid& grid, const Patch& patch) {
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
  const auto plane_y = [&](std::size_t row) {
    return slope_y * (grid.y(row) - grid.y(patch.front));
  };
  for (std::size_t first = patch.left; first <= patch.right; first += PatchColumns::kMost) {
    PatchColumns columns(grid, patch, first, slope_x);
    columns.Begin(patch.front);
    std::size_t row = patch.front + 1;
    for (; row + 4 <= patch.back + 1; row += 4)
      columns.Add<4>(row, {plane_y(row), plane_y(row + 1), plane_y(row + 2), plane_y(row + 3)});
    for (; row <= patch.back; ++row) columns.Add<1>(row, {plane_y(row)});
    columns.TellTo(found, low, high);
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
    if (width > 1 || depth > 1) rough = RoughnessOf(grid_, patch);
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
