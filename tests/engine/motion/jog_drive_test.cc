#include "engine/motion/jog/jog_drive.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

JogMachine Gantry() {
  return {.head = GantryHead{.length_mm = 300.0}, .axes = StandardMachine().axes};
}

AxisValues Values(const AxisPose& pose) {
  return {pose.column.x(), pose.column.y(), pose.column.z(), pose.a_rad, pose.b_rad};
}

AxisValues Only(int axis, double speed) {
  AxisValues speeds;
  speeds[axis] = speed;
  return speeds;
}

constexpr std::array kSteps = {0.0005, 0.003, 0.01, 0.03, 0.09, 0.15, 0.21, 0.27, 0.33, 0.40};
const AxisPose kMiddle{{1000.0, 900.0, -300.0}, 0.4, 0.9};

// The way of a ramp between rest and `v`, as LIVE-8.01 has it; below a^2/j that of a ramp without a
// middle (motion.md 5.2).
double StopWay(double v, double a, double j) {
  return v >= a * a / j ? 0.5 * v * (v / a + a / j) : v * std::sqrt(v / j);
}

// LIVE-8.01: v/2 (v/a + a/j), at all ten steps of the jog table, X and B.
TEST(JogDrive, StopsInTheWayOfItsRamp) {
  for (const double share : kSteps) {
    for (const int axis : {0, 4}) {
      JogDrive drive(Gantry(), JogMode::kRobot, {{1000.0, 900.0, -300.0}, 0.0, -2.0});
      const double v = share * (axis == 0 ? 500.0 : kTurn);
      drive.Demand(Only(axis, v));
      drive.Advance(1.0);
      const double before = Values(drive.axes())[axis];
      drive.Demand({});
      drive.Advance(3.0);
      EXPECT_TRUE(drive.rests());
      const double way = axis == 0 ? StopWay(v, 2000.0, 40000.0) : StopWay(v, 20.0, 400.0);
      EXPECT_NEAR(Values(drive.axes())[axis] - before, way, 1e-9) << share << " " << axis;
    }
  }
  EXPECT_NEAR(StopWay(200.0, 2000.0, 40000.0), 15.0, 1e-12);  // at 40 %, in 0.15 s
  EXPECT_LT(StopWay(5.0, 2000.0, 40000.0), 1.3);              // at 1 %
}

// LIVE-8.01: 40 % is 200 mm/s, reached and left in 0.15 s.
TEST(JogDrive, ReachesItsSpeedAndLeavesIt) {
  JogDrive drive(Gantry(), JogMode::kRobot, kMiddle);
  drive.Demand(Only(1, -200.0));
  drive.Advance(0.15);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 200.0, 1e-9);
  EXPECT_NEAR(drive.axes().column.y(), 900.0 - 15.0, 1e-9);
  drive.Advance(0.65);
  EXPECT_NEAR(drive.axes().column.y(), 900.0 - 115.0, 1e-9);
  drive.Brake();
  drive.Advance(0.799);
  EXPECT_FALSE(drive.rests());
  drive.Advance(0.801);
  EXPECT_TRUE(drive.rests());
  EXPECT_EQ(drive.tip_speed_mm_s(), 0.0);
}

