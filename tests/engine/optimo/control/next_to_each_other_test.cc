// Neighbours that must not be taken for each other: steps of two programs, sums and comparisons, a
// WAIT and the MOVE beside it, a HOLD and the steps behind it.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/machine/observer.h"
#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::next_to_each_other {
namespace {

using machine::InputKind;
using machine::RunPhase;

constexpr double kCycle_s = 0.048;

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// OPT-7.24: a number is true when it is not zero, also one that was computed for the condition.
TEST(NextToEachOther, ASumIsACondition) {
  const std::string known = "VR[1]=3.\nVR[2]=-3.\nVR[3]=0.\nVR[4]=2.\n";
  const auto taken = [&](const std::string& condition) {
    return Value(known + "IF " + condition + " THEN 9\nVI[2]=5\nENDTASK\n9 VI[2]=7\n", "VI[2]");
  };
  for (const std::string zero : {"VR[1]+VR[2]", "VR[1]-3.", "VR[1]*VR[3]", "VR[3]/VR[4]"})
    EXPECT_EQ(taken(zero), "5") << zero;
  for (const std::string other : {"VR[1]+VR[4]", "VR[1]-VR[4]", "VR[1]*VR[2]", "VR[1]/VR[4]"})
    EXPECT_EQ(taken(other), "7") << other;
}

// OPT-6.05, LIVE-3.10: a breakpoint that is set while a step is carried out is one of its own
// program only, whatever number the step has.
TEST(NextToEachOther, BreakpointsOfAnotherProgram) {
  for (const double at : {1.5, 2.5}) {
    const auto run = RunOfText("DELAY 1\nDELAY 1\nDELAY 1\nDELAY 1\n",
                               {.programs = {{45, "DELAY 1\nDELAY 1\nDELAY 1\n"}}});
    EXPECT_EQ(run->Advance(At(at)), RunPhase::kRunning);
    run->SetBreakpoints({{.at = {45, 1}}, {.at = {45, 2}}, {.at = {45, 3}}, {.at = {2, 3}}});
    EXPECT_EQ(run->Advance(At(9.0)), RunPhase::kFinished) << at;
    EXPECT_EQ(run->state().time, At(4.0));
  }
}

// OPT-1.13, OPT-1.15: an executable whose FUNCTION is stored as an executable alone, or not at all,
// runs with the one that it holds.
TEST(NextToEachOther, AFunctionWithoutObject) {
  const std::string text = "VI[2]=1\nFUNCTION 44\n";
  RunOptions options{.programs = {{44, "VI[3]=7\nRETURN\n"}}, .variables = {"VI[3]"}};
  const std::string made = RunText(text, options).executables.at(1);
  options.programs.clear();
  options.executables[1] = made;
  for (const bool executable : {false, true}) {
    if (executable) options.executables[44] = made;
    const Ran ran = RunText(text, options);
    EXPECT_EQ(CodeOf(ran), 0);
    EXPECT_FALSE(ran.Told("E7110"));
    EXPECT_EQ(ran.variables.at("VI[3]"), "7");
  }
}

// OPT-B.22: a hole that never moves is no motion at all, neither to its circle nor on it.
TEST(NextToEachOther, AHoleWithoutSpeed) {
  const Ran ran = RunText(
      kThere +
      "PATH HOLE (10.)\nSPEED 0\nMOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-300.,0.,0.)\n");
  EXPECT_EQ(CodeOf(ran), 7307);
  EXPECT_EQ(ran.outcome.place.step, 7);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1000.0, 1e-6);
}

// OPT-4.17: HOLD finishes the instruction: no assignment behind it is carried out before START.
TEST(NextToEachOther, NoStepComesBehindAHold) {
  const auto run = RunOfText("VI[2]=1\nDELAY 1\nVI[2]=2\nVI[3]=VI[2]\nDELAY 1\n");
  EXPECT_EQ(run->Advance(At(0.5)), RunPhase::kRunning);
  run->Apply({.kind = InputKind::kHold});
  EXPECT_EQ(run->Advance(At(5.0)), RunPhase::kHalted);
  EXPECT_EQ(run->state().time, At(1.0));
  EXPECT_EQ(run->state().place.step, 2);
  EXPECT_EQ(run->ReadVariable("VI[2]")->text, "1");
  EXPECT_EQ(run->ReadVariable("VI[3]")->text, "0");
}

