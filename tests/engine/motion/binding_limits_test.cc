// Machines in which one limit binds and no other: what the standard machine, whose limits agree
// with each other, hides. motion.md 1, 3.4, 3.5, 5.1.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/core/units.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "engine/motion/kinematics/speed_bound.h"
#include "engine/motion/planner/planner.h"
#include "tests/engine/motion/random_chain.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

constexpr double kPlenty = 1e7;  // what an axis or the tip does not lack

// No limit binds: each test lowers the one that it is about.
MachineLimits Strong() {
  MachineLimits machine;
  machine.tip_speed_mm_s = 1000.0;
  machine.tip_acceleration_mm_s2 = kPlenty;
  machine.tip_jerk_mm_s3 = 1e3 * kPlenty;
  machine.axes.speed.fill(kPlenty);
  machine.axes.acceleration.fill(1e6 * kPlenty);
  machine.axes.jerk.fill(1e9 * kPlenty);
  return machine;
}

MoveCommand MoveOn(const PathPiece& path, const Head& head = MillHead{}) {
  MoveCommand move;
  move.path = path;
  move.head = head;
  return move;
}

// About the origin in the XY plane, from one angle to another (degrees).
PathPiece ArcFrom(double radius, double from_deg, double to_deg) {
  const double from = from_deg * kRadPerDegree;
  return PathPiece::Circle({{radius * std::cos(from), radius * std::sin(from), 0}}, {}, {0, 0, 1},
                           (to_deg - from_deg) * kRadPerDegree, 0, 0);
}

// SPEED, ACCEL and what the tip can do. Shares above 1 count as 1, below 0 as 0. OPT-B.21
TEST(BindingLimits, TipAlone) {
  MachineLimits machine = Strong();
  machine.tip_speed_mm_s = 300.0;
  machine.tip_acceleration_mm_s2 = 700.0;
  machine.tip_jerk_mm_s3 = 9000.0;
  MoveCommand move = MoveOn(PathPiece::Line({}, {{10, 20, 30}}));
  move.speed_fraction = 0.25;
  move.acceleration_fraction = 0.5;
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).speed, 75.0);
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).acceleration, 350.0);
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).jerk, 4500.0);
  move.speed_fraction = move.acceleration_fraction = 1.5;
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).speed, 300.0);
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).acceleration, 700.0);
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).jerk, 9000.0);
  move.speed_fraction = -0.5;
  EXPECT_EQ(LimitsOf(move, machine).speed, 0.0);
}

// Each of X Y Z alone, on a line of direction (0.36, 0.48, 0.8): V_i / |q'_i|, A_i / |q'_i|,
// J_i / |q'_i|, whatever ACCEL. One that asks for just less than the tip binds nothing.
TEST(BindingLimits, EachLinearAxisOnALine) {
  constexpr double kDirection[3] = {0.36, 0.48, 0.8};
  MoveCommand move = MoveOn(PathPiece::Line({{5, 5, 5}}, {{5 - 36, 5 + 48, 5 - 80}}));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    MachineLimits machine = Strong();
    machine.axes.speed[axis] = 12.0;
    machine.axes.acceleration[axis] = 340.0;
    machine.axes.jerk[axis] = 5600.0;
    const PathLimits limits = LimitsOf(move, machine);
    EXPECT_NEAR(limits.speed, 12.0 / kDirection[axis], 1e-9) << axis;
    EXPECT_NEAR(limits.acceleration, 340.0 / kDirection[axis], 1e-9) << axis;
    EXPECT_NEAR(limits.jerk, 5600.0 / kDirection[axis], 1e-8) << axis;
    machine = Strong();
    machine.axes.speed[axis] = 1000.0 * kDirection[axis] * (1.0 + 1e-9);
    EXPECT_EQ(LimitsOf(move, machine).speed, 1000.0) << axis;
    machine.tip_jerk_mm_s3 = kNoLimit;
    machine.axes.jerk[axis] = 1.0;  // counts nowhere
    EXPECT_EQ(LimitsOf(move, machine).jerk, kNoLimit) << axis;
    EXPECT_EQ(LimitsOf(move, machine).speed, 1000.0) << axis;
  }
}

