// Steps and instants that come together: a key or an input at the very instant that is gone to,
// what goes on in the background while a program waits, and how many steps those were.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/machine/step_entry.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::steps_and_instants {
namespace {

using machine::InputKind;
using machine::RunPhase;

constexpr double kCycle_s = 0.048;

double RampTime(double change_mm_s) { return 2.0 * std::sqrt(change_mm_s / 40000.0); }

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// run.h: Advance goes on to its instant, also where nothing can happen any more.
TEST(StepsAndInstants, TimeGoesOnWhereNothingIsToCome) {
  const auto run = RunOfText("WAIT (IL[20])\n");
  EXPECT_EQ(run->Advance(At(5.0)), RunPhase::kRunning);
  EXPECT_EQ(run->state().time, At(5.0));
}

// run.h: what happens at the instant that Advance goes on to has happened, a scripted START, too.
TEST(StepsAndInstants, AScriptedStartAtTheInstantThatIsGoneTo) {
  const auto run = RunOfText("STOP\nVI[2]=1\n", {.inputs = {{At(5.0), InputKind::kStart}}});
  EXPECT_EQ(run->Advance(At(5.0) - SimTime(1)), RunPhase::kHalted);
  EXPECT_EQ(run->ReadVariable("VI[2]")->text, "0");
  EXPECT_EQ(run->Advance(At(5.0)), RunPhase::kFinished);
  EXPECT_EQ(run->ReadVariable("VI[2]")->text, "1");
  EXPECT_EQ(run->state().time, At(5.0));
}

// OPT-B.30: an input that changes at a tick is what is sampled at that tick.
TEST(StepsAndInstants, AnInputAtATick) {
  const double tick = 21.0 * kCycle_s;
  const Ran ran = RunText("WORK 0,0/ON/END (IL[20])\nDELAY 5\n",
                          {.inputs = {{At(tick), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.First("beam off").at_s, tick, 1e-9);
}

// OPT-B.30: the ticks of a WORK are counted from the WORK on: 11 of them behind 0.01 s.
TEST(StepsAndInstants, TicksOfAWorkBeginWithIt) {
  const Ran ran = RunText("DELAY .01\nWORK 0,0/ON/END (IL[20])\nDELAY 5\n",
                          {.inputs = {{At(0.5), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.First("beam off").at_s, 0.01 + 11.0 * kCycle_s, 1e-9);
}

// OPT-7.68, OPT-B.30: that the machine has come to rest is seen at the next tick, also where
// nothing settles and nothing else happens.
TEST(StepsAndInstants, AnArrivalIsSeenAtTheNextTick) {
  const std::string text = kThere +
                           "WORK 0,0/ON/END (IL[95] = OFF)\nMOVE (1100.,1000.,-400.,0.,0.)/NEXT\n"
                           "DELAY 9\n";
  const Ran ran = RunText(text, {.parameters = {{"SETTLE", "0"}}});
  const double begin = ToSeconds(ran.moves.front().at);
  const double moved = 2.0 + RampTime(50.0);
  EXPECT_NEAR(ran.First("beam off").at_s, begin + std::ceil(moved / kCycle_s) * kCycle_s, 1e-6);
}

// OPT-B.30: what the program sets right before it waits is seen in the background at the next tick.
TEST(StepsAndInstants, WhatIsSetBeforeAWaitIsSeen) {
  const Ran ran = RunText("WORK 0,0/ON/END (VL[1])\nDELAY 1\nVL[1]=ON\nWAIT (IL[20])\nDELAY 1\n",
                          {.inputs = {{At(3.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.First("beam off").at_s, 21.0 * kCycle_s, 1e-9);
}

// OPT-4.18, OPT-3.38: while STOP brings the machine to rest nothing begins, though its condition
// comes true meanwhile; it begins behind START.
TEST(StepsAndInstants, NothingBeginsWhileAStopBrakes) {
  const std::string text = kThere +
                           "WORK 0,0/ON/START (IL[20])/NEXT\nMOVE (1500.,1000.,-400.,0.,0.)\n"
                           "WORK 0,0/OFF\n";
  const double begin = BeginOf(text);
  const Ran ran = RunText(text, {.inputs = {{At(begin + 1.0), InputKind::kStop},
                                            {At(begin + 1.03), InputKind::kLogical, 20, 1.0},
                                            {At(begin + 5.0), InputKind::kStart}}});
  EXPECT_NEAR(ran.First("halt STOP").at_s, begin + 1.0 + RampTime(50.0), 1e-6);
  EXPECT_GE(ran.First("beam on 100.0").at_s, begin + 5.0 - 1e-9);
  EXPECT_LE(ran.First("beam on 100.0").at_s, begin + 5.0 + kCycle_s + 1e-9);
}

// Inputs beyond the last index act on the last one, those below the first on the first.
TEST(StepsAndInstants, InputsBeyondTheirEnds) {
  const Ran ran = RunText("DELAY 1\nVL[1]=IL[0]\nVL[2]=IL[99]\nVR[1]=IA[99]\n",
                          {.inputs = {{At(0.5), InputKind::kLogical, -5, 1.0},
                                      {At(0.5), InputKind::kLogical, 500, 1.0},
                                      {At(0.5), InputKind::kAnalogue, 500, 2.5}},
                           .variables = {"VL[1]", "VL[2]", "VR[1]"}});
  EXPECT_EQ(ran.variables.at("VL[1]") + ran.variables.at("VL[2]"), "11");
  EXPECT_EQ(ran.variables.at("VR[1]"), "2.5");
}

// OPT-4.07: the instruction that is shown is the one that was carried out last, here the 20,000th
// of a loop of two.
TEST(StepsAndInstants, TheInstructionOfALoopIsShown) {
  const auto run = RunOfText("10 VI[1]=VI[1]+1\nGOTO 10\n");
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kRunning);
  EXPECT_EQ(run->steps_executed(), 20'000U);
  EXPECT_EQ(run->state().instruction, "GOTO");
}

// OPT-2.49: outputs between two moves of a passage count among its instructions like all others.
TEST(StepsAndInstants, OutputsCountAmongTheInstructionsOfAPassage) {
  const auto run = [](int loops) {
    return RunText(kThere +
                   "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nVI[1]=0\n10 OL[16]=ON\nVI[1]=VI[1]+1\n"
                   "IF VI[1] < " +
                   std::to_string(loops) + " THEN 10\nMOVE (1100.,1100.,-400.,0.,0.)\n");
  };
  EXPECT_EQ(run(3332).Count("E7304"), 0);  // 9,998 with the MOVE
  const Ran more = run(3333);
  EXPECT_EQ(more.Count("E7304"), 1);
  EXPECT_EQ(more.Finding(7304).step, 10);
}

// OPT-2.48: a WORK of which something goes on in the background needs standstill.
TEST(StepsAndInstants, AWorkThatGoesOnNeedsStandstill) {
  for (const std::string how : {"/END (IL[20])", "/NEXT"}) {
    const Ran ran = RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nWORK 0,0/ON" + how +
                            "\nMOVE (1100.,1100.,-400.,0.,0.)\nWORK 0,0/OFF\n");
    EXPECT_EQ(ran.Count("E7304"), 1) << how;
    EXPECT_LT(ran.DistanceTo({1100.0, 1000.0, -400.0}), 1e-6) << how;
  }
}

// OPT-3.44, OPT-3.43: schedule 1 is one like any other, on each of the lasers.
TEST(StepsAndInstants, TheFirstSchedule) {
  EXPECT_TRUE(RunText("WORKDEF 2,1 (1)\nWORK 2,1/ON\nWORK 2,1/OFF\n").Told("schedule 1"));
  EXPECT_EQ(CodeOf(RunText("WORKDEF 1,1 (50.,50.,0.,50.,1)\nWORK 1,1/ON\n",
                           {.parameters = {{"LASER", "EFA51"}}})),
            7405);
}

// OPT-2.45: a COORD that fails behind a passage is an executed step like any other.
TEST(StepsAndInstants, ACoordThatFailsIsAnExecutedStep) {
  const Ran ran = RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nCOORD ROBOT\nDELAY 1\n");
  EXPECT_EQ(CodeOf(ran), Lookup(ErrorCode::kFlyBeforeCoord).number);
  EXPECT_EQ(ran.steps, 6U);
}

// LIVE-6.05: each motion of the way to a step is looked at from where the one before it ends: from
// a machine that stands 400 mm outside only those are outside that begin there.
TEST(StepsAndInstants, EachMotionOfAnApproachIsLookedAt) {
  const auto run = RunOfText(kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nVI[2]=1\n");
  machine::EnterableRun& entered = *run->enterable();
  ASSERT_TRUE(entered.HaltBefore({.at = {1, 4}}).ok());
  ASSERT_EQ(run->Advance(At(1000.0)), RunPhase::kHalted);
  MachineState stands = NewMachine(Resolve(machine::Parameters(OptimoFamily().parameters())));
  stands.axes.column = {4000.0, 1000.0, -300.0};
  const std::vector<machine::ApproachMotion> way =
      entered.PlanApproach(EncodeMachineState(stands), machine::ApproachWay::kSafe);
  ASSERT_EQ(way.size(), 3U);
  for (const std::size_t n : {0U, 1U}) {
    ASSERT_EQ(way[n].beyond.size(), 1U) << n;
    EXPECT_EQ(way[n].beyond[0].axis, 0) << n;
    EXPECT_NEAR(way[n].beyond[0].excess, 400.0, 1e-9) << n;
    EXPECT_EQ(way[n].beyond[0].at_target, n == 0) << n;
  }
  EXPECT_TRUE(way[2].beyond.empty());
  EXPECT_EQ(way[0].path, "PTP");
  EXPECT_EQ(way[1].path, "PTP");
  EXPECT_EQ(way[2].path, "LIN");
  EXPECT_EQ(way[0].feed_mm_s + way[1].feed_mm_s, 0.0);
  EXPECT_NEAR(way[2].feed_mm_s, 50.0, 1e-9);
}

// A program of this machine has steps, and no bytes that a run could come to.
TEST(StepsAndInstants, NoRunBeginsAtAByte) {
  for (const std::int64_t byte : {0, 7}) {
    const Status refused =
        RunOfText("DELAY 1\n")->enterable()->HaltBefore({.at = {1, 1}, .byte_offset = byte});
    ASSERT_FALSE(refused) << byte;
    EXPECT_EQ(refused.error().code, ErrorCode::kCellStepUnreachable) << byte;
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::steps_and_instants
