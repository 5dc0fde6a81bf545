// A motion under way and what is asked of it meanwhile: where the machine is, how fast it goes and
// may brake, what comes behind it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::under_way {
namespace {

using machine::InputKind;
using machine::RunPhase;

constexpr double kCycle_s = 0.048;

double RampTime(double change_mm_s) { return 2.0 * std::sqrt(change_mm_s / 40000.0); }

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

const std::string kOneMove = kThere + "MOVE (1100.,1000.,-400.,0.,0.)\n";

// What the program has set itself nobody assumes.
TEST(UnderWay, WhatIsSetIsNotAssumed) {
  class Watcher final : public machine::RunObserver {
   public:
    void OnAssumed(const machine::Assumed& one) override {
      names.push_back(std::string(one.group) + std::to_string(one.index));
    }
    std::vector<std::string> names;
  };
  Watcher watcher;
  const auto run = *OptimoFamily().NewRun(
      SetupOf("VR[1]=2.\nVR[2]=VR[1]*3.\nVI[3]=4\nVI[4]=VI[3]+1\nVL[5]=ON\nVL[6]=VL[5]\n"
              "VR[7]=VR[2]+VI[4]\nVR[8]=VR[9]\n"),
      watcher);
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kFinished);
  EXPECT_EQ(watcher.names, std::vector<std::string>{"VR9"});
}

// OPT-4.51: the axes look for their zero with a tenth of their speed, whatever the override is.
TEST(UnderWay, ZeroGoesWithATenthOfTheSpeed) {
  for (const double percent : {10.0, 100.0}) {
    const auto run = RunOfText(
        "COORD ROBOT\nMOVE (521.02,0.,0.,0.,0.)\nZERO\n",
        {.parameters = {{"VMAX", "200"}, {"HEAD_LENGTH", "400"}}, .override_percent = percent});
    while (run->state().place.step < 3 && run->state().time < At(300.0))
      run->Advance(run->state().time + At(0.01));
    run->Advance(run->state().time + At(2.0));
    EXPECT_NEAR(run->state().tip_speed_mm_s, 50.0, 1e-6) << percent;
    const machine::RunState state = run->state();
    EXPECT_NEAR(state.tip.tip.z(), state.axes.column.z() - 400.0, 1e-9);  // OPT-B.02
  }
}

// motion.md 6: whoever stops the run while it moves finds it standing.
TEST(UnderWay, AfterAnEmergencyStopNothingMoves) {
  const double begin = BeginOf(kOneMove);
  const auto run = RunOfText(kOneMove);
  run->Advance(At(begin + 1.0));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 50.0, 1e-6);
  const double x = run->state().tip.tip.x();
  run->Apply({.kind = InputKind::kEmergencyStop});
  EXPECT_EQ(run->state().phase, RunPhase::kFinished);
  EXPECT_EQ(run->state().tip_speed_mm_s, 0.0);
  EXPECT_NEAR(run->state().tip.tip.x(), x, 1e-9);
}

// OPT-4.17, OPT-4.18, OPT-4.37: at the instant of a key the machine is where it was, with the speed
// that it had: on one move, and in chains that are planned anew, of long moves and of short ones.
TEST(UnderWay, AKeyActsFromWhereTheMachineIs) {
  const std::string chain =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1200.,1000.,-400.,0.,0.)/FLY\n"
      "MOVE (1300.,1000.,-400.,0.,0.)\n";
  std::string short_moves = "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
  for (int k = 1; k <= 200; ++k)
    short_moves += "MOVE (" + std::to_string(1000 + k) + ".,1000.,-400.,0.,0.)/FLY\n";
  short_moves += "MOVE (1201.,1000.,-400.,0.,0.)\n";
  struct Row {
    std::string text;
    InputKind key;
    double value;
    double speed_mm_s;
  };
  for (const Row& row :
       {Row{kOneMove, InputKind::kStop, 1.0, 50.0}, Row{chain, InputKind::kStop, 1.0, 50.0},
        Row{chain, InputKind::kHold, 1.0, 50.0}, Row{chain, InputKind::kOverride, 130.0, 50.0},
        Row{chain, InputKind::kOverride, 55.0, 50.0},
        Row{short_moves, InputKind::kHold, 1.0, 200.0}}) {
    SCOPED_TRACE(row.text.substr(0, 99) + std::to_string(row.value));
    const auto run = RunOfText(row.text);
    run->Advance(At(BeginOf(row.text) + 0.5025));
    const motion::MachinePoint before = run->state().tip.tip;
    run->Apply({.kind = row.key, .value = row.value});
    const machine::RunState state = run->state();
    EXPECT_EQ(state.phase, RunPhase::kRunning);
    EXPECT_NEAR(state.tip_speed_mm_s, row.speed_mm_s, 1e-3);
    EXPECT_NEAR((state.tip.tip - before).norm(), 0.0, 1e-6);
  }
}