// Each channel brakes with what its axis has; along the tool X, Y and Z with what the weakest of
// them has, and the tip allows; A and B with the tip held with half of that, at the length of the
// head.
TEST(JogDrive, RunsOnWithTheLimitsOfItsMode) {
  JogMachine machine = Gantry();
  machine.axes.acceleration = {3000.0, 2500.0, 2000.0, 30.0, 24.0};
  machine.axes.jerk = {60000.0, 50000.0, 40000.0, 600.0, 480.0};
  machine.tip_acceleration_mm_s2 = 1500.0;
  machine.tip_jerk_mm_s3 = 30000.0;
  const auto runs_on = [&](JogMode mode, int axis, double acceleration, double jerk) {
    JogDrive drive(machine, mode, kMiddle);
    const double v = axis < 3 ? 20.0 : 0.1;
    drive.Demand(Only(axis, v));
    const double way = StopWay(v, acceleration, jerk);
    EXPECT_NEAR(drive.RunsOn(axis), way, 1e-12) << axis;
    const double radius = axis == 3 ? 300.0 * std::sin(0.9) : 300.0;
    const double linear = mode == JogMode::kAbsolute ? way * radius : 0.0;
    EXPECT_NEAR(drive.LinearRunsOn(axis), axis < 3 ? way : linear, 1e-9) << axis;
  };
  for (int axis = 0; axis < kAxisCount; ++axis) {
    const double acceleration = machine.axes.acceleration[axis], jerk = machine.axes.jerk[axis];
    runs_on(JogMode::kRobot, axis, acceleration, jerk);
    const bool turns = axis >= 3;
    runs_on(JogMode::kTool, axis, turns ? acceleration : 1500.0, turns ? jerk : 30000.0);
    runs_on(JogMode::kAbsolute, axis, turns ? 1000.0 / 300.0 : acceleration,
            turns ? 40000.0 / 300.0 : jerk);
  }
  machine.tip_acceleration_mm_s2 = 9000.0;
  machine.tip_jerk_mm_s3 = 90000.0;
  for (int axis = 0; axis < 3; ++axis) runs_on(JogMode::kTool, axis, 2000.0, 40000.0);
  machine.head = GantryHead{.length_mm = 20.0};  // shorter than what the axes A and B need
  JogDrive drive(machine, JogMode::kAbsolute, kMiddle);
  drive.Demand(Only(3, 0.1));
  EXPECT_NEAR(drive.RunsOn(3), StopWay(0.1, 30.0, 600.0), 1e-12);
}

// What is asked for is lowered as a whole, so that no axis goes faster than it can, nor is asked
// for more than half of its acceleration by what turns meanwhile. How fast it is then its stop
// tells.
TEST(JogDrive, LowersWhatNoAxisCan) {
  const auto share_of = [](const JogMachine& machine, JogMode mode, const AxisPose& at,
                           const AxisValues& speeds, int axis) {
    JogDrive drive(machine, mode, at);
    drive.Demand(speeds);
    const bool held = mode == JogMode::kAbsolute && axis >= 3;
    const double a = held ? 1000.0 / 300.0 : axis < 3 ? 2000.0 : 20.0;
    const double j = held ? 40000.0 / 300.0 : axis < 3 ? 40000.0 : 400.0;
    double low = 0.0, high = 1.0;
    for (int n = 0; n < 50; ++n) {
      const double middle = 0.5 * (low + high);
      (StopWay(middle * std::abs(speeds[axis]), a, j) < drive.RunsOn(axis) ? low : high) = middle;
    }
    return low;
  };
  const JogMachine machine = Gantry();
  const AxisPose upright{{1000.0, 900.0, -300.0}, 0.0, 0.0};
  AxisValues all;
  all.head<3>().setConstant(200.0);
  EXPECT_NEAR(share_of(machine, JogMode::kTool, upright, all, 1), 1.0, 1e-9);
  all[3] = 0.1;  // now any axis may come to lie along all three
  EXPECT_NEAR(share_of(machine, JogMode::kTool, upright, all, 1), 500.0 / 600.0, 1e-9);
  AxisValues fast = Only(2, 400.0);
  fast[3] = 2.0;
  fast[4] = 1.0;
  EXPECT_NEAR(share_of(machine, JogMode::kTool, kMiddle, fast, 2), 1000.0 / 1200.0, 1e-9);
  EXPECT_NEAR(share_of(machine, JogMode::kTool, kMiddle, fast, 3), 1.0, 1e-9);
  EXPECT_NEAR(share_of(machine, JogMode::kTool, kMiddle, Only(3, 10.0), 3), kTurn / 10.0, 1e-9);
  EXPECT_NEAR(share_of(machine, JogMode::kRobot, kMiddle, Only(0, -600.0), 0), 500.0 / 600.0, 1e-9);

  // With the tip held: about A alone the column of an upright head does not move at all.
  EXPECT_NEAR(share_of(machine, JogMode::kAbsolute, upright, Only(3, 3.0), 3), 1.0, 1e-9);
  const double aside = 300.0 * std::sin(0.9);  // 2.4 rad/s: 564 mm/s, and inward 1354 mm/s2
  EXPECT_NEAR(share_of(machine, JogMode::kAbsolute, kMiddle, Only(3, 2.4), 3),
              std::sqrt(1000.0 / (2.4 * 2.4 * aside)), 1e-9);
  AxisValues both = Only(3, 1.0);
  both[4] = 1.0;  // 300 mm/s for each of them
  EXPECT_NEAR(share_of(machine, JogMode::kAbsolute, kMiddle, both, 4), 500.0 / 600.0, 1e-9);
}

