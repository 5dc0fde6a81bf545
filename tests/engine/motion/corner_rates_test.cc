// Corners at which the head turns on at another rate, and what small curves ask of the axes.
// motion.md 4.3
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/core/units.h"
#include "engine/motion/corner/axes_corner.h"
#include "engine/motion/corner/corner.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// Straight on along X, 1 mm to each side, with these rates of the head in rad/mm.
Corner WithRates(double a_in, double a_out, double b_in, double b_out) {
  return Corner::Between(
      PathPiece::Line({{-1, 0, 0}, 0.3 - a_in, 0.2 - b_in}, {{0, 0, 0}, 0.3, 0.2}),
      PathPiece::Line({{0, 0, 0}, 0.3, 0.2}, {{1, 0, 0}, 0.3 + a_out, 0.2 + b_out}));
}

// d = 0.75 |dr| w^2 / A or sqrt(1.5 |dr| w^3 / J), whichever is more: of each angle the change of
// its rate, with the limits of its own axis.
TEST(CornerCut, FollowsTheChangeOfEachRate) {
  MachineLimits machine = StandardMachine();
  machine.axes.acceleration[3] = 20.0;
  machine.axes.acceleration[4] = 30.0;
  machine.axes.jerk[3] = 1e9;
  machine.axes.jerk[4] = 2e9;
  constexpr double kSquare = 40.0 * 40.0, kCube = 40.0 * 40.0 * 40.0;
  const auto cut = [&](const Corner& corner) { return corner.CutFor(40.0, machine); };
  EXPECT_NEAR(cut(WithRates(0.02, 0.05, 0.0, 0.0)), 0.75 * 0.03 * kSquare / 20.0, 1e-9);
  EXPECT_NEAR(cut(WithRates(0.05, -0.02, 0.0, 0.0)), 0.75 * 0.07 * kSquare / 20.0, 1e-9);
  EXPECT_NEAR(cut(WithRates(0.0, 0.0, 0.02, 0.05)), 0.75 * 0.03 * kSquare / 30.0, 1e-9);
  EXPECT_NEAR(cut(WithRates(0.0, 0.0, 0.05, -0.02)), 0.75 * 0.07 * kSquare / 30.0, 1e-9);
  machine.axes.acceleration[3] = machine.axes.acceleration[4] = 1e9;
  machine.axes.jerk[3] = 400.0;
  machine.axes.jerk[4] = 700.0;
  EXPECT_NEAR(cut(WithRates(0.02, 0.05, 0.0, 0.0)), std::sqrt(1.5 * 0.03 * kCube / 400.0), 1e-9);
  EXPECT_NEAR(cut(WithRates(0.0, 0.0, 0.02, 0.05)), std::sqrt(1.5 * 0.03 * kCube / 700.0), 1e-9);
  // Both: the wider one counts, not their sum.
  EXPECT_NEAR(cut(WithRates(0.02, 0.05, 0.01, 0.02)), std::sqrt(1.5 * 0.03 * kCube / 400.0), 1e-9);
  EXPECT_NEAR(cut(WithRates(0.02, 0.03, 0.01, 0.06)), std::sqrt(1.5 * 0.05 * kCube / 700.0), 1e-9);
}

// Whichever angle begins or ceases to turn there, it is a bend, and the head turns in it.
TEST(CornerPassage, OneRateAloneIsABend) {
  for (const auto& [a_in, a_out, b_in, b_out] : {std::array{0.02, 0.0, 0.0, 0.0},
                                                 {0.0, 0.02, 0.0, 0.0},
                                                 {0.0, 0.0, 0.02, 0.0},
                                                 {0.0, 0.0, 0.0, 0.02}}) {
    const Corner corner = WithRates(a_in, a_out, b_in, b_out);
    EXPECT_EQ(corner.passage(), Passage::kBlend);
    EXPECT_FALSE(corner.plain());
    EXPECT_FALSE(corner.straight());
  }
}

