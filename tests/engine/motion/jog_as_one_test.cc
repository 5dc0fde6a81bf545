// What moves several axes as one, at the ends of their travels and while the
// tool turns. LIVE-8.02, OPT-4.54, OPT-4.56.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "engine/motion/jog/jog_drive.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion::jog_as_one {
namespace {

const AxisPose kAslant{{1000.0, 900.0, -300.0}, 0.4, 0.9};

JogMachine Gantry() { return {.head = GantryHead{}, .axes = StandardMachine().axes}; }
AxisValues Of(double x, double y, double z, double a, double b) { return {x, y, z, a, b}; }
AxisValues ValuesAt(const JogDrive& drive) {
  const AxisPose at = drive.axes();
  return Of(at.column.x(), at.column.y(), at.column.z(), at.a_rad, at.b_rad);
}

// Advances by a millisecond each; the hardest that X, Y or Z is pushed
// meanwhile, mm/s2. What is cut off at an end would be a jump.
double HardestPush(JogDrive& drive, double from_s, double until_s) {
  constexpr double kStep_s = 1e-3;
  drive.Advance(from_s);
  std::array<AxisValues, 3> last{ValuesAt(drive), ValuesAt(drive), ValuesAt(drive)};
  double hardest = 0.0;
  for (int n = 1; from_s + kStep_s * n <= until_s; ++n) {
    drive.Advance(from_s + kStep_s * n);
    last = {last[1], last[2], ValuesAt(drive)};
    if (n < 2) continue;
    const AxisValues push = (last[2] - 2.0 * last[1] + last[0]) / (kStep_s * kStep_s);
    hardest = std::max(hardest, push.head<3>().cwiseAbs().maxCoeff());
  }
  return hardest;
}

// Along the tool, in each of its directions: to the end that the first axis
// comes to, exactly, on a straight line, and softly.
TEST(JogAsOne, EveryDirectionOfTheToolEndsWhereTheFirstAxisDoes) {
  const AxisLimits limits = StandardMachine().axes;
  const Rotation along = ToolRotation(0.4, 0.9);
  for (int k = 0; k < 3; ++k) {
    for (const double sense : {1.0, -1.0}) {
      JogDrive drive(Gantry(), JogMode::kTool, kAslant);
      AxisValues speeds;
      speeds[k] = sense * 250.0;
      drive.Demand(speeds);
      const MachineVector way = along.col(k) * sense;
      double room = kNoLimit;
      for (int axis = 0; axis < 3; ++axis) {
        const double end = way[axis] > 0.0 ? limits.travel_max[axis] : limits.travel_min[axis];
        if (std::abs(way[axis]) > 1e-9)
          room = std::min(room, (end - kAslant.column[axis]) / way[axis]);
      }
      EXPECT_LE(HardestPush(drive, 0.0, room / 250.0 + 0.5), 2000.0 * 1.01) << k;
      EXPECT_TRUE(drive.rests());
      EXPECT_LT((drive.axes().column - (kAslant.column + room * way)).norm(), 1e-6) << k;
    }
  }
}

// With the tip held A and B come to their own ends, and the tip stays.
TEST(JogAsOne, AHeldTipTurnsToTheEndOfTheTurningAxis) {
  const JogMachine machine = Gantry();
  for (const int axis : {3, 4}) {
    for (const double sense : {1.0, -1.0}) {
      JogDrive drive(machine, JogMode::kAbsolute, kAslant);
      AxisValues speeds;
      speeds[axis] = sense * 1.5;
      drive.Demand(speeds);
      EXPECT_LE(HardestPush(drive, 0.0, 20.0), 2000.0 * 1.01);
      EXPECT_TRUE(drive.rests());
      EXPECT_NEAR(ValuesAt(drive)[axis], sense * (axis == 3 ? 12.6 : 2.4), 1e-9);
      const MachinePoint tip = machine.head.TipOf(drive.axes()).tip;
      EXPECT_LT((tip - machine.head.TipOf(kAslant).tip).norm(), 1e-6) << axis;
    }
  }
}

// And to the end of an axis of the column that the turn carries along: all
// stands there.
TEST(JogAsOne, AHeldTipTurnsToTheEndOfTheColumn) {
  const JogMachine machine = Gantry();
  const MachineVector aside = kAslant.column - machine.head.TipOf(kAslant).tip;
  const double radius = std::hypot(aside.x(), aside.y());
  for (const int axis : {0, 1}) {
    for (const double sense : {1.0, -1.0}) {
      for (const double turn : {1.0, -1.0}) {
        AxisPose at = kAslant;
        const double end =
            axis == 0 ? (sense > 0.0 ? 3600.0 : -600.0) : (sense > 0.0 ? 3100.0 : -600.0);
        at.column[axis] = end + aside[axis] - sense * 0.95 * radius;  // the tip stands inside
        JogDrive drive(machine, JogMode::kAbsolute, at);
        drive.Demand(Of(0.0, 0.0, 0.0, turn * 1.2, 0.0));
        EXPECT_LE(HardestPush(drive, 0.0, 12.0), 2000.0 * 1.01);
        EXPECT_TRUE(drive.rests());
        EXPECT_NEAR(drive.axes().column[axis], end, 1e-6) << axis << " " << sense;
        const MachinePoint tip = machine.head.TipOf(drive.axes()).tip;
        EXPECT_LT((tip - machine.head.TipOf(at).tip).norm(), 1e-6);
      }
    }
  }
}

// X goes on while A, which is slow to stop, carries the column back: when both stop X comes to rest
// first, and what has gone on by then is taken back. The farthest is in the middle of the stop, or,
// where A is very slow, at its very begin.
void ComesBackBeforeTheEnd(int axis, double sense, double acceleration_of_a, double away) {
  const double end = 1000.0;
  JogMachine machine = Gantry();
  machine.axes.acceleration[3] = acceleration_of_a;
  machine.axes.travel_min[3] = -kNoLimit;
  machine.axes.travel_max[3] = kNoLimit;
  machine.axes.travel_max[axis] = end;
  machine.axes.travel_min[axis] = -end;
  // Upright at B = 90 deg the column stands along -Y of the turned tool: A moves X by +300 mm a
  // radian.
  AxisPose at{{0.0, 0.0, 0.0}, axis == 0 ? 0.0 : kPi / 2.0, kPi / 2.0};
  at.column[axis] = sense * (end - away);
  JogDrive drive(machine, JogMode::kAbsolute, at);
  AxisValues speeds;
  speeds[axis] = sense * 100.0;
  speeds[3] = -sense * 0.16;
  drive.Demand(speeds);
  EXPECT_LE(HardestPush(drive, 0.0, 12.0), 2000.0 + 2.0 * 60.0);
  EXPECT_TRUE(drive.rests());
  EXPECT_LT(sense * drive.axes().column[axis], end - 1.0);
}

TEST(JogAsOne, WhatTurnsBackWhileItStopsStaysInside) {
  for (const double sense : {1.0, -1.0}) {
    for (const int axis : {0, 1}) {
      SCOPED_TRACE(std::to_string(sense * (axis + 1)));
      ComesBackBeforeTheEnd(axis, sense, 0.2, 70.0);
      ComesBackBeforeTheEnd(axis, sense, 0.05, 300.0);
    }
  }
}

// Along the tool A and B are by themselves: what else comes to an end does not
// keep them.
TEST(JogAsOne, AlongTheToolTheHeadTurnsOnAtAnEnd) {
  for (const int turned : {3, 4}) {
    AxisPose at = kAslant;
    at.column.z() = 1080.0;
    JogDrive drive(Gantry(), JogMode::kTool, at);
    AxisValues speeds = Of(0.0, 0.0, 100.0, 0.0, 0.0);
    speeds[turned] = 0.2;
    drive.Demand(speeds);
    EXPECT_LE(HardestPush(drive, 0.0, 2.0), 2000.0 * 1.1);
    EXPECT_FALSE(drive.rests());
    EXPECT_NEAR(drive.axes().column.z(), 1100.0, 0.5);
    EXPECT_GT(ValuesAt(drive)[turned], (turned == 3 ? 0.4 : 0.9) + 0.38);
    drive.Demand({});
    drive.Advance(3.0);
    EXPECT_TRUE(drive.rests());
  }
}

// With a head that stands X, Y and Z are each by itself with the tip held, too.
TEST(JogAsOne, WithoutATurnTheHeldTipMovesEachAxisByItself) {
  AxisPose at = kAslant;
  at.column.x() = 3550.0;
  JogDrive drive(Gantry(), JogMode::kAbsolute, at);
  drive.Demand(Of(100.0, 50.0, -20.0, 0.0, 0.0));
  drive.Advance(2.0);
  EXPECT_NEAR(drive.axes().column.x(), 3600.0, 1e-9);
  EXPECT_NEAR(drive.tip_speed_mm_s(), std::hypot(50.0, 20.0), 1e-9);
  EXPECT_NEAR(drive.axes().column.z(), -300.0 - 40.0 + 0.5 * 20.0 * 2.0 * std::sqrt(20.0 / 40000.0),
              1e-9);
}

// When the turn is let go each goes on to its own end.
TEST(JogAsOne, AfterATurnEachAxisIsByItselfAgain) {
  AxisPose at = kAslant;
  at.column.x() = 3400.0;
  JogDrive drive(Gantry(), JogMode::kAbsolute, at);
  drive.Demand(Of(100.0, 50.0, 0.0, 0.3, 0.0));
  drive.Advance(0.5);
  drive.Demand(Of(100.0, 50.0, 0.0, 0.0, 0.0));
  EXPECT_LE(HardestPush(drive, 0.5, 6.0), 2000.0 * 1.1);
  EXPECT_NEAR(drive.axes().column.x(), 3600.0, 1e-9);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 50.0, 1e-9);
}

