// Keys that come right behind another one, runs that are ended from outside, and what is seen of a
// run before it is over.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, Z0 20 mm below the top, the tool up 5 mm above it, 200 mm/s2; travel at
// 60 mm/s, all else at 2 mm/s.
namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::OutcomeKind;
using machine::RunPhase;
using namespace std::chrono_literals;

std::ptrdiff_t HaltsOf(const TestRun& run) {
  return std::ranges::count_if(run.seen().Events(),
                               [](const std::string& event) { return event.starts_with("halt "); });
}

// run.h: START takes a STOP back that has not halted the run yet. The clock of a dwell then goes on
// as if nobody had stopped it: 1 s of it, and 20 mm down at 2 mm/s.
TEST(EndedRuns, AStopOfADwellThatIsTakenBackAtOnce) {
  TestRun run(ParametersOf("t1"), "!MC0;W1000;PD;");
  run->Advance(400ms);
  run.Press(InputKind::kStop);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(HaltsOf(run), 0);
  EXPECT_NEAR(run.time_s(), 1.0 + 20.0 / 2.0 + 2.0 / 200.0, 1e-8);
  EXPECT_NEAR(run.figures().at("dwell_time"), 1.0, 1e-9);
}

// START alone waits for what may yet halt at its instant: a HOLD of the first instant halts before
// anything is read.
TEST(EndedRuns, AHoldOfTheFirstInstant) {
  TestRun run(ParametersOf("t1"), "!MC0;PU1000,0;", {{.at = 0s, .kind = InputKind::kHold}});
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run->state().time, SimTime::zero());
  EXPECT_EQ(run.seen().Events(), std::vector<std::string>{"halt HOLD"});
}

// motion.md 6: STOP counts before HOLD, whichever key comes first. 15 mm down take 7.51 s; at 8 s
// 9 mm to speed and 0.19 s at 60 mm/s lie behind the tool, and 9 mm of braking before it.
TEST(EndedRuns, AStopCountsBeforeAHold) {
  using Keys = std::pair<InputKind, InputKind>;
  for (const auto& [first, second] :
       {Keys{InputKind::kStop, InputKind::kHold}, Keys{InputKind::kHold, InputKind::kStop}}) {
    TestRun run(ParametersOf("t1"), "!MC0;PU6000,0;");
    run->Advance(8s);
    run.Press(first);
    run.Press(second);
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
    EXPECT_EQ(run.seen().Events().back(), "halt STOP");
    EXPECT_EQ(run->state().halted_by, machine::HaltReason::kStop);
    EXPECT_NEAR(run->state().tip.tip.x(), 9.0 + 0.19 * 60.0 + 9.0, 1e-5);
  }
}

// Who ends a run in a wait ends the wait: it lasted as long as that.
TEST(EndedRuns, AWaitEndsWithItsRun) {
  for (const bool emergency : {false, true}) {
    TestRun run(ParametersOf("t1"), "!MC0;W1000;PD;");
    run->Advance(400ms);
    if (emergency) {
      run.Press(InputKind::kEmergencyStop);
      EXPECT_EQ(run->outcome().detail, "emergency stop");
    } else {
      run->End(OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
    }
    EXPECT_EQ(run.seen().Events().back(), "dwell 0.4");
    EXPECT_NEAR(run.figures().at("dwell_time"), 0.4, 1e-9);
  }
}

// What is over stands, and no key changes it any more.
TEST(EndedRuns, AToolThatWasFrozenHasNoSpeed) {
  TestRun run(ParametersOf("t1"), "!MC0;PU6000,0;");
  run->Advance(8s);
  EXPECT_NEAR(run->state().tip_speed_mm_s, 60.0, 1e-6);
  run.Press(InputKind::kEmergencyStop);
  EXPECT_EQ(run->state().tip_speed_mm_s, 0.0);
  const machine::RunState frozen = run->state();
  run.Press(InputKind::kOverride, 50.0);
  run->Stand(100s);
  EXPECT_EQ(run->state().override_percent, 100.0);
  EXPECT_EQ(run->state().time, frozen.time);
  EXPECT_EQ(run->state().tip, frozen.tip);
}

// LIVE-3.01: a run that fails because no time goes by stops its spindle as any other end does.
TEST(EndedRuns, TooManyCommandsStopTheSpindle) {
  machine::RunSetup setup = SetupOf(ParametersOf("t1"), "!MC1;PU100,0;VS1;VS2;VS3;VS4;VS5;");
  setup.budget.steps_at_one_instant = 3;
  TestRun run(std::move(setup));
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kFailed);
  EXPECT_EQ(run.seen().Events().back(), "stop");
  EXPECT_FALSE(run->state().spindle_on);
}

