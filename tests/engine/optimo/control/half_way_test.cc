// What is so on the way, and no more at the end: axes without reference until all are at their
// zero, what goes on beside a step, keys and modes where nothing is under way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/machine/step_entry.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::half_way {
namespace {

using machine::InputKind;
using machine::RunPhase;
using ::testing::ElementsAre;

// Of a run that halts before this step of program 1.
machine::StepFacts FactsBefore(const std::string& text, int step) {
  const auto run = RunOfText(text);
  EXPECT_TRUE(run->enterable()->HaltBefore({.at = {1, step}}).ok());
  EXPECT_EQ(run->Advance(At(100.0)), RunPhase::kHalted) << text;
  return run->enterable()->reached().value_or(machine::StepFacts{});
}

// LIVE-6.04: what of /NEXT goes on beside a step: a WORK that waits or dwells, a MOVE, also one
// that can never move (OPT-B.22). A WORK that is ON until its /END is none of these.
TEST(HalfWay, WhatGoesOnBesideAStep) {
  const auto beside = [](const std::string& text, int step) {
    return FactsBefore(text, step).beside;
  };
  EXPECT_TRUE(beside("WORK 0,0/ON/START (IL[20])/NEXT\nVI[2]=1\n", 2));
  EXPECT_TRUE(beside("WORKDEF 1,0 (10.,60.,5.,95.)\nWORK 1,0/ON/NEXT\nVI[2]=1\n", 3));
  EXPECT_TRUE(beside(kAbsol +
                         "SPEED 0\nMOVE (1100.,1000.,-400.,0.,0.)/TIME (5.,900)/NEXT\nVI[2]=1\n"
                         "ENDTASK\n900 RETURN\n",
                     5));
  EXPECT_FALSE(beside(kThere + "VI[2]=1\n", 5));
  const machine::StepFacts moves =
      FactsBefore(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/NEXT\nVI[2]=1\n", 6);
  EXPECT_TRUE(moves.beside);
  EXPECT_FALSE(moves.stands);
  const machine::StepFacts on = FactsBefore("WORK 0,0/ON/END (IL[20])\nVI[2]=1\n", 2);
  EXPECT_FALSE(on.beside);
  EXPECT_TRUE(on.work_active);
}

// OPT-4.48, OPT-4.49: the axes have their reference when the last of them, X and Y, have found it:
// not with that of Z, and not where the procedure is broken off before.
TEST(HalfWay, ZeroIsNoReferenceBeforeXAndY) {
  MachineState cold = NewMachine(Resolve(machine::Parameters(OptimoParameterTable())));
  cold.zeroed = false;
  const RunOptions options{.machine_state = EncodeMachineState(cold)};
  const auto run = RunOfText("ZERO\n", options);
  EXPECT_EQ(run->Advance(At(10.0)), RunPhase::kRunning);
  EXPECT_NEAR(run->state().axes.column.z(), 0.0, 1e-9);
  EXPECT_GT(run->state().axes.column.y(), 1000.0);  // of 2201.2 mm, at 50 mm/s
  EXPECT_FALSE(run->state().zeroed);
  run->End(machine::OutcomeKind::kCancelled, ErrorCode::kCancelled);
  const Result<MachineState> kept = DecodeMachineState(run->SaveMachine());
  ASSERT_TRUE(kept);
  EXPECT_FALSE(kept->zeroed);
  const auto whole = RunOfText("ZERO\n", options);
  EXPECT_EQ(whole->Advance(At(600.0)), RunPhase::kFinished);
  EXPECT_TRUE(whole->state().zeroed);
}

// OPT-3.51, OPT-4.18: a run that is halted between two instructions is not halted once more by
// STOP, nor by the door: the operator is waited for from its first halt on.
TEST(HalfWay, AHaltIsNotHaltedAgain) {
  for (const InputKind key : {InputKind::kStop, InputKind::kDoor}) {
    const Ran ran = RunText("PAUSE\nDELAY 1\n", {.inputs = {{At(1.0), key, 0, 1.0},
                                                            {At(2.0), InputKind::kDoor, 0, 0.0},
                                                            {At(3.0), InputKind::kStart}}});
    EXPECT_THAT(ran.told,
                ElementsAre("compiling 1", "halt PAUSE", "wait operator 3.0", "wait dwell 1.0"));
  }
}

// OPT-B.59, OPT-2.49: the moves of a /FLY chain are finished before the GOSUB of a timer that is
// due on the way: no passage is lost for it, and what it switches comes behind the last target.
TEST(HalfWay, ATimerWaitsForTheEndOfAChain) {
  const Ran ran = RunText(kThere +
                          "TIMER (1.,900)\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
                          "MOVE (1100.,1100.,-400.,0.,0.)/FLY\nMOVE (1200.,1100.,-400.,0.,0.)/FLY\n"
                          "MOVE (1200.,1200.,-400.,0.,0.)/FLY\nMOVE (1300.,1200.,-400.,0.,0.)\n"
                          "ENDTASK\n900 OL[16]=ON\nRETURN\n");
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.Count("E7304"), 0);
  EXPECT_GT(ran.DistanceTo({1100.0, 1100.0, -400.0}), 0.01);
  ASSERT_EQ(ran.moves.size(), 6U);
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, ToSeconds(ran.moves.back().at), 1e-9);
}

// OPT-2.16: an axis holds an arc back as it does a line: at the top of this half circle X alone
// moves, with 60 of 100 mm/s.
TEST(HalfWay, AnAxisThatHoldsAnArcBackIsTold) {
  const Ran ran = RunText(kThere +
                              "SPEED 20\nPATH CIR\n"
                              "MOVE (1200.,1000.,-400.,0.,0.)/VIA (1100.,1100.,-400.,0.,0.)\n",
                          {.parameters = {{"AXIS_SPEED_X", "60"}}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(std::ranges::count_if(ran.findings,
                                  [](const Diagnostic& one) {
                                    return one.code == ErrorCode::kSpeedHeldByAxis && one.step == 7;
                                  }),
            1);
}

// OPT-6.31: SINGLE that is chosen while the run is halted between two instructions is for the next
// one: that is carried out first.
TEST(HalfWay, SingleIsChosenBetweenTwoSteps) {
  const auto run = RunOfText("PAUSE\nVI[1]=1\nVI[2]=1\n");
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kHalted);
  run->SetMode(machine::Mode::kSingle);
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(2.0)), RunPhase::kHalted);
  EXPECT_EQ(run->state().halted_by, machine::HaltReason::kSingle);
  EXPECT_EQ(run->ReadVariable("VI[1]")->text, "1");
  EXPECT_EQ(run->ReadVariable("VI[2]")->text, "0");
}

// OPT-6.31: chosen while a WAIT waits it halts behind that WAIT, and once: one START leads to the
// end of the next step.
TEST(HalfWay, SingleIsChosenWhileAWaitWaits) {
  const auto run = RunOfText("WAIT IL[20]\nVI[1]=1\nVI[2]=1\n");
  EXPECT_EQ(run->Advance(At(0.5)), RunPhase::kRunning);
  run->SetMode(machine::Mode::kSingle);
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kRunning);
  run->Apply({.kind = InputKind::kLogical, .index = 20, .value = 1.0});
  EXPECT_EQ(run->Advance(At(2.0)), RunPhase::kHalted);
  EXPECT_EQ(run->steps_executed(), 1U);
  EXPECT_EQ(run->ReadVariable("VI[1]")->text, "0");
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(3.0)), RunPhase::kHalted);
  EXPECT_EQ(run->ReadVariable("VI[1]")->text, "1");
  EXPECT_EQ(run->ReadVariable("VI[2]")->text, "0");
}

}  // namespace
}  // namespace rmlcell::optimo::testing::half_way
