#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// What MOVE and its kin do when they are executed. Times follow motion.md 5.2: a ramp over a change
// of speed v takes 2 sqrt(v / j) where v <= a^2 / j, else v / a + a / j; j is 40,000 mm/s3, a is
// 2000 mm/s2.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;

constexpr double kCycle_s = 0.048;
constexpr double kReal_mm = 1e-4;  // literals have seven digits (OPT-B.37)

// OPT-2.05: five absolute coordinates in the active system.
TEST(MotionRules, AMoveEndsAtItsFiveCoordinates) {
  const Ran ran = RunText("COORD ABSOL\nMOVE (1200, 170.5, -118.3, 0.5, 0.12)\n");
  EXPECT_NEAR(ran.end.tip.tip.x(), 1200.0, 1e-3);
  EXPECT_NEAR(ran.end.tip.tip.y(), 170.5, 1e-3);
  EXPECT_NEAR(ran.end.tip.tip.z(), -118.3, 1e-3);
  EXPECT_NEAR(ran.end.axes.a_rad, 0.5, 1e-6);
  EXPECT_NEAR(ran.end.axes.b_rad, 0.12, 1e-6);
}

// OPT-2.09, OPT-2.10, OPT-B.02: a new machine stands at home; a program begins in COORD ROBOT, PATH
// PTP, SPEED 70, ACCEL 100. 350 mm of X at 70 % of 500 mm/s.
TEST(MotionRules, AProgramBeginsWithTheDefaults) {
  const Ran ran = RunText("MOVE (371.02, 2201.2, -50., 0., 0.)\n");
  ASSERT_EQ(ran.moves.size(), 1U);
  EXPECT_EQ(ran.moves[0].path, "PTP");
  EXPECT_NEAR(ran.end.axes.column.x(), 371.02, kReal_mm);
  EXPECT_NEAR(ran.time_s, 350.0 / 350.0 + 350.0 / 2000.0 + 2000.0 / 40000.0 + kSettle_s, 1e-6);
}

// OPT-2.11: under the profile pw-1993 the same program runs in COORD ABSOL, PATH LIN. 700 mm at 350
// mm/s.
TEST(MotionRules, TheCustomerProfileBeginsInAbsolLin) {
  const Ran ran = RunText("MOVE (721.02, 2201.2, -350., 0., 0.)\n", {.profile = "pw-1993"});
  ASSERT_EQ(ran.moves.size(), 1U);
  EXPECT_EQ(ran.moves[0].path, "LIN");
  EXPECT_NEAR(ran.end.tip.tip.x(), 721.02, kReal_mm);
  EXPECT_NEAR(ran.time_s, 700.0 / 350.0 + 350.0 / 2000.0 + 2000.0 / 40000.0 + kSettle_s, 1e-6);
}

// OPT-2.22: /FLY on an arc passes near its end; the via point is reached exactly.
TEST(MotionRules, AnArcFliesAtItsEndOnly) {
  const Ran ran =
      RunText(kAbsol +
              "SPEED 10\nMOVE (1000.,1000.,-400.,0.,0.)\nPATH CIR\n"
              "MOVE (1020.,1000.,-400.,0.,0.)/VIA (1010.,1010.,-400.,0.,0.)/FLY\nPATH LIN\n"
              "MOVE (1060.,1000.,-400.,0.,0.)\n");
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_LT(ran.DistanceTo({1010.0, 1010.0, -400.0}), 1e-6);
  EXPECT_GT(ran.DistanceTo({1020.0, 1000.0, -400.0}), 0.1);
}

// OPT-2.26: a hole by itself touches neither shutter nor beam.
TEST(MotionRules, AHoleDoesNotSwitchTheBeam) {
  const Ran ran = RunText(kAbsol +
                          "MOVE (1200.,1120.,-350.,0.,0.)\nPATH HOLE (25.)\n"
                          "MOVE (1200.,1120.,-350.,0.,0.)/VIA (1200.,1120.,-150.,0.,0.)\n");
  EXPECT_THAT(ran.told, ::testing::ElementsAre("compiling 1"));
  EXPECT_EQ(ran.BeamOnLength(), 0.0);
}

