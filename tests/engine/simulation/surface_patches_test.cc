#include "engine/simulation/material/surface_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/engine/simulation/thread_for.h"

namespace rmlcell::simulation {
namespace {

// The rule, with every vertex looked at: a patch is halved while its vertices are further from the
// plane that its corners suggest than the tolerance, across the way of the greater steps.
class EveryVertex {
 public:
  EveryVertex(const VertexGrid& grid, double tolerance_mm) : grid_(grid), tolerance_(tolerance_mm) {
    Divide({0, grid.columns() - 1, 0, grid.rows() - 1});
  }
  const std::vector<Patch>& patches() const { return patches_; }

 private:
  void Divide(const Patch& patch) {
    const auto& [left, right, front, back] = patch;
    const auto z = [&](std::size_t column, std::size_t row) { return grid_.z(column, row); };
    const double slope_x = (z(right, front) + z(right, back) - z(left, front) - z(left, back)) /
                           (2.0 * (grid_.x(right) - grid_.x(left)));
    const double slope_y = (z(left, back) + z(right, back) - z(left, front) - z(right, front)) /
                           (2.0 * (grid_.y(back) - grid_.y(front)));
    const auto above = [&](std::size_t column, std::size_t row) {
      return z(column, row) - slope_x * (grid_.x(column) - grid_.x(left)) -
             slope_y * (grid_.y(row) - grid_.y(front));
    };
    double low = HUGE_VAL, high = -HUGE_VAL, along_x = 0.0, along_y = 0.0;
    for (std::size_t row = front; row <= back; ++row) {
      for (std::size_t column = left; column <= right; ++column) {
        const double here = above(column, row);
        low = std::min(low, here);
        high = std::max(high, here);
        if (column > left) along_x = std::max(along_x, std::abs(here - above(column - 1, row)));
        if (row > front) along_y = std::max(along_y, std::abs(here - above(column, row - 1)));
      }
    }
    const std::size_t width = right - left, depth = back - front;
    if ((width == 1 && depth == 1) || !(high - low > tolerance_)) return patches_.push_back(patch);
    const bool rougher_x = along_x > along_y || (along_x == along_y && width >= depth);
    const auto [first, second] = Halves(patch, depth == 1 || (width > 1 && rougher_x));
    Divide(first);
    Divide(second);
  }

  const VertexGrid& grid_;
  double tolerance_;
  std::vector<Patch> patches_;
};

std::vector<Patch> PatchesOf(const VertexGrid& grid, double tolerance_mm, ParallelFor& parallel) {
  const SurfacePatches patches(
      grid, tolerance_mm, [] { return true; }, parallel);
  std::vector<Patch> all;
  for (std::size_t section = 0; section < patches.sections(); ++section)
    patches.ForEach(section, [&](const Patch& patch) { all.push_back(patch); });
  return all;
}

// Slots along both axes, slopes, waves, and what is cut through, in blocks of many measures.
HeightField MilledBlock(unsigned seed) {
  std::mt19937_64 random(seed);  // NOLINT: the same every time
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const double wide = seed % 5 == 4 ? 0.2 : 6.0 + 24.0 * share(random);
  const double deep = seed % 7 == 6 ? 0.1 : 5.0 + 30.0 * share(random);
  HeightField field = HeightField::Of({.x_min = -3.7,
                                       .x_max = -3.7 + wide,
                                       .y_min = 100.3,
                                       .y_max = 100.3 + deep,
                                       .bottom = -4.3,
                                       .top = 0.17,
                                       .cell = 0.1})
                          .value();
  using Shape = MillTool::Shape;
  const MillTool tool{.shape = seed % 2 == 0 ? Shape::kFlat : Shape::kBall, .radius_mm = 0.8};
  motion::MachinePoint at{-1.0, 102.0, -1.0};
  for (int k = 0; k < 25; ++k) {
    motion::MachinePoint to{-3.7 + wide * share(random), 100.3 + deep * share(random),
                            0.5 - 5.5 * share(random)};
    if (seed % 3 == 0) (k % 2 == 0 ? to.x() : to.y()) = k % 2 == 0 ? at.x() : at.y();
    if (seed % 3 == 0) to.z() = at.z() = -2.0;
    field.Cut(tool, at, to);
    at = to;
  }
  return field;
}

// Ranges of a table, some vertices, narrow ones lane by lane: the patches are those of the rule.
TEST(SurfacePatches, AreThoseOfLookingAtEveryVertex) {
  SerialFor serial;
  ThreadFor threads(3);
  std::size_t patches = 0;
  for (unsigned seed = 0; seed < 24; ++seed) {
    const HeightField field = MilledBlock(seed);
    const VertexGrid grid(field);
    for (const double tolerance : {0.01, 0.1}) {
      const EveryVertex rule(grid, tolerance);
      EXPECT_TRUE(PatchesOf(grid, tolerance, serial) == rule.patches()) << seed;
      EXPECT_TRUE(PatchesOf(grid, tolerance, threads) == rule.patches()) << seed;
      patches += rule.patches().size();
    }
  }
  EXPECT_GT(patches, 50000u);
}

}  // namespace
}  // namespace rmlcell::simulation
