// SPEED and ACCEL beyond all of it, where the axes alone set the limits. motion.md 3.4, 3.5, 5.1
#include <gtest/gtest.h>

#include <cmath>

#include "engine/motion/kinematics/speed_bound.h"
#include "engine/motion/planner/planner.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

// What is above 100 % counts as 100, and what is below 0 as nothing. OPT-2.13, OPT-2.14
TEST(LimitShares, AreClampedWhereTheAxesAloneCount) {
  for (const auto kind :
       {MoveCommand::Kind::kPointToPointAxes, MoveCommand::Kind::kPointToPointTip}) {
    MoveCommand move;
    move.kind = kind;
    move.path = kind == MoveCommand::Kind::kPointToPointAxes
                    ? PathPiece::Joint({{0, 0, 0}}, {{100, 50, 0}})
                    : PathPiece::Line({{0, 0, 0}}, {{100, 50, 0}});
    const PathLimits all = LimitsOf(move, StandardMachine());
    move.speed_fraction = 1.5;
    move.acceleration_fraction = 1.25;
    PathLimits limits = LimitsOf(move, StandardMachine());
    EXPECT_EQ(limits.speed, all.speed);
    EXPECT_EQ(limits.acceleration, all.acceleration);
    EXPECT_EQ(limits.jerk, all.jerk);
    move.speed_fraction = 0.25;
    move.acceleration_fraction = 0.5;
    limits = LimitsOf(move, StandardMachine());
    EXPECT_DOUBLE_EQ(limits.speed, 0.25 * all.speed);
    EXPECT_DOUBLE_EQ(limits.acceleration, 0.5 * all.acceleration);
    EXPECT_DOUBLE_EQ(limits.jerk, 0.5 * all.jerk);
    move.speed_fraction = move.acceleration_fraction = -0.5;
    limits = LimitsOf(move, StandardMachine());
    EXPECT_EQ(limits.speed, 0.0);
    EXPECT_EQ(limits.acceleration, 0.0);
    EXPECT_EQ(limits.jerk, 0.0);
  }
}

// Where the radius of an arc is what counts no axis is named: by the normal acceleration of the
// tip, sqrt(1600 * 50), by its jerk, cbrt(32000 * 9), and by what an axis may take in the bend,
// sqrt(0.5 * 300 * 50). motion.md 5.1
TEST(SpeedBound, NamesNoAxisWhereTheRadiusCounts) {
  MachineLimits machine = StandardMachine();
  machine.axes.acceleration.fill(1e9);
  const auto circle = [](double radius) {
    return PathPiece::Circle({{radius, 0, 0}}, {}, {0, 0, 1}, 2.0, 0.0, 0.0);
  };
  const SpeedBound by_normal = TightestBound(circle(50.0), MillHead{}, machine, 499.0);
  EXPECT_EQ(by_normal.cause, SpeedBound::Cause::kRadius);
  EXPECT_EQ(by_normal.axis, -1);
  EXPECT_NEAR(by_normal.speed, std::sqrt(80000.0), 1e-9);
  const SpeedBound by_jerk = TightestBound(circle(3.0), MillHead{}, machine, 499.0);
  EXPECT_EQ(by_jerk.cause, SpeedBound::Cause::kRadius);
  EXPECT_EQ(by_jerk.axis, -1);
  EXPECT_NEAR(by_jerk.speed, std::cbrt(288000.0), 1e-9);
  for (const int axis : {0, 1}) {
    machine = StandardMachine();
    machine.axes.acceleration.fill(1e9);
    machine.axes.acceleration[axis] = 300.0;
    const SpeedBound by_axis = TightestBound(circle(50.0), MillHead{}, machine, 499.0);
    EXPECT_EQ(by_axis.cause, SpeedBound::Cause::kRadius);
    EXPECT_EQ(by_axis.axis, -1);
    EXPECT_NEAR(by_axis.speed, std::sqrt(0.5 * 300.0 * 50.0), 0.01 * by_axis.speed);
  }
}

// B alone turns from -0.4 to 0.4 rad over 100 mm: Y = 300 * 0.008 cos B per mm is most in the
// middle.
TEST(SpeedBound, LooksAlongATurnOfBAlone) {
  const PathPiece line = PathPiece::Line({{0, 0, 0}, 0.0, -0.4}, {{100, 0, 0}, 0.0, 0.4});
  const SpeedBound bound = TightestBound(line, Head{}, StandardMachine(), 499.0);
  EXPECT_EQ(bound.cause, SpeedBound::Cause::kAxis);
  EXPECT_EQ(bound.axis, 1);
  EXPECT_NEAR(bound.speed, 500.0 / 2.4, 1e-9);
}

}  // namespace
}  // namespace rmlcell::motion