// OPT-B.11, OPT-B.12: the lead of a hole ends at rest without settling; case H01: 12.7 mm and one
// turn of radius 12.7 at 30 mm/s. OPT-B.14: a start above the plane makes no difference to where it
// ends.
TEST(MotionRules, AHoleIsALineAStopAndATurn) {
  const std::string hole =
      "SPEED 6\nPATH HOLE (12.7)\nMOVE (1200.,1120.,-350.,0.,0.)/VIA (1200.,1120.,-150.,0.,0.)\n";
  const Ran centre = RunText(kAbsol + "SPEED 50\nMOVE (1200.,1120.,-350.,0.,0.)\n" + hole);
  ASSERT_EQ(centre.moves.size(), 2U);
  const double ramp_s = 2.0 * std::sqrt(30.0 / 40000.0);
  EXPECT_NEAR(ToSeconds(centre.moves[1].at - centre.moves[0].at),
              12.7 / 30.0 + ramp_s + kTurn * 12.7 / 30.0 + ramp_s + kSettle_s, 1e-6);
  EXPECT_NEAR(ToSeconds(centre.moves[1].at - centre.moves[0].at), 3.240759625, 1e-6);
  ASSERT_EQ(centre.parts.size(), 3U);
  EXPECT_EQ(centre.parts[1].motion.speed.end().speed, 0.0);
  EXPECT_EQ(centre.parts[1].done.end, centre.parts[2].done.start);

  const Ran above = RunText(kAbsol + "SPEED 50\nMOVE (1203.,1120.,-250.,0.,0.)\n" + hole);
  EXPECT_NEAR(above.end.tip.tip.x(), 1212.7, kReal_mm);
  EXPECT_NEAR(above.end.tip.tip.y(), 1120.0, kReal_mm);
  EXPECT_NEAR(above.end.tip.tip.z(), -350.0, kReal_mm);
}

// OPT-2.30: PATH LIN takes no notice of /VIA: the point 50 mm beside the line stays 50 mm away.
TEST(MotionRules, LinIgnoresVia) {
  const Ran ran = RunText(kAbsol +
                          "MOVE (1000.,1000.,-400.,0.,0.)\n"
                          "MOVE (1200.,1000.,-400.,0.,0.)/VIA (1100.,950.,-400.,0.,0.)\n");
  EXPECT_NEAR(ran.DistanceTo({1100.0, 950.0, -400.0}), 50.0, 1e-6);
  EXPECT_EQ(ran.Count("E7308"), 0);
}

// OPT-2.37: a low ACCEL gives little motion: 100 mm at SPEED 10, ACCEL 1 (a 20, j 400) never reach
// 50 mm/s. OPT-B.22: below 0.1 they give none.
TEST(MotionRules, LowAccelerationGivesLittleMotion) {
  const std::string there = kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 10\n";
  const Ran slow = RunText(there + "ACCEL 1\nMOVE (1100.,1000.,-400.,0.,0.)\n");
  ASSERT_EQ(slow.moves.size(), 2U);
  const double b = 20.0 * 20.0 / 400.0;
  const double peak = (-b + std::sqrt(b * b + 4.0 * 20.0 * 100.0)) / 2.0;
  EXPECT_NEAR(ToSeconds(slow.moves[1].at - slow.moves[0].at),
              2.0 * (peak / 20.0 + 20.0 / 400.0) + kSettle_s, 1e-6);
  EXPECT_EQ(CodeOf(RunText(there + "ACCEL .05\nMOVE (1100.,1000.,-400.,0.,0.)\n")), 7307);
}