// figures.h: how a stream ends is known of a run that has got there, and of no other one. 21 mm
// down at 10 mm/s, and 5 mm across.
TEST(EndedRuns, HowItEndsIsKnownAtItsEnd) {
  const auto expect_unknown = [](const TestRun& run) {
    const Figures figures = run.figures();
    for (const char* name :
         {"depth_at_end", "spindle_on_at_end", "incomplete_at_end", "nothing_cut"})
      EXPECT_FALSE(figures.contains(name)) << name;
  };
  TestRun run(ParametersOf("t1"), "!MC0;V10;Z0,0,-100;Z500,0,-100;");
  run->Advance(1s);
  expect_unknown(run);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.figures().at("depth_at_end"), 1.0, 1e-9);
  EXPECT_EQ(run.figures().at("nothing_cut"), 0.0);
  TestRun cut_short(ParametersOf("t1"), "!MC0;V10;Z0,0,-100;Z500,0,-100;");
  cut_short->Advance(1s);
  cut_short->End(OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
  expect_unknown(cut_short);
}

// run.h: what a run leaves that is cut short has its spindle off; behind its end it may turn.
TEST(EndedRuns, ASpindleIsLeftOnAtTheEndAlone) {
  TestRun run(ParametersOf("t1"), "!MC1;PD1000,0;");
  run->Advance(11s);
  ASSERT_TRUE(run->state().spindle_on);
  EXPECT_NE(run->SaveMachine().find("\nspindle_on 0\n"), std::string::npos);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NE(run->SaveMachine().find("\nspindle_on 1\n"), std::string::npos);
}

// LIVE-2.13: VIEW has taken the tool away: there it stands, and is left, and who goes on goes on
// where it was halted. A millionth of a mm is no way.
TEST(EndedRuns, AToolThatIsAwayStandsThere) {
  const motion::AxisPose away{.column = {50.0, 60.0, 0.0}, .a_rad = 0.0, .b_rad = 0.0};
  TestRun run(ParametersOf("t1"), "!MC0;PU1000,500;!NR;PU2000,500;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run->MoveTo(away);
  EXPECT_NEAR((run->state().tip.tip - away.column).norm(), 0.0, 1e-9);
  EXPECT_EQ(run.variable("X"), "5000");
  EXPECT_NE(run->SaveMachine().find("\nx 5000\ny 6000\nz 0\n"), std::string::npos)
      << run->SaveMachine();
  run->MoveTo({.column = {10.0 + 1e-7, 5.0, -15.0}, .a_rad = 0.0, .b_rad = 0.0});
  EXPECT_EQ(run.variable("X"), "1000");
  EXPECT_NE(run->SaveMachine().find("\nx 1000\ny 500\nz -1500\n"), std::string::npos);
  run->MoveTo({.column = {10.0 + 1e-5, 5.0, -15.0}, .a_rad = 0.0, .b_rad = 0.0});
  EXPECT_EQ(run.variable("X"), "1000.001");
  run->MoveTo(away);
  run.Press(InputKind::kStart);
  EXPECT_EQ(run.variable("X"), "1000");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.variable("X"), "2000");

  TestRun ended(ParametersOf("t1"), "!MC0;PU1000,500;!NR;PU2000,500;");
  ASSERT_EQ(ended.AdvanceToEnd(), RunPhase::kHalted);
  ended->MoveTo(away);
  ended->End(OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
  EXPECT_NEAR((ended->state().tip.tip - away.column).norm(), 0.0, 1e-9);
  EXPECT_NE(ended->SaveMachine().find("\nx 5000\ny 6000\nz 0\n"), std::string::npos);
}

// RML1-3D.29: a turn to the left is stopped and goes on as one to the right: 9 degrees to 60
// degrees a second, 36 more, and 9 of braking.
TEST(EndedRuns, ATurnToTheLeftIsStopped) {
  machine::Parameters parameters = ParametersOf("t1a");
  ASSERT_TRUE(parameters.Set("A_SENSE", std::string_view("LEFT")).ok());
  TestRun run(parameters, "!MC0;!ZE A90;");
  run->Advance(900ms);
  run.Press(InputKind::kStop);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run->state().tip.a_rad, -54.0 * kRadPerDegree, 1e-6);
  EXPECT_NEAR(std::stod(run.variable("A")), 54.0, 1e-4);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.variable("A"), "90");
  EXPECT_NEAR(run.time_s(), 0.9 + 0.3 + 36.0 / 60.0 + 0.3, 1e-6);
}

