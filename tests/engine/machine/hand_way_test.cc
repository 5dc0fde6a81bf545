// What a key sends a machine to, and how far its axes run on: of machines by hand, without a run.
#include <gtest/gtest.h>

#include <limits>

#include "engine/machine/hand_jog.h"
#include "engine/machine/hand_travel.h"
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

// X, Y and Z with 20, 40 and 10 mm/s and 100, 50 and 200 mm/s2, without a limit on jerk.
HandMotion AxisMill() {
  HandMotion how;
  how.machine.head = motion::MillHead();
  how.machine.axes.speed = {20.0, 40.0, 10.0, 0.0, 0.0};
  how.machine.axes.acceleration = {100.0, 50.0, 200.0, 0.0, 0.0};
  how.machine.axes.jerk.setConstant(std::numeric_limits<double>::infinity());
  how.plus = how.minus = how.machine.axes.speed;
  return how;
}

motion::AxisPose ColumnAt(double x, double y, double z) { return {{x, y, z}, 0.0, 0.0}; }

// Along X: up to 20 mm/s within 0.2 s and 2 mm, the same down, 10 mm between in 0.5 s. It stands at
// the very instant at which it comes to its end.
TEST(HandTravel, GoesAsFastAsItsAxes) {
  HandTravel travel({ColumnAt(14, 0, 0)}, AxisMill(), ColumnAt(0, 0, 0), At(5.0));
  EXPECT_FALSE(travel.rests());
  EXPECT_EQ(travel.tip_speed_mm_s(), 0.0);
  travel.Advance(At(5.2));
  EXPECT_NEAR(travel.axes().column.x(), 2.0, 1e-9);
  EXPECT_NEAR(travel.tip_speed_mm_s(), 20.0, 1e-9);
  travel.Advance(At(5.9) - SimTime(1));
  EXPECT_FALSE(travel.rests());
  travel.Advance(At(5.9));
  EXPECT_TRUE(travel.rests());
  EXPECT_EQ(travel.axes(), ColumnAt(14, 0, 0));
  EXPECT_EQ(travel.tip_speed_mm_s(), 0.0);
  EXPECT_FALSE(travel.brakes());
}

// Three, four and no mm: X takes 0.6 of the speed and of the acceleration, Y 0.8. The slower axis
// of each sets 20/0.6 mm/s and 50/0.8 mm/s2, Z, which stands, nothing.
TEST(HandTravel, AslantNoAxisIsTooSlow) {
  HandTravel travel({ColumnAt(60, 80, 0)}, AxisMill(), ColumnAt(0, 0, 0), At(0.0));
  const double speed = 20.0 / 0.6, ramp_s = speed / 62.5;
  travel.Advance(At(1.0));
  EXPECT_NEAR(travel.tip_speed_mm_s(), speed, 1e-9);
  EXPECT_NEAR(travel.axes().column.y(), 0.8 * speed * (1.0 - 0.5 * ramp_s), 1e-9);
  travel.Advance(At(100.0 / speed + ramp_s) + SimTime(1));
  EXPECT_TRUE(travel.rests());
  EXPECT_EQ(travel.axes(), ColumnAt(60, 80, 0));
}

// One place after the other, at rest at each; one where it stands already is none.
TEST(HandTravel, GoesFromPlaceToPlace) {
  HandTravel travel({ColumnAt(0, 0, 0), ColumnAt(0, 0, 1), ColumnAt(0, 0, 1), ColumnAt(14, 0, 1)},
                    AxisMill(), ColumnAt(0, 0, 0), At(0.0));
  const double up_s = 1.0 / 10.0 + 10.0 / 200.0;
  travel.Advance(At(up_s));
  EXPECT_FALSE(travel.rests());
  EXPECT_EQ(travel.axes(), ColumnAt(0, 0, 1));
  EXPECT_EQ(travel.tip_speed_mm_s(), 0.0);
  travel.Advance(At(up_s + 0.45));
  EXPECT_NEAR(travel.axes().column.x(), 7.0, 1e-9);
  travel.Advance(At(up_s + 0.9));
  EXPECT_TRUE(travel.rests());
  EXPECT_EQ(travel.axes(), ColumnAt(14, 0, 1));
  const HandTravel none({ColumnAt(1, 2, 3)}, AxisMill(), ColumnAt(1, 2, 3), At(0.0));
  EXPECT_TRUE(none.rests());
  EXPECT_EQ(none.axes(), ColumnAt(1, 2, 3));
}

// Braking takes 2 mm and 0.2 s from the full speed; the places behind are gone to no more, and it
// brakes once.
TEST(HandTravel, BrakesOnItsWay) {
  HandTravel travel({ColumnAt(14, 0, 0), ColumnAt(14, 50, 0)}, AxisMill(), ColumnAt(0, 0, 0),
                    At(0.0));
  travel.Advance(At(0.3));  // at 4 mm
  travel.Brake();
  EXPECT_TRUE(travel.brakes());
  EXPECT_FALSE(travel.rests());
  travel.Advance(At(0.4));
  EXPECT_NEAR(travel.axes().column.x(), 5.5, 1e-9);
  EXPECT_NEAR(travel.tip_speed_mm_s(), 10.0, 1e-9);
  travel.Brake();
  travel.Advance(At(0.5));
  EXPECT_TRUE(travel.rests());
  EXPECT_NEAR(travel.axes().column.x(), 6.0, 1e-9);
  EXPECT_EQ(travel.axes().column.y(), 0.0);
}

// Before it has begun to move there is nothing to brake, and behind its end neither.
TEST(HandTravel, BrakesWhereItStands) {
  HandTravel begun({ColumnAt(14, 0, 0)}, AxisMill(), ColumnAt(0, 0, 0), At(0.0));
  begun.Brake();
  EXPECT_TRUE(begun.rests());
  EXPECT_EQ(begun.axes(), ColumnAt(0, 0, 0));
  HandTravel over({ColumnAt(14, 0, 0)}, AxisMill(), ColumnAt(0, 0, 0), At(0.0));
  over.Advance(At(1.0));
  over.Brake();
  EXPECT_FALSE(over.brakes());
  EXPECT_EQ(over.axes(), ColumnAt(14, 0, 0));
}

// LIVE-8.01: the axis that runs on farthest, of those that move and of those that turn: v * v / 2a
// of the faster key.
TEST(RunOnOf, IsThatOfTheFarthestAxis) {
  constexpr auto kRobot = JogReference::kRobot;
  HandMotion how = AxisMill();
  how.machine.axes.speed[3] = 2.0;
  how.machine.axes.speed[4] = 1.0;
  how.machine.axes.acceleration[3] = how.machine.axes.acceleration[4] = 4.0;
  how.plus = how.minus = how.machine.axes.speed;
  const RunOn all = RunOnOf(how, kRobot, ColumnAt(0, 0, 0));
  EXPECT_NEAR(all.mm, 40.0 * 40.0 / (2.0 * 50.0), 1e-9);
  EXPECT_NEAR(all.rad, 2.0 * 2.0 / (2.0 * 4.0), 1e-9);
  how.plus[1] = how.minus[1] = 10.0;  // 1 mm: now X, by 20 * 20 / 200
  how.plus[3] = how.minus[3] = 0.1;   // now B
  how.minus[0] = 5.0;
  const RunOn others = RunOnOf(how, kRobot, ColumnAt(0, 0, 0));
  EXPECT_NEAR(others.mm, 2.0, 1e-9);
  EXPECT_NEAR(others.rad, 1.0 / 8.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::machine
