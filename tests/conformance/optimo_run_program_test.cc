// Chapter 7 and B.5: calls, offsets, variables and images on the virtual machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/number_text.h"
#include "tests/conformance/optimo_machine.h"

namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;

// OPT-7.03, OPT-7.04, OPT-7.08: variables live on; GO drops the pending returns and starts anew.
TEST(OptimoRunProgram, GoDropsThePendingReturns) {
  OptimoMachine machine;
  machine.Store(45, "VR[6]=2.5\nSPEED 5\nGO 46\n").Store(46, "VR[7]=VR[5]+VR[6]\n");
  const Ran ran = machine.Run("VR[5]=1.5\nCALL 45\nVI[2]=9\n");
  EXPECT_TRUE(ran.completed());
  EXPECT_EQ(ran.Var("VR[7]"), "4.0");
  EXPECT_EQ(ran.Var("VI[2]"), "0");
  machine.Store(45, "VR[6]=2.5\n");
  EXPECT_EQ(machine.Run("CALL 45\nVR[8]=VR[6]\n").Var("VR[8]"), "2.5");
}

// OPT-7.09, OPT-7.10, OPT-E.7107, OPT-E.7501: the program on the fourth level must have its
// executable; a fifth level never runs.
TEST(OptimoRunProgram, TheFourthLevelIsNotCompiled) {
  OptimoMachine machine;
  machine.Store(11, "CALL 12\n").Store(12, "CALL 13\n").Store(13, "CALL 14\n");
  machine.Store(14, "VI[2]=VI[2]+1\n").Store(1, "CALL 11\n");
  EXPECT_EQ(machine.Run(1).code(), 7107);
  EXPECT_TRUE(machine.Run(14).completed());
  EXPECT_TRUE(machine.HasExecutable(14));
  const Ran four = machine.Run(1);
  EXPECT_TRUE(four.completed());
  EXPECT_EQ(four.Var("VI[2]"), "2");
  machine.Store(14, "CALL 15\n").Store(15, "VI[2]=9\n");
  machine.Run(15);
  machine.Run(14);
  EXPECT_EQ(machine.Run(1).code(), 7501);
}

// OPT-7.11, OPT-1.11, OPT-6.34: loaded over the caller, compiled at the first time only; the caller
// comes back. CALL_TIME is the time that loading takes.
TEST(OptimoRunProgram, ACalledProgramIsLoadedAndCompiledOnce) {
  OptimoMachine machine;
  machine.Store(45, "VI[2]=1\n").Store(1, "CALL 45\nVI[3]=1\n");
  const Ran first = machine.Run(1);
  EXPECT_EQ(first.Count("compiling 45"), 1);
  EXPECT_EQ(first.Count("call 45"), 1);
  EXPECT_EQ(first.Count("return 1"), 1);
  EXPECT_EQ(first.time_s(), 0.0);
  EXPECT_EQ(machine.Run(1).Count("compiling 45"), 0);
  machine.Set("CALL_TIME", "0.5");
  EXPECT_GE(machine.Run(1).time_s(), 0.5);
}

// OPT-7.14, OPT-E.7106: two programs that together are too long for one executable.
TEST(OptimoRunProgram, EachCalledProgramHasItsOwnLimit) {
  std::string half;
  // A step of 4, a target and two variables of 2, an operator of 1 (OPT-B.72): 11 bytes.
  for (int n = 0; n < 2500; ++n) half += "VR[1]=VR[2]+VR[3]\n";
  OptimoMachine machine;
  machine.Store(45, half);
  EXPECT_TRUE(machine.Run(half + "CALL 45\n").completed());
  EXPECT_EQ(machine.Run(half + "FUNCTION 45\n").code(), 7106);
}