// OPT-2.54, OPT-7.27: the time of a MOVE that goes on beside a WAIT ends the MOVE, and not the
// WAIT.
TEST(NextToEachOther, TheTimeOfAMoveBesideAWait) {
  const std::string text = kThere +
                           "MOVE (1900.,1000.,-400.,0.,0.)/NEXT/TIME (2.,900)\nWAIT (IL[20])\n"
                           "OL[17]=ON\nENDTASK\n900 OL[16]=ON\nRETURN\n";
  const double begin = BeginOf(text);
  const Ran ran = RunText(text, {.inputs = {{At(begin + 8.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_GE(ran.First("OL[17] 1").at_s, begin + 8.0 - 1e-9);
  EXPECT_TRUE(ran.Told("OL[16] 1"));
  const double due = std::ceil(2.0 / kCycle_s) * kCycle_s;
  EXPECT_NEAR(ran.end.tip.tip.x(), 1000.0 + 50.0 * due, 1e-3);
}

// OPT-B.55: an error of a step that the program has run ahead to, before a MOVE of /NEXT whose time
// runs out on the way: it ends the run, when the machine stands.
TEST(NextToEachOther, AnErrorBeforeATimeRunsOut) {
  const Ran ran = RunText(kThere +
                          "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
                          "MOVE (1100.,1100.,-400.,0.,0.)/NEXT/TIME (1.,900)\nVR[0]=1./VR[9]\n"
                          "ENDTASK\n900 OL[16]=ON\nRETURN\n");
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_EQ(ran.outcome.place.step, 7);
  EXPECT_FALSE(ran.Told("OL[16] 1"));
}

// OPT-7.01, OPT-7.04: GO ends the program, and with it the WORK that it has waiting in the
// background, whatever program that was of.
TEST(NextToEachOther, AWaitingWorkEndsWithGo) {
  const std::string waits = "WORK 0,0/ON/START (IL[20])/NEXT\n";
  const std::map<int, std::string> others = {{45, "DELAY 5\n"}, {46, "GO 45\n"}};
  for (const std::string leave : {"GO 45\n", "CALL 46\n"}) {
    const Ran ran =
        RunText(waits + leave + "WORK 0,0/OFF\n",
                {.programs = others, .inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
    EXPECT_EQ(CodeOf(ran), 0) << leave;
    EXPECT_FALSE(ran.Told("beam on 100.0")) << leave;
    EXPECT_NEAR(ran.time_s, 5.0, 1e-9) << leave;
  }
}

// OPT-4.23, OPT-7.70: in REPEAT a program of nothing takes its turn with each cycle, also behind
// one that carried something out.
TEST(NextToEachOther, NothingIsRepeatedBehindSomething) {
  RunOptions options{.programs = {{45, "; nothing\n"}}, .mode = machine::Mode::kRepeat};
  options.variables = {"VI[98]", "VI[2]"};
  options.budget.virtual_time = At(0.5);
  options.slice = At(1.0);
  const Ran ran = RunText("VI[2]=1\nVI[2]=2\nGO 45\n", options);
  EXPECT_EQ(CodeOf(ran), 7902);
  // One for each of the 11 cycles from 0 to 0.480 s, and those that are begun before one is over.
  EXPECT_GE(std::stoi(ran.variables.at("VI[98]")), 11);
  EXPECT_LE(std::stoi(ran.variables.at("VI[98]")), 14);
  EXPECT_EQ(ran.steps, 3U);
}

// motion.md 3.6, OPT-B.18: a circle of one point without /FLY is a target like any other: the
// passage before it ends there.
TEST(NextToEachOther, ACircleOfOnePointEndsAChain) {
  const motion::MachinePoint corner{1100.0, 1000.0, -400.0};
  const std::string to = kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n";
  const std::string on = "MOVE (1100.,1100.,-400.,0.,0.)\n";
  EXPECT_GT(RunText(to + on).DistanceTo(corner), 0.01);
  const Ran ran = RunText(
      to + "PATH CIR\nMOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-400.,0.,0.)\nPATH LIN\n" +
      on);
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_LT(ran.DistanceTo(corner), 1e-6);
}

// OPT-B.57: the handler of a program goes on in the program, and not in the FUNCTION that failed.
TEST(NextToEachOther, AHandlerLeavesTheFunctionThatFailed) {
  const Ran ran = RunText("ERR 900\nFUNCTION 44\nENDTASK\n900 VI[2]=VI[2]+1\nFUNCTION 46\n",
                          {.programs = {{44, "FUNCTION 45\nVI[3]=7\nRETURN\n"},
                                        {45, "VR[0]=1./VR[9]\nVI[4]=7\nRETURN\n"},
                                        {46, "VI[5]=VI[5]+1\nRETURN\n"}},
                           .variables = {"VI[2]", "VI[3]", "VI[4]", "VI[5]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[2]") + ran.variables.at("VI[3]") + ran.variables.at("VI[4]") +
                ran.variables.at("VI[5]"),
            "1001");
}

// OPT-7.05: a slot that is known and holds nothing has no program, as one that nobody knows.
TEST(NextToEachOther, ASlotThatHoldsNothing) {
  for (const bool known : {true, false}) {
    machine::RunSetup setup = SetupOf("VI[2]=1\nCALL 45\n");
    if (known) setup.programs[45] = {.name = "nothing"};
    machine::RunObserver nobody;
    const auto run = *OptimoFamily().NewRun(std::move(setup), nobody);
    EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kFinished);
    EXPECT_EQ(run->outcome().code, ErrorCode::kProgramMissing);
    EXPECT_EQ(std::string(run->outcome().detail), "program 45");
  }
}

// OPT-B.55, OPT-3.38: a pierce in the background whose time is over on the way to an error that the
// program has run ahead to: the machine comes to its target all the same.
TEST(NextToEachOther, APierceOnTheWayToAnError) {
  const std::string text = kThere +
                           "WORKDEF 1,1 (10.,60.,1.5,95.)\nWORK 1,1/ON/NEXT\n"
                           "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nVR[0]=1./VR[9]\n"
                           "MOVE (1100.,1100.,-400.,0.,0.)\n";
  const Ran ran = RunText(text);
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_EQ(ran.outcome.place.step, 8);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1100.0, 1e-6);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::next_to_each_other