// A and B alone, 0.2 and 0.5 rad/mm with a head that has no arm.
TEST(BindingLimits, EachRotaryAxisOnALine) {
  const MoveCommand move = MoveOn(PathPiece::Line({{0, 0, 0}, 1, 1}, {{10, 0, 0}, 3, -4}));
  constexpr double kRate[2] = {0.2, 0.5};
  for (const std::size_t k : {0u, 1u}) {
    MachineLimits machine = Strong();
    machine.axes.speed[3 + k] = 1.5;
    machine.axes.acceleration[3 + k] = 4.0;
    machine.axes.jerk[3 + k] = 70.0;
    const PathLimits limits = LimitsOf(move, machine);
    EXPECT_NEAR(limits.speed, 1.5 / kRate[k], 1e-9);
    EXPECT_NEAR(limits.acceleration, 4.0 / kRate[k], 1e-9);
    EXPECT_NEAR(limits.jerk, 70.0 / kRate[k], 1e-8);
  }
}

// The column is thrown out where the head turns. Upright but for B = pi/2 the column goes round the
// tip, 300 mm off, by 0.01 rad/mm: 3 mm for each mm across, and 0.03 per mm of curvature, of which
// half of 2000 mm/s2 leaves V = sqrt(1000/0.03) = 182.57.
TEST(BindingLimits, WhatTheTurningHeadAsksOfTheColumn) {
  // A from -1 to 1: column = tip + 300 (sin A, -cos A, 0), X' = 1 + 3 cos A, Y'' = 0.03 cos A.
  const PathPiece line = PathPiece::Line({{0, 0, 0}, -1, kPi / 2}, {{200, 0, 0}, 1, kPi / 2});
  const MoveCommand move = MoveOn(line, GantryHead{});
  MachineLimits machine = Strong();
  machine.axes.speed[0] = 200.0;
  EXPECT_NEAR(LimitsOf(move, machine).speed, 50.0, 1e-7);  // 1 + 3 in the middle
  machine = Strong();
  machine.axes.acceleration[1] = 2000.0;
  EXPECT_NEAR(LimitsOf(move, machine).speed, std::sqrt(1000.0 / 0.03), 1e-6);
  // Y' = 3 sin A is greatest at the ends, X'' = -0.03 sin A too.
  machine = Strong();
  machine.axes.speed[1] = 200.0;
  EXPECT_NEAR(LimitsOf(move, machine).speed, 200.0 / (3.0 * std::sin(1.0)), 1e-7);
  machine = Strong();
  machine.axes.jerk[1] = 5000.0;
  EXPECT_NEAR(LimitsOf(move, machine).jerk, 5000.0 / (3.0 * std::sin(1.0)), 1e-5);
}

// Within 1 % below the exact limit, and never above it, where a short search will do: each figure
// of each axis alone, on lines with a little turning.
TEST(BindingLimits, ShortTurnsAreWithinOnePercent) {
  for (const double turn : {1e-4, 2e-3, 8e-3, 0.02, 0.05}) {
    const PathPiece line =
        PathPiece::Line({{0, 0, 0}, 0.7, 0.4}, {{3, -2, 1}, 0.7 + turn, 0.4 - 0.6 * turn});
    const MoveCommand move = MoveOn(line, GantryHead{.tool = {7.0, -3.0, 2.0}});
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      MachineLimits by_speed = Strong(), by_curvature = Strong(), by_jerk = Strong();
      by_speed.axes.speed[axis] = 0.01;
      by_curvature.axes.acceleration[axis] = 0.5;
      by_jerk.axes.jerk[axis] = 3.0;
      const PathLimits bend = LimitsOf(move, by_curvature);
      double speed = 1000.0, bent = 1000.0, acceleration = kPlenty, jerk = 1e3 * kPlenty;
      for (int k = 0; k <= 4000; ++k) {
        const AxisDerivatives q = DerivativesAt(line, move.head, line.length() * k / 4000.0);
        const double first = std::abs(q.first[axis]), second = std::abs(q.second[axis]);
        speed = std::min(speed, 0.01 / first);
        bent = std::min(bent, std::sqrt(0.25 / second));
        acceleration = std::min(acceleration, (0.5 - second * bend.speed * bend.speed) / first);
        jerk = std::min(jerk, 3.0 / first);
      }
      const auto near = [&](double got, double exact) {
        EXPECT_LE(got, exact * (1.0 + 1e-6)) << turn << " axis " << axis;
        EXPECT_GE(got, exact * 0.99) << turn << " axis " << axis;
      };
      near(LimitsOf(move, by_speed).speed, speed);
      near(bend.speed, bent);
      near(bend.acceleration, acceleration);
      near(LimitsOf(move, by_jerk).jerk, jerk);
    }
  }
}