// Straight on from an arc of R 20 into one of R 30, d = 1.2 |dkappa| w^3 / J: bends to the other
// side add up, those to the same side do not. motion.md 4.3
TEST(CornerCut, FollowsTheJumpBetweenTwoArcs) {
  constexpr double kAngle = 0.5;
  const PathPiece in =
      PathPiece::Circle({{-20.0 * std::sin(kAngle), 20.0 - 20.0 * std::cos(kAngle), 0}}, {0, 20, 0},
                        {0, 0, 1}, kAngle, 0, 0);
  const PathPiece same = PathPiece::Circle({{0, 0, 0}}, {0, 30, 0}, {0, 0, 1}, kAngle, 0, 0);
  const PathPiece other = PathPiece::Circle({{0, 0, 0}}, {0, -30, 0}, {0, 0, -1}, kAngle, 0, 0);
  const double scale = 1.2 * 60.0 * 60.0 * 60.0 / 32000.0;
  for (const auto& [out, jump] :
       {std::pair{&same, 1.0 / 20.0 - 1.0 / 30.0}, {&other, 1.0 / 20.0 + 1.0 / 30.0}}) {
    const Corner corner = Corner::Between(in, *out);
    EXPECT_TRUE(corner.straight());
    EXPECT_EQ(corner.passage(), Passage::kBlend);
    EXPECT_NEAR(corner.CutFor(60.0, StandardMachine()), scale * jump, 1e-9);
    EXPECT_NEAR(corner.cut_max_mm(), 10.0, 1e-12);
  }
}

// With every length and every linear figure times c the axes follow as they did. motion.md 10,
// property 6
TEST(AxesFollow, AtEveryScaleAlike) {
  int yes = 0;
  for (const double factor : {1.0, 1e-2, 1e-4, 1e3}) {
    for (const double degrees : {10.0, 40.0, 80.0}) {
      const double turn = degrees * kRadPerDegree, cut = 2.0 * factor, way = 50.0 * factor;
      const PathPiece in = PathPiece::Line({{-way, 0, 0}, 0.1, 0.6}, {{0, 0, 0}, 0.4, 0.8});
      const PathPiece out = PathPiece::Line(
          {{0, 0, 0}, 0.4, 0.8}, {{way * std::cos(turn), way * std::sin(turn), 0}, -0.1, 0.3});
      const CornerCurve curve(EndAt(in, way - cut), EndAt(out, cut), cut);
      const double bend = Corner::Between(in, out).PlainCurvature(cut);
      MachineLimits machine = StandardMachine();
      for (const int axis : {0, 1, 2}) {
        machine.axes.speed[axis] *= factor;
        machine.axes.acceleration[axis] *= factor;
      }
      const Head head = GantryHead{.length_mm = 30.0 * factor};
      if (AxesFollow(curve, head, machine, 5.0 * factor, bend)) ++yes;
      EXPECT_FALSE(AxesFollow(curve, head, machine, 450.0 * factor, bend)) << factor;
    }
  }
  EXPECT_EQ(yes, 12);
}

// By the axes, as shares of full speed: of each axis the change, and the greatest counts.
TEST(AxesCornerCut, FollowsTheWorstAxis) {
  MachineLimits machine = StandardMachine();
  const PathPiece in = PathPiece::Joint({{0, 0, 0}, 0.0, 0.0}, {{100, 40, 0}, 0.5, 0.0});
  const PathPiece out = PathPiece::Joint({{100, 40, 0}, 0.5, 0.0}, {{130, 20, 0}, 0.9, 0.0});
  // X loses 70, Y 60, A 0.1 of their speeds by sigma.
  const auto cut = [&](double w, double share) {
    return AxesCorner(in, out, share, machine).CutFor(w);
  };
  const auto lasts = [](double w, double by_acceleration, double by_jerk) {
    return 0.5 * w * std::max(1.5 * w * by_acceleration, std::sqrt(6.0 * w * by_jerk));
  };
  EXPECT_NEAR(cut(0.3, 1.0), lasts(0.3, 70.0 / 2000.0, 70.0 / 40000.0), 1e-12);
  EXPECT_NEAR(cut(0.3, 0.5), lasts(0.3, 70.0 / 1000.0, 70.0 / 20000.0), 1e-12);
  machine.axes.acceleration[1] = 1000.0;
  machine.axes.jerk[1] = 30000.0;
  EXPECT_NEAR(cut(0.4, 1.0), lasts(0.4, 60.0 / 1000.0, 60.0 / 30000.0), 1e-12);
  machine.axes.jerk[3] = 40.0;
  EXPECT_NEAR(cut(0.4, 1.0), lasts(0.4, 60.0 / 1000.0, 0.1 / 40.0), 1e-12);
  const AxesCorner corner(in, out, 1.0, machine);
  for (const double w : {0.01, 0.4, 0.9}) EXPECT_NEAR(corner.SpeedFor(corner.CutFor(w)), w, 1e-12);
}

}  // namespace
}  // namespace rmlcell::motion
