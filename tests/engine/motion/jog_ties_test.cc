// A jog at the very instant at which it comes to rest, with exactly as much way as it needs, and of
// two ways as one of which the first is over sooner. LIVE-8.01, LIVE-8.02
#include <gtest/gtest.h>

#include <cmath>

#include "engine/motion/jog/jog_drive.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion::jog_ties {
namespace {

JogMachine Gantry() { return {.head = GantryHead{}, .axes = StandardMachine().axes}; }
AxisValues Of(double x, double y, double z, double a, double b) { return {x, y, z, a, b}; }

// Along the tool X and Y stop as one, X in less time: the one that is over first comes to its end,
// and not to a place before it as what turns back would.
TEST(JogTies, WhatIsOverFirstStandsOnItsEnd) {
  for (const double sense : {1.0, -1.0}) {
    const double end = sense > 0.0 ? 3600.0 : -600.0;
    JogDrive drive(Gantry(), JogMode::kTool, {{end - sense * 12.0, 900.0, -300.0}, 0.0, 0.0});
    drive.Demand(Of(sense * 20.0, 200.0, 0.0, 0.0, 0.0));
    drive.Advance(3.0);
    EXPECT_TRUE(drive.rests());
    EXPECT_NEAR(drive.axes().column.x(), end, 1e-6);
  }
}

// Trapezoids of 64 mm/s and 128 mm/s2: asked back after 1 s it stands at 1.5 s and goes back at
// once. Who looks at that very instant sees it under way.
TEST(JogTies, WhatIsAskedBackDoesNotRest) {
  JogMachine machine = Gantry();
  machine.axes.acceleration.setConstant(128.0);
  machine.axes.jerk.setConstant(kNoLimit);
  JogDrive drive(machine, JogMode::kRobot, {{1000.0, 900.0, -300.0}, 0.0, 0.0});
  drive.Demand(Of(0.0, 64.0, 0.0, 0.0, 0.0));
  drive.Advance(1.0);
  drive.Demand(Of(0.0, -64.0, 0.0, 0.0, 0.0));
  drive.Advance(1.5);
  EXPECT_FALSE(drive.rests());
  EXPECT_NEAR(drive.tip_speed_mm_s(), 0.0, 1e-9);
  EXPECT_NEAR(drive.axes().column.y(), 900.0 + 64.0, 1e-9);
  drive.Advance(2.0);
  EXPECT_NEAR(drive.tip_speed_mm_s(), 64.0, 1e-9);
}

// X is asked back and is at rest after 0.07 s, while Y still speeds up, for 0.15 s: each axis is by
// itself, and Y goes on with its ramp.
TEST(JogTies, WhatTurnsBackDoesNotDelayAnother) {
  JogDrive drive(Gantry(), JogMode::kRobot, {{1000.0, 900.0, -300.0}, 0.0, 0.0});
  drive.Demand(Of(50.0, 0.0, 0.0, 0.0, 0.0));
  drive.Advance(1.0);
  drive.Demand(Of(-50.0, 200.0, 0.0, 0.0, 0.0));
  drive.Advance(1.15);
  EXPECT_NEAR(drive.axes().column.y(), 915.0, 1e-9);
  EXPECT_NEAR(drive.tip_speed_mm_s(), std::hypot(50.0, 200.0), 1e-6);
}

// 192 mm/s2 and 192 mm/s3, from 768 to 192 mm/s: after 1 s of braking 672 mm/s are left, and to end
// the braking takes 1 s, 608 mm and 96 mm/s more; from there to rest 4 s and 1152 mm. With exactly
// these 1760 mm it is sped up again, with a millimetre less it goes on braking.
TEST(JogTies, ExactlyEnoughWayIsEnough) {
  JogMachine machine = Gantry();
  machine.axes.speed.setConstant(4096.0);
  machine.axes.acceleration.setConstant(192.0);
  machine.axes.jerk.setConstant(192.0);
  machine.axes.travel_min.setConstant(-65536.0);
  machine.axes.travel_max.setConstant(65536.0);
  for (const double less : {0.0, 1.0}) {
    // 5 s and 1920 mm to 768 mm/s, 1 s there, 736 mm in the first second of braking.
    const double gone = 1920.0 + 768.0 + 736.0;
    const double from = 65536.0 - gone - 1760.0 + less;
    JogDrive drive(machine, JogMode::kRobot, {{from, 0.0, 0.0}, 0.0, 0.0});
    drive.Demand(Of(768.0, 0.0, 0.0, 0.0, 0.0));
    drive.Advance(6.0);
    ASSERT_EQ(drive.axes().column.x(), from + 2688.0);
    drive.Demand(Of(192.0, 0.0, 0.0, 0.0, 0.0));
    drive.Advance(7.0);
    ASSERT_EQ(drive.axes().column.x(), from + gone);
    ASSERT_EQ(drive.tip_speed_mm_s(), 672.0);
    drive.Demand(Of(4000.0, 0.0, 0.0, 0.0, 0.0));
    drive.Advance(8.0);
    EXPECT_NEAR(drive.tip_speed_mm_s(), less == 0.0 ? 576.0 : 480.0, 1e-9);
    drive.Advance(30.0);
    EXPECT_TRUE(drive.rests());
    EXPECT_NEAR(drive.axes().column.x(), 65536.0, 1e-6);
  }
}

// What is asked back brakes at once, however little way it has gone: A at 0.5 rad/s, 0.18 rad after
// it began, is at rest after one ramp, and after a second one as fast the other way.
TEST(JogTies, WhatIsAskedBackBrakesAtOnce) {
  JogDrive drive(Gantry(), JogMode::kRobot, {{1000.0, 900.0, -300.0}, 0.0, 0.0});
  drive.Demand(Of(0.0, 0.0, 0.0, 0.5, 0.0));
  drive.Advance(0.4);
  const double ramp_s = 2.0 * std::sqrt(0.5 / 400.0);
  const double there = drive.axes().a_rad;
  ASSERT_NEAR(there, 0.5 * (0.4 - 0.5 * ramp_s), 1e-9);
  drive.Demand(Of(0.0, 0.0, 0.0, -0.5, 0.0));
  drive.Advance(1.4);
  EXPECT_NEAR(drive.axes().a_rad, there - 0.5 * (1.0 - 2.0 * ramp_s), 1e-9);
}

}  // namespace
}  // namespace rmlcell::motion::jog_ties