// run.h: time goes by for a run that is halted, forwards, and for no other one.
TEST(EndedRuns, TimeGoesByInAHalt) {
  TestRun run(ParametersOf("t1"), "!MC0;!NR;PU;");
  run->Stand(9s);
  EXPECT_EQ(run->state().time, SimTime::zero());
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run->Stand(3s);
  run->Stand(1s);
  EXPECT_EQ(run->state().time, SimTime(3s));
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), 3.0 + 15.0 / 2.0 + 2.0 / 200.0, 1e-8);
  EXPECT_NEAR(run.figures().at("halted_time"), 3.0, 1e-9);
}

// A mill knows SINGLE, and any other mode ends it.
TEST(EndedRuns, ModesOnTheWay) {
  TestRun run(ParametersOf("t1"), "VS1;VS2;VS3;VS4;");
  run->SetMode(machine::Mode::kSingle);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run->state().place.step, 1);
  EXPECT_EQ(run->state().halted_by, machine::HaltReason::kSingle);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run->state().place.step, 2);
  run->SetMode(machine::Mode::kCycle);
  run.Press(InputKind::kStart);
  EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
}

// What comes beside steps and motions, of the program in slot 7.
class ToldBeside final : public machine::RunObserver {
 public:
  void OnDiagnostic(SimTime, const Diagnostic&) override { ++diagnostics; }
  void OnCounted(SimTime, const Diagnostic& finding) override { counted.push_back(finding); }
  void OnLost(const machine::LostWay& way) override { lost.push_back(way); }

  int diagnostics = 0;
  std::vector<Diagnostic> counted;
  std::vector<machine::LostWay> lost;
};

void RunInSlotSeven(const std::string& stream, ToldBeside& told) {
  machine::RunSetup setup = SetupOf(ParametersOf("t1"), stream);
  setup.programs[7] = setup.programs[1];
  setup.programs.erase(1);
  setup.main_program = 7;
  const auto run = Rml1Family().NewRun(std::move(setup), told).value();
  while (run->Advance(kForever) == RunPhase::kRunning) {
  }
  EXPECT_EQ(run->state().phase, RunPhase::kFinished);
}

// RML1-9.06: advice of one kind is told a thousand times; what is more of it is counted, by its
// code and its place.
TEST(EndedRuns, WhatARunCountsHasItsPlace) {
  std::string stream;
  for (int n = 0; n < 1003; ++n) stream += "F99;";
  ToldBeside told;
  RunInSlotSeven(stream, told);
  EXPECT_EQ(told.diagnostics, 1000);
  ASSERT_EQ(told.counted.size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) {
    const Diagnostic& one = told.counted[n];
    EXPECT_EQ(one.code, ErrorCode::kRml1SpeedClamped);
    EXPECT_EQ(one.severity, Lookup(one.code).severity);
    EXPECT_EQ(one.program, 7);
    EXPECT_EQ(one.step, static_cast<int>(1001 + n));
    EXPECT_EQ(one.where.byte_offset, static_cast<std::int64_t>(4 * (1000 + n)));
  }
}