// OPT-7.30, OPT-7.31, OPT-7.32, OPT-7.40: one SYSDEF at a time, with the values of its own moment;
// IA stays in machine coordinates.
TEST(OptimoRunProgram, AnOffsetReplacesTheOneBefore) {
  const Ran ran = OptimoMachine().Run(
      "COORD ABSOL\nVR[86]=900.\nOA[5]=1000.\nSYSDEF (VR[86],OA[5],0.,0.,0.,0.)\n"
      "SYSDEF (VR[86],OA[5],0.,0.,0.,0.)\nVR[86]=5.\nMOVE (10.,20.,-500.,0.,0.)\nVR[0]=IA[0]\n"
      "VR[1]=IA[1]\n");
  EXPECT_NEAR(ran.run().state().tip.tip.x(), 910.0, 1e-3);
  EXPECT_NEAR(ran.Number("VR[0]"), 910.0, 1e-3);
  EXPECT_NEAR(ran.Number("VR[1]"), 1020.0, 1e-3);
}

// OPT-7.33, OPT-7.34, OPT-7.36: ROBOT moves are not shifted, the head does not turn, the offset
// outlives the program until it is cancelled (OPT-7.35).
TEST(OptimoRunProgram, WhatAnOffsetLeavesAlone) {
  OptimoMachine machine;
  const Ran robot = machine.Run("SYSDEF (50.,60.,70.,1.5708,0,0)\nMOVE (100.,200.,-60.,0.,0.)\n");
  EXPECT_NEAR(robot.run().state().axes.column.x(), 100.0, 1e-6);
  EXPECT_NEAR(robot.run().state().axes.column.y(), 200.0, 1e-6);
  const Ran next = machine.Run("COORD ABSOL\nMOVE (1000.,-500.,-500.,0.,0.5)\n");
  // Rz of 90 degrees: (1000,-500) -> (500,1000), then the translation.
  EXPECT_NEAR(next.run().state().tip.tip.x(), 550.0, 0.01);
  EXPECT_NEAR(next.run().state().tip.tip.y(), 1060.0, 0.01);
  EXPECT_NEAR(next.run().state().tip.tip.z(), -430.0, 0.01);
  EXPECT_NEAR(next.run().state().axes.a_rad, 0.0, 1e-9);
  const Ran cancelled = machine.Run("SYSDEF\nCOORD ABSOL\nMOVE (1000.,500.,-500.,0.,0.)\n");
  EXPECT_NEAR(cancelled.run().state().tip.tip.x(), 1000.0, 1e-6);
}

// OPT-7.61, OPT-7.63, OPT-7.64: both ends of VI; a new machine is all zero; analogue images.
TEST(OptimoRunProgram, VariablesAndImages) {
  const Ran ran = OptimoMachine().Run(
      "VI[2]=32767\nVI[3]=-32768\nOA[5]=2.5\nVR[0]=OA[5]\nCOORD ABSOL\n"
      "MOVE (1000.,1000.,-400.,0.25,0.)\nVR[1]=IA[3]\n");
  EXPECT_EQ(ran.Var("VI[2]"), "32767");
  EXPECT_EQ(ran.Var("VI[3]"), "-32768");
  EXPECT_EQ(ran.Var("VR[0]"), "2.5");
  EXPECT_NEAR(ran.Number("VR[1]"), 0.25, 1e-6);
  for (const char* name : {"VR[99]", "VI[4]", "VL[99]", "OL[16]"})
    EXPECT_EQ(ParseDouble(ran.Var(name)), 0.0) << name;
  // OPT-E.7203: one more cannot be assigned, and ERR takes it (OPT-B.47).
  const Ran over =
      OptimoMachine().Run("ERR 900\nVI[2]=5\nVI[2]=32767+1\nENDTASK\n900 VI[3]=VI[99]\n");
  EXPECT_EQ(over.Var("VI[2]"), "5");
  EXPECT_EQ(over.Var("VI[3]"), "7203");
}

