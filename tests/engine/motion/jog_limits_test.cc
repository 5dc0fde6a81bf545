// What lowers the speeds of a jog, with machines in which one limit binds and
// no other; and what a jog does when it is asked for something else on its last
// millimetres. LIVE-8.01, LIVE-8.02.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/motion/jog/jog_drive.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion::jog_limits {
namespace {

const AxisPose kAslant{{1000.0, 900.0, -300.0}, 0.4, 0.9};
constexpr double kReach = 300.0;
const double kAside = kReach * std::sin(0.9);  // what A turns the column about, with the tip held

// Trapezoids: a ramp from v takes v / a. With the tip held A has 1.2 rad/s2 and
// B 500 / 300.
JogMachine Trapezoids() {
  JogMachine machine{.head = GantryHead{.length_mm = kReach}, .axes = StandardMachine().axes};
  machine.axes.acceleration = {1000.0, 1600.0, 1250.0, 1.2, 20.0};
  machine.axes.jerk.setConstant(kNoLimit);
  machine.tip_jerk_mm_s3 = kNoLimit;
  return machine;
}
const AxisValues kAccelerations{1000.0, 1600.0, 1250.0, 1.2, 500.0 / 300.0};

AxisValues Of(double x, double y, double z, double a, double b) { return {x, y, z, a, b}; }

// The speed that a channel is moved at in the end, by the way in which it would
// stop.
double SpeedOf(const JogDrive& drive, int channel) {
  return std::sqrt(2.0 * kAccelerations[channel] * drive.RunsOn(channel));
}

AxisValues KeyOf(int axis, double speed) {
  AxisValues keys;
  keys.setConstant(kNoLimit);
  keys[axis] = speed;
  return keys;
}

// With the tip held X, Y and Z are moved by their own key and by B at the reach
// of the head; X and Y by A, too: at that reach while B turns with it, and else
// at the radius at which the column stands aside. All together are no faster
// than the key alone. LIVE-8.01
TEST(JogLimits, AHeldTipMovesNoAxisFasterThanItsKey) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double b : {0.0, 0.05}) {
      for (const double sense : {1.0, -1.0}) {
        JogDrive drive(Trapezoids(), JogMode::kAbsolute, kAslant);
        drive.KeepTo(KeyOf(axis, 100.0));
        AxisValues speeds = Of(0, 0, 0, -sense * 0.05, sense * b);
        speeds[axis] = sense * 95.0;
        drive.Demand(speeds);
        const double radius = b > 0.0 ? kReach : kAside;
        const double all = 95.0 + (axis < 2 ? 0.05 * radius : 0.0) + b * kReach;
        const double share = std::min(1.0, 100.0 / all);
        EXPECT_NEAR(SpeedOf(drive, axis), 95.0 * share, 1e-6) << axis;
        EXPECT_NEAR(SpeedOf(drive, 3), 0.05 * share, 1e-8) << axis;
        EXPECT_NEAR(SpeedOf(drive, 4), b * share, 1e-8) << axis;
      }
    }
  }
}

// A turn stops in no more time than any axis would by its own key, Z with A,
// too.
TEST(JogLimits, AHeldTipStopsAsSoonAsItsKey) {
  for (int axis = 0; axis < 3; ++axis) {
    const double stop_s = 60.0 / kAccelerations[axis];
    for (const double sense : {1.0, -1.0}) {
      for (int turned = 3; turned < 5; ++turned) {
        JogDrive drive(Trapezoids(), JogMode::kAbsolute, kAslant);
        drive.KeepTo(KeyOf(axis, 60.0));
        AxisValues speeds = Of(0, 0, 0, 0.01, 0.01);  // the other one is slow, and stops sooner
        speeds[turned] = sense * 0.3;
        drive.Demand(speeds);
        EXPECT_NEAR(SpeedOf(drive, turned), kAccelerations[turned] * stop_s, 1e-8) << axis;
      }
    }
  }
}

// What its key allows is not lowered at all; nor does a key count where no turn
// is asked for.
TEST(JogLimits, WhatIsWithinTheKeysStays) {
  JogDrive drive(Trapezoids(), JogMode::kAbsolute, kAslant);
  drive.KeepTo(Of(100.0, 110.0, 120.0, 1.0, 1.0));
  drive.Demand(Of(80.0, -85.0, 90.0, 0.02, -0.03));
  EXPECT_NEAR(SpeedOf(drive, 0), 80.0, 1e-9);
  EXPECT_NEAR(SpeedOf(drive, 1), 85.0, 1e-9);
  EXPECT_NEAR(SpeedOf(drive, 2), 90.0, 1e-9);
  EXPECT_NEAR(SpeedOf(drive, 3), 0.02, 1e-12);
  EXPECT_NEAR(SpeedOf(drive, 4), 0.03, 1e-12);
  JogDrive steady(Trapezoids(), JogMode::kAbsolute, kAslant);
  steady.KeepTo(Of(100.0, 110.0, 120.0, 1.0, 1.0));
  steady.Demand(Of(100.0, -200.0, 120.0, 0.0, 0.0));
  EXPECT_NEAR(SpeedOf(steady, 0), 100.0, 1e-9);
  EXPECT_NEAR(SpeedOf(steady, 1), 110.0, 1e-9);
  EXPECT_NEAR(SpeedOf(steady, 2), 120.0, 1e-9);
}

// Keys are no reason to be faster than the axis can.
TEST(JogLimits, AKeyFasterThanItsAxisIsAsFastAsThat) {
  JogDrive drive(Trapezoids(), JogMode::kRobot, kAslant);
  drive.KeepTo(Of(700.0, 400.0, 900.0, 100.0, 1.0));
  drive.Demand(Of(-650.0, 650.0, 650.0, 0.0, 0.0));
  EXPECT_NEAR(SpeedOf(drive, 0), 500.0, 1e-9);
  EXPECT_NEAR(SpeedOf(drive, 1), 400.0, 1e-9);
  EXPECT_NEAR(SpeedOf(drive, 2), 500.0, 1e-9);
}

// What keeps the column on its circle about the held tip: a^2 r by A, b^2 L by
// B, and 2 a b L by both, of half of what each axis has. What still turns
// counts as what is asked for.
TEST(JogLimits, AHeldTipLeavesHalfOfEachAxisToTheCircle) {
  JogMachine machine = Trapezoids();
  machine.axes.speed.head<3>().setConstant(5000.0);
  for (int axis = 0; axis < 3; ++axis) {
    machine.axes.acceleration = {4e4, 4e4, 4e4, 1.2, 500.0 / 300.0};
    machine.axes.acceleration[axis] = 600.0;
    JogDrive drive(machine, JogMode::kAbsolute, kAslant);
    drive.Demand(Of(0.0, 0.0, 0.0, 2.0, -1.5));
    const double inward = 4.0 * kReach + 2.0 * 2.0 * 1.5 * kReach + 1.5 * 1.5 * kReach;
    const double share = std::sqrt(300.0 / inward);
    const double b_rad_s2 = 300.0 / kReach;  // half of what the weakest axis has
    EXPECT_NEAR(std::sqrt(2.0 * b_rad_s2 * drive.RunsOn(4)), 1.5 * share, 1e-9) << axis;
    EXPECT_NEAR(std::sqrt(2.0 * b_rad_s2 * drive.RunsOn(3)), 2.0 * share, 1e-9) << axis;
  }
}

TEST(JogLimits, WhatStillTurnsCountsWithTheTipHeld) {
  JogMachine machine = Trapezoids();
  machine.axes.speed[0] = 200.0;
  for (const int turned : {3, 4}) {
    for (const double sense : {1.0, -1.0}) {
      JogDrive drive(machine, JogMode::kAbsolute, kAslant);
      AxisValues turn;
      turn[turned] = sense * 0.5;
      drive.Demand(turn);
      drive.Advance(0.6);  // at its speed, some of the way
      const double radius =
          turned == 4
              ? kReach
              : std::hypot(drive.axes().column.x() - machine.head.TipOf(drive.axes()).tip.x(),
                           drive.axes().column.y() - machine.head.TipOf(drive.axes()).tip.y());
      drive.Demand(Of(-sense * 150.0, 0.0, 0.0, 0.0, 0.0));
      EXPECT_NEAR(SpeedOf(drive, 0), 150.0 * 200.0 / (150.0 + 0.5 * radius), 1e-6) << turned;
    }
  }
}

// A turn of A does not move Z: it is as fast as it can be.
TEST(JogLimits, ATurnOfALeavesZItsSpeed) {
  JogMachine machine = Trapezoids();
  machine.axes.speed[2] = 20.0;
  JogDrive drive(machine, JogMode::kAbsolute, kAslant);
  drive.Demand(Of(0.0, 0.0, -30.0, 0.05, 0.0));
  EXPECT_NEAR(SpeedOf(drive, 2), 20.0, 1e-9);
  EXPECT_NEAR(SpeedOf(drive, 3), 0.05, 1e-12);
}

// An axis whose key stands, and which is not asked for, keeps nobody back: X goes while a turn that
// was let go comes to rest.
TEST(JogLimits, AKeyThatStandsBoundsItsOwnAxisAlone) {
  JogDrive drive(Trapezoids(), JogMode::kAbsolute, kAslant);
  drive.Demand(Of(0.0, 0.0, 0.0, 0.5, 0.0));
  drive.Advance(0.6);
  drive.KeepTo(Of(100.0, 100.0, 0.0, 1.0, 1.0));
  drive.Demand(Of(60.0, 0.0, 0.0, 0.0, 0.0));
  EXPECT_NEAR(SpeedOf(drive, 0), 60.0, 1e-9);
}

// Along the tool A and B are no faster than they can be, either.
TEST(JogLimits, AlongTheToolTheHeadTurnsAsFastAsItCan) {
  const JogMachine machine = Trapezoids();
  for (const int axis : {3, 4}) {
    JogDrive drive(machine, JogMode::kTool, kAslant);
    AxisValues speeds;
    speeds[axis] = -10.0;
    drive.Demand(speeds);
    const double speed = std::sqrt(2.0 * machine.axes.acceleration[axis] * drive.RunsOn(axis));
    EXPECT_NEAR(speed, machine.axes.speed[axis], 1e-9) << axis;
  }
}

// Along the tool: while nothing turns each axis has its part of each direction,
// R(A, B).
TEST(JogLimits, AlongTheToolEachAxisHasItsPart) {
  for (int axis = 0; axis < 3; ++axis) {
    JogMachine machine = Trapezoids();
    machine.tip_acceleration_mm_s2 = 1000.0;
    machine.axes.speed[axis] = 20.0;
    JogDrive drive(machine, JogMode::kTool, kAslant);
    drive.Demand(Of(100.0, -60.0, 80.0, 0.0, 0.0));
    const Rotation along = ToolRotation(0.4, 0.9);
    const double asked = 100.0 * std::abs(along(axis, 0)) + 60.0 * std::abs(along(axis, 1)) +
                         80.0 * std::abs(along(axis, 2));
    for (int k = 0; k < 3; ++k) {
      const double full = k == 0 ? 100.0 : k == 1 ? 60.0 : 80.0;
      EXPECT_NEAR(std::sqrt(2.0 * 1000.0 * drive.RunsOn(k)), full * 20.0 / asked, 1e-6) << axis;
    }
  }
}

// While the tool turns, half of what an axis has: speed along times speed of
// turning.
TEST(JogLimits, AToolThatTurnsTakesHalfOfAnAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    JogMachine machine = Trapezoids();
    machine.axes.acceleration[axis] = 100.0;
    JogDrive drive(machine, JogMode::kTool, kAslant);
    drive.Demand(Of(100.0, -60.0, 80.0, 0.3, -0.4));
    const double share = 50.0 / (240.0 * 0.7);
    EXPECT_NEAR(std::sqrt(2.0 * 100.0 * drive.RunsOn(0)), 100.0 * share, 1e-6) << axis;
    EXPECT_NEAR(std::sqrt(2.0 * 100.0 * drive.RunsOn(2)), 80.0 * share, 1e-6) << axis;
    EXPECT_NEAR(SpeedOf(drive, 3), 0.3, 1e-9);  // the turning is not lowered
  }
}

// How far X, Y and Z run on with it, of a head with its tool aside.
TEST(JogLimits, RunsOnAboutTheTipOfAToolThatStandsAside) {
  JogMachine machine = Trapezoids();
  machine.head = GantryHead{.length_mm = 280.0, .tool = {30.0, -40.0, 20.0}};
  JogDrive drive(machine, JogMode::kAbsolute, kAslant);
  drive.Demand(Of(0.0, 0.0, 0.0, 0.02, 0.03));
  const MachineVector aside = kAslant.column - machine.head.TipOf(kAslant).tip;
  EXPECT_NEAR(drive.LinearRunsOn(3), 0.02 * 0.02 / 2.4 * std::hypot(aside.x(), aside.y()), 1e-9);
  EXPECT_NEAR(drive.LinearRunsOn(4), drive.RunsOn(4) * std::sqrt(900.0 + 1600.0 + 260.0 * 260.0),
              1e-9);
}