// About A alone, with the tip held, Z does not move: it has all of its speed for its own key, and
// keeps exactly to it. LIVE-8.01
TEST(JogDrive, TurningAboutATakesNothingFromZ) {
  JogMachine machine = Gantry();
  machine.axes.speed[2] = 200.0;
  JogDrive alone(machine, JogMode::kAbsolute, kMiddle);
  JogDrive turning(machine, JogMode::kAbsolute, kMiddle);
  AxisValues speeds = Only(2, 200.0);
  alone.Demand(speeds);
  speeds[3] = 0.1;
  turning.KeepTo({200.0, 200.0, 200.0, 2.5, 2.5});
  turning.Demand(speeds);
  EXPECT_EQ(turning.RunsOn(2), alone.RunsOn(2));
  alone.Advance(1.0);
  turning.Advance(1.0);
  const MachinePoint tip = machine.head.TipOf(turning.axes()).tip;
  EXPECT_NEAR(tip.z(), machine.head.TipOf(alone.axes()).tip.z(), 1e-9);
}

// OPT-4.52: with ROB a key moves its own axis only.
TEST(JogDrive, RobotMovesOneAxis) {
  for (int axis = 0; axis < kAxisCount; ++axis) {
    for (const double sense : {1.0, -1.0}) {
      JogDrive drive(Gantry(), JogMode::kRobot, kMiddle);
      drive.Demand(Only(axis, sense * 0.5));
      drive.Advance(1.0);
      const AxisValues moved = Values(drive.axes()) - Values(kMiddle);
      for (int other = 0; other < kAxisCount; ++other)
        EXPECT_EQ(moved[other] != 0.0, other == axis) << axis;
      EXPECT_GT(sense * moved[axis], 0.4);
    }
  }
}

// OPT-4.53: with ABS the tip stays where it is while A or B turns, and X, Y, Z are as with ROB.
TEST(JogDrive, AbsoluteHoldsTheTip) {
  const JogMachine machine = Gantry();
  for (const int axis : {3, 4}) {
    JogDrive drive(machine, JogMode::kAbsolute, kMiddle);
    drive.Demand(Only(axis, 0.4 * kTurn));
    const MachinePoint tip = machine.head.TipOf(kMiddle).tip;
    for (double t = 0.01; t < 0.8; t += 0.01) {
      drive.Advance(t);
      EXPECT_LT((machine.head.TipOf(drive.axes()).tip - tip).norm(), 1e-9);
      EXPECT_EQ(drive.tip_speed_mm_s(), 0.0);
    }
    EXPECT_GT(Values(drive.axes())[axis] - Values(kMiddle)[axis], 0.5);
    EXPECT_GT((drive.axes().column - kMiddle.column).norm(), 50.0);
  }
  JogDrive drive(machine, JogMode::kAbsolute, kMiddle);
  drive.Demand(Only(2, 100.0));
  drive.Advance(1.0);
  EXPECT_EQ(drive.axes().column.x(), 1000.0);
  EXPECT_GT(drive.axes().column.z(), -210.0);
}

// OPT-4.54 and case K09: along the axes of the tool; A and B as with ROB.
TEST(JogDrive, ToolMovesAlongItsAxes) {
  JogDrive drive(Gantry(), JogMode::kTool, kMiddle);
  drive.Demand(Only(2, 105.0));
  drive.Advance(0.5);
  drive.Brake();
  drive.Advance(1.0);
  const MachineVector moved = drive.axes().column - kMiddle.column;
  const MachineVector k09(3.050418666, -7.21491862, 6.216099683);
  EXPECT_LT((moved.normalized() - ToolDirection(0.4, 0.9)).norm(), 1e-9);
  EXPECT_LT((moved.normalized() - k09 / 10.0).norm(), 1e-8);

  JogDrive aside(Gantry(), JogMode::kTool, {{0.0, 0.0, 0.0}, 0.0, kPi / 2.0});
  aside.Demand(Only(2, 100.0));
  aside.Advance(1.0);
  EXPECT_NEAR(aside.axes().column.x(), 0.0, 1e-9);
  EXPECT_LT(aside.axes().column.y(), -90.0);
  EXPECT_NEAR(aside.axes().column.z(), 0.0, 1e-9);

  JogDrive turned(Gantry(), JogMode::kTool, kMiddle);
  turned.Demand(Only(4, 0.5));
  turned.Advance(1.0);
  EXPECT_EQ(turned.axes().column, kMiddle.column);
  EXPECT_GT(turned.axes().b_rad, 1.3);
}