// OPT-7.65, OPT-7.99: tip or column by the active COORD; IA is read without UPDATE.
TEST(OptimoRunProgram, CoordinatesAsTheActiveTypeHasThem) {
  const Ran ran = OptimoMachine().Run("VR[0]=IA[2]\nCOORD ABSOL\nVR[1]=IA[2]\nVR[2]=IA[0]\n");
  EXPECT_NEAR(ran.Number("VR[0]") - ran.Number("VR[1]"), 300.0, 1e-4);
  EXPECT_NEAR(ran.Number("VR[2]"), 21.02, 1e-4);
}

// OPT-7.67: IL[16] is the START push-button.
TEST(OptimoRunProgram, AMoveWaitsForTheButton) {
  const Ran ran =
      OptimoMachine().Run(kAbsolSlowly + "MOVE (31.02,2201.2,-350.,0.,0.) / START (IL[16])\n",
                          {.inputs = {{At(3.0), InputKind::kLogical, 16, 1.0}}});
  ASSERT_EQ(ran.motions.size(), 1U);
  EXPECT_NEAR(ran.motions[0].start_s, 3.0, 1e-6);
}

// OPT-7.68: 1 from the first instant of a motion to standstill.
TEST(OptimoRunProgram, TheMotionFlag) {
  const std::string move = kAbsolSlowly + "MOVE (521.02,2201.2,-350.,0.,0.)";
  EXPECT_EQ(OptimoMachine().Run(move + "/NEXT\nVL[0]=IL[95]\n").Var("VL[0]"), "1");
  EXPECT_EQ(OptimoMachine().Run(move + "\nVL[0]=IL[95]\n").Var("VL[0]"), "0");
}

// OPT-7.69: 50 mm/s times the system cycle.
TEST(OptimoRunProgram, TheSpeedOfTheTip) {
  const std::string program =
      kAbsolSlowly + "MOVE (521.02,2201.2,-350.,0.,0.)/NEXT\nDELAY 2\nVR[0]=OA[0]\n";
  EXPECT_NEAR(OptimoMachine().Run(program).Number("VR[0]"), 2.4, 1e-5);
  EXPECT_NEAR(OptimoMachine().Set("CYCLE", "0.064").Run(program).Number("VR[0]"), 3.2, 1e-5);
}

// OPT-7.70, OPT-B.63: the executions of the main program since it was selected.
TEST(OptimoRunProgram, RepetitionsAreCounted) {
  const Ran ran = OptimoMachine().Run("VI[5]=VI[98]\nIF VI[98] < 3 THEN 9\nSTOP\n9 ENDTASK\n",
                                      {.mode = machine::Mode::kRepeat});
  EXPECT_EQ(ran.Var("VI[5]"), "3");
}

// OPT-7.71, OPT-1.17: the last error stays, over good steps and programs.
TEST(OptimoRunProgram, TheLastErrorStays) {
  OptimoMachine machine;
  std::string program = "ERR 900\nGOTO 77\n900 VI[2]=0\n";
  for (int n = 0; n < 20; ++n) program += "VI[2]=VI[2]+1\n";
  EXPECT_EQ(machine.Run(program + "VI[3]=VI[99]\n").Var("VI[3]"), "60");
  const Ran next = machine.Run("VI[4]=VI[99]\n");
  EXPECT_EQ(next.Var("VI[4]"), "60");
  EXPECT_EQ(next.Var("VI[2]"), "20");
}

