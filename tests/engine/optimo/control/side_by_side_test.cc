// What goes on beside something else, and must leave it alone: conditions in the background that
// change each other, inputs of one kind, a door that opens on the way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::side_by_side {
namespace {

using machine::InputKind;
using machine::RunPhase;

constexpr double kCycle_s = 0.048;

double TickBehind(double time_s) { return std::ceil(time_s / kCycle_s) * kCycle_s; }

// OPT-B.30, OPT-3.37: a process that is switched on in the background is seen at the next cycle by
// what waits for its flag there, whatever the program does meanwhile.
TEST(SideBySide, AProcessThatComesOnIsSeen) {
  const Ran ran = RunText(
      "WORKDEF 2,1 (11)\nWORK 2,1/ON/START (IL[87])/NEXT\nWORK 0,0/ON/START (IL[20])/NEXT\n"
      "DELAY 5\nWORK 0,0/OFF\nWORK 2,1/OFF\n",
      {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.First("beam on 100.0").at_s, 1.0, 1e-9);
  EXPECT_NEAR(ran.First("schedule 11").at_s, TickBehind(1.0), 1e-9);
}

// OPT-B.30, OPT-3.37: the same of one that goes off.
TEST(SideBySide, AProcessThatGoesOffIsSeen) {
  const Ran ran = RunText(
      "WORKDEF 2,1 (11)\nWORK 2,1/ON/START (VL[1] AND (IL[87] = OFF))/NEXT\n"
      "WORK 0,0/ON/END (IL[20])\nVL[1]=ON\nDELAY 5\nWORK 2,1/OFF\n",
      {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.First("beam off").at_s, TickBehind(1.0), 1e-9);
  EXPECT_NEAR(ran.First("schedule 11").at_s, TickBehind(1.0) + kCycle_s, 1e-9);
}

// LIVE-5.02, OPT-B.30: a variable that a person writes is seen by what waits in the background.
TEST(SideBySide, AWrittenVariableIsSeenInTheBackground) {
  const auto run = RunOfText("WORK 0,0/ON/END (VL[1])\nDELAY 5\nDELAY 1\n");
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kRunning);
  run->WriteVariable("VL[1]", 1.0);
  run->Advance(At(TickBehind(1.0)) - SimTime(1000));
  EXPECT_TRUE(run->state().beam_on);
  run->Advance(At(TickBehind(1.0)) + SimTime(1000));
  EXPECT_FALSE(run->state().beam_on);
}

// OPT-B.22: neither has an input that changes before anything to say where nothing moves.
TEST(SideBySide, AnInputDoesNotEndAStandstillOfYears) {
  constexpr double kYears_s = 3e8;
  const Ran ran = RunText(kAbsol +
                              "SPEED 0\nMOVE (1100.,1000.,-400.,0.,0.)/TIME (300000000.,900)"
                              "/END (IL[20])\nENDTASK\n900 VI[2]=1\nRETURN\n",
                          {.inputs = {{At(1.0), InputKind::kLogical, 21, 1.0}},
                           .variables = {"VI[2]"},
                           .budget = {.virtual_time = At(2.0 * kYears_s)},
                           .slice = At(2.0 * kYears_s)});
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_NEAR(ran.time_s, kYears_s, 1e-3);
}

// OPT-7.18: where the time of a MOVE runs out while the machine settles, its GOSUB is made, and its
// /END is over: an error of that condition at the same instant is none any more.
TEST(SideBySide, TheTimeComesBeforeTheCondition) {
  const auto text = [](const std::string& time) {
    return kThere + "MOVE (1100.,1000.,-400.,0.,0.)/TIME (" + time +
           ",900)/END (1./IA[20] > 2.)\nENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n";
  };
  const machine::InputChange one{SimTime(0), InputKind::kAnalogue, 20, 1.0};
  const Ran free = RunText(text("9."), {.inputs = {one}});
  ASSERT_EQ(CodeOf(free), 0);
  const double end = ToSeconds(free.moves[1].at);  // settled
  const double begin = ToSeconds(free.moves[0].at);
  const double cycles = std::floor((end - begin) / kCycle_s - 0.02);
  const double due = begin + cycles * kCycle_s;
  ASSERT_GT(due, end - kSettle_s);
  const Ran ran = RunText(
      text(std::to_string((cycles - 0.5) * kCycle_s)),
      {.inputs = {one, {At(due - 0.001), InputKind::kAnalogue, 20, 0.0}}, .variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
}

// OPT-4.14, OPT-7.96: behind an EMERGENCY STOP nothing is looked at any more, at no tick of that
// instant.
TEST(SideBySide, NothingIsTestedBehindAnEmergencyStop) {
  const Ran ran = RunText(kAbsol +
                              "SPEED 0\nMOVE (1100.,1000.,-400.,0.,0.)/TIME (9.,900)"
                              "/END (1./IA[20] > 2.)\nENDTASK\n900 RETURN\n",
                          {.inputs = {{SimTime(0), InputKind::kAnalogue, 20, 1.0},
                                      {At(10.0 * kCycle_s), InputKind::kAnalogue, 20, 0.0},
                                      {At(10.0 * kCycle_s), InputKind::kEmergencyStop}}});
  EXPECT_EQ(ran.outcome.code, ErrorCode::kEmergencyStop);
  EXPECT_TRUE(ran.findings.empty());
}

// OPT-7.96, OPT-7.98: inputs of a kind set those of their kind only.
TEST(SideBySide, InputsSetTheirOwnKind) {
  const Ran ran = RunText("DELAY 1\nVR[1]=IA[20]\nVR[2]=IA[30]\nVL[1]=IL[20]\nVL[2]=IL[30]\n",
                          {.inputs = {{At(0.5), InputKind::kLogical, 20, 1.0},
                                      {At(0.5), InputKind::kAnalogue, 30, 50.0}},
                           .variables = {"VR[1]", "VR[2]", "VL[1]", "VL[2]"}});
  EXPECT_EQ(ran.variables.at("VR[1]"), "0.0");
  EXPECT_EQ(ran.variables.at("VR[2]"), "50.0");
  EXPECT_EQ(ran.variables.at("VL[1]"), "1");
  EXPECT_EQ(ran.variables.at("VL[2]"), "0");
  EXPECT_EQ(ran.end.override_percent, 100.0);
  EXPECT_FALSE(ran.end.door_open);
}

// LIVE-3.05: each scripted key does its own thing, and nothing of the others.
TEST(SideBySide, KeysDoTheirOwnThing) {
  const auto run = RunOfText("DELAY 2\nDELAY 2\nDELAY 2\nDELAY 2\n");
  run->Advance(At(1.0));
  run->Apply({.kind = InputKind::kOverride, .value = 55.0});
  EXPECT_EQ(run->Advance(At(3.0)), RunPhase::kRunning);
  EXPECT_EQ(run->state().override_percent, 55.0);
  EXPECT_FALSE(run->state().door_open);
  run->Apply({.kind = InputKind::kStop, .value = 7.0, .name = "VI[5]"});
  EXPECT_EQ(run->ReadVariable("VI[5]")->text, "0");
  EXPECT_EQ(run->state().phase, RunPhase::kHalted);
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(5.0)), RunPhase::kRunning);
  run->Apply({.kind = InputKind::kHold, .value = 7.0, .name = "VI[5]"});
  EXPECT_EQ(run->state().phase, RunPhase::kRunning);
  EXPECT_EQ(run->Advance(At(9.0)), RunPhase::kHalted);
  EXPECT_EQ(run->state().time, At(6.0));
  EXPECT_EQ(run->state().halted_by, machine::HaltReason::kHold);
  EXPECT_EQ(run->ReadVariable("VI[5]")->text, "0");
}

// OPT-3.21: the machine waits with the peak power while it pierces.
TEST(SideBySide, APierceIsToldWithItsPeak) {
  const Ran ran = RunText("WORKDEF 1,1 (50.,60.,1.5,95.)\nWORK 1,1/ON\nDELAY 2\nWORK 1,1/OFF\n");
  ASSERT_GE(ran.waits.size(), 2U);
  EXPECT_EQ(ran.waits[0].kind, machine::WaitKind::kPierce);
  EXPECT_TRUE(ran.waits[0].beam_on);
  EXPECT_EQ(ran.waits[0].power_percent, 95.0);
  EXPECT_EQ(ran.waits[1].power_percent, 0.0);  // the ramp: nothing moves
}

// OPT-B.34, LIVE-3.10: a door that opens on the way is a STOP: a breakpoint that is set then on a
// step that the program has read ahead halts behind what is under way, as it does behind STOP.
TEST(SideBySide, TheDoorKeepsWhatWasReadAhead) {
  const std::string text =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
      "MOVE (1200.,1100.,-400.,0.,0.)\nDELAY 1\nDELAY 1\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  std::vector<std::pair<int, double>> halts;
  for (const InputKind key : {InputKind::kStop, InputKind::kDoor}) {
    const auto run = RunOfText(text);
    run->Advance(At(begin + 1.0));
    run->Apply({.kind = key, .value = 1.0});
    EXPECT_EQ(run->Advance(At(begin + 2.0)), RunPhase::kHalted);
    run->SetBreakpoints({{.at = {1, 7}}});
    run->Apply({.kind = InputKind::kDoor, .value = 0.0});
    run->Apply({.kind = InputKind::kStart});
    EXPECT_EQ(run->Advance(At(begin + 60.0)), RunPhase::kHalted);
    halts.emplace_back(run->state().place.step, ToSeconds(run->state().time));
    EXPECT_EQ(run->state().halted_by, machine::HaltReason::kBreakpoint);
  }
  EXPECT_EQ(halts[0].first, 7);
  EXPECT_EQ(halts[0], halts[1]);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::side_by_side