// OPT-2.40, OPT-2.44: at OVERSH 100, the default, the bend is taken at the lower of the two speeds;
// case C01 has it at 50 mm/s, 1.358847515 mm from the corner. /FLY holds for its own MOVE: the next
// corner is exact.
TEST(MotionRules, OnlyTheMoveWithFlyFlies) {
  const Ran ran =
      RunText(kAbsol +
              "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 20\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
              "SPEED 10\nMOVE (1100.,1100.,-400.,0.,0.)\nMOVE (1200.,1100.,-400.,0.,0.)\n");
  EXPECT_NEAR(ran.DistanceTo({1100.0, 1000.0, -400.0}), 1.358847515, 1e-6);
  EXPECT_LT(ran.DistanceTo({1100.0, 1100.0, -400.0}), 1e-9);
  for (const Ran::Part& part : ran.parts) {
    if (part.motion.path.kind() != motion::PathPiece::Kind::kBlend) continue;
    EXPECT_NEAR(part.SpeedAt(part.duration_s() / 2.0), 50.0, 1e-9);
  }
}

// OPT-2.59: the MOVE after a /NEXT move takes over, at the next tick, from wherever the machine is.
TEST(MotionRules, AMoveTakesOverFromNext) {
  const Ran ran =
      RunText(kAbsol +
              "SPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/NEXT\nMOVE (21.02,2101.2,-350.,0.,0.)\n");
  EXPECT_EQ(CodeOf(ran), 0);
  ASSERT_EQ(ran.moves.size(), 2U);
  // Below 50 mm/s the whole time, braking included: less than 0.048 s and one ramp.
  EXPECT_GT(ran.moves[0].tip.tip.x(), kHomeTip.x());
  EXPECT_LT(ran.moves[0].tip.tip.x(),
            kHomeTip.x() + 50.0 * (kCycle_s + 2.0 * std::sqrt(50.0 / 40000.0)));
  EXPECT_NEAR(ran.end.tip.tip.y(), 2101.2, kReal_mm);
  EXPECT_NEAR(ran.end.tip.tip.x(), 21.02, kReal_mm);
}

// OPT-2.59, motion.md 6: the take-over is at the next tick, whatever happens before it. The MOVE is
// reached at 0.5 s, the tick is at 0.528 s, an input comes at 0.51 s.
TEST(MotionRules, AnInputDoesNotHastenTheTakeOver) {
  const std::string text = kAbsol +
                           "SPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/NEXT\nDELAY 0.5\n"
                           "MOVE (21.02,2101.2,-350.,0.,0.)\n";
  const Ran ran = RunText(text, {.inputs = {{At(0.51), machine::InputKind::kLogical, 20, 1.0}}});
  ASSERT_EQ(ran.moves.size(), 2U);
  // The ramp to 50 mm/s costs 50 mm/s x half of 2 sqrt(50/40000) s, and the brake gives as much
  // back.
  EXPECT_NEAR(ran.moves[0].tip.tip.x(), kHomeTip.x() + 50.0 * 0.528, 1e-6);
  EXPECT_NEAR(ToSeconds(ran.moves[0].at), 0.528 + 2.0 * std::sqrt(50.0 / 40000.0), 1e-6);
}