// OPT-B.89, motion.md 6: while a MOVE takes over from that of /NEXT the machine is still at the
// latter, which it brings to rest.
TEST(UnderWay, TheMotionThatIsTakenOverIsWhereItIs) {
  const std::string text = kThere +
                           "MOVE (1900.,1000.,-400.,0.,0.)/NEXT\nDELAY 1\n"
                           "MOVE (1100.,1100.,-400.,0.,0.)\n";
  const double begin = BeginOf(text);
  const double tick = std::ceil((begin + 1.0) / kCycle_s) * kCycle_s;
  for (const auto& [at, step] : {std::pair{begin + 0.5, 6}, std::pair{tick + 0.02, 5}}) {
    const Ran ran = RunText(text, {.inputs = {{At(at), InputKind::kEmergencyStop}}});
    EXPECT_EQ(ran.outcome.code, ErrorCode::kEmergencyStop);
    EXPECT_EQ(ran.outcome.place.step, step) << at;
  }
}

// OPT-B.30: a WAIT beside a motion is tested each cycle from its own begin.
TEST(UnderWay, AWaitCountsItsOwnCycles) {
  const std::string text = kThere +
                           "MOVE (1900.,1000.,-400.,0.,0.)/NEXT\nDELAY .01\nWAIT (IA[0] > 1050.)\n"
                           "OL[16]=ON\n";
  const double begin = BeginOf(text);
  const double waits = begin + 0.01;
  const double there = begin + 1.0 + 0.5 * RampTime(50.0);
  EXPECT_NEAR(RunText(text).First("OL[16] 1").at_s,
              waits + std::ceil((there - waits) / kCycle_s) * kCycle_s, 1e-6);
}

// OPT-4.17, OPT-2.48: a passage that an instruction has made a stop stays one when it is planned
// anew behind a HOLD: its move is ridden before that instruction.
TEST(UnderWay, ACancelledPassageBehindAHold) {
  const std::string text =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
      "DELAY 1\nOL[16]=ON\n";
  const double hold = BeginOf(text) + 1.0;
  const Ran ran = RunText(
      text, {.inputs = {{At(hold), InputKind::kHold}, {At(hold + 20.0), InputKind::kStart}}});
  EXPECT_EQ(ran.First("halt HOLD").step, 5);
  EXPECT_NEAR(ran.end.tip.tip.y(), 1100.0, 1e-6);
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, hold + 20.0 + 2.0 + RampTime(50.0) + kSettle_s + 1.0,
              1e-6);
}

// A breakpoint that is set while the machine stands on a chain, on a step that was read ahead,
// halts behind what is under way; also where an output was shown at a passage before.
TEST(UnderWay, WhatAPassageShowsMovesNoPlace) {
  const std::string text = kThere +
                           "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nOL[16]=ON\n"
                           "MOVE (1100.,1100.,-400.,0.,0.)/FLY\nMOVE (1200.,1100.,-400.,0.,0.)\n"
                           "DELAY 1\nDELAY 1\n";
  const double begin = BeginOf(text);
  const auto run = RunOfText(text);
  run->Advance(At(begin + 3.0));
  EXPECT_EQ(run->state().place.step, 7);
  run->Apply({.kind = InputKind::kStop});
  EXPECT_EQ(run->Advance(At(begin + 5.0)), RunPhase::kHalted);
  run->SetBreakpoints({{.at = {1, 8}}});
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(begin + 60.0)), RunPhase::kHalted);
  EXPECT_EQ(run->state().halted_by, machine::HaltReason::kBreakpoint);
  EXPECT_EQ(run->state().place.step, 8);
}

// OPT-4.18, OPT-4.38: a motion of the axes that goes on with another override stops with what the
// axes can do: from 350 or 175 mm/s by 2000 mm/s2, its jerk 40000 mm/s3.
TEST(UnderWay, AStopBehindAnotherOverride) {
  const std::string text = "COORD ROBOT\nMOVE (2021.02,2201.2,-50.,0.,0.)\nDELAY 1\n";
  for (const double percent : {100.0, 50.0}) {
    const Ran ran = RunText(text, {.inputs = {{At(0.4), InputKind::kOverride, 0, percent},
                                              {At(2.0), InputKind::kStop}}});
    const double speed = 3.5 * percent;  // SPEED 70
    EXPECT_NEAR(ran.First("halt STOP").at_s, 2.0 + speed / 2000.0 + 2000.0 / 40000.0, 1e-6)
        << percent;
  }
}

// OPT-4.38, OPT-2.34: a motion from point to point has the speed of its axes, not that of contours,
// also where the override changes on the way.
TEST(UnderWay, PointToPointKeepsTheSpeedOfItsAxes) {
  const auto run =
      RunOfText("COORD ABSOL\nPATH PTP\nSPEED 100\nMOVE (2521.02,2201.2,-350.,0.,0.)\n",
                {.parameters = {{"VMAX", "200"}}});
  run->Advance(At(1.0));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 500.0, 1e-6);
  run->Apply({.kind = InputKind::kOverride, .value = 50.0});
  run->Advance(At(2.0));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 250.0, 1e-6);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::under_way