// OPT-4.52, OPT-4.53, OPT-4.54: every key with every reference ends where the rule for a way puts
// it (motion.md 6).
TEST(JogDrive, EveryKeyGoesWhereItsWayLeads) {
  const JogMachine machine = Gantry();
  for (const JogMode mode : {JogMode::kRobot, JogMode::kAbsolute, JogMode::kTool}) {
    for (int axis = 0; axis < kAxisCount; ++axis) {
      for (const double sense : {1.0, -1.0}) {
        JogDrive drive(machine, mode, kMiddle);
        drive.Demand(Only(axis, sense * (axis < 3 ? 75.0 : 0.5)));
        drive.Advance(0.8);
        drive.Brake();
        drive.Advance(2.0);
        const AxisValues moved = Values(drive.axes()) - Values(kMiddle);
        const double way = axis < 3 ? sense * moved.head<3>().norm() : moved[axis];
        EXPECT_GT(sense * way, axis < 3 ? 55.0 : 0.3);
        const AxisPose to =
            Jogged(kMiddle, machine.head, {.mode = mode, .axis = axis, .distance = way});
        EXPECT_LT((Values(drive.axes()) - Values(to)).norm(), 1e-9) << axis;
      }
    }
  }
}

// OPT-4.54: "along the tool axes, which turn with the head", also while it turns. Against steps of
// a tenth of a millisecond.
TEST(JogDrive, ToolAxesTurnWithTheHead) {
  JogDrive drive(Gantry(), JogMode::kTool, kMiddle);
  AxisValues speeds = Only(2, 100.0);
  speeds[3] = 0.7;
  speeds[4] = -0.9;
  drive.Demand(speeds);
  constexpr double kStep = 1e-4;
  MachinePoint column = kMiddle.column;
  JogDrive alone(Gantry(), JogMode::kTool, kMiddle);
  alone.Demand(Only(2, 100.0));
  double way = 0.0;
  for (int n = 1; n <= 10000; ++n) {
    const AxisPose before = drive.axes();
    drive.Advance(kStep * n);
    alone.Advance(kStep * n);
    const double gone = (alone.axes().column - kMiddle.column).norm();
    const AxisPose behind = drive.axes();
    column += (gone - way) * ToolDirection(0.5 * (before.a_rad + behind.a_rad),
                                           0.5 * (before.b_rad + behind.b_rad));
    way = gone;
  }
  EXPECT_LT((drive.axes().column - column).norm(), 1e-4);
  EXPECT_GT(way, 90.0);
}

// LIVE-8.01: keys add as vectors; one that is let go leaves the others. No axis is asked for more
// than it can.
TEST(JogDrive, KeysAdd) {
  JogDrive drive(Gantry(), JogMode::kRobot, kMiddle);
  AxisValues both = Only(0, 200.0);
  both[1] = -200.0;
  drive.Demand(both);
  drive.Advance(1.0);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 200.0 * std::sqrt(2.0), 1e-9);
  drive.Demand(Only(1, -200.0));
  drive.Advance(1.2);
  EXPECT_NEAR(drive.axes().column.x(), 1000.0 + 185.0 + 15.0, 1e-9);
  EXPECT_NEAR(drive.axes().column.y(), 900.0 - 225.0, 1e-9);

  JogMachine slow = Gantry();
  slow.axes.speed[1] = 50.0;
  JogDrive limited(slow, JogMode::kRobot, kMiddle);
  limited.Demand(both);
  limited.Advance(1.0);
  EXPECT_NEAR(limited.tip_speed_mm_s(), std::hypot(200.0, 50.0), 1e-9);
}