// OPT-2.59, OPT-7.68: the move that takes over is waited for like any other, and so is a chain
// behind it.
TEST(MotionRules, AMoveThatTookOverIsWaitedFor) {
  const Ran ran =
      RunText(kAbsol +
                  "SPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/NEXT\n"
                  "MOVE (21.02,2101.2,-350.,0.,0.)\nVL[0] = IL[95]\n"
                  "MOVE (21.02,2001.2,-350.,0.,0.)/NEXT\nMOVE (21.02,2051.2,-350.,0.,0.)/FLY\n"
                  "MOVE (21.02,2101.2,-350.,0.,0.)\nVL[1] = IL[95]\n",
              {.variables = {"VL[0]", "VL[1]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VL[0]"), "0");
  EXPECT_EQ(ran.variables.at("VL[1]"), "0");
  EXPECT_NEAR(ran.end.tip.tip.y(), 2101.2, kReal_mm);
}

// OPT-2.60, OPT-B.89: CALL, and the end of the program, wait for the end of a /NEXT move.
TEST(MotionRules, CallWaitsForTheNextMove) {
  const Ran ran = RunText("MOVE (521.02,2201.2,-50.,0.,0.)/NEXT\nCALL 46\n",
                          {.programs = {{46, "VR[0] = IA[0]\n"}}, .variables = {"VR[0]"}});
  EXPECT_NEAR(std::stod(ran.variables.at("VR[0]")), 521.02, kReal_mm);
  const Ran end = RunText("MOVE (521.02,2201.2,-50.,0.,0.)/NEXT\n");
  EXPECT_NEAR(end.end.axes.column.x(), 521.02, kReal_mm);
}

// OPT-7.68, OPT-7.69: IL[95] is 1 from the first instant of a motion; OA[0] is mm/s times the
// cycle. A DELAY of 1 s into a /NEXT move at 50 mm/s: 50 x 0.048, or x 0.064.
TEST(MotionRules, SpeedAndMotionFlagCanBeRead) {
  const std::string text =
      kAbsol +
      "SPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/NEXT\nVL[0] = IL[95]\nDELAY 1\n"
      "VR[0] = OA[0]\nWAIT (NOT IL[95])\nVL[1] = IL[95]\nVR[1] = OA[0]\n";
  const Ran ran = RunText(text, {.variables = {"VL[0]", "VL[1]", "VR[0]", "VR[1]"}});
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
  EXPECT_EQ(ran.variables.at("VL[1]"), "0");
  EXPECT_EQ(ran.variables.at("VR[0]"), "2.4");
  EXPECT_EQ(ran.variables.at("VR[1]"), "0.0");
  const Ran slow = RunText(text, {.parameters = {{"CYCLE", "0.064"}}, .variables = {"VR[0]"}});
  EXPECT_EQ(slow.variables.at("VR[0]"), "3.2");
}

// OPT-B.30, OPT-B.31, OPT-2.58: /END that becomes true at 1.0 s is seen at 1.008 s, 21 cycles into
// the move (case O04): at rest after 50.4 mm, 1.078710678 s.
TEST(MotionRules, EndIsSeenAtTheNextTick) {
  const Ran ran = RunText(kAbsol + "SPEED 10\nMOVE (321.02,2201.2,-350.,0.,0.)/END (IL[20])\n",
                          {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.end.tip.tip.x(), kHomeTip.x() + 50.4, 1e-6);
  EXPECT_NEAR(ran.time_s, 1.078710678, 1e-6);
}

// OPT-2.58: a hole can be ended too, on its lead or on the circle; 7316 and the like do not come of
// it.
TEST(MotionRules, EndStopsAHoleWhereItIs) {
  const Ran ran =
      RunText(kAbsol +
                  "SPEED 10\nPATH HOLE (100.)\n"
                  "MOVE (221.02,2201.2,-350.,0.,0.)/VIA (221.02,2201.2,-150.,0.,0.)/END "
                  "(IL[20])\nVI[2] = 1\n",
              {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}, .variables = {"VI[2]"}});
  EXPECT_NEAR(ran.end.tip.tip.x(), kHomeTip.x() + 50.4, 1e-6);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
}

// OPT-B.32: a move that /END ends half way makes no passage, and does not go on to its target.
TEST(MotionRules, EndCancelsThePassage) {
  const Ran ran =
      RunText(kAbsol +
                  "SPEED 10\nMOVE (321.02,2201.2,-350.,0.,0.)/FLY/END (IL[20])\nVR[0] = IA[0]\n"
                  "MOVE (321.02,2101.2,-350.,0.,0.)\n",
              {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}, .variables = {"VR[0]"}});
  EXPECT_NEAR(std::stod(ran.variables.at("VR[0]")), kHomeTip.x() + 50.4, kReal_mm);
  EXPECT_NEAR(ran.end.tip.tip.y(), 2101.2, kReal_mm);
}