// Where the ends of a line do not tell the limits they are searched for: never above what 20,000
// places allow, and within 1 % below it (1e-9 where the head turns far). One axis alone is weak.
TEST(BindingLimits, RandomTurnsAgainstBruteForce) {
  Dice dice(46);
  int far = 0;
  for (int round = 0; round < 150; ++round) {
    const double turn = dice.Magnitude(0.02, 3.0);
    const TipPose from{{0, 0, 0}, dice.Uniform(-3.0, 3.0), dice.Uniform(-2.0, 2.0)};
    const TipPose to{dice.Direction() * dice.Magnitude(1.0, 300.0),
                     from.a_rad + dice.Uniform(-1.0, 1.0) * turn,
                     from.b_rad + dice.Uniform(-1.0, 1.0) * turn};
    const PathPiece line = PathPiece::Line(from, to);
    const Head head = GantryHead{
        .tool = {dice.Uniform(-9.0, 9.0), dice.Uniform(-9.0, 9.0), dice.Uniform(0.0, 90.0)}};
    const auto axis = static_cast<std::size_t>(dice.Uniform(0.0, 4.999));
    MachineLimits machine = Strong();
    machine.axes.speed[axis] = dice.Magnitude(0.5, 500.0);
    machine.axes.acceleration[axis] = dice.Magnitude(1.0, 2000.0);
    machine.axes.jerk[axis] = dice.Magnitude(10.0, 40000.0);
    const PathLimits limits = LimitsOf(MoveOn(line, head), machine);
    PathLimits least{machine.tip_speed_mm_s, machine.tip_acceleration_mm_s2,
                     machine.tip_jerk_mm_s3};
    constexpr int kPlaces = 20000;
    for (int k = 0; k <= kPlaces; ++k) {
      const AxisDerivatives q = DerivativesAt(line, head, line.length() * k / kPlaces);
      const double first = std::abs(q.first[axis]), second = std::abs(q.second[axis]);
      const double room = machine.axes.acceleration[axis] - second * limits.speed * limits.speed;
      least.speed = std::min({least.speed, machine.axes.speed[axis] / first,
                              std::sqrt(0.5 * machine.axes.acceleration[axis] / second)});
      least.acceleration = std::min(least.acceleration, room / first);
      least.jerk = std::min(least.jerk, machine.axes.jerk[axis] / first);
    }
    const bool searched = turn > 0.5;
    far += searched ? 1 : 0;
    const auto near = [&](double got, double exact) {
      EXPECT_LE(got, exact * (1.0 + 1e-7)) << round << " axis " << axis << " turn " << turn;
      EXPECT_GE(got, exact * 0.99) << round << " axis " << axis << " turn " << turn;
    };
    near(limits.speed, least.speed);
    near(limits.acceleration, least.acceleration);
    near(limits.jerk, least.jerk);
  }
  EXPECT_GT(far, 40);
}

// V <= sqrt(a_n R), a <= curve_tangential a_max: R = 50 and a_max = 2000, whose shares are 1600 and
// 1200. ACCEL lowers the second alone.
TEST(BindingLimits, NormalAccelerationOnArcs) {
  MachineLimits machine = Strong();
  machine.tip_acceleration_mm_s2 = 2000.0;
  MoveCommand move = MoveOn(ArcFrom(50, 0, 90));
  EXPECT_NEAR(LimitsOf(move, machine).speed, std::sqrt(80000.0), 1e-9);
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).acceleration, 1200.0);
  move.acceleration_fraction = 0.5;
  EXPECT_NEAR(LimitsOf(move, machine).speed, std::sqrt(80000.0), 1e-9);
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).acceleration, 1000.0);
  machine.curve_normal = 0.5;
  machine.curve_tangential = 0.3;
  EXPECT_NEAR(LimitsOf(move, machine).speed, std::sqrt(50000.0), 1e-9);
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).acceleration, 600.0);
  const SpeedBound bound = TightestBound(move.path, move.head, machine, 500.0);
  EXPECT_EQ(bound.cause, SpeedBound::Cause::kRadius);
  EXPECT_NEAR(bound.speed, std::sqrt(50000.0), 1e-9);
}

