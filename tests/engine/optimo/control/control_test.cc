#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using machine::OutcomeKind;
using ::testing::ElementsAre;

// OPT-2.06, OPT-2.07: what ABSOL and ROBOT coordinates mean; L = 300.
TEST(Motion, AbsolIsTheTipAndRobotTheColumn) {
  const Ran absol = RunText(std::string(kAbsol) + "MOVE (100.,100.,-400.,0.,1.5708)\n");
  EXPECT_NEAR(absol.end.tip.tip.x(), 100.0, 1e-3);
  EXPECT_NEAR(absol.end.axes.column.y(), -200.0, 0.01);
  const Ran robot = RunText("COORD ROBOT\nMOVE (100.,100.,-400.,0.,0.)\n");
  EXPECT_NEAR(robot.end.axes.column.z(), -400.0, 1e-9);
  EXPECT_NEAR(robot.end.tip.tip.z(), -700.0, 1e-9);
}

// OPT-2.08: LIN in COORD ROBOT is an error of the MOVE, not of PATH or COORD.
TEST(Motion, LinNeedsAbsolWhenTheMoveIsExecuted) {
  EXPECT_EQ(CodeOf(RunText("COORD ROBOT\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\n")), 7302);
  EXPECT_EQ(CodeOf(RunText("PATH LIN\nCOORD ROBOT\nPATH PTP\nMOVE (0.,0.,0.,0.,0.)\n")), 0);
}

// OPT-2.27, OPT-B.15: radius zero is 348, before an undefined normal; no motion.
TEST(Motion, HoleOfRadiusZeroIs348) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH HOLE (0.)\nMOVE (100.,50.,-550.,0.,0.)/VIA (100.,50.,-550.,0.,0.)\n");
  EXPECT_EQ(CodeOf(ran), 348);
  EXPECT_TRUE(ran.moves.empty());
}

// OPT-2.23: the tip goes to the nearest point of the circle, round it, and stops there.
TEST(Motion, HoleEndsWhereItEntered) {
  const Ran ran = RunText(std::string(kAbsol) +
                          "MOVE (130.,50.,-540.,0.,0.)\nPATH HOLE (25.)\n"
                          "MOVE (100.,50.,-550.,0.,0.)/VIA (100.,50.,-450.,0.,0.)\n");
  EXPECT_NEAR(ran.end.tip.tip.x(), 125.0, 1e-6);
  EXPECT_NEAR(ran.end.tip.tip.y(), 50.0, 1e-6);
  EXPECT_NEAR(ran.end.tip.tip.z(), -550.0, 1e-6);
}

// OPT-2.35: a computed SPEED out of range is an error of the program, and the old value stays.
TEST(Motion, ComputedSpeedOutOfRangeIs7205) {
  EXPECT_EQ(CodeOf(RunText("VR[64] = 150.\nSPEED VR[64]\n")), 7205);
}

// OPT-B.20: 500 mm at SPEED 10: 10 s, the ramps of the jerk limit, settling.
TEST(Motion, AMoveWithoutFlySettles) {
  const Ran ran = RunText(std::string(kAbsol) +
                          "SPEED 100\nMOVE (1000.,1000.,-400.,0.,0.)\nVR[0] = 1.\nSPEED 10\n"
                          "MOVE (1500.,1000.,-400.,0.,0.)\n");
  ASSERT_EQ(ran.moves.size(), 2U);
  EXPECT_NEAR(ToSeconds(ran.moves[1].at - ran.moves[0].at),
              500.0 / 50.0 + 2.0 * std::sqrt(50.0 / 40000.0) + 0.048, 1e-6);
}

// OPT-B.08: a target outside the travel is refused before anything moves.
TEST(Motion, TargetOutsideTheTravelIs7301WithoutMotion) {
  const Ran ran = RunText("COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\n");
  EXPECT_EQ(CodeOf(ran), 7301);
  EXPECT_TRUE(ran.moves.empty());
}