// OPT-B.32, OPT-2.55: the time of /TIME counts the wait for /START; no motion is made, the GOSUB
// is, and RETURN goes on after the MOVE. OPT-B.30: it is tested every cycle, so 1 s is over at 21 x
// 0.048 s.
TEST(MotionRules, TimeCountsTheWaitForStart) {
  const Ran ran =
      RunText(kAbsol +
                  "MOVE (321.02,2201.2,-350.,0.,0.)/TIME (1.,900)/START (IL[20])\nVI[3] = VI[2]\n"
                  "ENDTASK\n900 VI[2] = 7\nRETURN\n",
              {.inputs = {{At(60.0), InputKind::kLogical, 20, 1.0}}, .variables = {"VI[3]"}});
  EXPECT_TRUE(ran.moves.empty());
  EXPECT_EQ(ran.variables.at("VI[3]"), "7");
  EXPECT_NEAR(ran.time_s, 21 * kCycle_s, 1e-9);
}

// OPT-2.55: a /NEXT move keeps its /TIME: when it runs out the motion is abandoned and the GOSUB is
// made between two instructions. At 2.016 s, 42 cycles, the tip has travelled 100.8 mm less half a
// ramp, and it takes half a ramp more to rest.
TEST(MotionRules, TimeOfANextMoveRunsOut) {
  const Ran ran = RunText(
      kAbsol +
          "SPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/NEXT/TIME (2.,900)\nDELAY 1\nDELAY 3\n"
          "VI[3] = VI[2]\nENDTASK\n900 VI[2] = VI[2] + 1\nRETURN\n",
      {.variables = {"VI[3]"}});
  EXPECT_EQ(ran.variables.at("VI[3]"), "1");
  EXPECT_NEAR(ran.end.tip.tip.x(), kHomeTip.x() + 100.8, 1e-6);
}

// OPT-2.58: the condition of a /NEXT move is its own, whatever module runs meanwhile.
TEST(MotionRules, EndOfANextMoveIsWatchedInsideAFunction) {
  const Ran ran = RunText(
      kAbsol +
          "SPEED 10\nVL[3] = OFF\nMOVE (521.02,2201.2,-350.,0.,0.)/NEXT/END (VL[3])\nFUNCTION 44\n",
      {.programs = {{44, "DELAY 1.\nVL[3] = ON\nDELAY 1.\n"}}});
  EXPECT_NEAR(ran.end.tip.tip.x(), kHomeTip.x() + 50.4, 1e-6);
}

// OPT-B.33: /START with /NEXT: the program waits for the condition, then motion and program go on
// together.
TEST(MotionRules, StartWithNextWaitsForTheCondition) {
  const Ran ran = RunText(
      kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)/START (IL[21])/NEXT\nVL[0] = IL[95]\nOL[16] = ON\n",
      {.inputs = {{At(2.0), InputKind::kLogical, 21, 1.0}}, .variables = {"VL[0]"}});
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, 2.0, 1e-9);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1000.0, kReal_mm);
}

// OPT-B.34: one beam-off and one beam-on for a STOP and START while cutting; the shutter stays
// open.
TEST(MotionRules, StopWhileCuttingSwitchesTheBeamOffAndOn) {
  const Ran ran =
      RunText(kAbsol + "SPEED 10\nWORK 0,0/ON\nMOVE (521.02,2201.2,-350.,0.,0.)\nWORK 0,0/OFF\n",
              {.inputs = {{At(2.0), InputKind::kStop}, {At(5.0), InputKind::kStart}}});
  EXPECT_THAT(ran.told,
              ::testing::ElementsAre("compiling 1", "shutter open", "beam on 100.0", "beam off",
                                     "halt STOP", ::testing::StartsWith("wait operator"),
                                     "beam on 100.0", "beam off", "shutter closed"));
}