// LIVE-8.01: with the tip held no axis of the column goes faster than it can: 300 mm at 40 % of a
// turn in a second were 754 mm/s. Nor is it asked for more acceleration.
TEST(JogDrive, TheHeldTipKeepsTheColumnWithinItsSpeed) {
  constexpr double kStep = 1e-3;
  for (const int axis : {3, 4}) {
    JogDrive drive(Gantry(), JogMode::kAbsolute, {{1000.0, 900.0, -300.0}, 0.0, 1.2});
    drive.Demand(Only(axis, -0.4 * kTurn));
    std::array<AxisValues, 3> last{};
    double fastest = 0.0;
    double hardest = 0.0;
    for (int n = 0; n <= 1000; ++n) {
      if (n == 700) drive.Brake();
      drive.Advance(kStep * n);
      last = {last[1], last[2], Values(drive.axes())};
      if (n < 2) continue;
      const AxisValues speed = (last[2] - last[1]) / kStep;
      const AxisValues push = (last[2] - 2.0 * last[1] + last[0]) / (kStep * kStep);
      fastest = std::max(fastest, speed.head<3>().cwiseAbs().maxCoeff());
      hardest = std::max(hardest, push.head<3>().cwiseAbs().maxCoeff());
    }
    EXPECT_LE(fastest, 500.0 + 1e-6);
    EXPECT_GT(fastest, 400.0);
    EXPECT_LE(hardest, 2000.0 * 1.001);
  }
}

// OPT-4.56, LIVE-8.02: an axis stands on its end, and the others go on.
TEST(JogDrive, AnAxisStandsOnItsEnd) {
  for (const double sense : {1.0, -1.0}) {
    for (int axis = 0; axis < kAxisCount; ++axis) {
      JogDrive drive(Gantry(), JogMode::kRobot, {{1500.0, 1200.0, 0.0}, 0.0, 0.0});
      AxisValues speeds = Only(axis, sense * (axis < 3 ? 200.0 : 2.0));
      const int other = axis == 0 ? 1 : 0;
      speeds[other] = 10.0;
      drive.Demand(speeds);
      drive.Advance(20.0);
      const AxisLimits limits = StandardMachine().axes;
      const double end = sense > 0.0 ? limits.travel_max[axis] : limits.travel_min[axis];
      EXPECT_NEAR(Values(drive.axes())[axis], end, 1e-9);
      EXPECT_NEAR(drive.tip_speed_mm_s(), 10.0, 1e-9);
      drive.Demand(Only(axis, sense * 0.1));  // no farther, and back again
      drive.Advance(21.0);
      EXPECT_NEAR(Values(drive.axes())[axis], end, 1e-9);
      drive.Demand(Only(axis, -sense * 0.1));
      drive.Advance(22.0);
      EXPECT_GT(std::abs(Values(drive.axes())[axis] - end), 0.05);
    }
  }
}

// An axis goes on to its very end, but not for a way that is none.
TEST(JogDrive, GoesTheLastOfItsTravel) {
  for (const double left : {1e-7, 1e-10}) {
    AxisPose at = kMiddle;
    at.column.x() = 3600.0 - left;
    JogDrive drive(Gantry(), JogMode::kRobot, at);
    drive.Demand(Only(0, 100.0));
    EXPECT_EQ(drive.rests(), left < 1e-9);
    drive.Advance(1.0);
    EXPECT_TRUE(drive.rests());
    EXPECT_NEAR(drive.axes().column.x(), left < 1e-9 ? at.column.x() : 3600.0, 1e-12);
  }
}

// LIVE-8.02: what moves several axes stops as one: a tool that goes aslant keeps to its line, and
// comes to rest where the first axis comes to its end.
TEST(JogDrive, AslantItStopsAsOne) {
  JogDrive drive(Gantry(), JogMode::kTool, kMiddle);
  drive.Demand(Only(2, 200.0));
  drive.Advance(20.0);
  EXPECT_TRUE(drive.rests());
  const MachineVector moved = drive.axes().column - kMiddle.column;
  EXPECT_NEAR(drive.axes().column.y(), -600.0, 1e-7);
  EXPECT_LT(moved.cross(ToolDirection(0.4, 0.9)).norm(), 1e-6);
  drive.Demand(Only(2, 20.0));  // no farther
  drive.Advance(21.0);
  EXPECT_NEAR(drive.axes().column.y(), -600.0, 1e-7);
  EXPECT_TRUE(drive.rests());
  drive.Demand(Only(2, -20.0));
  drive.Advance(22.0);
  EXPECT_GT(drive.axes().column.y(), -590.0);
}