// motion.md 4.5: X at 250 mm/s, then Y. No settling between them, and an output of the passage
// comes when half of the curve is behind (OPT-2.49): the ramp takes 250/2000 + 2000/40000 s, of
// which half is lost, and each 1000 mm 4 s.
TEST(Motion, PassagesInCoordRobot) {
  const Ran ran = RunText(
      "COORD ROBOT\nMOVE (0.,0.,-50.,0.,0.)\nSPEED 50\nMOVE (1000.,0.,-50.,0.,0.)/FLY\n"
      "OL[20]=1\nMOVE (1000.,1000.,-50.,0.,0.)\n");
  const Ran there = RunText("COORD ROBOT\nMOVE (0.,0.,-50.,0.,0.)\n");
  ASSERT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
  const double ramps = 250.0 / 2000.0 + 2000.0 / 40000.0;
  EXPECT_NEAR(ran.time_s - there.time_s, 8.0 + ramps + 0.048, 1e-6);
  EXPECT_FALSE(ran.Told("E7304"));
  const auto curve = std::ranges::find_if(ran.parts, [](const Ran::Part& part) {
    return part.motion.path.kind() == motion::PathPiece::Kind::kBlend;
  });
  ASSERT_NE(curve, ran.parts.end());
  EXPECT_EQ(curve->motion.corner.passage, motion::Passage::kBlend);
  ASSERT_TRUE(ran.Told("OL[20] 1"));
  EXPECT_NEAR(ran.First("OL[20] 1").at_s - there.time_s, 4.0 + 0.5 * ramps, 1e-6);
}

// OPT-2.59: behind a /FLY passage the instructions after a MOVE with /NEXT begin with that move,
// which is the middle of the bend, and nothing of the move before it is lost.
TEST(Motion, NextBehindAPassage) {
  const std::string text = std::string(kAbsol) +
                           "SPEED 30\nMOVE (100.,1500.,-300.,0.,0.)\n"
                           "MOVE (600.,1500.,-300.,0.,0.)/FLY\nMOVE (600.,1800.,-300.,0.,0.)";
  const std::string behind = "OL[20]=1\nDELAY 20.\n";
  const Ran plain = RunText(text + "\n");
  const Ran next = RunText(text + "/NEXT\n" + behind);
  ASSERT_TRUE(next.Told("OL[20] 1"));
  ASSERT_EQ(next.moves.size(), 3u);
  EXPECT_NEAR(next.First("OL[20] 1").at_s, ToSeconds(plain.moves[1].at), 1e-6);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(ToSeconds(next.moves[k].at), ToSeconds(plain.moves[k].at), 1e-6) << k;
    EXPECT_NEAR((next.moves[k].tip.tip - plain.moves[k].tip.tip).norm(), 0.0, 1e-6) << k;
  }
}

// motion.md 6, OPT-B.34: STOP, and the door, stop the machine at once, also on its way to the
// target of a HOLD: from 50 mm/s in 2 sqrt(50/40000) = 0.0707 s.
TEST(Motion, StopOvertakesAHold) {
  const std::string text = std::string(kAbsol) +
                           "SPEED 10\nMOVE (500.,2201.2,-350.,0.,0.)/FLY\n"
                           "MOVE (500.,1500.,-350.,0.,0.)\n";
  const Ran plain = RunText(text);
  for (const InputKind stop : {InputKind::kStop, InputKind::kDoor}) {
    const Ran ran = RunText(text, {.inputs = {{FromSeconds(2.0), InputKind::kHold, 0, 1.0},
                                              {FromSeconds(3.0), stop, 0, 1.0},
                                              {FromSeconds(4.0), InputKind::kDoor, 0, 0.0},
                                              {FromSeconds(5.0), InputKind::kStart, 0, 1.0}}});
    ASSERT_TRUE(ran.Told("halt STOP"));
    EXPECT_NEAR(ran.First("halt STOP").at_s, 3.0 + 2.0 * std::sqrt(50.0 / 40000.0), 1e-6);
    EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
    EXPECT_NEAR((ran.end.tip.tip - plain.end.tip.tip).norm(), 0.0, 1e-9);
  }
}