// OPT-B.06: A is absolute and never reduced by a turn: 2.76 to 3.5256 goes on by 0.7656.
TEST(MotionRules, HeadAnglesAreNotReduced) {
  const Ran ran = RunText(
      "MOVE (1000.,1000.,-50.,2.76,0.)\nMOVE (1000.,1000.,-50.,3.5256,0.)\nMOVE "
      "(1000.,1000.,-50.,7.,0.)\n");
  ASSERT_EQ(ran.moves.size(), 3U);
  EXPECT_NEAR(ran.moves[1].axes.a_rad, 3.5256, 1e-6);
  EXPECT_NEAR(ran.end.axes.a_rad, 7.0, 1e-6);
}

// OPT-B.07: OL[11] is the sensor; nothing moves.
TEST(MotionRules, TheSensorIsNoMotion) {
  const Ran ran = RunText("OL[11]=ON\nOL[11]=OFF\n");
  EXPECT_TRUE(ran.Told("sensor on"));
  EXPECT_TRUE(ran.Told("sensor off"));
  EXPECT_TRUE(ran.parts.empty());
}

// OPT-B.60, OPT-4.49: ZERO takes Z home first, then the head, then X and Y, and ends at the
// mechanical zero.
TEST(MotionRules, ZeroEndsAtTheMechanicalZero) {
  const Ran ran = RunText(
      "MOVE (500.,600.,-200.,1.,0.5)\nZERO\nVR[0]=IA[0]\nVR[1]=IA[1]\nVR[2]=IA[2]\nVR[3]=IA[3]\n",
      {.variables = {"VR[0]", "VR[1]", "VR[2]", "VR[3]"}});
  EXPECT_THAT(ran.variables, ::testing::Each(::testing::Pair(::testing::_, "0.0")));
  ASSERT_EQ(ran.parts.size(), 4U);
  const motion::AxisPose after_z = ran.parts[1].motion.path.axes_to();
  EXPECT_NEAR(after_z.column.z(), 0.0, 1e-9);
  EXPECT_NEAR(after_z.column.x(), 500.0, 1e-9);
  EXPECT_NEAR(after_z.a_rad, 1.0, 1e-6);
  const motion::AxisPose after_head = ran.parts[2].motion.path.axes_to();
  EXPECT_NEAR(after_head.column.x(), 500.0, 1e-9);
  EXPECT_NEAR(after_head.a_rad, 0.0, 1e-9);
}

// OPT-4.49, OPT-B.60: each group of axes is told when it has found its zero, at the step of ZERO;
// the points are the machine's, not the program's.
TEST(MotionRules, ZeroIsTold) {
  const Ran ran = RunText("MOVE (500.,600.,-200.,1.,0.5)\nZERO\n");
  ASSERT_EQ(ran.moves.size(), 4U);
  EXPECT_TRUE(ran.moves[0].programmed);
  for (std::size_t n = 1; n < 4; ++n) {
    EXPECT_EQ(ran.moves[n].place.step, 2);
    EXPECT_FALSE(ran.moves[n].programmed);
    EXPECT_EQ(ran.moves[n].at, ran.parts[n].done.end);
  }
  EXPECT_EQ(ran.moves[1].path, "ZERO_Z");
  EXPECT_NEAR(ran.moves[1].axes.column.z(), 0.0, 1e-9);
  EXPECT_NEAR(ran.moves[1].axes.column.x(), 500.0, 1e-9);
  EXPECT_NEAR(ran.moves[1].axes.a_rad, 1.0, 1e-6);
  EXPECT_EQ(ran.moves[2].path, "ZERO_AB");
  EXPECT_NEAR(ran.moves[2].axes.a_rad, 0.0, 1e-9);
  EXPECT_NEAR(ran.moves[2].axes.column.x(), 500.0, 1e-9);
  EXPECT_EQ(ran.moves[3].path, "ZERO_XY");
  EXPECT_NEAR(ran.moves[3].axes.column.x(), 0.0, 1e-9);
  EXPECT_NEAR(ran.moves[3].axes.column.y(), 0.0, 1e-9);
}