// LIVE-8.02: with the tip held A and B stop together with the column.
TEST(JogDrive, WithTheTipHeldAllStopAsOne) {
  const JogMachine machine = Gantry();
  const AxisPose at{{1000.0, 900.0, 1050.0}, 0.0, 1.2};  // the column rises as B turns back
  JogDrive drive(machine, JogMode::kAbsolute, at);
  AxisValues speeds = Only(4, -0.8);
  speeds[3] = 0.3;
  drive.Demand(speeds);
  drive.Advance(10.0);
  EXPECT_TRUE(drive.rests());
  EXPECT_NEAR(drive.axes().column.z(), 1100.0, 1e-7);
  EXPECT_GT(drive.axes().b_rad, 0.9);
  EXPECT_LT((machine.head.TipOf(drive.axes()).tip - machine.head.TipOf(at).tip).norm(), 1e-6);
}

// A key of the other direction brakes first; both together stand.
TEST(JogDrive, TurnsBackOverRest) {
  JogDrive drive(Gantry(), JogMode::kRobot, kMiddle);
  drive.Demand(Only(0, 200.0));
  drive.Advance(1.0);
  drive.Demand(Only(0, -200.0));
  drive.Advance(1.15);
  EXPECT_NEAR(drive.axes().column.x(), 1200.0, 1e-9);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 0.0, 1e-9);
  drive.Advance(1.30);
  EXPECT_NEAR(drive.axes().column.x(), 1185.0, 1e-9);
}

// LIVE-8.01: another speed acts at once, on the way to the end of the travel, too.
TEST(JogDrive, AnotherSpeedActsAtOnce) {
  JogDrive drive(Gantry(), JogMode::kRobot, kMiddle);
  drive.Demand(Only(0, 200.0));
  drive.Advance(1.0);
  drive.Demand(Only(0, 50.0));
  drive.Advance(1.125);  // 150 / 2000 + 0.05
  EXPECT_NEAR(drive.tip_speed_mm_s(), 50.0, 1e-9);
  EXPECT_NEAR(drive.axes().column.x(), 1185.0 + 125.0 * 0.125, 1e-9);
  drive.Demand(Only(0, 200.0));
  drive.Advance(1.25);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 200.0, 1e-9);
}

// A step of a mill: pressed and let go at once, it goes its way; stopped otherwise, it does not.
TEST(JogDrive, GoesItsLeastWay) {
  JogMachine mill{.head = MillHead()};
  mill.axes.speed = {60.0, 60.0, 30.0, 1.0, 0.0};
  mill.axes.acceleration = {200.0, 200.0, 200.0, 3.0, 0.0};
  mill.axes.jerk.setConstant(kNoLimit);
  mill.axes.travel_min = {0.0, 0.0, -60.0, -kNoLimit, 0.0};
  mill.axes.travel_max = {200.0, 150.0, 0.0, kNoLimit, 0.0};
  const AxisPose at{{10.0, 10.0, -10.0}, 0.0, 0.0};
  JogDrive drive(mill, JogMode::kRobot, at);
  AxisValues least;
  least.setConstant(0.01);
  for (int n = 1; n <= 3; ++n) {
    drive.Demand(Only(0, 1.0));
    drive.Demand({}, least);
    drive.Advance(n);
    EXPECT_NEAR(drive.axes().column.x(), 10.0 + 0.01 * n, 1e-12);
    EXPECT_TRUE(drive.rests());
  }
  drive.Demand(Only(3, 0.5));  // an axis without ends
  drive.Advance(1000.0);
  EXPECT_GT(drive.axes().a_rad, 490.0);
  drive.Brake();
  drive.Advance(1001.0);
  drive.Demand(Only(0, 1.0));
  drive.Brake();
  drive.Advance(1002.0);
  EXPECT_NEAR(drive.axes().column.x(), 10.03, 1e-12);
}