// A STOP that ends on the target of the move: it is told once.
TEST(Motion, StopOnTheTarget) {
  for (const std::string start : {"COORD ROBOT\nMOVE (221.02,2201.2,-50.,0.,0.)\n",
                                  "COORD ABSOL\nPATH LIN\nMOVE (221.02,2201.2,-350.,0.,0.)\n"}) {
    const Ran plain = RunText("SPEED 10\n" + start);
    const double at = plain.time_s - 0.048 - 0.02;  // braking already
    const Ran ran =
        RunText("SPEED 10\n" + start, {.inputs = {{FromSeconds(at), InputKind::kStop, 0, 1.0},
                                                  {FromSeconds(10.0), InputKind::kStart, 0, 1.0}}});
    EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
    EXPECT_EQ(ran.moves.size(), 1u) << start;
  }
}

// motion.md 3.6: a MOVE to where the machine goes anyway ends the chain, with 7304, and is told
// when that is over; so does a motion that cannot be passed into.
TEST(Motion, WhatEndsAChainOfPassages) {
  const std::string there = std::string(kAbsol) + "MOVE (600.,1500.,-300.,0.,0.)/FLY\n";
  const Ran nowhere = RunText(there +
                              "MOVE (600.,1800.,-300.,0.,0.)/FLY\n"
                              "MOVE (600.,1800.,-300.,0.,0.)\nOL[20]=1\n"
                              "MOVE (100.,1800.,-300.,0.,0.)\n");
  ASSERT_EQ(nowhere.moves.size(), 4u);
  EXPECT_EQ(nowhere.moves[2].tip.tip, (motion::MachineVector{600.0, 1800.0, -300.0}));
  EXPECT_GE(nowhere.moves[2].at, nowhere.moves[1].at);
  EXPECT_EQ(nowhere.Count("E7304"), 1);
  const Ran turn = RunText(there + "MOVE (600.,1500.,-300.,0.5,0.)\n");
  EXPECT_EQ(turn.Count("E7304"), 1);
}

// OPT-2.45, OPT-2.46, OPT-2.47: /FLY before COORD and before the end.
TEST(Motion, FlyBeforeCoordAndBeforeTheEnd) {
  const std::string fly =
      std::string(kAbsol) + "MOVE (1000.,1000.,-400.,0.,0.)\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n";
  EXPECT_EQ(CodeOf(RunText(fly + "COORD ROBOT\n")), 7303);
  EXPECT_TRUE(RunText(fly + "COORD ABSOL\n").Told("E7304"));
  const Ran end = RunText(fly);
  EXPECT_TRUE(end.Told("E7304"));
  EXPECT_NEAR(end.end.tip.tip.x(), 1100.0, 1e-9);
}