// V <= (j_n R^2)^(1/3): R = 3 and j_max = 40000, of which 0.8: cbrt(288000). Without a limit on
// jerk it binds nothing. ACCEL does not count.
TEST(BindingLimits, JerkOnArcs) {
  MachineLimits machine = Strong();
  machine.tip_jerk_mm_s3 = 40000.0;
  MoveCommand move = MoveOn(ArcFrom(3, 0, 359));
  move.acceleration_fraction = 0.5;
  EXPECT_NEAR(LimitsOf(move, machine).speed, std::cbrt(288000.0), 1e-9);
  EXPECT_DOUBLE_EQ(LimitsOf(move, machine).jerk, 20000.0);
  EXPECT_NEAR(TightestBound(move.path, move.head, machine, 500.0).speed, std::cbrt(288000.0), 1e-9);
  machine.curve_jerk = 0.4;
  EXPECT_NEAR(LimitsOf(move, machine).speed, std::cbrt(144000.0), 1e-9);
  machine.tip_jerk_mm_s3 = kNoLimit;
  EXPECT_EQ(LimitsOf(move, machine).speed, 1000.0);
  EXPECT_EQ(TightestBound(move.path, move.head, machine, 2000.0).cause, SpeedBound::Cause::kNone);
}

// An axis is fastest where the tangent lies along it and bends most at its quadrant point: where an
// arc has that place inside, it binds there, else at an end. No sample falls on it.
TEST(BindingLimits, QuadrantPointsOfArcs) {
  struct Case {
    double from, to;           // degrees
    double tangent_x, bend_x;  // the greatest of |sin| and |cos|
  };
  const double s40 = std::sin(40 * kRadPerDegree), c37 = std::cos(37 * kRadPerDegree);
  for (const Case& each : {Case{-23, 40, s40, 1.0}, Case{37, 101, 1.0, c37}, Case{37, 40, s40, c37},
                           Case{-160, 177, 1.0, 1.0}}) {
    const MoveCommand move = MoveOn(ArcFrom(80, each.from, each.to));
    MachineLimits machine = Strong();
    machine.axes.speed[0] = 30.0;
    EXPECT_NEAR(LimitsOf(move, machine).speed, 30.0 / each.tangent_x, 1e-7) << each.from;
    machine = Strong();
    machine.axes.acceleration[0] = 500.0;
    EXPECT_NEAR(LimitsOf(move, machine).speed, std::sqrt(250.0 * 80.0 / each.bend_x), 1e-6)
        << each.from;
    machine = Strong();
    machine.axes.jerk[0] = 900.0;
    EXPECT_NEAR(LimitsOf(move, machine).jerk, 900.0 / each.tangent_x, 1e-5) << each.from;
  }
}

// What the bend leaves of an axis: with V^2 / R = c of its A, (A - c cos) / sin is least at
// cos = c / A, where it is sqrt(A^2 - c^2). V = 100, R = 50: c = 200, just below half of A.
TEST(BindingLimits, AccelerationLeftOnAnArc) {
  for (const std::size_t axis : {0u, 1u}) {
    MachineLimits machine = Strong();
    machine.tip_speed_mm_s = 100.0;
    machine.axes.acceleration[axis] = 401.0;
    const MoveCommand circle = MoveOn(ArcFrom(50, 0, 360));
    EXPECT_EQ(LimitsOf(circle, machine).speed, 100.0);
    EXPECT_NEAR(LimitsOf(circle, machine).acceleration, std::sqrt(401.0 * 401.0 - 40000.0), 1e-5);
    machine.axes.acceleration[axis] = 399.0;
    EXPECT_NEAR(LimitsOf(circle, machine).speed, std::sqrt(0.5 * 399.0 * 50.0), 1e-8);
    EXPECT_NEAR(LimitsOf(circle, machine).acceleration, 399.0 * std::sqrt(0.75), 1e-5);
  }
}

// Arcs of any length have the limits of their radius: almost none, and almost a full circle.
TEST(BindingLimits, ArcsOfNoLengthAndOfAFullTurn) {
  MachineLimits machine = Strong();
  machine.tip_acceleration_mm_s2 = 2000.0;
  for (const double degrees : {1e-3, 359.9, 360.0}) {
    EXPECT_NEAR(LimitsOf(MoveOn(ArcFrom(20, 15, 15 + degrees)), machine).speed, std::sqrt(32000.0),
                1e-9);
  }
}