// OPT-7.96, OPT-7.97: an output follows its image at once; an input is read when it is used.
TEST(OptimoRunProgram, ImagesFollowWhatIsConnected) {
  const Ran ran = OptimoMachine().Run("OL[16]=ON\nVL[0]=IL[20]\nDELAY 2\nVL[1]=IL[20]\n",
                                      {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_EQ(ran.Find("OL[16] 1")->at_s, 0.0);
  EXPECT_EQ(ran.Var("VL[0]") + ran.Var("VL[1]"), "01");
}

// OPT-7.107: the calling example with stand-ins for 46 and 2, which the manual does not list.
TEST(OptimoRunProgram, TheCallingExample) {
  const std::string caller = CorpusProgram("ch07-calling.S");
  if (caller.empty()) GTEST_SKIP() << "the shared corpus is not here";
  OptimoMachine machine;
  machine.Store(45, CorpusProgram("ch07-target45.S"));
  machine.Store(46, "VR[20]=VR[86]\n").Store(2, "SYSDEF\n");
  const Ran ran = machine.Run(caller);
  EXPECT_TRUE(ran.completed());
  EXPECT_TRUE(ran.Has("E7311"));
  EXPECT_TRUE(ran.Has("beam on 99.0"));
  EXPECT_TRUE(ran.Has("wait pierce 1.2"));
  EXPECT_EQ(ran.Var("VR[20]"), "30.0");
  // TCP moved the tip by 5 mm towards the lens: 295 mm below the column.
  EXPECT_NEAR(ran.run().state().axes.column.z() - ran.run().state().tip.tip.z(), 295.0, 1e-6);
}

// OPT-B.53, OPT-B.54: what a program starts with, and what it leaves.
TEST(OptimoRunProgram, WhatStartsAnewAndWhatStays) {
  OptimoMachine machine;
  machine.Run(
      "UPDATE OL /OFF\nOL[16]=ON\nUPDATE OL /ON\nOL[40]=ON\nUPDATE OL /OFF\nERR 900\n"
      "SPEED 5\nCOORD ABSOL\n900 VR[3]=1.\n");
  const Ran ran =
      machine.Run("VL[0]=OL[40]\nOL[41]=ON\nMOVE (121.02,2201.2,-50.,0.,0.)\nVR[0]=1/0\n");
  EXPECT_EQ(ran.Var("VL[0]"), "1");
  EXPECT_TRUE(ran.Has("OL[41] 1"));
  EXPECT_NEAR(ran.run().state().axes.column.x(), 121.02, 1e-4);
  EXPECT_EQ(ran.code(), 7201);
}

// OPT-1.16: variables are apart from the programs.
TEST(OptimoRunProgram, StoringProgramsLeavesTheVariables) {
  OptimoMachine machine;
  machine.Run("VR[5]=7.\nVL[3]=ON\nVI[7]=-3\n");
  machine.Delete(1).Store(1, "VI[8]=1\n").Store(2, "SPEED 5\n");
  const Ran ran = machine.Run(1);
  EXPECT_EQ(ran.Var("VR[5]"), "7.0");
  EXPECT_EQ(ran.Var("VL[3]"), "1");
  EXPECT_EQ(ran.Var("VI[7]"), "-3");
}

// OPT-4.48, OPT-E.7310: without its zero the machine does not move; ZERO finds it.
TEST(OptimoRunProgram, AnUnzeroedMachineDoesNotMove) {
  OptimoMachine machine;
  machine.LoseZero();
  const Ran refused =
      machine.Run("VI[2]=1\nMOVE (100.,100.,-60.,0.,0.)\n", {.mode = machine::Mode::kRemote});
  EXPECT_EQ(refused.code(), 7310);
  EXPECT_EQ(refused.run().outcome().place.step, 2);
  EXPECT_EQ(refused.Var("VI[2]"), "1");
  EXPECT_TRUE(machine.Run("ZERO\nMOVE (100.,100.,-60.,0.,0.)\n", {.mode = machine::Mode::kRemote})
                  .completed());
}

// OPT-B.60: ZERO performs the zero procedure and stands at the mechanical zero.
TEST(OptimoRunProgram, ZeroStandsAtTheMechanicalZero) {
  const Ran ran = OptimoMachine().Run("ZERO\nVR[0]=IA[0]\nVR[1]=IA[1]\nVR[2]=IA[2]\nVR[3]=IA[3]\n");
  EXPECT_TRUE(ran.completed());
  for (const char* name : {"VR[0]", "VR[1]", "VR[2]", "VR[3]"})
    EXPECT_NEAR(ran.Number(name), 0.0, 1e-6) << name;
}

// OPT-B.62, OPT-7.02: the mode of the program that GO starts.
TEST(OptimoRunProgram, GoSetsTheMode) {
  OptimoMachine machine;
  machine.Store(46, "VI[2]=1\nVI[3]=1\n");
  const Ran single = machine.Run("GO 46/S\n");
  EXPECT_FALSE(single.completed());
  EXPECT_EQ(single.Var("VI[2]"), "0");
  const Ran cycle = machine.Run(
      "GO 46/C\n", {.mode = machine::Mode::kSingle, .inputs = {{At(1.0), InputKind::kStart}}});
  EXPECT_TRUE(cycle.completed());
  EXPECT_EQ(cycle.Var("VI[3]"), "1");
}

// OPT-B.64, OPT-6.07: HOLD in a CALLed program halts there.
TEST(OptimoRunProgram, HoldHaltsInTheCalledProgram) {
  OptimoMachine machine;
  machine.Store(45, kAbsolSlowly + "MOVE (521.02,2201.2,-350.,0.,0.)\nVI[2]=1\n");
  const Ran ran = machine.Run("CALL 45\nVI[3]=1\n", {.inputs = {{At(2.0), InputKind::kHold}}});
  EXPECT_FALSE(ran.completed());
  EXPECT_EQ(ran.Var("VI[2]"), "0");
  ASSERT_TRUE(ran.Find("halt HOLD"));
  EXPECT_EQ(ran.Find("halt HOLD")->program, 45);
}

// OPT-B.66, OPT-3.50: in REMOTE a STOP ends the run at its step.
TEST(OptimoRunProgram, JobsWithoutAnOperatorStop) {
  const Ran ran = OptimoMachine().Run("VI[2]=1\nSTOP\nVI[2]=2\n", {.mode = machine::Mode::kRemote});
  EXPECT_EQ(ran.run().outcome().kind, machine::OutcomeKind::kStopped);
  EXPECT_EQ(ran.run().outcome().place.step, 2);
  EXPECT_EQ(ran.Var("VI[2]"), "1");
}

// OPT-B.89: a TIMER stands still while a CALLed program runs; a /NEXT move is finished before CALL.
TEST(OptimoRunProgram, TimersAndNextMovesAtACall) {
  OptimoMachine machine;
  machine.Store(45, "DELAY 10\nVI[3]=VI[2]\n").Store(46, "VR[0]=IA[0]\n");
  const Ran timer = machine.Run(
      "TIMER (2., 900)\nCALL 45\nVI[4]=VI[2]\nDELAY 3\nENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n");
  EXPECT_EQ(timer.Var("VI[3]") + timer.Var("VI[4]") + timer.Var("VI[2]"), "001");
  const Ran next = machine.Run(kAbsolSlowly + "MOVE (521.02,2201.2,-350.,0.,0.)/NEXT\nCALL 46\n");
  EXPECT_NEAR(next.Number("VR[0]"), 521.02, 1e-3);
}

// OPT-E.7205, OPT-E.7503, OPT-E.7102: values that only the run can refuse.
TEST(OptimoRunProgram, WhatOnlyTheRunCanRefuse) {
  const Ran speed = OptimoMachine().Run("ERR 900\nVR[1]=-1.\nDELAY VR[1]\n900 VI[2]=VI[99]\n");
  EXPECT_EQ(speed.Var("VI[2]"), "7205");
  const Ran deep = OptimoMachine().Run("ERR 900\n10 GOSUB 10\n900 VI[2]=1\n");
  EXPECT_EQ(deep.code(), 7503);
  EXPECT_EQ(deep.Var("VI[2]"), "0");
  EXPECT_EQ(OptimoMachine().Run("GO 46\n").code(), 7102);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