// OPT-2.54, OPT-2.55: when /TIME runs out the motion is abandoned, the GOSUB made, RETURN goes on
// after it.
TEST(Motion, TimeRunsOut) {
  const Ran ran =
      RunText(std::string(kAbsol) +
                  "SPEED 100\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 10\n"
                  "MOVE (1500.,1000.,-400.,0.,0.)/TIME (2., 900)\nVI[3] = VI[2] + 1\nENDTASK\n"
                  "900 VI[2] = 5\nRETURN\n",
              {.variables = {"VI[2]", "VI[3]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "5");
  EXPECT_EQ(ran.variables.at("VI[3]"), "6");
  EXPECT_NEAR(ran.end.tip.tip.x(), 1100.0, 5.0);
}

// OPT-2.57: /START waits; OPT-2.58: /END true from the beginning means no motion.
TEST(Motion, StartAndEndConditions) {
  const Ran start = RunText(std::string(kAbsol) + "MOVE (1000.,1000.,-400.,0.,0.)/START (IL[16])\n",
                            {.inputs = {{At(3.0), InputKind::kLogical, 16, 1.0}}});
  EXPECT_TRUE(start.Told("wait condition 3.0"));
  const Ran end =
      RunText(std::string(kAbsol) + "MOVE (1000.,1000.,-400.,0.,0.)/END (IL[20])\nVI[2] = 1\n",
              {.inputs = {{At(0.0), InputKind::kLogical, 20, 1.0}}, .variables = {"VI[2]"}});
  EXPECT_NEAR(end.end.axes.column.x(), 21.02, 1e-9);
  EXPECT_EQ(end.variables.at("VI[2]"), "1");
}

// OPT-2.60: while a /NEXT move runs IL[95] is 1; a program can wait for its end.
TEST(Motion, NextGoesOnWhileTheMachineMoves) {
  const Ran ran = RunText(
      std::string(kAbsol) +
          "MOVE (1000.,1000.,-400.,0.,0.)/NEXT\nVL[0] = IL[95]\nWAIT (NOT IL[95])\nVR[0] = IA[0]\n",
      {.variables = {"VL[0]", "VR[0]"}});
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
  EXPECT_EQ(ran.variables.at("VR[0]"), "1000.0");
}

// OPT-4.18: STOP halts on the path; START goes on over the same path to the target.
TEST(Motion, StopAndStartReachTheTarget) {
  const Ran ran = RunText(std::string(kAbsol) + "SPEED 10\nMOVE (500.,2201.2,-350.,0.,0.)\n",
                          {.inputs = {{At(2.0), InputKind::kStop}, {At(5.0), InputKind::kStart}}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_TRUE(ran.Told("halt STOP"));
  EXPECT_NEAR(ran.end.tip.tip.x(), 500.0, 1e-9);
}

// OPT-3.14: ARROW: the shutter opens at the first ON and closes at the end; later only the beam
// switches.
TEST(Laser, ArrowShutterStaysOpen) {
  EXPECT_THAT(RunText("WORK 0,0/ON\nWORK 0,0/OFF\nWORK 0,0/ON\nWORK 0,0/OFF\n").told,
              ElementsAre("compiling 1", "shutter open", "beam on 100.0", "beam off",
                          "beam on 100.0", "beam off", "shutter closed"));
}

// OPT-3.15: EFA-51: every ON opens and every OFF closes the shutter.
TEST(Laser, Efa51ShutterFollowsTheBeam) {
  const Ran ran = RunText("WORK 0,0/ON\nWORK 0,0/OFF\nWORK 0,0/ON\nWORK 0,0/OFF\n",
                          {.parameters = {{"LASER", "EFA51"}}});
  EXPECT_EQ(ran.Count("shutter open"), 2);
  EXPECT_EQ(ran.Count("shutter closed"), 2);
}

// OPT-3.21: WORK 1 dwells at PEAK power.
TEST(Laser, PierceDwellsAtPeak) {
  const Ran ran = RunText("WORKDEF 1,0 (6.5,80.,1.5,95.)\nWORK 1,0/ON\nWORK 1,0/OFF\n");
  EXPECT_THAT(ran.told, ElementsAre("compiling 1", "shutter open", "beam on 95.0",
                                    "wait pierce 1.5", "beam off", "shutter closed"));
  EXPECT_NEAR(ran.time_s, 1.5, 1e-9);
}

// OPT-3.09: WORK ON without its WORKDEF; OPT-3.10: 0,0 needs none.
TEST(Laser, WorkNeedsItsDefinition) {
  EXPECT_EQ(CodeOf(RunText("WORK 1,3/ON\n")), 7401);
  EXPECT_EQ(CodeOf(RunText("WORK 0,0/ON\nWORK 0,0/OFF\n")), 0);
}

// OPT-3.30: the manual's third example of WORK: two schedules, one beam.
TEST(Laser, SchedulesChangeUnderTheBeam) {
  EXPECT_THAT(
      RunText(
          "WORKDEF 2,5 (15)\nWORKDEF 2,6 (16)\nWORKDEF 0,0\nWORK 2,5/ON\nWORK 0,0/ON\nDELAY 0.5\n"
          "WORK 2,6/ON\nWORK 0,0/OFF\nWORK 2,5/OFF\nWORK 2,6/OFF\n")
          .told,
      ElementsAre("compiling 1", "schedule 15", "shutter open", "beam on 100.0", "wait dwell 0.5",
                  "schedule 16", "beam off", "shutter closed"));
}

// OPT-3.24: WORK 2 OFF switches the beam off, with a warning.
TEST(Laser, ScheduleOffSwitchesTheBeamOff) {
  const Ran ran = RunText("WORKDEF 2,5 (15)\nWORK 0,0/ON\nWORK 2,5/OFF\nWORK 0,0/OFF\n");
  EXPECT_TRUE(ran.Told("E7411"));
  EXPECT_EQ(ran.Count("beam off"), 1);
}

// OPT-3.33, OPT-3.34: a process that is ON at CALL is an error, at the end a warning.
TEST(Laser, WorkOnAtCallAndAtTheEnd) {
  EXPECT_EQ(CodeOf(RunText("WORK 0,0/ON\nCALL 2\n", {.programs = {{2, "ENDTASK\n"}}})), 7407);
  const Ran end = RunText("WORK 0,0/ON\n");
  EXPECT_EQ(end.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_TRUE(end.Told("E7408"));
}

// OPT-5.41: the third gas with two channels is an alarm that ERR does not catch (OPT-B.56).
TEST(Laser, GasThreeNotFittedIsAlarm931) {
  EXPECT_EQ(CodeOf(RunText("ERR 900\nOL[9]=ON\n900 VI[2]=1\n")), 931);
}

// OPT-5.40: a second assist gas is refused while the first is on.
TEST(Laser, OneGasAtATime) {
  const Ran ran = RunText("OL[8]=ON\nOL[9]=ON\n", {.parameters = {{"GAS_CHANNELS", "3"}}});
  EXPECT_TRUE(ran.Told("gas 2"));
  EXPECT_TRUE(ran.Told("E7409"));
  EXPECT_FALSE(ran.Told("gas 3"));
}

// OPT-3.45, OPT-4.39: DELAY keeps its time at any override.
TEST(Control, DelayIgnoresTheOverride) {
  EXPECT_NEAR(RunText("DELAY 2\n", {.override_percent = 10.0}).time_s, 2.0, 1e-9);
}

// OPT-3.53, OPT-3.54: ERR takes over; VI[99] holds the code. OPT-3.55: taking it disarms it.
TEST(Control, ErrCatchesOnce) {
  const Ran ran = RunText("ERR 900\nVR[0]=1/0\nVI[2]=1\nENDTASK\n900 VI[3]=VI[99]\nVR[0]=1/0\n",
                          {.variables = {"VI[2]", "VI[3]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
  EXPECT_EQ(ran.variables.at("VI[3]"), "7201");
  EXPECT_EQ(CodeOf(ran), 7201);
}

// OPT-3.57: an error in a FUNCTION without ERR is passed to its caller; OPT-B.58: not out of a
// CALL.
TEST(Control, ErrorsClimbFunctionsButNotCalls) {
  EXPECT_EQ(Value("ERR 900\nFUNCTION 44\nENDTASK\n900 VI[2]=7\n", "VI[2]",
                  {.programs = {{44, "VR[0]=1/0\n"}}}),
            "7");
  EXPECT_EQ(CodeOf(RunText("ERR 900\nCALL 45\nENDTASK\n900 VI[2]=7\n",
                           {.programs = {{45, "VR[0]=1/0\n"}}})),
            7201);
}

// OPT-3.59: the label of ERR is looked up when an error occurs.
TEST(Control, ErrWithoutItsLabelIsError60) {
  const Ran ran = RunText("ERR 5\nVR[0]=1/0\n", {.variables = {"VI[99]"}});
  EXPECT_EQ(CodeOf(ran), 60);
  EXPECT_EQ(ran.variables.at("VI[99]"), "60");
}

// OPT-7.05, OPT-7.06: CALL of a program that is not there, or of a number that is none.
TEST(Control, CallOfMissingPrograms) {
  EXPECT_EQ(CodeOf(RunText("CALL 77\n")), 7102);
  EXPECT_EQ(CodeOf(RunText("VI[2]=145\nCALL VI[2]\n")), 7101);
}

// OPT-7.12: modal values belong to the program, SYSDEF to all.
TEST(Control, CallKeepsTheCallersModalValues) {
  const Ran ran = RunText("COORD ABSOL\nCALL 2\nMOVE (10.,20.,-500.,0.,0.)\n",
                          {.programs = {{2, "COORD ROBOT\nSYSDEF (1000.,1000.,0.,0.,0.,0.)\n"}}});
  EXPECT_NEAR(ran.end.tip.tip.x(), 1010.0, 1e-9);
}

// OPT-7.13: a program may call itself within four levels; the fifth is 7501.
TEST(Control, CallNestsFourDeep) {
  EXPECT_EQ(CodeOf(RunText("VI[2]=VI[2]+1\nIF VI[2] > 4 THEN 9\nCALL 1\n9 ENDTASK\n")), 0);
  EXPECT_EQ(CodeOf(RunText("VI[2]=VI[2]+1\nIF VI[2] > 5 THEN 9\nCALL 1\n9 ENDTASK\n")), 7501);
}

// OPT-9.08: four FUNCTION levels, counted at run time.
TEST(Control, FunctionNestsFourDeep) {
  const std::string recursive = "VI[2]=VI[2]+1\nIF VI[2] = VI[3] THEN 9\nFUNCTION 44\n9 RETURN\n";
  EXPECT_EQ(CodeOf(RunText("VI[3]=4\nFUNCTION 44\n", {.programs = {{44, recursive}}})), 0);
  EXPECT_EQ(CodeOf(RunText("VI[3]=5\nFUNCTION 44\n", {.programs = {{44, recursive}}})), 7502);
}

// OPT-9.21, OPT-9.27, OPT-9.28: parameters by position, converted; those not passed are 0.
TEST(Control, ParametersAreConvertedCopies) {
  const Ran ran = RunText(
      "VR[1]=2.7\nFUNCTION 44 (VR[1], ON)\n",
      {.programs = {{44,
                     "DEFINE PAR[0] = INT\nVI[2]=PAR[0]\nVR[2]=PAR[1]\nVR[3]=PAR[2]\nPAR[0]=9\n"}},
       .variables = {"VI[2]", "VR[2]", "VR[3]", "VR[1]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "2");
  EXPECT_EQ(ran.variables.at("VR[2]"), "1.0");
  EXPECT_EQ(ran.variables.at("VR[3]"), "0.0");
  EXPECT_EQ(ran.variables.at("VR[1]"), "2.7");
}

// OPT-7.15, OPT-7.16, OPT-7.17, OPT-7.18: jumps, computed jumps, missing labels.
TEST(Control, JumpsGoWhereTheySay) {
  EXPECT_EQ(Value("GOTO 20\n10 VI[2]=1\n20 VI[3]=1\n", "VI[2]"), "0");
  EXPECT_EQ(CodeOf(RunText("VL[1]=ON\nIF VL[1] THEN 99\n")), 60);
  EXPECT_EQ(Value("VR[2]=2.9\nGOTO VR[2] (20,30,40)\nVI[3]=9\nENDTASK\n20 VI[3]=2\nENDTASK\n30 "
                  "VI[3]=3\nENDTASK\n40 VI[3]=4\n",
                  "VI[3]"),
            "3");
  EXPECT_EQ(Value("VI[2]=-1\nGOTO VI[2] (20)\nVI[3]=9\nENDTASK\n20 VI[3]=2\n", "VI[3]"), "9");
}

// OPT-7.21, OPT-7.22: GOSUB 16 deep; RETURN with nothing to return to.
TEST(Control, GosubDepthAndStrayReturn) {
  EXPECT_EQ(CodeOf(RunText("10 VI[2]=VI[2]+1\nIF VI[2] > 16 THEN 20\nGOSUB 10\n20 ENDTASK\n")), 0);
  EXPECT_EQ(CodeOf(RunText("10 VI[2]=VI[2]+1\nIF VI[2] > 17 THEN 20\nGOSUB 10\n20 ENDTASK\n")),
            7503);
  EXPECT_EQ(CodeOf(RunText("RETURN\n")), 7504);
}

// OPT-7.29: translation and rotation of SYSDEF.
TEST(Control, SysdefRotatesAboutZThenYThenX) {
  const Ran z =
      RunText("COORD ABSOL\nSYSDEF (1000.,1000.,-500.,1.570796,0,0)\nMOVE (10.,0.,0.,0.,0.)\n");
  EXPECT_NEAR(z.end.tip.tip.y(), 1010.0, 1e-4);
  const Ran zx = RunText(
      "COORD ABSOL\nSYSDEF (1000.,1000.,-500.,1.570796,0,1.570796)\nMOVE (0.,10.,0.,0.,0.)\n");
  EXPECT_NEAR(zx.end.tip.tip.z(), -490.0, 1e-4);
}

// OPT-7.98, OPT-7.101: UPDATE OFF disconnects the images; ON sets the outputs from them.
TEST(Control, UpdateConnectsOutputs) {
  const Ran ran = RunText("UPDATE OL /OFF\nOL[16]=ON\nVL[0]=OL[16]\nDELAY 1\nUPDATE OL /ON\n",
                          {.variables = {"VL[0]"}});
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
  EXPECT_THAT(ran.told, ElementsAre("compiling 1", "wait dwell 1.0", "OL[16] 1"));
}

// OPT-7.102, OPT-7.103: ASSIGN writes binary, least significant bit first.
TEST(Control, AssignWritesBits) {
  const Ran ran =
      RunText("ASSIGN VL[22] = 5 /8\n", {.variables = {"VL[22]", "VL[23]", "VL[24]", "VL[25]"}});
  EXPECT_EQ(ran.variables.at("VL[22]") + ran.variables.at("VL[23]") + ran.variables.at("VL[24]"),
            "101");
  EXPECT_EQ(CodeOf(RunText("VI[2]=16\nASSIGN VL[12]=VI[2] /4\n")), 7206);
}

// OPT-3.49, OPT-3.50: STOP goes on with START in CYCLE; in REMOTE it ends the run.
TEST(Control, StopInCycleAndInRemote) {
  EXPECT_EQ(Value("STOP\nVI[2]=1\n", "VI[2]", {.inputs = {{At(4.0), InputKind::kStart}}}), "1");
  const Ran remote = RunText("STOP\nVI[2]=1\n", {.mode = machine::Mode::kRemote});
  EXPECT_EQ(remote.outcome.kind, OutcomeKind::kStopped);
  EXPECT_TRUE(remote.Told("E7507"));
}

// OPT-3.52: the beam is off while halted and comes back with START.
TEST(Control, BeamReturnsWithStart) {
  const Ran ran =
      RunText("WORK 0,0/ON\nSTOP\nWORK 0,0/OFF\n", {.inputs = {{At(4.0), InputKind::kStart}}});
  EXPECT_EQ(ran.Count("beam on 100.0"), 2);
  EXPECT_EQ(ran.Count("beam off"), 2);
}

// OPT-6.31: one START for each step in SINGLE.
TEST(Control, SingleTakesOneStartForEachStep) {
  const Ran ran = RunText("VI[2]=1\nVI[3]=1\nVI[4]=1\n",
                          {.inputs = {{At(1.0), InputKind::kStart}, {At(2.0), InputKind::kStart}},
                           .mode = machine::Mode::kSingle});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.Count("halt SINGLE"), 2);
}

// OPT-6.07, OPT-6.10: a breakpoint halts after its step, each time.
TEST(Control, BreakpointHaltsAfterItsStep) {
  const Ran ran = RunText("10 VI[2]=VI[2]+1\nIF VI[2] < 3 THEN 10\n",
                          {.inputs = {{At(1.0), InputKind::kStart},
                                      {At(2.0), InputKind::kStart},
                                      {At(3.0), InputKind::kStart}},
                           .breakpoint = machine::ProgramStep{.program = 1, .step = 1}});
  EXPECT_EQ(ran.Count("halt BREAK"), 3);
}

// OPT-6.13, OPT-6.18, OPT-6.23, OPT-6.24: simulated steps move nothing and take no time; outputs
// follow at the end.
TEST(Control, SimulRunsDryUpToItsStep) {
  const Ran ran =
      RunText(std::string(kAbsol) + "OL[16]=ON\nDELAY 5\nMOVE (1000.,1000.,-400.,0.,0.)\nVI[2]=1\n",
              {.variables = {"VI[2]"}, .simul = machine::ProgramStep{.program = 1, .step = 6}});
  EXPECT_TRUE(ran.moves.empty());
  EXPECT_EQ(ran.time_s, 0.0);
  EXPECT_TRUE(ran.Told("OL[16] 1"));
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
}

// OPT-B.59: TIMER makes its GOSUB between two instructions.
TEST(Control, TimerMakesItsGosubOnce) {
  EXPECT_EQ(
      Value("TIMER (2., 900)\nDELAY 5\nVI[3]=VI[2]\nENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n", "VI[3]"),
      "1");
}

// OPT-B.67: budgets of steps and of virtual time.
TEST(Control, BudgetsEndTheRun) {
  EXPECT_EQ(CodeOf(RunText("10 GOTO 10\n", {.budget = {.steps = 1000}})), 7901);
  EXPECT_EQ(CodeOf(RunText("WAIT IL[20]\n",
                           {.budget = {.steps = 1000, .virtual_time = std::chrono::seconds(5)}})),
            7902);
}

// OPT-B.67: a budget of 0 is no limit, of steps as of time; a day longer than the usual one of 30.
TEST(Control, ABudgetOfZeroIsNoLimit) {
  const double days_31 = 31.0 * 24.0 * 3600.0;
  const Ran limited = RunText("DELAY 2678400\n");
  EXPECT_EQ(CodeOf(limited), 7902);
  const Ran ran =
      RunText("DELAY 2678400\nVI[2]=1\n",
              {.variables = {"VI[2]"}, .budget = {.steps = 0, .virtual_time = SimTime(0)}});
  EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_NEAR(ran.time_s, days_31, 1e-6);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
}

// OPT-B.67: with no limit of time a WAIT that nothing can end goes on as long as it is
// asked to, and no further.
TEST(Control, WithoutALimitAnEndlessWaitStands) {
  machine::RunObserver nobody;
  machine::RunSetup setup =
      SetupOf("WAIT IL[20]\n", {.budget = {.steps = 0, .virtual_time = SimTime(0)}});
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(std::move(setup), nobody);
  ASSERT_TRUE(bool(run));
  EXPECT_EQ((*run)->Advance(At(1e9)), machine::RunPhase::kRunning);
  EXPECT_EQ((*run)->state().time, At(1e9));
  EXPECT_EQ((*run)->Advance(kForever), machine::RunPhase::kRunning);
  EXPECT_EQ((*run)->state().time, At(1e9));
}

// OPT-B.68: DECLARE and the implied ENDTASK are not executed steps; a written ENDTASK is.
TEST(Control, StepsAreCountedAsExecuted) {
  EXPECT_EQ(RunText("DECLARE X = VR[0]\nX = 1.\nENDTASK\n").steps, 2U);
}

// How time is cut into calls of Advance changes nothing that is told.
TEST(Control, SlicesChangeNothing) {
  const std::string text =
      std::string(kAbsol) +
      "SPEED 20\nMOVE (1000.,1000.,-400.,0.,0.)/FLY\nOL[16]=ON\n"
      "MOVE (1100.,1100.,-400.,0.,0.)/FLY\nMOVE (1200.,1000.,-400.,0.,0.)\nDELAY .3\n";
  const Ran whole = RunText(text);
  const Ran sliced = RunText(text, {.slice = std::chrono::milliseconds(7)});
  EXPECT_EQ(whole.told, sliced.told);
  EXPECT_EQ(whole.end.time, sliced.end.time);
  ASSERT_EQ(whole.moves.size(), sliced.moves.size());
  for (std::size_t n = 0; n < whole.moves.size(); ++n)
    EXPECT_EQ(whole.moves[n].at, sliced.moves[n].at);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
