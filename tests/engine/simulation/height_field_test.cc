#include "engine/simulation/height_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

using motion::Vec3;
using Shape = MillTool::Shape;

const MillTool kFlat{.shape = Shape::kFlat, .radius_mm = 1.5};
const MillTool kBall{.shape = Shape::kBall, .radius_mm = 1.5};
const MillTool kVee{
    .shape = Shape::kVee, .radius_mm = 3.0, .half_angle_rad = kPi / 6, .tip_radius_mm = 0.2};

// The surface of the tool above its lowest point, at a distance from its axis.
double Surface(const MillTool& tool, double d) {
  if (tool.shape == Shape::kFlat) return 0.0;
  if (tool.shape == Shape::kBall)
    return tool.radius_mm - std::sqrt(std::max(0.0, tool.radius_mm * tool.radius_mm - d * d));
  return std::max(0.0, d - tool.tip_radius_mm) / std::tan(tool.half_angle_rad);
}

// motion.md 9, by many positions of the tool instead of a formula.
std::optional<double> ByPositions(const MillTool& tool, const Vec3& from, const Vec3& to, double x,
                                  double y) {
  std::optional<double> least;
  for (int k = 0; k <= 4000; ++k) {
    const Vec3 at = from + (to - from) * (k / 4000.0);
    const double d = std::hypot(x - at.x, y - at.y);
    if (d > tool.radius_mm) continue;
    const double z = at.z + Surface(tool, d);
    if (!least || z < *least) least = z;
  }
  return least;
}

HeightField Field(const Stock& stock) { return HeightField::Of(stock).value(); }
const Stock kPlate{.x_max = 20.0, .y_max = 12.0, .bottom = -5.0, .top = 0.0, .cell = 0.25};

TEST(MillTool, RefusesWhatCannotBe) {
  EXPECT_TRUE(CheckTool(kVee));
  EXPECT_FALSE(CheckTool({.radius_mm = 0.0}));
  EXPECT_FALSE(CheckTool({.radius_mm = NAN}));
  EXPECT_FALSE(CheckTool({.shape = Shape::kVee, .radius_mm = 1.0, .half_angle_rad = 0.0}));
  EXPECT_FALSE(CheckTool({.shape = Shape::kVee, .radius_mm = 1.0, .half_angle_rad = kPi / 2}));
  EXPECT_FALSE(CheckTool(
      {.shape = Shape::kVee, .radius_mm = 1.0, .half_angle_rad = 0.5, .tip_radius_mm = 1.1}));
}

// motion.md 10, property 14: against brute force over 4000 positions.
TEST(MillTool, SweepsWhatItsPositionsDo) {
  std::mt19937 random(5);  // NOLINT: the same every time
  std::uniform_real_distribution<double> place(-6.0, 6.0);
  for (int round = 0; round < 40; ++round) {
    const Vec3 from{place(random), place(random), place(random)};
    Vec3 to{place(random), place(random), place(random)};
    if (round % 5 == 0) to.z = from.z;
    if (round % 8 == 0) to = {from.x, from.y, to.z};  // a plunge
    for (const MillTool& tool : {kFlat, kBall, kVee}) {
      const double x = place(random), y = place(random);
      const auto closed = SweptHeight(tool, from, to, x, y);
      const auto found = ByPositions(tool, from, to, x, y);
      if (!found) continue;  // a grazing touch falls between two positions
      ASSERT_TRUE(closed);
      // Between two positions the tool goes down by at most its way times what its flank rises.
      const double step = Distance(from, to) / 4000.0;
      EXPECT_LE(*closed, *found + 1e-9);
      if (tool.shape != Shape::kBall) {
        EXPECT_GE(*closed, *found - 4.0 * step - 1e-9);
      }
    }
  }
}

// A plunge of a flat tool of 3 mm into a plate: the cells within 1.5 mm of its axis.
TEST(HeightField, PlungeIsADisc) {
  HeightField field = Field(kPlate);
  field.Cut(kFlat, {10, 6, 2}, {10, 6, -1});
  int low = 0;
  for (std::size_t row = 0; row < field.rows(); ++row) {
    for (std::size_t column = 0; column < field.columns(); ++column) {
      const double x = 0.25 * (static_cast<double>(column) + 0.5);
      const double y = 0.25 * (static_cast<double>(row) + 0.5);
      const bool inside = std::hypot(x - 10.0, y - 6.0) <= 1.5;
      EXPECT_EQ(field.height(column, row), inside ? -1.0f : 0.0f);
      low += inside ? 1 : 0;
    }
  }
  EXPECT_NEAR(field.removed_mm3(), low * 0.0625, 1e-9);
  EXPECT_NEAR(field.removed_mm3(), kPi * 1.5 * 1.5, 0.3);
}

