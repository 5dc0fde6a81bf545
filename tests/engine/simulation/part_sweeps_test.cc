// Parts of a way that begin somewhere on it: how far the tip goes, and how each coordinate of tip,
// column and head does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/path/path_extent.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;

const motion::Head& HeadOfSweeps() {
  static const motion::Head head = motion::GantryHead{.length_mm = 300.0};
  return head;
}

// The same of values at many places: what goes up and down by more than rounding.
CoordinateSweep SeenSweep(const std::vector<double>& values) {
  CoordinateSweep sweep;
  sweep.minimum = *std::ranges::min_element(values);
  sweep.maximum = *std::ranges::max_element(values);
  double last = values.front();
  for (const double value : values) {
    if (std::abs(value - last) < 1e-9) continue;
    const int sign = value > last ? 1 : -1;
    if (sweep.first_sign == 0) sweep.first_sign = sign;
    if (sweep.last_sign == -sign) ++sweep.turns;
    sweep.last_sign = sign;
    sweep.travel += std::abs(value - last);
    last = value;
  }
  return sweep;
}

void ExpectAsSeen(const CoordinateSweep& sweep, const std::vector<double>& values, double near,
                  const std::string& what) {
  const CoordinateSweep seen = SeenSweep(values);
  EXPECT_NEAR(sweep.minimum, seen.minimum, near) << what;
  EXPECT_NEAR(sweep.maximum, seen.maximum, near) << what;
  EXPECT_NEAR(sweep.travel, seen.travel, 4.0 * near) << what;
  // Hardly anything, or hardly anything at an end: rounding may decide where that leads.
  const double least = 1e-6 * seen.travel;
  if (seen.travel < 100.0 * near || std::abs(values[1] - values[0]) < least ||
      std::abs(values[values.size() - 1] - values[values.size() - 2]) < least)
    return;
  EXPECT_EQ(sweep.first_sign, seen.first_sign) << what;
  EXPECT_EQ(sweep.last_sign, seen.last_sign) << what;
  EXPECT_EQ(sweep.turns, seen.turns) << what;
}

void ExpectSweeps(const PathPiece& path, double from, double to, const std::string& what) {
  const motion::Head& head = HeadOfSweeps();
  PartShape shape({path, head, from * path.length(), to * path.length()});
  const PointSweep tip = TipSweep(shape), column = ColumnSweep(shape);
  const auto rotary = RotarySweep(shape);
  std::vector<std::vector<double>> values(8);
  constexpr int kPlaces = 400;
  double way = 0.0;
  motion::MachinePoint last;
  for (int n = 0; n <= kPlaces; ++n) {
    const double s = path.length() * (from + (to - from) * n / kPlaces);
    const motion::PathPose at = path.At(s);
    const motion::MachinePoint point = motion::TipOn(path, head, at).tip;
    const motion::MachinePoint above = motion::AxesOn(path, head, at).column;
    for (int i = 0; i < 3; ++i) {
      values[static_cast<std::size_t>(i)].push_back(point[i]);
      values[static_cast<std::size_t>(i) + 3].push_back(above[i]);
    }
    values[6].push_back(at.a_rad);
    values[7].push_back(at.b_rad);
    if (n > 0) way += (point - last).norm();
    last = point;
  }
  double most = 0.0;
  for (const auto& each : values) most = std::max(most, SeenSweep(each).travel);
  const double near = 1e-4 * most + 1e-9;
  for (std::size_t i = 0; i < 3; ++i) {
    ExpectAsSeen(tip[i], values[i], near, what + " tip " + std::to_string(i));
    ExpectAsSeen(column[i], values[i + 3], near, what + " column " + std::to_string(i));
    if (i < 2) ExpectAsSeen(rotary[i], values[i + 6], 1e-4, what + " angle " + std::to_string(i));
  }
  EXPECT_NEAR(TipLength(shape), way, 1e-4 * way + 1e-9) << what;
}

TEST(PartSweeps, OfLinesJointsAndArcs) {
  const std::vector<PathPiece> ways = {
      PathPiece::Line({{5, -6, 7}, 0.3, 0.9}, {{65, 74, -23}, 0.3, 0.9}),
      PathPiece::Line({{5, -6, 7}, 0.3, 0.9}, {{-25, 34, 57}, 0.3, -0.9}),
      PathPiece::Line({{5, -6, 7}, 0.3, 0.9}, {{5, -6, 7}, 2.9, 0.9}),
      PathPiece::Joint({{10, 20, 30}, 0.3, 0.7}, {{70, -60, 130}, 0.3, 0.7}),
      PathPiece::Joint({{10, 20, 30}, 0.3, 0.7}, {{20, 30, 40}, 2.3, -1.1}),
      PathPiece::Circle({{32, 0, 9}, 0.1, 0.2}, {12, 0, 9}, {0, 0, 1}, 5.5, 0.1, 0.2),
      PathPiece::Circle({{32, 0, 9}, 0.1, 0.2}, {12, 0, 9}, {0, 0.6, 0.8}, 5.5, 0.4, -0.3)};
  for (std::size_t way = 0; way < ways.size(); ++way) {
    const std::string what = "way " + std::to_string(way);
    ExpectSweeps(ways[way], 0.0, 1.0, what);
    ExpectSweeps(ways[way], 0.25, 0.875, what + " part");
    ExpectSweeps(ways[way], 0.5, 1.0, what + " end");
  }
}

TEST(PartSweeps, OfBends) {
  const motion::TipPose from{{0, 0, 0}, 0.1, 0.5}, corner{{100, 0, 20}, 0.5, 0.2};
  int number = 0;
  for (const motion::TipPose& to : {motion::TipPose{{150, 90, 40}, 0.1, 0.7},
                                    {{10, 30, 0}, 0.1, 0.1},
                                    {{150, -90, 10}, 0.9, 0.2},
                                    {{60, 70, 90}, -0.4, 0.8},
                                    {{180, 10, -60}, 0.5, -0.4}}) {
    for (const bool back : {false, true}) {
      const auto motions = back ? PlannedCorner(to, corner, from) : PlannedCorner(from, corner, to);
      for (const motion::PlannedMotion& planned : motions) {
        if (planned.path.kind() != PathPiece::Kind::kBlend) continue;
        const std::string what = "bend " + std::to_string(++number);
        ExpectSweeps(planned.path, 0.0, 1.0, what);
        ExpectSweeps(planned.path, 0.125, 0.75, what + " part");
        ExpectSweeps(planned.path, 0.375, 1.0, what + " end");
      }
    }
  }
  EXPECT_EQ(number, 20);
}

// A tip that goes along its path goes as far as that, to the last digit.
TEST(PartSweeps, ThePartOfAPathIsItsLength) {
  const PathPiece line = PathPiece::Line({{5, -6, 7}, 0.3, 0.9}, {{65, 74, -23}, 0.3, 0.9});
  const PathPiece arc = PathPiece::Circle({{20, 0, 0}}, {0, 0, 0}, {0, 0, 1}, 5.0, 0.0, 0.0);
  const PathPiece bend = PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}}).at(1).path;
  for (const PathPiece& path : {line, arc, bend}) {
    const double from = 0.1 * path.length(), to = 0.7 * path.length();
    EXPECT_EQ(TipLengthOf({path, HeadOfSweeps(), from, to}), to - from);
  }
  EXPECT_EQ(TipLengthOf({line, HeadOfSweeps(), 1.0, 1.0}), 0.0);
}

}  // namespace
}  // namespace rmlcell::simulation