// LIVE-8.02: 10,000 random jogs, and no axis is ever out. How time is divided changes nothing.
TEST(JogDrive, RandomJogsStayInside) {
#ifdef RMLCELL_SANITIZED
  constexpr int kJogs = 1'500;  // the release build does them all
#else
  constexpr int kJogs = 10'000;
#endif
  std::mt19937 random(20261127);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const AxisLimits limits = StandardMachine().axes;
  constexpr double kBeyond = 0.0;
  for (int jog = 0; jog < kJogs; ++jog) {
    AxisPose at{{-600.0 + 4200.0 * share(), -600.0 + 3700.0 * share(), -1300.0 + 2400.0 * share()},
                -12.6 + 25.2 * share(),
                -2.4 + 4.8 * share()};
    // Many of them near an end.
    if (jog % 2 == 0) at.column.z() = 1100.0 - 40.0 * share();
    if (jog % 3 == 0) at.column.x() = -600.0 + 40.0 * share();
    if (jog % 5 == 0) at.b_rad = 2.4 - 0.2 * share();
    const std::array modes = {JogMode::kRobot, JogMode::kAbsolute, JogMode::kTool};
    JogDrive drive(Gantry(), modes[random() % 3], at);
    JogDrive other(Gantry(), drive.mode(), at);
    double t = 0.0;
    for (int act = 0; act < 4; ++act) {
      AxisValues speeds;
      const double step = kSteps[random() % kSteps.size()];
      for (int axis = 0; axis < kAxisCount; ++axis) {
        const int key = static_cast<int>(random() % 4) - 1;
        if (key < 2) speeds[axis] = key * step * (axis < 3 ? 500.0 : kTurn);
      }
      drive.Demand(speeds);
      other.Demand(speeds);
      const double until = t + (act == 3 ? 1.0 : 0.4 * share());
      for (int n = 1; n <= 25; ++n) {
        drive.Advance(n == 25 ? until : t + (until - t) * n / 25.0);
        const TravelExcess excess = WorstExcess(drive.axes(), limits);
        ASSERT_LE(excess.excess, kBeyond) << jog << " axis " << excess.axis;
      }
      other.Advance(until);
      ASSERT_EQ(Values(drive.axes()), Values(other.axes())) << jog;
      t = until;
    }
    drive.Brake();
    drive.Advance(t + 1.0);
    ASSERT_TRUE(drive.rests()) << jog;
    ASSERT_LE(WorstExcess(drive.axes(), limits).excess, kBeyond) << jog;
  }
}

// The same, and what is cut off at an end is rounding: no axis jumps, whatever its keys do.
TEST(JogDrive, NothingIsCutOffAtTheEnds) {
  std::mt19937 random(7);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (int jog = 0; jog < 300; ++jog) {
    const AxisPose at{{3500.0 + 99.0 * share(), 3000.0 + 99.0 * share(), 1000.0 + 99.0 * share()},
                      -12.0 + 24.0 * share(),
                      -2.0 + 4.0 * share()};
    const std::array modes = {JogMode::kRobot, JogMode::kAbsolute, JogMode::kTool};
    JogDrive drive(Gantry(), modes[static_cast<std::size_t>(jog % 3)], at);
    const auto ask = [&] {
      AxisValues speeds;
      for (int axis = 0; axis < 3; ++axis) speeds[axis] = 200.0 * (share() - 0.4);
      if (drive.mode() != JogMode::kTool) {
        for (int axis = 3; axis < 5; ++axis) speeds[axis] = 2.0 * (share() - 0.5);
      }
      drive.Demand(speeds);
    };
    constexpr double kStep = 1e-3;
    std::array<AxisValues, 3> last{Values(at), Values(at), Values(at)};
    for (int n = 1; n <= 1500; ++n) {
      if (n % 250 == 1) ask();
      drive.Advance(kStep * n);
      last = {last[1], last[2], Values(drive.axes())};
      const AxisValues push = (last[2] - 2.0 * last[1] + last[0]) / (kStep * kStep);
      // Three keys together ask each axis for that of three at most.
      ASSERT_LE(push.head<3>().cwiseAbs().maxCoeff(), 3.0 * 2000.0 * 1.01) << jog << " at " << n;
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion
