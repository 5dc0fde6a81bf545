// Chapter 2 and B.2, B.3: what MOVE does on the virtual machine.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/conformance/optimo_machine.h"

namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;

const std::string kStart = kAbsolSlowly + "MOVE (1000.,1000.,-400.,0.,0.)\n";

// OPT-2.05, OPT-2.02
TEST(OptimoRunMotion, TheTipComesToTheTarget) {
  const Ran ran = OptimoMachine().Run(
      "COORD ABSOL\nMOVE (1200, 170.5, -118.3, 0.5, 0.12)\n"
      "MOVE (1200, 170.5, -118.3, 0.5, 0.12)\n");
  const motion::TipPose tip = ran.run().state().tip;
  EXPECT_NEAR(tip.tip.x(), 1200.0, 1e-3);
  EXPECT_NEAR(tip.tip.y(), 170.5, 1e-3);
  EXPECT_NEAR(tip.tip.z(), -118.3, 1e-3);
  EXPECT_NEAR(tip.a_rad, 0.5, 1e-6);
  EXPECT_NEAR(tip.b_rad, 0.12, 1e-6);
}

// OPT-2.09, OPT-2.10, OPT-B.02: a new machine stands at home and starts in ROBOT, PTP, SPEED 70.
// 100 mm of X at 350 mm/s: ramps of 350/2000 + 2000/40000 = 0.225 s and 39.375 mm each, the rest at
// full speed, and the settling of 0.048 s.
TEST(OptimoRunMotion, ProgramsStartWithTheDefaults) {
  const Ran ran =
      OptimoMachine().Run("VR[0] = IA[0]\nVR[1] = IA[2]\nMOVE (121.02,2201.2,-50.,0.,0.)\n");
  EXPECT_EQ(ran.Var("VR[0]"), "21.02");
  EXPECT_EQ(ran.Var("VR[1]"), "-50.0");
  EXPECT_NEAR(ran.run().state().axes.column.x(), 121.02, 1e-4);
  EXPECT_NEAR(ran.time_s(), 2 * 0.225 + (100.0 - 78.75) / 350.0 + 0.048, 1e-4);
}

// OPT-2.11: the same program on the customer's machine: tip coordinates, LIN at 70 %.
TEST(OptimoRunMotion, TheCustomerMachineStartsInAbsolAndLin) {
  const Ran ran = OptimoMachine().Profile("pw-1993").Run("MOVE (521.02,2201.2,-350.,0.,0.)\n");
  EXPECT_NEAR(ran.run().state().tip.tip.x(), 521.02, 1e-3);
  ASSERT_EQ(ran.moves.size(), 1U);
  EXPECT_EQ(ran.moves[0].path, "LIN");
  EXPECT_NEAR(ran.moves[0].feed_mm_s, 350.0, 1e-9);
}

// OPT-2.22: with /FLY the end of an arc is passed by, its via point never.
TEST(OptimoRunMotion, AnArcGoesThroughItsViaPointEvenWithFly) {
  const Ran ran = OptimoMachine().Run(kStart +
                                      "PATH CIR\nMOVE (1020.,1000.,-400.,0.,0.)/VIA "
                                      "(1010.,1010.,-400.,0.,0.)/FLY\nPATH LIN\n"
                                      "MOVE (1120.,1000.,-400.,0.,0.)\n");
  EXPECT_LT(ran.NearestTo({1010, 1010, -400}), 0.01);
  EXPECT_GT(ran.NearestTo({1020, 1000, -400}), 0.1);
}

// OPT-2.26, OPT-B.14: a hole without WORK switches nothing; it may start above its plane: S is 100
// mm above and 3 mm from the axis, A = C + r X.
TEST(OptimoRunMotion, AHoleSwitchesNothing) {
  const Ran ran = OptimoMachine().Run(kAbsolSlowly +
                                      "MOVE (103.,50.,-450.,0.,0.)\nPATH HOLE (25.)\n"
                                      "MOVE (100.,50.,-550.,0.,0.)/VIA (100.,50.,-450.,0.,0.)\n");
  EXPECT_TRUE(ran.completed());
  EXPECT_TRUE(ran.Events().empty());
  EXPECT_NEAR(ran.run().state().tip.tip.x(), 125.0, 1e-6);
  EXPECT_NEAR(ran.run().state().tip.tip.z(), -550.0, 1e-6);
  EXPECT_LT(ran.NearestTo({75, 50, -550}), 0.05);
}

// OPT-B.11: the straight part ends at rest, the circle too; only the move as a whole settles.
TEST(OptimoRunMotion, AHoleStopsTwiceAtItsFirstPoint) {
  const Ran ran = OptimoMachine().Run(kAbsolSlowly +
                                      "MOVE (130.,50.,-540.,0.,0.)\nPATH HOLE (25.)\n"
                                      "MOVE (100.,50.,-550.,0.,0.)/VIA (100.,50.,-450.,0.,0.)\n");
  ASSERT_EQ(ran.motions.size(), 3U);
  const Ran::Motion &straight = ran.motions[1], &circle = ran.motions[2];
  EXPECT_NEAR(straight.length_mm, std::sqrt(125.0), 1e-6);
  EXPECT_NEAR(circle.length_mm, 50.0 * M_PI, 1e-6);
  EXPECT_NEAR(straight.end_speed_mm_s, 0.0, 1e-9);
  EXPECT_NEAR(circle.end_speed_mm_s, 0.0, 1e-9);
  EXPECT_NEAR(circle.start_s, straight.end_s, 1e-9);
  // Ramps of sqrt(50/40000) s twice, 3.5355 mm in all, the rest at 50 mm/s; no settling.
  EXPECT_NEAR(straight.end_s - straight.start_s,
              4 * std::sqrt(50.0 / 40000) + (std::sqrt(125.0) - 3.535534) / 50, 1e-5);
  // On an arc 0.6 of the acceleration: 50/1200 + 1200/40000 = 0.0716667 s and 1.7916667 mm a ramp.
  // Then it settles.
  EXPECT_NEAR(circle.end_s - circle.start_s, 2 * 0.0716667 + (50 * M_PI - 3.583333) / 50 + 0.048,
              1e-5);
}

// OPT-2.30: /VIA means nothing in LIN: straight, 50 mm past the via point, no warning.
TEST(OptimoRunMotion, ViaIsIgnoredOnStraightMoves) {
  const Ran ran = OptimoMachine().Run(
      kStart + "MOVE (1100.,1000.,-400.,0.,0.)/VIA (1050.,1050.,-400.,0.,0.)\n");
  EXPECT_NEAR(ran.NearestTo({1050, 1050, -400}), 50.0, 1e-6);
  EXPECT_TRUE(ran.Events().empty());
}

// OPT-2.37, OPT-B.22, OPT-E.7307: nothing would ever move; with /TIME the time runs out.
TEST(OptimoRunMotion, TooLittleSpeedOrAccelerationIsNoMotion) {
  for (const std::string setting : {"SPEED 0\n", "ACCEL 0.05\n"}) {
    EXPECT_EQ(OptimoMachine().Run(kStart + setting + "MOVE (1100.,1000.,-400.,0.,0.)\n").code(),
              7307);
    EXPECT_TRUE(OptimoMachine()
                    .Run(kStart + setting + "MOVE (1000.,1000.,-400.,0.,0.)\n")
                    .completed());  // no distance
    const Ran timed = OptimoMachine().Run(kStart + setting +
                                          "MOVE (1100.,1000.,-400.,0.,0.)/TIME (1.,900)\nENDTASK\n"
                                          "900 VI[2]=1\nRETURN\n");
    EXPECT_EQ(timed.Var("VI[2]"), "1") << setting;
  }
}

// OPT-2.38, OPT-2.40: 50 mm/s before the corner and 30 behind it; OVERSH is a share of the lower.
TEST(OptimoRunMotion, TheBendIsTakenAtAShareOfTheLowerSpeed) {
  const auto speed = [](const std::string& oversh) {
    const Ran ran = OptimoMachine().Run(oversh + kStart +
                                        "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nSPEED 6\n"
                                        "MOVE (1100.,1100.,-400.,0.,0.)\n");
    for (const Ran::Motion& motion : ran.motions) {
      if (motion.corner.speed > 0.0) return motion.corner.speed;
    }
    return 0.0;
  };
  EXPECT_NEAR(speed(""), 30.0, 1e-9);
  EXPECT_NEAR(speed("OVERSH 50\n"), 15.0, 1e-9);
  EXPECT_NEAR(speed("OVERSH 0\n"), 0.0, 1e-9);
}

// OPT-2.44: /FLY holds for its own MOVE only. Case C01: 1.3588 mm from a corner of 90 degrees.
TEST(OptimoRunMotion, FlyBelongsToOneMove) {
  const Ran ran = OptimoMachine().Run(kStart +
                                      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
                                      "MOVE (1100.,1100.,-400.,0.,0.)\n"
                                      "MOVE (1000.,1100.,-400.,0.,0.)\n");
  EXPECT_NEAR(ran.NearestTo({1100, 1000, -400}), 1.3588, 2e-3);
  EXPECT_LT(ran.NearestTo({1100, 1100, -400}), 1e-6);
}

// OPT-2.59: the next MOVE takes over from wherever the machine is.
TEST(OptimoRunMotion, AMoveTakesOverFromANextMove) {
  const Ran ran = OptimoMachine().Run(kStart +
                                      "MOVE (1500.,1000.,-400.,0.,0.)/NEXT\nDELAY 2\n"
                                      "MOVE (1000.,1200.,-400.,0.,0.)\n");
  EXPECT_TRUE(ran.completed());
  EXPECT_NEAR(ran.run().state().tip.tip.y(), 1200.0, 1e-6);
  EXPECT_GT(ran.NearestTo({1500, 1000, -400}), 300.0);
}

// OPT-B.06: angles are never reduced by a turn: from 3.1416 to -3.1416 A passes 0.
TEST(OptimoRunMotion, AnglesAreAbsolute) {
  const Ran ran = OptimoMachine().Run(kStart +
                                      "MOVE (1000.,1000.,-400.,3.1416,0.)\n"
                                      "MOVE (1100.,1000.,-400.,-3.1416,0.)\n");
  ASSERT_FALSE(ran.motions.empty());
  double least = HUGE_VAL;
  for (const motion::TipPose& pose : ran.motions.back().poses)
    least = std::fmin(least, std::fabs(pose.a_rad));
  EXPECT_LT(least, 0.06);  // one of 64 parts of a turn
  EXPECT_NEAR(ran.run().state().axes.a_rad, -3.1416, 1e-4);
}

// OPT-B.30, OPT-B.31: seen at 21 cycles of 0.048 s at 50 mm/s, at rest after 50.4 mm (case O04).
TEST(OptimoRunMotion, EndIsSeenAtACycle) {
  const Ran ran =
      OptimoMachine().Run(kAbsolSlowly + "MOVE (521.02,2201.2,-350.,0.,0.)/END (IL[20])\n",
                          {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_TRUE(ran.completed());
  EXPECT_NEAR(ran.run().state().tip.tip.x(), 21.02 + 50.4, 1e-3);
}

// OPT-B.32: /END that ends the move leaves no passage; /TIME counts the wait of /START.
TEST(OptimoRunMotion, EndWithFlyAndTimeWithStart) {
  const Ran end = OptimoMachine().Run(kAbsolSlowly +
                                          "MOVE (521.02,2201.2,-350.,0.,0.)/FLY/END (IL[20])\n"
                                          "VR[1] = IA[0]\nMOVE (521.02,2301.2,-350.,0.,0.)\n",
                                      {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(end.Number("VR[1]"), 21.02 + 50.4, 1e-2);
  const Ran time = OptimoMachine().Run(kAbsolSlowly +
                                       "MOVE (521.02,2201.2,-350.,0.,0.)/TIME (1.,900)/START "
                                       "(IL[20])\nENDTASK\n900 VI[2]=1\nRETURN\n");
  EXPECT_EQ(time.Var("VI[2]"), "1");
  EXPECT_TRUE(time.moves.empty() || time.NearestTo({521.02, 2201.2, -350}) > 499.0);
  EXPECT_NEAR(time.time_s(), 1.008, 0.0081);
}

// OPT-B.33: the program waits for the condition, starts the motion and goes on.
TEST(OptimoRunMotion, StartWithNextWaitsAndGoesOn) {
  const Ran ran = OptimoMachine().Run(
      kAbsolSlowly + "MOVE (521.02,2201.2,-350.,0.,0.)/START (IL[21])/NEXT\nVL[0] = IL[95]\n",
      {.inputs = {{At(2.0), InputKind::kLogical, 21, 1.0}}});
  EXPECT_EQ(ran.Var("VL[0]"), "1");
  ASSERT_TRUE(ran.Find("step LET"));
  EXPECT_NEAR(ran.Find("step LET")->at_s, 2.0, 1e-6);
}

// OPT-B.34, OPT-4.18: one beam-off and one beam-on per STOP and START; no dwell again.
TEST(OptimoRunMotion, TheBeamIsOffWhileMotionIsHeld) {
  const Ran ran = OptimoMachine().Run(
      kAbsolSlowly +
          "WORKDEF 1,0 (10.,80.,0.5,60.)\nWORK 1,0/ON\nMOVE (521.02,2201.2,-350.,0.,0.)\n"
          "WORK 1,0/OFF\n",
      {.inputs = {{At(2.0), InputKind::kStop}, {At(5.0), InputKind::kStart}}});
  EXPECT_TRUE(ran.completed());
  EXPECT_EQ(ran.Count("beam off"), 2);
  EXPECT_EQ(ran.Count("wait pierce 0.5"), 1);
  EXPECT_EQ(ran.Count("shutter open"), 1);
  EXPECT_NEAR(ran.BeamLength(), 500.0, 1e-3);
}

// OPT-E.7305, OPT-E.7306, OPT-E.7309, OPT-E.129, OPT-E.348
TEST(OptimoRunMotion, GeometryThatMakesNoPath) {
  const auto arc = [](const std::string& end, const std::string& via) {
    return OptimoMachine().Run(kStart + "PATH CIR\nMOVE (" + end + ",-400.,0.,0.)/VIA (" + via +
                               ",-400.,0.,0.)\n");
  };
  EXPECT_EQ(arc("1010.,1000.", "1020.,1000.").code(), 7305);
  EXPECT_EQ(arc("1000.,1000.", "1005.,1005.").code(), 7305);
  const Ran straight = arc("1010.,1000.", "1005.,1000.");
  EXPECT_TRUE(straight.completed());
  EXPECT_TRUE(straight.Has("E7306"));
  const std::string hole = kStart + "PATH HOLE (5.)\n";
  EXPECT_EQ(OptimoMachine()
                .Run(hole + "MOVE (1000.,1000.,-500.,0.,0.)/VIA (1000.,1000.,-500.,0.,0.)\n")
                .code(),
            7309);
  const std::string on_axis = hole + "MOVE (1000.,1000.,-500.,0.,0.)/VIA (1000.,1000.,0.,0.,0.)\n";
  EXPECT_EQ(OptimoMachine().Run(on_axis).code(), 0);
  EXPECT_EQ(OptimoMachine().Set("TEACH_SIM", "ON").Run(on_axis).code(), 129);
  EXPECT_EQ(OptimoMachine()
                .Run(kStart + "PATH HOLE (0.)\nMOVE (1.,1.,1.,0.,0.)/VIA (1.,1.,9.,0.,0.)\n")
                .code(),
            348);
}

// OPT-E.7303, OPT-E.7304, OPT-E.7316, OPT-E.7320, OPT-E.7301
TEST(OptimoRunMotion, PassagesAndSpeedsThatCannotBe) {
  const std::string fly = kStart + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n";
  EXPECT_EQ(OptimoMachine().Run(fly + "COORD ROBOT\n").code(), 7303);
  EXPECT_TRUE(OptimoMachine().Run(fly + "DELAY 1\n").Has("E7304"));
  const Ran reversal = OptimoMachine().Run(fly + "MOVE (1000.,1000.,-400.,0.,0.)\n");
  EXPECT_TRUE(reversal.Has("E7316"));
  EXPECT_LT(reversal.NearestTo({1100, 1000, -400}), 1e-6);
  const Ran fast = OptimoMachine().Run(
      "SPEED 100\nMOVE (100.,2201.2,-50.,0.,0.)\nMOVE (21.02,2201.2,-50.,0.,0.)\n",
      {.override_percent = 145.0});
  EXPECT_EQ(fast.Count("E7320"), 1);
  EXPECT_EQ(OptimoMachine().Run("MOVE (9000.,0.,0.,0.,0.)\n").code(), 7301);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
