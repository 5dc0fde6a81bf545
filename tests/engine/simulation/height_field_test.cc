#include "engine/simulation/material/height_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;
using ToolShape = MillTool::Shape;

const MillTool kFlat{.shape = ToolShape::kFlat, .radius_mm = 1.5};
const MillTool kBall{.shape = ToolShape::kBall, .radius_mm = 1.5};
const MillTool kVee{
    .shape = ToolShape::kVee, .radius_mm = 3.0, .half_angle_rad = kPi / 6, .tip_radius_mm = 0.2};

// The surface of the tool above its lowest point, at a distance from its axis.
double Surface(const MillTool& tool, double d) {
  if (tool.shape == ToolShape::kFlat) return 0.0;
  if (tool.shape == ToolShape::kBall)
    return tool.radius_mm - std::sqrt(std::max(0.0, tool.radius_mm * tool.radius_mm - d * d));
  return std::max(0.0, d - tool.tip_radius_mm) / std::tan(tool.half_angle_rad);
}

// motion.md 9, by many positions of the tool instead of a formula.
std::optional<double> ByPositions(const MillTool& tool, const motion::MachinePoint& from,
                                  const motion::MachinePoint& to, double x, double y) {
  std::optional<double> least;
  for (int k = 0; k <= 4000; ++k) {
    const motion::MachinePoint at = from + (to - from) * (k / 4000.0);
    const double d = std::hypot(x - at.x(), y - at.y());
    if (d > tool.radius_mm) continue;
    const double z = at.z() + Surface(tool, d);
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
  EXPECT_FALSE(CheckTool({.shape = ToolShape::kVee, .radius_mm = 1.0, .half_angle_rad = 0.0}));
  EXPECT_FALSE(CheckTool({.shape = ToolShape::kVee, .radius_mm = 1.0, .half_angle_rad = kPi / 2}));
  EXPECT_FALSE(CheckTool(
      {.shape = ToolShape::kVee, .radius_mm = 1.0, .half_angle_rad = 0.5, .tip_radius_mm = 1.1}));
}

// motion.md 10, property 14: against brute force over 4000 positions.
TEST(MillTool, SweepsWhatItsPositionsDo) {
  std::mt19937 random(5);  // NOLINT: the same every time
  std::uniform_real_distribution<double> place(-6.0, 6.0);
  for (int round = 0; round < 40; ++round) {
    const motion::MachinePoint from{place(random), place(random), place(random)};
    motion::MachinePoint to{place(random), place(random), place(random)};
    if (round % 5 == 0) to.z() = from.z();
    if (round % 8 == 0) to = {from.x(), from.y(), to.z()};  // a plunge
    for (const MillTool& tool : {kFlat, kBall, kVee}) {
      const double x = place(random), y = place(random);
      const auto closed = SweptHeight(tool, from, to, x, y);
      const auto found = ByPositions(tool, from, to, x, y);
      if (!found) continue;  // a grazing touch falls between two positions
      ASSERT_TRUE(closed);
      // Between two positions the tool goes down by at most its way times what its flank rises.
      const double step = (from - to).norm() / 4000.0;
      EXPECT_LE(*closed, *found + 1e-9);
      if (tool.shape != ToolShape::kBall) {
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
    motion::MachinePoint from;
    motion::MachinePoint to;
  };
  std::mt19937 random(3);  // NOLINT: the same every time
  std::uniform_real_distribution<double> x(-2.0, 22.0), y(-2.0, 14.0), z(-4.0, 1.0);
  std::vector<Move> moves;
  for (int k = 0; k < 60; ++k) {
    const motion::MachinePoint from{x(random), y(random), z(random)};
    const motion::MachinePoint to =
        k % 7 == 0 ? MachineVector{from.x(), from.y(), z(random)}
                   : MachineVector{x(random), y(random), k % 3 == 0 ? from.z() : z(random)};
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

// Where a block lies makes no difference: one that begins elsewhere is cut there in the same way.
TEST(HeightField, LiesWhereItsStockBegins) {
  Stock moved = kPlate;  // by binary fractions, so that all digits stay
  moved.x_min -= 32.0, moved.x_max -= 32.0, moved.y_min += 64.0, moved.y_max += 64.0;
  moved.bottom += 8.0, moved.top += 8.0;
  const MachineVector by{-32.0, 64.0, 8.0};
  HeightField here = Field(kPlate), there = Field(moved);
  EXPECT_EQ(there.columns(), 80u);
  EXPECT_EQ(there.rows(), 48u);
  for (const auto& [from, to] : {std::pair{MachineVector{3, 4, -1}, MachineVector{12, 7.5, -2}},
                                 std::pair{MachineVector{16, 10, -3}, MachineVector{16, 3, -3}},
                                 std::pair{MachineVector{18, 9, 1}, MachineVector{18, 9, -4}}}) {
    for (const MillTool& tool : {kFlat, kBall, kVee}) {
      EXPECT_NEAR(there.DepthOf(tool, from + by, to + by), here.DepthOf(tool, from, to), 1e-5);
      here.Cut(tool, from, to);
      there.Cut(tool, from + by, to + by);
    }
  }
  for (std::size_t k = 0; k < here.heights().size(); ++k) {
    ASSERT_NEAR(there.heights()[k], here.heights()[k] + 8.0f, 1e-5) << k;
  }
  EXPECT_NEAR(there.removed_mm3(), here.removed_mm3(), 1e-3);
  EXPECT_GT(here.removed_mm3(), 10.0);
}

// 3 mm are thirty cells of 0.1, and a cell begun is a cell; a block smaller than one has one.
TEST(HeightField, CellsCoverTheBlock) {
  const auto cells = [](double width, double cell) {
    return Field({.x_max = width, .y_max = 1.0, .bottom = -1.0, .top = 0.0, .cell = cell})
        .columns();
  };
  EXPECT_EQ(cells(3.0, 0.1), 30u);
  EXPECT_EQ(cells(3.01, 0.1), 31u);
  EXPECT_EQ(cells(3.00000005, 0.1), 31u);  // more than the last digits
  EXPECT_EQ(cells(0.01, 1.0), 1u);
  const Stock most{.x_max = 8192.0, .y_max = 8192.0, .bottom = -1.0, .top = 0.0, .cell = 1.0};
  EXPECT_TRUE(CheckStock(most).ok());  // 1 << 26 cells
  Stock more = most;
  more.x_max = 8193.0;
  EXPECT_FALSE(CheckStock(more).ok());
  // Numbers as people write them: 200,000 by 1,000 cells.
  EXPECT_EQ(CheckStock({.x_max = 2000.0, .y_max = 10.0, .top = 1.0, .cell = 0.01}).error().detail,
            "the stock has 200000 by 1000 cells, more than 67108864: make the cells larger");
}

// Each side of a block has an extent, each edge a finite place.
TEST(HeightField, RefusesEachSideOfABlock) {
  EXPECT_TRUE(CheckStock(kPlate).ok());
  for (double Stock::*const edge : {&Stock::x_min, &Stock::x_max, &Stock::y_min, &Stock::y_max,
                                    &Stock::bottom, &Stock::top, &Stock::cell}) {
    Stock stock = kPlate;
    stock.*edge = HUGE_VAL;
    EXPECT_FALSE(CheckStock(stock).ok());
    stock.*edge = -HUGE_VAL;
    EXPECT_FALSE(CheckStock(stock).ok());
  }
  for (const auto& [low, high] :
       {std::pair{&Stock::x_min, &Stock::x_max}, std::pair{&Stock::y_min, &Stock::y_max},
        std::pair{&Stock::bottom, &Stock::top}}) {
    Stock stock = kPlate;
    stock.*high = stock.*low;
    EXPECT_FALSE(CheckStock(stock).ok());
  }
  Stock stock = kPlate;
  stock.cell = -1.0;
  EXPECT_FALSE(CheckStock(stock).ok());
}

// Both sides of each limit of a tool.
TEST(MillTool, LimitsOfATool) {
  const auto vee = [](double half_angle, double tip) {
    return CheckTool({.shape = ToolShape::kVee,
                      .radius_mm = 1.0,
                      .half_angle_rad = half_angle,
                      .tip_radius_mm = tip})
        .ok();
  };
  EXPECT_TRUE(vee(0.001, 0.0));
  EXPECT_FALSE(vee(-0.001, 0.0));
  EXPECT_TRUE(vee(0.5 * kPi - 0.001, 0.0));
  EXPECT_FALSE(vee(0.5 * kPi + 0.001, 0.0));
  EXPECT_TRUE(vee(0.5, 1.0));
  EXPECT_FALSE(vee(0.5, -0.001));
  EXPECT_FALSE(CheckTool({.radius_mm = -1.0}).ok());
  EXPECT_FALSE(CheckTool({.radius_mm = HUGE_VAL}).ok());
}

TEST(HeightField, TellsHowDeepAToolWouldGo) {
  HeightField field = Field(kPlate);
  EXPECT_EQ(field.DepthOf(kFlat, {2, 6, 1}, {18, 6, 1}), 0.0);
  EXPECT_NEAR(field.DepthOf(kFlat, {2, 6, -1.25}, {18, 6, -1.25}), 1.25, 1e-6);
  field.Cut(kFlat, {2, 6, -2}, {18, 6, -2});
  EXPECT_NEAR(field.DepthOf(kFlat, {2, 6, -1.25}, {18, 6, -1.25}), 0.0, 1e-6);
  EXPECT_NEAR(field.DepthOf(kFlat, {2, 6, -2.5}, {18, 6, -2.5}), 0.5, 1e-6);
}

// By hand: a tool of 3 mm that cuts for 2 mm, above it a shank. Into a plate with its top at 0.
TEST(HeightField, TellsHowDeepAShankWouldGo) {
  const auto with_shank = [](double shank_radius) {
    return MillTool{.radius_mm = 1.5, .flute_mm = 2.0, .shank_radius_mm = shank_radius};
  };
  HeightField field = Field(kPlate);
  // A plunge of 3 mm: a wider shank sits 1 mm deep on the rim of the hole, a slimmer one is in it.
  EXPECT_NEAR(field.ShankDepthOf(with_shank(3.0), {10, 6, 2}, {10, 6, -3}), 1.0, 1e-6);
  EXPECT_EQ(field.ShankDepthOf(with_shank(3.0), {10, 6, 2}, {10, 6, -2}), 0.0);
  EXPECT_EQ(field.ShankDepthOf(with_shank(1.0), {10, 6, 2}, {10, 6, -3}), 0.0);
  EXPECT_EQ(field.ShankDepthOf({.radius_mm = 1.5, .flute_mm = 2.0}, {10, 6, 2}, {10, 6, -3}), 0.0);
  // Across, 3 mm deep: the uppermost millimetre is not cut before the shank comes, whatever its
  // width. 2 mm deep it is.
  for (const double radius : {0.0, 1.0, 3.0}) {
    EXPECT_NEAR(field.ShankDepthOf(with_shank(radius), {2, 6, -3}, {18, 6, -3}), 1.0, 1e-6);
    EXPECT_EQ(field.ShankDepthOf(with_shank(radius), {2, 6, -2}, {18, 6, -2}), 0.0);
  }
  // Down along 16 mm to a depth of 4: at the end 2 mm too deep, which the front of the tool meets
  // where the next centre of a cell is: up to 0.25 mm before it, a sixteenth of that depth.
  EXPECT_NEAR(field.ShankDepthOf(with_shank(1.5), {2, 6, 0}, {18, 6, -4}), 2.0, 0.0625);
  // Up again on the same way: where it begins the tool stands in material already.
  EXPECT_NEAR(field.ShankDepthOf(with_shank(1.5), {18, 6, -4}, {2, 6, 0}), 2.0, 1e-6);
  // In a slot as wide as the tool the shank of the same width has room, a wider one has not.
  field.Cut(kFlat, {2, 6, -3}, {18, 6, -3});
  EXPECT_EQ(field.ShankDepthOf(with_shank(1.5), {2, 6, -3}, {18, 6, -3}), 0.0);
  EXPECT_NEAR(field.ShankDepthOf(with_shank(2.0), {2, 6, -3}, {18, 6, -3}), 1.0, 1e-6);
  // Nothing told, nothing found; a holder of 20 mm at 2.5 mm is half a millimetre deep at 3.
  EXPECT_EQ(field.ShankDepthOf(kFlat, {10, 3, -3}, {12, 3, -3}), 0.0);
  EXPECT_EQ(field.ShankDepthOf(kFlat, {10, 3.125, -3}, {12, 3.125, -3}), 0.0);  // over centres
  const MillTool held{.radius_mm = 1.5, .holder_radius_mm = 10.0, .holder_from_mm = 2.5};
  EXPECT_NEAR(field.ShankDepthOf(held, {10, 6, 2}, {10, 6, -3}), 0.5, 1e-6);
  EXPECT_EQ(field.ShankDepthOf(held, {10, 6, 2}, {10, 6, -2.5}), 0.0);
}

// A shank of 6 mm above a tool of 3 mm that cuts for 2 mm, down by a quarter of the way. Beside the
// tool the shank comes over a place for as long as it reaches there: over the last column of a
// block of 10 mm, 7.875 mm on the way and 1.625 beside it, for sqrt(9 - 1.625^2) mm more. Before
// the end it reaches where the tool never comes, and is no deeper there than at the end.
TEST(HeightField, AWideShankReachesFurtherThanItsTool) {
  const MillTool tool{.radius_mm = 1.5, .flute_mm = 2.0, .shank_radius_mm = 3.0};
  const motion::MachinePoint from{2, 6, 0}, to{18, 6, -4};
  Stock narrow = kPlate;
  narrow.x_max = 10.0;
  EXPECT_NEAR(Field(narrow).ShankDepthOf(tool, from, to),
              0.25 * (7.875 + std::sqrt(9.0 - 1.625 * 1.625)) - 2.0, 1e-5);
  EXPECT_NEAR(Field(kPlate).ShankDepthOf(tool, from, to), 2.0, 1e-5);
}

// How long the tool is over a point on a way across, and whether it is so at an end of the way.
struct Stay {
  double length = 0.0;
  bool at_an_end = false;
};
Stay StayOver(const MillTool& tool, const motion::MachinePoint& from,
              const motion::MachinePoint& to, double x, double y) {
  const double across = std::hypot(to.x() - from.x(), to.y() - from.y());
  const double wx = (to.x() - from.x()) / across, wy = (to.y() - from.y()) / across;
  const double along = (x - from.x()) * wx + (y - from.y()) * wy;
  const double off = (y - from.y()) * wx - (x - from.x()) * wy;
  if (std::abs(off) > tool.radius_mm) return {.length = HUGE_VAL};  // it is never there
  const double half = std::sqrt(tool.radius_mm * tool.radius_mm - off * off);
  const double low = std::max(0.0, along - half), high = std::min(across, along + half);
  return {std::max(0.0, high - low), low <= 0.0 || high >= across};
}

// The plain model: 2000 positions of the tool on each of four moves, each cell below each of them
// looked at. Two positions are `step` apart. Where the tool stays over a cell for longer, or until
// an end of the way, one of the positions over the cell is within a step of the best place; there
// the tool is higher by the slope of the way, and its surface by its flank, times that step: 0 for
// a flat, the cotangent of half the angle for a vee; for a ball, steepest at its rim, by sqrt(2 R
// step). Cells that the tool only grazes are compared from one side.
TEST(HeightField, IsWhatAPlainModelSays) {
  constexpr int kPositions = 2000;
  std::mt19937 random(21);  // NOLINT: the same every time
  std::uniform_real_distribution<double> x(-1.0, 7.0), y(-1.0, 5.0), z(-2.0, 0.5), share(0.0, 1.0);
  const Stock block{.x_max = 6.0, .y_max = 4.0, .bottom = -4.0, .top = 0.0, .cell = 0.125};
  const auto centre = [](std::size_t index) { return 0.125 * (static_cast<double>(index) + 0.5); };
  for (int round = 0; round < 9; ++round) {
    MillTool tool{.shape = round % 3 == 0   ? ToolShape::kFlat
                           : round % 3 == 1 ? ToolShape::kBall
                                            : ToolShape::kVee,
                  .radius_mm = 0.3 + share(random)};
    tool.half_angle_rad = 0.2 + share(random);
    tool.tip_radius_mm = round % 2 == 0 ? 0.0 : 0.5 * tool.radius_mm * share(random);
    HeightField fast = Field(block);
    std::vector<double> plain(fast.heights().size(), 0.0);
    std::vector<bool> grazed(plain.size());
    double step = 0.0;
    double slope = 0.0;
    motion::MachinePoint from{x(random), y(random), z(random)};
    for (int move = 0; move < 4; ++move) {
      motion::MachinePoint to{x(random), y(random), z(random)};
      const double across = std::hypot(to.x() - from.x(), to.y() - from.y());
      if (move == 1 || across < 1.0) to.z() = from.z();
      fast.Cut(tool, from, to);
      step = std::max(step, across / kPositions);
      slope = std::max(slope, std::abs(to.z() - from.z()) / across);
      for (int k = 0; k <= kPositions; ++k) {
        const motion::MachinePoint at = from + (to - from) * (1.0 * k / kPositions);
        const auto first = [&](double place) {
          return static_cast<std::size_t>(std::max(0.0, (place - tool.radius_mm) / 0.125 - 1.0));
        };
        const std::size_t row_end = std::min(fast.rows(), first(at.y()) + 24);
        const std::size_t column_end = std::min(fast.columns(), first(at.x()) + 24);
        for (std::size_t row = first(at.y()); row < row_end; ++row) {
          for (std::size_t column = first(at.x()); column < column_end; ++column) {
            const double d = std::hypot(centre(column) - at.x(), centre(row) - at.y());
            if (d > tool.radius_mm) continue;
            double& height = plain[row * fast.columns() + column];
            height = std::min(height, at.z() + Surface(tool, d));
          }
        }
      }
      for (std::size_t cell = 0; cell < plain.size(); ++cell) {
        const Stay stay =
            StayOver(tool, from, to, centre(cell % fast.columns()), centre(cell / fast.columns()));
        if (stay.length < step && !stay.at_an_end) grazed[cell] = true;
      }
      from = to;
    }
    const double flank = tool.shape == ToolShape::kFlat   ? 0.0
                         : tool.shape == ToolShape::kBall ? std::sqrt(2.0 * tool.radius_mm / step)
                                                          : 1.0 / std::tan(tool.half_angle_rad);
    std::size_t compared = 0;
    for (std::size_t cell = 0; cell < plain.size(); ++cell) {
      ASSERT_LE(fast.heights()[cell], plain[cell] + 1e-5) << round << ' ' << cell;
      if (grazed[cell] && fast.heights()[cell] < plain[cell]) continue;
      ASSERT_GE(fast.heights()[cell], plain[cell] - step * (flank + slope) - 1e-5)
          << round << ' ' << cell;
      ++compared;
    }
    EXPECT_GT(compared, plain.size() * 9 / 10);
  }
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