// OPT-4.49: a machine that stands at its zero finds it again, without a motion.
TEST(MotionRules, ZeroAtTheZeroIsToldToo) {
  const Ran ran = RunText("ZERO\nZERO\n");
  ASSERT_EQ(ran.moves.size(), 6U);
  for (std::size_t n = 3; n < 6; ++n) {
    EXPECT_EQ(ran.moves[n].place.step, 2);
    EXPECT_EQ(ran.moves[n].path, ran.moves[n - 3].path);
    EXPECT_EQ(ran.moves[n].at, ran.moves[2].at);
  }
}

// OPT-B.53, OPT-2.09: each program begins with the defaults; what a CALLed one sets is gone after
// it.
TEST(MotionRules, ACalledProgramBeginsWithTheDefaults) {
  const Ran ran =
      RunText("COORD ABSOL\nPATH LIN\nSPEED 10\nCALL 46\nMOVE (121.02,2201.2,-350.,0.,0.)\n",
              {.programs = {{46, "MOVE (21.02,2201.2,-50.,0.,0.)\nSPEED 90\n"}}});
  ASSERT_EQ(ran.moves.size(), 2U);
  EXPECT_EQ(ran.moves[0].path, "PTP");
  EXPECT_EQ(ran.moves[1].path, "LIN");
  EXPECT_NEAR(ToSeconds(ran.moves[1].at - ran.moves[0].at),
              100.0 / 50.0 + std::sqrt(50.0 / 40000.0) * 2.0 + kSettle_s, 1e-5);
}