// OPT-4.54: along the axes of the tool while A or B alone turns, begun before
// the way or after it. Against the sum of its parts, a tenth of a millisecond
// each.
TEST(JogAsOne, TheWayAlongAToolThatTurns) {
  for (const auto& [a, b] : {std::pair{0.7, 0.0}, {0.0, -0.9}, {0.6, 0.8}}) {
    for (const double begins_s : {0.0, 0.53}) {
      JogDrive drive(Gantry(), JogMode::kTool, kAslant);
      if (begins_s > 0.0) drive.Demand(Of(0.0, 0.0, 0.0, a, b));
      drive.Advance(begins_s);
      EXPECT_LT((drive.axes().column - kAslant.column).norm(), 1e-12);
      drive.Demand(Of(60.0, -80.0, 100.0, a, b));
      JogDrive alone(Gantry(), JogMode::kTool, {kAslant.column, 0.0, 0.0});
      alone.Advance(begins_s);
      alone.Demand(Of(60.0, -80.0, 100.0, 0.0, 0.0));
      MachinePoint column = kAslant.column;
      constexpr double kStep_s = 2e-4;
      for (int n = 1; n <= 4000; ++n) {
        if (n == 3000) {  // the way ends, the turn does not
          drive.Demand(Of(0.0, 0.0, 0.0, a, b));
          alone.Demand({});
        }
        const AxisPose before = drive.axes();
        const MachinePoint gone = alone.axes().column;
        drive.Advance(begins_s + kStep_s * n);
        alone.Advance(begins_s + kStep_s * n);
        column += ToolRotation(0.5 * (before.a_rad + drive.axes().a_rad),
                               0.5 * (before.b_rad + drive.axes().b_rad)) *
                  MachineVector(alone.axes().column - gone);
      }
      EXPECT_LT((drive.axes().column - column).norm(), 1e-5) << a << " " << b << " " << begins_s;
      EXPECT_GT((column - kAslant.column).norm(), 50.0);
    }
  }
}