// A slot: 10 mm long, 3 mm wide, 2 mm deep, and half a disc at both ends.
TEST(HeightField, SlotHasItsVolume) {
  Stock fine = kPlate;
  fine.cell = 0.02;
  HeightField field = Field(fine);
  field.Cut(kFlat, {5, 6, -2}, {15, 6, -2});
  EXPECT_NEAR(field.removed_mm3(), 2.0 * (30.0 + kPi * 2.25), 0.2);
}

TEST(HeightField, CutsNothingBeyondItsBottomOrBesideIt) {
  HeightField field = Field({.x_max = 1.0, .y_max = 1.0, .bottom = -1.0, .top = 0.0, .cell = 0.5});
  field.Cut(kFlat, {0.5, 0.5, -9}, {0.5, 0.5, -9});
  EXPECT_NEAR(field.removed_mm3(), 1.0, 1e-9);
  HeightField whole = Field(kPlate);
  whole.Cut(kFlat, {-50, -50, -3}, {-40, -60, -3});
  whole.Cut(kFlat, {500, 6, -3}, {510, 6, -3});
  whole.Cut(kBall, {5, 5, 0}, {9, 9, 3});  // above all of it
  EXPECT_EQ(whole.removed_mm3(), 0.0);
}

// motion.md 10, property 14: each cell as the closed form has it, whatever the order and whoever
// cuts which rows.
TEST(HeightField, IsTheSameInAnyOrderAndByAnyRows) {
  struct Move {
    MillTool tool;
    Vec3 from;
    Vec3 to;
  };
  std::mt19937 random(3);  // NOLINT: the same every time
  std::uniform_real_distribution<double> x(-2.0, 22.0), y(-2.0, 14.0), z(-4.0, 1.0);
  std::vector<Move> moves;
  for (int k = 0; k < 60; ++k) {
    const Vec3 from{x(random), y(random), z(random)};
    const Vec3 to = k % 7 == 0 ? Vec3{from.x, from.y, z(random)}
                               : Vec3{x(random), y(random), k % 3 == 0 ? from.z : z(random)};
    moves.push_back({k % 3 == 0 ? kFlat : k % 3 == 1 ? kBall : kVee, from, to});
  }
  HeightField field = Field(kPlate);
  for (const Move& move : moves) field.Cut(move.tool, move.from, move.to);
  HeightField back = Field(kPlate);
  for (std::size_t k = moves.size(); k-- > 0;) {
    for (HeightField::Rows rows : {HeightField::Rows{17, 999}, {0, 5}, {5, 17}})
      back.Cut(moves[k].tool, moves[k].from, moves[k].to, rows);
  }
  EXPECT_EQ(field.heights(), back.heights());
  for (std::size_t row = 0; row < field.rows(); ++row) {
    for (std::size_t column = 0; column < field.columns(); ++column) {
      double least = 0.0;
      for (const Move& move : moves) {
        const auto height =
            SweptHeight(move.tool, move.from, move.to, 0.25 * (static_cast<double>(column) + 0.5),
                        0.25 * (static_cast<double>(row) + 0.5));
        least = std::min(least, height.value_or(0.0));
      }
      ASSERT_NEAR(field.height(column, row), least, 1e-6) << column << ' ' << row;
    }
  }
}

TEST(HeightField, TellsHowDeepAToolWouldGo) {
  HeightField field = Field(kPlate);
  EXPECT_EQ(field.DepthOf(kFlat, {2, 6, 1}, {18, 6, 1}), 0.0);
  EXPECT_NEAR(field.DepthOf(kFlat, {2, 6, -1.25}, {18, 6, -1.25}), 1.25, 1e-6);
  field.Cut(kFlat, {2, 6, -2}, {18, 6, -2});
  EXPECT_NEAR(field.DepthOf(kFlat, {2, 6, -1.25}, {18, 6, -1.25}), 0.0, 1e-6);
  EXPECT_NEAR(field.DepthOf(kFlat, {2, 6, -2.5}, {18, 6, -2.5}), 0.5, 1e-6);
}

TEST(HeightField, RefusesBlocksThatCannotBe) {
  EXPECT_FALSE(HeightField::Of({}));
  Stock stock = kPlate;
  stock.cell = 0.0;
  EXPECT_FALSE(HeightField::Of(stock));
  stock.cell = 1e-4;
  EXPECT_FALSE(HeightField::Of(stock));
  stock = kPlate;
  stock.top = NAN;
  EXPECT_FALSE(HeightField::Of(stock));
}

}  // namespace
}  // namespace rmlcell::simulation