// An arc tilted about X: Y moves by cos of the tilt of what it would, Z by its sine.
TEST(BindingLimits, TiltedArcs) {
  const PathPiece arc = PathPiece::Circle({{40, 0, 0}}, {}, {0, -0.6, 0.8}, kTurn, 0, 0);
  for (const auto& [axis, share] : {std::pair{0u, 1.0}, {1u, 0.8}, {2u, 0.6}}) {
    MachineLimits machine = Strong();
    machine.axes.speed[axis] = 60.0;
    EXPECT_NEAR(LimitsOf(MoveOn(arc), machine).speed, 60.0 / share, 1e-7);
    machine = Strong();
    machine.axes.acceleration[axis] = 500.0;
    EXPECT_NEAR(LimitsOf(MoveOn(arc), machine).speed, std::sqrt(250.0 * 40.0 / share), 1e-6);
    const SpeedBound bound = TightestBound(arc, MillHead{}, machine, 1000.0);
    EXPECT_EQ(bound.cause, SpeedBound::Cause::kRadius);
    EXPECT_NEAR(bound.speed, std::sqrt(250.0 * 40.0 / share), 0.01 * bound.speed);
  }
}

// motion.md 3.4: f V_i / |D_i|, a A_i / |D_i|, a J_i / |D_i|, each axis alone. The tip has no say.
// OPT-2.13
TEST(BindingLimits, PositioningInAxes) {
  constexpr double kWay[5] = {30.0, 40.0, 50.0, 2.0, 4.0};
  MoveCommand move = MoveOn(PathPiece::Joint({{1, 1, 1}, 0, 0}, {{31, -39, 51}, 2, -4}));
  move.kind = MoveCommand::Kind::kPointToPointAxes;
  move.speed_fraction = 0.5;
  move.acceleration_fraction = 0.25;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    MachineLimits machine = Strong();
    machine.tip_speed_mm_s = machine.tip_acceleration_mm_s2 = 1e-3;
    machine.tip_jerk_mm_s3 = 1e-3;
    machine.axes.speed[axis] = 6.0;
    machine.axes.acceleration[axis] = 9.0;
    machine.axes.jerk[axis] = 20.0;
    const PathLimits limits = LimitsOf(move, machine);
    EXPECT_NEAR(limits.speed, 0.5 * 6.0 / kWay[axis], 1e-12) << axis;
    EXPECT_NEAR(limits.acceleration, 0.25 * 9.0 / kWay[axis], 1e-12) << axis;
    EXPECT_NEAR(limits.jerk, 0.25 * 20.0 / kWay[axis], 1e-12) << axis;
  }
}

// motion.md 3.5: the same for the tip's way, with f for speeds and a for accelerations, in the bend
// of the column, too: half of a A_Y = 500 for Y'' = 0.03 at A = 0. A contour that turns the head
// alone follows the same rule (3.1). OPT-2.14, OPT-2.17
TEST(BindingLimits, PositioningOfTheTip) {
  MoveCommand move =
      MoveOn(PathPiece::Line({{0, 0, 0}, -1, kPi / 2}, {{200, 0, 0}, 1, kPi / 2}), GantryHead{});
  move.kind = MoveCommand::Kind::kPointToPointTip;
  move.speed_fraction = 0.5;
  move.acceleration_fraction = 0.25;
  MachineLimits machine = Strong();
  machine.axes.speed[0] = 200.0;
  EXPECT_NEAR(LimitsOf(move, machine).speed, 25.0, 1e-7);
  machine = Strong();
  machine.axes.acceleration[1] = 2000.0;
  EXPECT_NEAR(LimitsOf(move, machine).speed, std::sqrt(250.0 / 0.03), 1e-6);
  machine = Strong();
  machine.axes.jerk[0] = 4000.0;
  EXPECT_NEAR(LimitsOf(move, machine).jerk, 0.25 * 4000.0 / 4.0, 1e-5);
  MoveCommand turn = MoveOn(PathPiece::Line({{9, 9, 9}, 0, 0}, {{9, 9, 9}, 3, 0}));
  turn.speed_fraction = 0.5;
  turn.acceleration_fraction = 0.25;
  machine = Strong();
  machine.axes.speed[3] = 6.0;
  machine.axes.acceleration[3] = 12.0;
  machine.axes.jerk[3] = 24.0;
  EXPECT_NEAR(LimitsOf(turn, machine).speed, 1.0, 1e-12);
  EXPECT_NEAR(LimitsOf(turn, machine).acceleration, 1.0, 1e-12);
  EXPECT_NEAR(LimitsOf(turn, machine).jerk, 2.0, 1e-12);
}