// The speed of the tip is that of the tip, whatever moves it.
TEST(JogLimits, TheSpeedOfTheTipIsHowFastItMoves) {
  JogMachine machine{.head = GantryHead{.length_mm = 280.0, .tool = {30.0, -40.0, 20.0}},
                     .axes = StandardMachine().axes};
  for (const JogMode mode : {JogMode::kRobot, JogMode::kAbsolute, JogMode::kTool}) {
    JogDrive drive(machine, mode, kAslant);
    drive.Demand(Of(50.0, -70.0, 30.0, 0.3, -0.4));
    for (const double t : {0.04, 0.6}) {
      constexpr double kBeside_s = 1e-5;
      drive.Advance(t - kBeside_s);
      const MachinePoint before = machine.head.TipOf(drive.axes()).tip;
      drive.Advance(t);
      const double speed = drive.tip_speed_mm_s();
      drive.Advance(t + kBeside_s);
      const MachinePoint behind = machine.head.TipOf(drive.axes()).tip;
      EXPECT_NEAR(speed, (behind - before).norm() / (2.0 * kBeside_s), 1e-3);
      EXPECT_GT(speed, 10.0);
    }
  }
}

// 200 mm/s, and then 50, near the end of X: 15.6 mm for the change, and 1.8 to
// stand. Asked again half way, 10.9 mm on, when it could not bring its
// acceleration to zero first and still stop: it goes on as it is, to the end.
TEST(JogLimits, WhatComesToItsEndGoesOnWithThat) {
  const JogMachine machine{.head = GantryHead{}, .axes = StandardMachine().axes};
  for (const double sense : {1.0, -1.0}) {
    for (const double again : {50.0, 200.0}) {
      const double end = sense > 0.0 ? 3600.0 : -600.0;
      const AxisPose at{{end - sense * (185.0 + 18.0), 900.0, -300.0}, 0.0, 0.0};
      JogDrive drive(machine, JogMode::kRobot, at);
      const AxisValues unit = Of(sense, 0.0, 0.0, 0.0, 0.0);
      drive.Demand(unit * 200.0);
      drive.Advance(1.0);  // 15 mm, and 0.85 s
      drive.Demand(unit * 50.0);
      drive.Advance(1.0625);
      drive.Demand(unit * again);
      drive.Advance(1.1251);
      EXPECT_NEAR(drive.tip_speed_mm_s(), 50.0, 0.5);
      drive.Advance(2.0);
      EXPECT_TRUE(drive.rests());
      EXPECT_NEAR(drive.axes().column.x(), end, 1e-9);
    }
  }
}

// With 7 mm more it can, and goes at 200 mm/s again as far as there is room.
TEST(JogLimits, WhatCanStillStopIsSpedUpAgain) {
  const JogMachine machine{.head = GantryHead{}, .axes = StandardMachine().axes};
  const AxisPose at{{3600.0 - 185.0 - 25.0, 900.0, -300.0}, 0.0, 0.0};
  JogDrive again(machine, JogMode::kRobot, at);
  JogDrive slow(machine, JogMode::kRobot, at);
  for (JogDrive* drive : {&again, &slow}) {
    drive->Demand(Of(200.0, 0.0, 0.0, 0.0, 0.0));
    drive->Advance(1.0);
    drive->Demand(Of(50.0, 0.0, 0.0, 0.0, 0.0));
    drive->Advance(1.0625);
  }
  again.Demand(Of(200.0, 0.0, 0.0, 0.0, 0.0));
  again.Advance(1.125);
  slow.Advance(1.125);
  EXPECT_GT(again.tip_speed_mm_s(), slow.tip_speed_mm_s() + 10.0);
  again.Advance(2.0);
  slow.Advance(2.0);
  EXPECT_NEAR(again.axes().column.x(), 3600.0, 1e-9);
  EXPECT_NEAR(slow.axes().column.x(), 3600.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::motion::jog_limits
