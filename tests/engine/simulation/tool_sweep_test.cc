#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/material/height_field.h"
#include "engine/simulation/material/swept_rows.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using ToolShape = MillTool::Shape;

// A move in steps of 5 um: centres of cells of 0.1 mm and places of programs are multiples of that,
// and whether a tool comes over a centre is a question of integers.
struct PlaceInSteps {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t z = 0;
};
MachinePoint PointAt(const PlaceInSteps& s) {
  const auto mm = [](std::int64_t steps) { return static_cast<double>(steps) / 200.0; };
  return {mm(s.x), mm(s.y), mm(s.z)};
}

enum class Side { kBeyond, kOnEdge, kUnder };
Side SideOf(const PlaceInSteps& from, const PlaceInSteps& to, std::int64_t radius, std::int64_t x,
            std::int64_t y) {
  const std::int64_t wx = to.x - from.x, wy = to.y - from.y;
  const std::int64_t along = (x - from.x) * wx + (y - from.y) * wy;
  const std::int64_t length_2 = wx * wx + wy * wy;
  std::int64_t distance = 0, reach = 0;  // squares, at the same scale
  if (along > 0 && along < length_2) {
    const std::int64_t across = (y - from.y) * wx - (x - from.x) * wy;
    distance = across * across;
    reach = radius * radius * length_2;
  } else {
    const PlaceInSteps& end = along <= 0 ? from : to;
    distance = (x - end.x) * (x - end.x) + (y - end.y) * (y - end.y);
    reach = radius * radius;
  }
  return distance > reach ? Side::kBeyond : distance == reach ? Side::kOnEdge : Side::kUnder;
}

// motion.md 9: the tool is over a point while its place lies in an interval with both its ends, so
// a centre on the very edge is cut. A flat tool on level moves, each cell beside exact arithmetic.
TEST(ToolSweep, FlatToolIsExactOnEveryCentre) {
  std::mt19937 random(17);  // NOLINT: the same every time
  std::uniform_int_distribution<std::int64_t> x(-500, 3500), y(-500, 2500), z(-600, -10),
      pick(0, 7);
  std::size_t on_edge = 0;
  for (int round = 0; round < 60; ++round) {
    const std::int64_t left = 10 * (round % 5) - 200, front = 2 * (round % 7) + 40;
    const std::int64_t radius = round % 3 == 0 ? 300 : 25 * (1 + pick(random)) + 5 * pick(random);
    HeightField field = HeightField::Of({.x_min = PointAt({left, 0, 0}).x(),
                                         .x_max = PointAt({left + 3000, 0, 0}).x(),
                                         .y_min = PointAt({0, front, 0}).y(),
                                         .y_max = PointAt({0, front + 2000, 0}).y(),
                                         .bottom = -5.0,
                                         .top = 0.0,
                                         .cell = 0.1})
                            .value();
    ASSERT_EQ(field.columns(), 150u);
    ASSERT_EQ(field.rows(), 100u);
    std::vector<std::int64_t> exact(field.heights().size(), 0);
    PlaceInSteps from{x(random), y(random), z(random)};
    for (int move = 0; move < 12; ++move) {
      PlaceInSteps to{x(random), y(random), z(random)};
      const std::int64_t kind = pick(random);
      if (kind < 2) to.x = from.x;  // along an axis, and straight down
      if (kind == 1 || kind == 2) to.y = from.y;
      if (kind > 4) to = {from.x + 5 * kind, from.y - 9 * kind + 50, 0};
      to.z = from.z;
      field.Cut({.radius_mm = static_cast<double>(radius) / 200.0}, PointAt(from), PointAt(to));
      for (std::size_t cell = 0; cell < exact.size(); ++cell) {
        const Side side = SideOf(from, to, radius, left + 10 + 20 * static_cast<int>(cell % 150),
                                 front + 10 + 20 * static_cast<int>(cell / 150));
        if (side != Side::kBeyond) exact[cell] = std::min(exact[cell], from.z);
        on_edge += side == Side::kOnEdge ? 1 : 0;
      }
      from = {to.x, to.y, z(random)};
    }
    for (std::size_t cell = 0; cell < exact.size(); ++cell) {
      ASSERT_EQ(field.heights()[cell], static_cast<float>(static_cast<double>(exact[cell]) / 200.0))
          << round << ' ' << cell % 150 << ' ' << cell / 150;
    }
  }
  EXPECT_GT(on_edge, 500u);
}

