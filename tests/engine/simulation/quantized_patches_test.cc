// Patches of surfaces whose heights are multiples of a quarter: steps along X and Y are often equal
// there, and heights just as far apart as the tolerance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/simulation/material/relief.h"
#include "engine/simulation/material/surface_patches.h"
#include "tests/engine/simulation/png_picture.h"

namespace rmlcell::simulation {
namespace {

struct LookedAt {
  double height = 0.0;
  double along_x = 0.0;
  double along_y = 0.0;
};

// How far the vertices of a patch are from the plane of its corners.
LookedAt LookAt(const VertexGrid& grid, const Patch& patch) {
  const auto& [left, right, front, back] = patch;
  const auto z = [&](std::size_t column, std::size_t row) { return grid.z(column, row); };
  const double slope_x = (z(right, front) + z(right, back) - z(left, front) - z(left, back)) /
                         (2.0 * (grid.x(right) - grid.x(left)));
  const double slope_y = (z(left, back) + z(right, back) - z(left, front) - z(right, front)) /
                         (2.0 * (grid.y(back) - grid.y(front)));
  const auto above = [&](std::size_t column, std::size_t row) {
    return z(column, row) - slope_x * (grid.x(column) - grid.x(left)) -
           slope_y * (grid.y(row) - grid.y(front));
  };
  LookedAt found;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t row = front; row <= back; ++row) {
    for (std::size_t column = left; column <= right; ++column) {
      const double here = above(column, row);
      low = std::min(low, here);
      high = std::max(high, here);
      if (column > left)
        found.along_x = std::max(found.along_x, std::abs(here - above(column - 1, row)));
      if (row > front)
        found.along_y = std::max(found.along_y, std::abs(here - above(column, row - 1)));
    }
  }
  found.height = high - low;
  return found;
}

// The rule: halved while above the tolerance, across the way of the greater steps; where they are
// equal across the longer side, and of equal ones across X.
void DivideByTheRule(const VertexGrid& grid, double tolerance, const Patch& patch,
                     std::vector<Patch>& patches) {
  const std::size_t width = patch.right - patch.left, depth = patch.back - patch.front;
  const LookedAt found = LookAt(grid, patch);
  if ((width == 1 && depth == 1) || found.height <= tolerance) return patches.push_back(patch);
  bool across_x = found.along_x > found.along_y;
  if (found.along_x == found.along_y) across_x = width >= depth;
  if (width == 1) across_x = false;
  if (depth == 1) across_x = true;
  const auto [first, second] = Halves(patch, across_x);
  DivideByTheRule(grid, tolerance, first, patches);
  DivideByTheRule(grid, tolerance, second, patches);
}

void ExpectTheRule(const HeightField& field, double tolerance, const std::string& what) {
  const VertexGrid grid(field);
  std::vector<Patch> rule;
  DivideByTheRule(grid, tolerance, {0, grid.columns() - 1, 0, grid.rows() - 1}, rule);
  SerialFor serial;
  const SurfacePatches patches(
      grid, tolerance, [] { return true; }, serial);
  std::vector<Patch> found;
  for (std::size_t section = 0; section < patches.sections(); ++section)
    patches.ForEach(section, [&](const Patch& patch) { found.push_back(patch); });
  EXPECT_TRUE(found == rule) << what << ": " << found.size() << " for " << rule.size();
  EXPECT_EQ(patches.Whole(), (Patch{0, grid.columns() - 1, 0, grid.rows() - 1}));
}

HeightField CellsOfOne(std::size_t columns, std::size_t rows) {
  return HeightField::Of({.x_max = static_cast<double>(columns),
                          .y_max = static_cast<double>(rows),
                          .bottom = -4.0,
                          .top = 0.0,
                          .cell = 1.0})
      .value();
}

// Level holes, and lines along both axes, each some quarters deep.
HeightField Quarters(std::size_t columns, std::size_t rows, unsigned seed) {
  HeightField field = CellsOfOne(columns, rows);
  std::mt19937 random(seed);  // NOLINT: the same every time
  const auto below = [&](std::size_t most) { return static_cast<double>(random() % most); };
  const std::size_t cuts = 1 + seed % 7;
  for (std::size_t k = 0; k < cuts; ++k) {
    const motion::MachinePoint at{below(columns) + 0.5, below(rows) + 0.5, -0.25 * (1 + below(4))};
    motion::MachinePoint to = at;
    if (k % 3 == 1) to.x() = below(columns) + 0.5;
    if (k % 3 == 2) to.y() = below(rows) + 0.5;
    field.Cut({.radius_mm = 0.6}, at, to);
  }
  return field;
}

TEST(QuantizedPatches, TiesAreDecidedByTheRule) {
  const std::pair<std::size_t, std::size_t> sizes[] = {{1, 1},  {1, 7},   {7, 1},   {2, 2},
                                                       {3, 7},  {7, 3},   {7, 7},   {5, 15},
                                                       {15, 6}, {15, 15}, {31, 17}, {23, 63}};
  for (const auto& [columns, rows] : sizes) {
    for (unsigned seed = 0; seed < 12; ++seed) {
      const HeightField field = Quarters(columns, rows, seed);
      for (const double tolerance : {0.0, 0.25, 0.5, 1.0})
        ExpectTheRule(
            field, tolerance,
            std::to_string(columns) + 'x' + std::to_string(rows) + " #" + std::to_string(seed));
    }
  }
}

// More vertices than are divided at a time, most of them level.
TEST(QuantizedPatches, LargeOnesAreDividedInSections) {
  for (unsigned seed = 3; seed < 7; ++seed) {
    const HeightField field = Quarters(seed % 2 == 0 ? 401 : 90, seed % 2 == 0 ? 90 : 401, seed);
    ExpectTheRule(field, 0.25, "large #" + std::to_string(seed));
  }
  ExpectTheRule(CellsOfOne(300, 200), 0.25, "level");
}

// Far more than are divided at the same time.
TEST(QuantizedPatches, ManySectionsAreDividedAll) {
  HeightField field = CellsOfOne(1400, 1200);
  for (int x = 0; x < 28; ++x) {
    for (int y = 0; y < 24; ++y) {
      const motion::MachinePoint at{50.0 * x + 20.5, 50.0 * y + 31.5, -0.5};
      field.Cut({.radius_mm = 0.6}, at, at);
    }
  }
  const VertexGrid grid(field);
  SerialFor serial;
  const SurfacePatches patches(
      grid, 0.25, [] { return true; }, serial);
  // All of it once, and 672 holes in squares of their own.
  std::size_t squares = 0, single = 0;
  for (std::size_t section = 0; section < patches.sections(); ++section) {
    patches.ForEach(section, [&](const Patch& patch) {
      const std::size_t area = (patch.right - patch.left) * (patch.back - patch.front);
      squares += area;
      single += area == 1 ? 1 : 0;
    });
  }
  EXPECT_EQ(squares, (grid.columns() - 1) * (grid.rows() - 1));
  EXPECT_GE(single, 4U * 672);
}

// A hole just as deep as the tolerance is plane enough, one a quarter deeper is not.
TEST(QuantizedPatches, JustTheToleranceIsPlane) {
  for (const std::size_t size : {4, 30}) {
    HeightField field = CellsOfOne(size, size);
    field.Cut({.radius_mm = 0.6}, {1.5, 2.5, -0.5}, {1.5, 2.5, -0.5});
    const VertexGrid grid(field);
    SerialFor serial;
    const auto count = [&](double tolerance) {
      std::size_t patches = 0;
      const SurfacePatches of(
          grid, tolerance, [] { return true; }, serial);
      for (std::size_t section = 0; section < of.sections(); ++section)
        of.ForEach(section, [&](const Patch&) { ++patches; });
      return patches;
    };
    EXPECT_EQ(count(0.5), 1U) << size;
    EXPECT_GT(count(0.25), 1U) << size;
  }
}

// How deep each column, or row, of a block of 12 mm is, and the grey that its neighbours make of
// it: half of what lies between them, at the edge what lies between the last two.
void ExpectGreys(const std::array<double, 6>& depths, bool along_x) {
  HeightField field =
      HeightField::Of({.x_max = 6.0, .y_max = 6.0, .bottom = -12.0, .top = 0.0, .cell = 1.0})
          .value();
  for (std::size_t k = 0; k < 6; ++k) {
    const double at = static_cast<double>(k) + 0.5;
    const double z = -depths[k];
    if (along_x) {
      field.Cut({.radius_mm = 0.4}, {at, -5, z}, {at, 11, z});
    } else {
      field.Cut({.radius_mm = 0.4}, {-5, at, z}, {11, at, z});
    }
  }
  std::string bytes;
  ASSERT_TRUE(WriteRelief(field, [&](std::string_view part) {
    bytes += part;
    return true;
  }));
  const PngPicture picture(bytes);
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t low = k > 0 ? k - 1 : 0, high = std::min<std::size_t>(k + 1, 5);
    const double slope = (depths[low] - depths[high]) / static_cast<double>(high - low);
    // From (-1, 1, sqrt 2)/2: a slope that rises along X, or falls along Y, faces the light.
    const double towards = along_x ? slope : -slope;
    const double level = std::sqrt(0.5);
    const double light = 0.25 + 0.75 * std::max(0.0, (0.5 * towards + level) /
                                                         std::sqrt(1.0 + slope * slope) / level);
    const double grey = 200.0 * light * (1.0 - 0.45 * depths[k] / 12.0);
    const Rgb here = along_x ? picture.At(k, 3) : picture.At(3, 5 - k);
    EXPECT_NEAR(here[1], std::min(255.0, grey), 0.51) << along_x << ' ' << depths[0] << ' ' << k;
  }
}

TEST(QuantizedPatches, ASlopeIsLitByItsNeighbours) {
  for (const bool along_x : {true, false}) {
    ExpectGreys({1.0, 1.5, 2.75, 3.0, 5.25, 5.5}, along_x);
    ExpectGreys({6.0, 5.5, 3.75, 3.5, 1.0, 0.25}, along_x);
  }
}

}  // namespace
}  // namespace rmlcell::simulation