// OPT-B.31, OPT-2.58: a move that /END ends is told whole, in two parts: 50.4 mm of way in all.
TEST(MotionRules, AnEndedMoveIsToldWhole) {
  const Ran ran = RunText(kAbsol + "SPEED 10\nMOVE (321.02,2201.2,-350.,0.,0.)/END (IL[20])\n",
                          {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
  ASSERT_EQ(ran.parts.size(), 2U);
  EXPECT_EQ(ran.parts[0].done.start, SimTime(0));
  EXPECT_EQ(ran.parts[0].done.end, ran.parts[1].done.start);
  EXPECT_NEAR(ToSeconds(ran.parts[1].done.start), 1.008, 1e-9);
  double way = 0.0;
  for (const Ran::Part& part : ran.parts) way += part.done.travelled - part.done.from;
  EXPECT_NEAR(way, 50.4, 1e-6);
}

// OPT-2.59: time beside a /NEXT move is the move's; what is left of a DELAY is told from its end
// on.
TEST(MotionRules, ADelayBesideANextMoveIsToldFromItsEnd) {
  const Ran ran = RunText(kAbsol + "SPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)/NEXT\nDELAY 5\n");
  ASSERT_EQ(ran.waits.size(), 1U);
  EXPECT_EQ(ran.waits[0].start, ran.moves[0].at);
  EXPECT_NEAR(ToSeconds(ran.waits[0].end), 5.0, 1e-9);
}

// OPT-4.18: a STOP while the machine settles finds it at its target.
TEST(MotionRules, StopWhileSettling) {
  const double settled = 100.0 / 50.0 + 2.0 * std::sqrt(50.0 / 40000.0) + kSettle_s;
  const Ran ran = RunText(kAbsol + "SPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)\nOL[16]=ON\n",
                          {.inputs = {{At(settled - 0.02), InputKind::kStop}}});
  EXPECT_EQ(ran.Count("halt STOP"), 1);
  EXPECT_NEAR(ran.end.tip.tip.x(), 121.02, kReal_mm);
  EXPECT_FALSE(ran.Told("OL[16] 1"));
}

// OPT-2.54: the time of a MOVE that came to its target counts no more, also where the next one
// waits for its /START; nor does its /END.
TEST(MotionRules, TimeEndsWithItsMove) {
  const Ran ran =
      RunText(kAbsol +
                  "SPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)/TIME (5.,900)/END (IL[21])\n"
                  "MOVE (221.02,2201.2,-350.,0.,0.)/START (IL[20])\nENDTASK\n900 VI[2]=1\nRETURN\n",
              {.inputs = {{At(4.0), InputKind::kLogical, 21, 1.0},
                          {At(10.0), InputKind::kLogical, 20, 1.0}},
               .variables = {"VI[2]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
  EXPECT_NEAR(ran.end.tip.tip.x(), 221.02, kReal_mm);
  EXPECT_GT(ran.time_s, 12.0);
}

// OPT-2.54, OPT-2.59, OPT-7.68: a MOVE that ends where it begins takes no time, on whichever path.
// So none runs out: not while the one before is still on its way, 2 s long, nor while the one
// behind waits for its /START; and that one is waited for.
TEST(MotionRules, AMoveOnTheSpotIsOver) {
  for (const std::string path : {"LIN", "CIR", "PTP", "HOLE (5.)"}) {
    for (const std::string before : {"", "/FLY"}) {
      for (const std::string how :
           {"", "/FLY", "/NEXT", "/FLY/NEXT", "/TIME (1.,900)", "/FLY/TIME (1.,900)",
            "/TIME (1.,900)/NEXT", "/END (IL[21])", "/END (IL[21])/NEXT"}) {
        const Ran ran = RunText(
            kAbsol + "SPEED 10\nMOVE (121.,2201.2,-350.,0.,0.)" + before + "\nPATH " + path +
                "\nMOVE (121.,2201.2,-350.,0.,0.)" + how +
                "\nPATH LIN\nMOVE (221.,2201.2,-350.,0.,0.)/START (IL[20])\nVL[1]=IL[95]\n"
                "ENDTASK\n900 VI[2]=1\nRETURN\n",
            {.inputs = {{At(6.0), InputKind::kLogical, 20, 1.0}}, .variables = {"VI[2]", "VL[1]"}});
        EXPECT_EQ(ran.variables.at("VI[2]"), "0") << path << before << how;
        EXPECT_EQ(ran.variables.at("VL[1]"), "0") << path << before << how;
        EXPECT_NEAR(ran.end.tip.tip.x(), 221.0, kReal_mm) << path << before << how;
        EXPECT_GT(ran.time_s, 8.0) << path << before << how;
      }
    }
  }
}

// OPT-B.30: an input of the instant of a tick is seen at that tick: 21 x 0.048 s.
TEST(MotionRules, AnInputOfTheTickIsSeenAtIt) {
  const Ran ran = RunText(kAbsol + "SPEED 10\nMOVE (321.02,2201.2,-350.,0.,0.)/END (IL[20])\n",
                          {.inputs = {{At(1.008), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.end.tip.tip.x(), kHomeTip.x() + 50.4, 1e-6);
}

// OPT-3.45, OPT-3.49: a wait without beam is told without power, and so is a halt.
TEST(MotionRules, WaitsWithoutBeamHaveNoPower) {
  const Ran ran =
      RunText("DELAY 1\nWORK 0,0/ON\nDELAY 1\nSTOP\nWORK 0,0/OFF\nWAIT IL[20]\n",
              {.inputs = {{At(4.0), InputKind::kStart}, {At(6.0), InputKind::kLogical, 20, 1.0}}});
  ASSERT_EQ(ran.waits.size(), 4U);
  const double powers[] = {0.0, 100.0, 0.0, 0.0};
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_EQ(ran.waits[n].power_percent, powers[n]) << n;
    EXPECT_EQ(ran.waits[n].beam_on, n == 1) << n;
  }
}

// OPT-B.11: a lead of half a millimetre is one, too: then a whole turn of radius 10.
TEST(MotionRules, AHoleWithAShortLead) {
  const Ran ran = RunText(kThere +
                          "PATH HOLE (10.)\nMOVE (1010.5,1000.,-400.,0.,0.)"
                          "/VIA (1010.5,1000.,-300.,0.,0.)\n");
  ASSERT_EQ(ran.parts.size(), 3U);
  EXPECT_NEAR(ran.parts[1].done.travelled, 0.5, kReal_mm);
  EXPECT_NEAR(ran.parts[2].done.travelled, 20.0 * M_PI, kReal_mm);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1000.5, kReal_mm);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