// RML1-5A.01: what the travel of 200 mm cuts off, in mm of the machine, by the command that lost
// it.
TEST(EndedRuns, WhatARunLosesHasItsPlace) {
  ToldBeside told;
  RunInSlotSeven("!MC0;PU19000,100;PD21000,100;", told);
  ASSERT_EQ(told.lost.size(), 1U);
  EXPECT_EQ(told.lost[0].place.program, 7);
  EXPECT_EQ(told.lost[0].place.step, 3);
  EXPECT_NEAR((told.lost[0].from - motion::MachinePoint(200.0, 1.0, -20.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((told.lost[0].to - motion::MachinePoint(210.0, 1.0, -20.0)).norm(), 0.0, 1e-6);
}

// LIVE-2.13: exactly a millionth of a mm is no way yet, and twice as much is one.
TEST(EndedRuns, AMillionthOfAMillimetreIsNoWay) {
  TestRun run(ParametersOf("t1"), "!MC0;!NR;PU100,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run->MoveTo({.column = {1e-6, 0.0, 0.0}, .a_rad = 0.0, .b_rad = 0.0});
  EXPECT_EQ(run.variable("X"), "0");
  run->MoveTo({.column = {2e-6, 0.0, 0.0}, .a_rad = 0.0, .b_rad = 0.0});
  EXPECT_NE(run.variable("X"), "0");
}

// motion.md 6: STOP 0.01 s before the end of a motion ends where that one ends; START takes it back
// before, so that nothing halts, and the next motion begins at once: 15 mm down, 60 mm across and 5
// mm down.
TEST(EndedRuns, AStopInTheLastRampThatIsTakenBack) {
  TestRun run(ParametersOf("t1"), "!MC0;PU6000,0;!RC15;PD;");
  const double across = 15.0 / 2.0 + 2.0 / 200.0 + 60.0 / 60.0 + 60.0 / 200.0;
  run->Advance(FromSeconds(across - 0.01));
  run.Press(InputKind::kStop);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(HaltsOf(run), 0);
  EXPECT_EQ(run.seen().moves().size(), 3U);
  EXPECT_NEAR(run.time_s(), across + 5.0 / 2.0 + 2.0 / 200.0, 1e-6);
}

// A budget that ends at the very instant at which a motion would begin: of that one nothing is
// told.
TEST(EndedRuns, AMotionThatHasNotBegunIsNotTold) {
  machine::RunSetup setup = SetupOf(ParametersOf("t1"), "!MC0;W250;PD;");
  setup.budget.virtual_time = 250ms;
  TestRun run(std::move(setup));
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kBudgetExceeded);
  EXPECT_EQ(run->state().time, SimTime(250ms));
  EXPECT_TRUE(run.seen().motions().empty());
  EXPECT_EQ(run.figures().at("motions"), 0.0);
  EXPECT_NEAR(run.figures().at("dwell_time"), 0.25, 1e-9);
}

// The tool has been where it was stopped, and no further: 15 mm down, and 21 of 60 mm across.
TEST(EndedRuns, ABoxEndsWhereTheToolWasStopped) {
  for (const bool emergency : {true, false}) {
    TestRun run(ParametersOf("t1"), "!MC0;PU6000,0;");
    run->Advance(FromSeconds(15.0 / 2.0 + 2.0 / 200.0 + 0.5));
    if (emergency) {
      run.Press(InputKind::kEmergencyStop);
    } else {
      run->End(OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
    }
    EXPECT_NEAR(run->state().tip.tip.x(), 21.0, 1e-6);
    EXPECT_NEAR(run.figures().at("box.xmax"), 2100.0, 1e-3);
    EXPECT_NEAR(run.figures().at("box_mm.xmax"), 21.0, 1e-5);
  }
}

// motion.md 6: another override while the tool brakes for a STOP counts from START on: the ramp
// stays what it is, in one part.
TEST(EndedRuns, AnOverrideInTheRampOfAStopWaits) {
  const auto stopped = [](TestRun& run, bool overridden) {
    run->Advance(11s);  // 20 mm down take some 10 s, 20 mm across 2 s
    run.Press(InputKind::kStop);
    run->Advance(11s + 20ms);  // of 50 ms
    if (overridden) run.Press(InputKind::kOverride, 50.0);
    return run.AdvanceToEnd();
  };
  const std::string stream = "!MC0;VS10;PD2000,0;";
  TestRun plain(ParametersOf("t1"), stream);
  ASSERT_EQ(stopped(plain, false), RunPhase::kHalted);
  TestRun run(ParametersOf("t1"), stream);
  ASSERT_EQ(stopped(run, true), RunPhase::kHalted);
  EXPECT_EQ(run.seen().text(), plain.seen().text());
  EXPECT_EQ(run.seen().motions().size(), plain.seen().motions().size());
  EXPECT_EQ(run->state().tip, plain->state().tip);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.seen().moves().back().feed_mm_s, 5.0);
}

}  // namespace
}  // namespace rmlcell::rml1
