// A jog that is asked for something else just before an end, or that is slower than most; and what
// moves as one near the ends of a travel. LIVE-8.01, LIVE-8.02.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/motion/jog/jog_drive.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion::jog_bounds {
namespace {

JogMachine Gantry() { return {.head = GantryHead{}, .axes = StandardMachine().axes}; }
AxisValues Of(double x, double y, double z, double a, double b) { return {x, y, z, a, b}; }

// From 200 mm/s on the way to 50, in the middle of that: at 125 mm/s and -2000 mm/s2. To bring its
// acceleration to zero takes 0.05 s and 0.05 (125 - 2000 * 0.05 / 3) mm, and the ramp from the
// 75 mm/s that are left 3.248 mm: with more room than these 7.831 it speeds up again, with less it
// goes on braking.
TEST(JogBounds, WhatBrakesIsSpedUpWhereItCanStillStop) {
  const double need = 0.05 * (125.0 - 100.0 / 3.0) + 75.0 * std::sqrt(75.0 / 40000.0);
  for (const double sense : {1.0, -1.0}) {
    for (const double more : {0.3, -0.3}) {
      const double end = sense > 0.0 ? 3600.0 : -600.0;
      // 15 mm and 0.85 s at 200 mm/s; 9.167 mm, and 1.719 in the last 0.0125 s.
      const double gone = 185.0 + (10.0 - 0.005 / 6.0 * 1000.0) + (1.875 - 0.15625);
      JogDrive drive(Gantry(), JogMode::kRobot,
                     {{end - sense * (gone + need + more), 900.0, -300.0}, 0.0, 0.0});
      const AxisValues unit = Of(sense, 0.0, 0.0, 0.0, 0.0);
      drive.Demand(unit * 200.0);
      drive.Advance(1.0);
      drive.Demand(unit * 50.0);
      drive.Advance(1.0625);
      EXPECT_NEAR(drive.tip_speed_mm_s(), 125.0, 1e-6);
      drive.Demand(unit * 200.0);
      drive.Advance(1.1125);
      const double braked = 50.0 + 0.5 * 40000.0 * 0.0125 * 0.0125;
      EXPECT_NEAR(drive.tip_speed_mm_s(), more > 0.0 ? 75.0 : braked, 0.01) << more;
      drive.Advance(3.0);
      EXPECT_TRUE(drive.rests());
      EXPECT_NEAR(drive.axes().column.x(), end, 1e-9);
    }
  }
}

// Half a millimetre or radian a second is no rest: another speed acts from there.
TEST(JogBounds, ASlowAxisIsUnderWay) {
  for (const int axis : {0, 3}) {
    JogDrive drive(Gantry(), JogMode::kRobot, {{1000.0, 900.0, -300.0}, 0.0, 0.0});
    AxisValues speeds;
    speeds[axis] = 0.5;
    drive.Demand(speeds);
    drive.Advance(2.0);
    const auto place = [&] { return axis == 0 ? drive.axes().column.x() : drive.axes().a_rad; };
    const double before = place();
    speeds[axis] = 0.6;
    drive.Demand(speeds);
    drive.Advance(2.1);
    // 0.1 mm/s more within 2 sqrt(0.1 / j).
    const double jerk = axis == 0 ? 40000.0 : 400.0;
    EXPECT_NEAR(place() - before, 0.06 - 0.1 * std::sqrt(0.1 / jerk), 1e-9) << axis;
  }
}

// The other direction at exactly 1 mm/s: it brakes, and goes there.
TEST(JogBounds, TurnsBackAtOneMillimetreASecond) {
  JogDrive drive(Gantry(), JogMode::kRobot, {{1000.0, 900.0, -300.0}, 0.0, 0.0});
  drive.Demand(Of(0.0, -4.0, 0.0, 0.0, 0.0));
  drive.Advance(1.0);
  drive.Demand(Of(0.0, 1.0, 0.0, 0.0, 0.0));
  drive.Advance(2.0);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 1.0, 1e-9);
}

// With the tip held X goes with the turn of B, and by itself when that has come to rest. It does so
// while it slows down from 20 to 2 mm/s, at 18 mm/s and -400 mm/s2, 0.4 mm before its end: too near
// for that, so it brakes on, as short as it can: 20 sqrt(20 / j) from where it began to brake. Then
// it goes the rest. With A at 0 the turn of B does not move X.
TEST(JogBounds, WhatComesTooNearItsEndStopsAndGoesTheRest) {
  const double ramp_s = 2.0 * std::sqrt(20.0 / 40000.0);
  const double ramp_mm = 10.0 * ramp_s;
  const double a = 1000.0 / 300.0, j = 40000.0 / 300.0;
  const double turn = a * (ramp_s + 0.01 - a / j);  // takes that much longer to rest
  const double to_end = ramp_mm + (0.2 - 40000.0 * 1e-6 / 6.0) + 0.4;
  JogDrive drive(Gantry(), JogMode::kAbsolute, {{3600.0 - to_end, 900.0, -300.0}, 0.0, 0.5});
  drive.Demand(Of(0.0, 0.0, 0.0, 0.0, turn));
  drive.Advance(1.0);
  drive.Demand(Of(20.0, 0.0, 0.0, 0.0, 0.0));
  drive.Advance(1.0 + ramp_s);
  drive.Demand(Of(2.0, 0.0, 0.0, 0.0, 0.0));
  drive.Advance(1.0 + 1.5 * ramp_s);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 10.0, 1e-3);
  EXPECT_NEAR(drive.axes().column.x(), 3600.0 - to_end + ramp_mm + ramp_mm * 5.0 / 6.0, 1e-3);
  drive.Advance(1.0 + 2.0 * ramp_s);
  EXPECT_NEAR(drive.axes().column.x(), 3600.0 - to_end + 2.0 * ramp_mm, 1e-4);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 0.0, 1e-2);
  drive.Advance(3.0);
  EXPECT_TRUE(drive.rests());
  EXPECT_NEAR(drive.axes().column.x(), 3600.0, 1e-9);
}

// A travel need not have a 0 in it: along the tool it goes to the end that the first axis comes to.
TEST(JogBounds, TravelsAreWhereTheyAre) {
  const AxisPose at{{1000.0, 900.0, 700.0}, 0.4, 0.9};
  JogMachine machine = Gantry();
  machine.axes.travel_min = {700.0, 600.0, 400.0, 0.2, 0.3};
  machine.axes.travel_max = {1300.0, 1200.0, 1000.0, 1.6, 1.9};
  const Rotation along = ToolRotation(0.4, 0.9);
  for (int k = 0; k < 3; ++k) {
    for (const double sense : {1.0, -1.0}) {
      JogDrive drive(machine, JogMode::kTool, at);
      AxisValues speeds;
      speeds[k] = sense * 150.0;
      drive.Demand(speeds);
      drive.Advance(10.0);
      EXPECT_TRUE(drive.rests());
      const double room = 300.0 / along.col(k).cwiseAbs().maxCoeff();
      const MachinePoint end = at.column + MachineVector(along.col(k) * (sense * room));
      EXPECT_LT((drive.axes().column - end).norm(), 1e-6) << k;
    }
  }
}

// What is cut off at an end is rounding alone: of the held tip nothing is seen.
TEST(JogBounds, TheHeldTipStaysToTheLastDigits) {
  const JogMachine machine = Gantry();
  const AxisPose at{{1000.0, 900.0, 1050.0}, 0.3, 1.2};
  for (const double speed : {-0.8, -0.3, -0.05}) {
    JogDrive drive(machine, JogMode::kAbsolute, at);
    drive.Demand(Of(0.0, 0.0, 0.0, 0.0, speed));
    drive.Advance(20.0);
    EXPECT_TRUE(drive.rests());
    EXPECT_NEAR(drive.axes().column.z(), 1100.0, 1e-9);
    EXPECT_LT((machine.head.TipOf(drive.axes()).tip - machine.head.TipOf(at).tip).norm(), 2e-9);
  }
}

// Slowly and along one axis, where no other one makes it look sooner: 30 mm to the end of X, which
// is come to softly. Below 100 mm/s a ramp never has all of its acceleration.
TEST(JogBounds, SlowWaysAlongOneAxisEndSoftly) {
  for (const double speed : {20.0, 5.0, 1.0}) {
    JogDrive drive(Gantry(), JogMode::kTool, {{3600.0 - 1.5 * speed, 900.0, -300.0}, 0.0, 0.0});
    drive.Demand(Of(speed, 0.0, 0.0, 0.0, 0.0));
    double before = drive.axes().column.x(), way = 0.0, hardest = 0.0;
    for (int n = 1; n <= 2500; ++n) {
      drive.Advance(1e-3 * n);
      const double x = drive.axes().column.x();
      hardest = std::max(hardest, std::abs(x - before - way) / 1e-6);
      way = x - before;
      before = x;
    }
    EXPECT_TRUE(drive.rests());
    EXPECT_NEAR(before, 3600.0, 1e-7);
    EXPECT_LE(hardest, std::sqrt(speed * 40000.0) * 1.001) << speed;
  }
}

// With 2 mm/s2, and no limit on jerk, 1 mm/s takes half a second and 0.25 mm to rest: so far before
// the end it brakes, though it was asked for again on the way. LIVE-8.02
TEST(JogBounds, WhatBrakesGentlyBrakesInTime) {
  JogMachine machine = Gantry();
  machine.axes.jerk.setConstant(kNoLimit);
  machine.tip_acceleration_mm_s2 = 2.0;
  machine.tip_jerk_mm_s3 = kNoLimit;
  JogDrive drive(machine, JogMode::kTool, {{3597.0, 900.0, -300.0}, 0.0, 0.0});
  drive.Demand(Of(1.0, 0.0, 0.0, 0.0, 0.0));
  drive.Advance(1.0);
  drive.Demand(Of(1.0, 0.0, 0.0, 0.0, 0.0));
  drive.Advance(3.25);  // 2.75 mm at 3 s
  EXPECT_NEAR(drive.tip_speed_mm_s(), 0.5, 1e-6);
  drive.Advance(4.0);
  EXPECT_TRUE(drive.rests());
  EXPECT_NEAR(drive.axes().column.x(), 3600.0, 1e-6);
}

// Along a tool that turns on meanwhile, X, Y and Z come to the end itself.
TEST(JogBounds, AlongAToolThatTurnsOnItComesToTheEnd) {
  for (const int turned : {3, 4}) {
    for (const double sense : {1.0, -1.0}) {
      JogDrive drive(Gantry(), JogMode::kTool, {{1000.0, 900.0, 1080.0}, 0.4, 0.9});
      AxisValues speeds = Of(0.0, 0.0, 100.0, 0.0, 0.0);
      speeds[turned] = sense * 0.2;
      drive.Demand(speeds);
      drive.Advance(2.0);
      EXPECT_FALSE(drive.rests());
      EXPECT_NEAR(drive.axes().column.z(), 1100.0, 1e-6) << turned << " " << sense;
    }
  }
}

// To brake is to ask for nothing, along a tool that turns, too, at whatever time.
TEST(JogBounds, ToBrakeIsToAskForNothing) {
  for (const double t : {0.0131, 0.0405, 0.2718}) {
    JogDrive braked(Gantry(), JogMode::kTool, {{1000.0, 900.0, -300.0}, 0.4, 0.9});
    JogDrive asked = braked;
    for (JogDrive* drive : {&braked, &asked}) {
      drive->Demand(Of(60.0, -80.0, 100.0, 1.1, -1.4));
      drive->Advance(t);
    }
    const MachinePoint before = braked.axes().column;
    braked.Brake();
    EXPECT_LT((braked.axes().column - before).norm(), 1e-12);
    asked.Demand({});
    for (const double later : {0.003, 0.05, 1.0}) {
      braked.Advance(t + later);
      asked.Advance(t + later);
      EXPECT_LT((braked.axes().column - asked.axes().column).norm(), 1e-12) << t << " " << later;
      EXPECT_EQ(braked.axes().a_rad, asked.axes().a_rad);
      EXPECT_EQ(braked.axes().b_rad, asked.axes().b_rad);
    }
  }
}

// What comes back while it stops, because a slow turn of A takes back what X or Y still goes, is
// not stopped much sooner than it must: at its farthest it is 1.5 mm from the end at most.
TEST(JogBounds, WhatTurnsBackComesNearTheEnd) {
  for (const double sense : {1.0, -1.0}) {
    for (const int axis : {0, 1}) {
      JogMachine machine = Gantry();
      machine.axes.acceleration[3] = 0.2;
      machine.axes.travel_min[3] = -kNoLimit;
      machine.axes.travel_max[3] = kNoLimit;
      machine.axes.travel_max[axis] = 1000.0;
      machine.axes.travel_min[axis] = -1000.0;
      AxisPose at{{0.0, 0.0, 0.0}, axis == 0 ? 0.0 : kPi / 2.0, kPi / 2.0};
      at.column[axis] = sense * 930.0;
      JogDrive drive(machine, JogMode::kAbsolute, at);
      AxisValues speeds;
      speeds[axis] = sense * 100.0;
      speeds[3] = -sense * 0.16;
      drive.Demand(speeds);
      double farthest = 0.0;
      for (int n = 1; n <= 12000; ++n) {
        drive.Advance(1e-3 * n);
        farthest = std::max(farthest, sense * drive.axes().column[axis]);
      }
      EXPECT_TRUE(drive.rests());
      EXPECT_LT(farthest, 1000.0);
      EXPECT_GT(farthest, 998.5);
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion::jog_bounds