// The formulas of motion.md 9 in more digits, by searching where they have none.
long double LeastOver(const MillTool& tool, const MachinePoint& from, const MachinePoint& to,
                      long double x, long double y) {
  const long double wx = to.x() - from.x(), wy = to.y() - from.y();
  const long double length = std::sqrt(wx * wx + wy * wy), radius = tool.radius_mm;
  const long double along = length > 0 ? (x * wx + y * wy) / length : 0;
  const long double across_2 = std::max(0.0L, x * x + y * y - along * along);
  const long double z = length > 0 ? from.z() : std::min(from.z(), to.z());
  const long double slope = length > 0 ? (to.z() - from.z()) / length : 0;
  const long double half = std::sqrt(std::max(0.0L, radius * radius - across_2));
  long double low = std::max(0.0L, along - half), high = std::min(length, along + half);
  const auto height = [&](long double place) {
    const long double d_2 = across_2 + (along - place) * (along - place);
    long double surface = 0;
    if (tool.shape == ToolShape::kBall)
      surface = radius - std::sqrt(std::max(0.0L, radius * radius - d_2));
    if (tool.shape == ToolShape::kVee)
      surface = std::max(0.0L, std::sqrt(d_2) - tool.tip_radius_mm) /
                std::tan(static_cast<long double>(tool.half_angle_rad));
    return z + slope * place + surface;
  };
  long double least = std::min(height(low), height(high));
  for (int k = 0; k < 120; ++k) {  // convex in the place
    const long double a = low + (high - low) / 3, b = high - (high - low) / 3;
    const long double at_a = height(a), at_b = height(b);
    least = std::min(least, std::min(at_a, at_b));
    (at_a < at_b ? high : low) = at_a < at_b ? b : a;
  }
  return least;
}

// Flat tools to the last digit of a height, others within 1e-6 mm; moves of all kinds and lengths,
// also longer than a piece of a row, a row of cells, and the block.
TEST(ToolSweep, HeightsAreThoseOfTheFormulas) {
  std::mt19937 random(23);  // NOLINT: the same every time
  std::uniform_real_distribution<double> x(-2.0, 14.0), y(-2.0, 7.0), z(-4.0, -0.1),
      share(0.0, 1.0);
  const Stock block{.x_max = 12.0, .y_max = 5.0, .bottom = -6.0, .top = 0.0, .cell = 0.1};
  for (int round = 0; round < 72; ++round) {
    MillTool tool{.shape = round % 3 == 0   ? ToolShape::kFlat
                           : round % 3 == 1 ? ToolShape::kBall
                                            : ToolShape::kVee,
                  .radius_mm = round % 8 == 7 ? 6.0 : 0.2 + 2.0 * share(random),
                  .half_angle_rad = 0.3 + share(random)};
    tool.tip_radius_mm = round % 2 == 0 ? 0.0 : tool.radius_mm * share(random);
    const MachinePoint from{x(random), y(random), z(random)};
    MachinePoint to{x(random), y(random), z(random)};
    if (round % 4 == 1) to = from + (to - from) * 0.02;  // short
    if (round % 5 == 2) to.z() = from.z();
    if (round % 5 == 3) to.y() = from.y();
    if (round % 7 == 3) to = {from.x(), from.y(), to.z()};
    HeightField field = HeightField::Of(block).value();
    field.Cut(tool, from, to);
    for (std::size_t row = 0; row < field.rows(); ++row) {
      for (std::size_t column = 0; column < field.columns(); ++column) {
        const double cx = 0.1 * (static_cast<double>(column) + 0.5);
        const double cy = 0.1 * (static_cast<double>(row) + 0.5);
        const auto told = SweptHeight(tool, from, to, cx, cy);
        const float height = field.height(column, row);
        if (!told) {
          ASSERT_EQ(height, 0.0f) << round << ' ' << column << ' ' << row;
          continue;
        }
        const long double exact =
            std::min(0.0L, LeastOver(tool, from, to, static_cast<long double>(cx) - from.x(),
                                     static_cast<long double>(cy) - from.y()));
        ASSERT_NEAR(height, static_cast<double>(exact), 1e-6)
            << round << ' ' << column << ' ' << row;
        if (tool.shape == ToolShape::kFlat) {
          ASSERT_EQ(height, static_cast<float>(exact)) << round << ' ' << column << ' ' << row;
        }
      }
    }
  }
}

// The columns of a row are those whose centres a tool covers, however long, short or level a move
// is, and in rows that are found together with others or not.
TEST(ToolSweep, RowsHaveWhatAToolCovers) {
  std::mt19937 random(29);  // NOLINT: the same every time
  std::uniform_real_distribution<double> x(-2.0, 14.0), y(-2.0, 7.0), share(0.0, 1.0);
  const HeightField field =
      HeightField::Of({.x_max = 12.0, .y_max = 5.0, .bottom = -1.0, .top = 0.0, .cell = 0.1})
          .value();
  for (int round = 0; round < 300; ++round) {
    const MillTool tool{.radius_mm = 0.01 + 2.5 * share(random) * share(random)};
    const MachinePoint from{x(random), y(random), 0.0};
    MachinePoint to{x(random), y(random), 0.0};
    if (round % 3 == 0)
      to.y() = from.y() + (round % 2 == 0 ? 1e-13 : -1e-9) * round;  // nearly level
    if (round % 5 == 0) to = from + (to - from) * 1e-9;
    const ToolPass pass(tool, from, to);
    const SweptRows swept(field, from, to, tool.radius_mm);
    for (std::size_t row = 0; row < field.rows(); ++row) {
      SweptRows::Columns columns;
      swept.Find(row, 1, columns);
      const bool within = row >= swept.rows().begin && row < swept.rows().end;
      for (std::int32_t column = 0; column < 120; ++column) {
        const double px = 0.1 * (column + 0.5) - from.x();
        const double py = 0.1 * (static_cast<double>(row) + 0.5) - from.y();
        const bool found = within && column >= columns.begin[0] && column < columns.end[0];
        ASSERT_EQ(found, pass.Covers(pass.AlongOf(px, py), pass.AcrossOf(px, py)))
            << round << ' ' << column << ' ' << row;
      }
    }
  }
}

// Rows that are cut by different threads at the same time have the bytes that one has.
TEST(ToolSweep, TwoThreadsByRowsLeaveTheSame) {
  const Stock block{.x_max = 30.0, .y_max = 20.0, .bottom = -6.0, .top = 0.0, .cell = 0.1};
  const MillTool ball{.shape = ToolShape::kBall, .radius_mm = 3.0};
  std::mt19937 random(31);  // NOLINT: the same every time
  std::uniform_real_distribution<double> x(0.0, 30.0), y(0.0, 20.0), z(-4.0, 0.0);
  std::vector<MachinePoint> way;
  for (int k = 0; k < 60; ++k) way.emplace_back(x(random), y(random), z(random));
  HeightField alone = HeightField::Of(block).value();
  HeightField shared = HeightField::Of(block).value();
  std::vector<double> most(way.size() - 1), lower(most.size()), upper(most.size());
  const auto cut = [&](HeightField& field, HeightField::Rows rows, std::vector<double>& taken) {
    for (std::size_t k = 0; k < taken.size(); ++k)
      taken[k] = field.Cut(ball, way[k], way[k + 1], rows);
  };
  cut(alone, alone.all_rows(), most);
  {
    const std::jthread other([&] { cut(shared, {0, 77}, lower); });
    cut(shared, {77, shared.rows()}, upper);
  }
  EXPECT_EQ(alone.heights(), shared.heights());
  for (std::size_t k = 0; k < most.size(); ++k) EXPECT_EQ(most[k], std::max(lower[k], upper[k]));
}

// Moves that no machine makes leave the block or cut it, and end.
TEST(ToolSweep, IsAtEaseWithAnyNumber) {
  HeightField field =
      HeightField::Of({.x_max = 3.0, .y_max = 2.0, .bottom = -1.0, .top = 0.0, .cell = 0.1})
          .value();
  for (const double far : {1e9, -1e9, 1e200, -1e300, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    for (const ToolShape shape : {ToolShape::kFlat, ToolShape::kBall, ToolShape::kVee}) {
      const MillTool tool{.shape = shape, .radius_mm = 1.0, .half_angle_rad = 0.5};
      field.Cut(tool, {1, 1, -0.5}, {far, 1, -0.5});
      field.Cut(tool, {far, far, -0.5}, {1, 1, -0.4});
      field.Cut(tool, {far, 1, far}, {far, far, -0.4});
    }
  }
  EXPECT_EQ(field.heights().size(), 600u);
}

}  // namespace
}  // namespace rmlcell::simulation