// However slowly: 0.5 mm/s along the tool, 0.2 mm before an end.
TEST(JogAsOne, ASlowWayEndsAtTheEnd) {
  AxisPose at = kAslant;
  at.column.z() = 1099.8;
  JogDrive drive(Gantry(), JogMode::kTool, at);
  drive.Demand(Of(0.0, 0.0, 0.5, 0.0, 0.0));
  drive.Advance(2.0);
  EXPECT_TRUE(drive.rests());
  EXPECT_NEAR(drive.axes().column.z(), 1100.0, 1e-7);
  EXPECT_NEAR((drive.axes().column - at.column).norm(), 0.2 / std::cos(0.9), 1e-6);
}

// A direction of the tool is as fast as the axes are that it is made of: 600
// mm/s along Z of the tool are 433 of Y.
TEST(JogAsOne, ADirectionMayBeFasterThanAnAxis) {
  JogDrive drive(Gantry(), JogMode::kTool, kAslant);
  drive.Demand(Of(0.0, 0.0, 600.0, 0.0, 0.0));
  drive.Advance(0.6);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 600.0, 1e-9);
}

// The step of a mill, let go while it is under way: it goes its way, and no
// farther. Beyond it, it stops as soon as it can.
TEST(JogAsOne, TheLeastWayIsGoneFromWhereItIsLetGo) {
  JogMachine mill{.head = MillHead()};
  mill.axes.speed = {60.0, 60.0, 30.0, 1.0, 0.0};
  mill.axes.acceleration = {200.0, 200.0, 200.0, 3.0, 0.0};
  mill.axes.jerk.setConstant(kNoLimit);
  mill.axes.travel_min = {0.0, 0.0, -60.0, -kNoLimit, 0.0};
  mill.axes.travel_max = {200.0, 150.0, 0.0, kNoLimit, 0.0};
  JogDrive drive(mill, JogMode::kRobot, {{10.0, 10.0, -10.0}, 0.0, 0.0});
  AxisValues least;
  least[1] = 0.5;
  drive.Advance(1.0);
  drive.Demand(Of(0.0, -10.0, 0.0, 0.0, 0.0));
  drive.Advance(1.06);  // 0.25 mm to get to 10 mm/s in 0.05 s, and 0.1 mm more
  drive.Demand({}, least);
  drive.Advance(3.0);
  EXPECT_NEAR(drive.axes().column.y(), 10.0 - 0.6, 1e-9);
  drive.Demand(Of(0.0, 1.0, 0.0, 0.0, 0.0));
  drive.Advance(3.1);
  drive.Demand({}, least);
  drive.Advance(3.3);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 1.0, 1e-9);
  drive.Advance(5.0);
  EXPECT_NEAR(drive.axes().column.y(), 9.4 + 0.5, 1e-9);
}

}  // namespace
}  // namespace rmlcell::motion::jog_as_one