// More turning than any travel has: the limits are those of the rates, by bounds.
TEST(BindingLimits, HundredTurns) {
  MachineLimits machine = Strong();
  machine.axes.speed[3] = 2.0;
  const PathPiece line = PathPiece::Line({}, {{10, 0, 0}, 100.0 * kTurn, 0});
  EXPECT_NEAR(LimitsOf(MoveOn(line), machine).speed, 2.0 * 10.0 / (100.0 * kTurn), 1e-12);
}

// Short cuts must not change the answer: lines of all directions with all axes as strong as the
// tip, and one axis a little weaker in one figure.
TEST(BindingLimits, LinesFollowTheTipUnlessAnAxisIsWeaker) {
  MachineLimits machine = Strong();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    machine.axes.speed[axis] = machine.tip_speed_mm_s;
    machine.axes.acceleration[axis] = machine.tip_acceleration_mm_s2;
    machine.axes.jerk[axis] = machine.tip_jerk_mm_s3;
  }
  EXPECT_TRUE(LinesFollowTip(machine));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (AxisValues AxisLimits::*figure :
         {&AxisLimits::speed, &AxisLimits::acceleration, &AxisLimits::jerk}) {
      MachineLimits weak = machine;
      (weak.axes.*figure)[axis] *= 1.0 - 1e-6;
      EXPECT_FALSE(LinesFollowTip(weak));
      weak.tip_jerk_mm_s3 = kNoLimit;
      EXPECT_EQ(LinesFollowTip(weak), figure == &AxisLimits::jerk);
    }
  }
}

// motion.md 5.1 in a plan: a slow Y axis slows a line along Y, one along X not. In a line the move
// is one speed all along.
TEST(BindingLimits, PlansKeepThem) {
  MachineLimits machine = Strong();
  machine.tip_acceleration_mm_s2 = 2000.0;
  machine.tip_jerk_mm_s3 = kNoLimit;
  machine.axes.speed[1] = 40.0;
  machine.settling_s = 0.0;
  const auto time = [&](const MachinePoint& to) {
    Planner planner(machine);
    MoveCommand move = MoveOn(PathPiece::Line({}, {to}));
    move.speed_fraction = 0.1;
    EXPECT_TRUE(planner.Append(move));
    return std::get<PlannedMotion>(*planner.Next()).duration_s();
  };
  EXPECT_NEAR(time({200, 0, 0}), 2.0 + 100.0 / 2000.0, 1e-9);
  EXPECT_NEAR(time({0, 200, 0}), 5.0 + 40.0 / 2000.0, 1e-9);
  EXPECT_NEAR(time({120, 160, 0}), 4.0 + 50.0 / 2000.0, 1e-9);  // 40 / 0.8 = 50
}

// Which figure of which axis it is that keeps a line with a turning head slow. SPEED does not
// count.
TEST(SpeedBound, NamesEachAxis) {
  const PathPiece line = PathPiece::Line({{0, 0, 0}, -1, 0.3}, {{2, 3, 6}, 1, -0.5});
  for (int axis = 0; axis < kAxisCount; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    for (AxisValues AxisLimits::*figure : {&AxisLimits::speed, &AxisLimits::acceleration}) {
      MachineLimits machine = Strong();
      (machine.axes.*figure)[i] = 0.5;
      const SpeedBound bound = TightestBound(line, GantryHead{}, machine, 1000.0);
      if (figure == &AxisLimits::acceleration && axis >= 3) {  // they turn evenly: no bend
        EXPECT_EQ(bound.cause, SpeedBound::Cause::kNone);
        continue;
      }
      EXPECT_EQ(bound.cause, SpeedBound::Cause::kAxis);
      EXPECT_EQ(bound.axis, axis);
      const double exact = LimitsOf(MoveOn(line, GantryHead{}), machine).speed;
      EXPECT_NEAR(bound.speed, exact, 0.01 * exact) << axis;
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion
