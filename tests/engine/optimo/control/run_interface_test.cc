#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/machine/step_entry.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "tests/engine/optimo/control/run_text.h"

// What a run shows to those who drive it and watch it: state, lines of the source, what a comment
// lets pass, and how much work one call does.
namespace rmlcell::optimo::testing::run_interface {
namespace {

using machine::InputKind;
using machine::RunPhase;

// Steps 1 to 5.
const std::string kCutting =
    "COORD ABSOL\nPATH LIN\nSPEED 10\nWORK 0,0/ON\nMOVE (521.02,2201.2,-350.,0.,0.)\n";

std::unique_ptr<machine::Run> RunOf(machine::RunSetup setup, machine::RunObserver& observer) {
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(std::move(setup), observer);
  EXPECT_TRUE(bool(run));
  return run ? std::move(*run) : nullptr;
}

class Findings final : public machine::RunObserver {
 public:
  void OnDiagnostic(SimTime, const Diagnostic& finding) override { found.push_back(finding); }
  void OnStep(SimTime, const machine::Place& place, std::string_view) override {
    lines.push_back(place.line);
  }
  std::vector<Diagnostic> found;
  std::vector<int> lines;
};

// Run::Advance: what happens at the instant that it goes on to has happened.
TEST(RunInterface, AdvanceGoesOnToTheInstantItself) {
  machine::RunObserver nobody;
  const std::unique_ptr<machine::Run> run = RunOf(SetupOf("DELAY 1\nVI[2]=1\n"), nobody);
  EXPECT_EQ(run->Advance(At(1.0) - SimTime(1)), RunPhase::kRunning);
  EXPECT_EQ(run->state().place.step, 1);
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kFinished);
  EXPECT_EQ(run->state().time, At(1.0));
}

// OPT-4.07, OPT-7.68: place, speed, beam and override are those of the moment: during the ramp, at
// full speed, in standstill.
TEST(RunInterface, TheStateIsThatOfTheMoment) {
  machine::RunObserver nobody;
  const std::unique_ptr<machine::Run> run =
      RunOf(SetupOf(kCutting, {.override_percent = 55.0}), nobody);
  const double ramp_s = 2.0 * std::sqrt(27.5 / 40000.0);
  EXPECT_EQ(run->Advance(At(0.5 * ramp_s)), RunPhase::kRunning);
  EXPECT_NEAR(run->state().tip_speed_mm_s, 13.75, 1e-4);
  EXPECT_EQ(run->Advance(At(2.0)), RunPhase::kRunning);
  const machine::RunState state = run->state();
  EXPECT_EQ(state.time, At(2.0));
  EXPECT_EQ(state.phase, RunPhase::kRunning);
  EXPECT_EQ(state.place.program, 1);
  EXPECT_EQ(state.place.step, 5);
  EXPECT_EQ(state.instruction, "MOVE");
  EXPECT_NEAR(state.tip.tip.x(), 21.02 + 27.5 * (2.0 - 0.5 * ramp_s), 1e-6);
  EXPECT_NEAR(state.axes.column.x(), state.tip.tip.x(), 1e-9);
  EXPECT_NEAR(state.axes.column.z(), -50.0, 1e-9);
  EXPECT_NEAR(state.tip_speed_mm_s, 27.5, 1e-9);
  EXPECT_EQ(state.override_percent, 55.0);
  EXPECT_TRUE(state.beam_on);
  EXPECT_EQ(run->Advance(At(100.0)), RunPhase::kFinished);
  EXPECT_EQ(run->state().tip_speed_mm_s, 0.0);
  EXPECT_FALSE(run->state().beam_on);
  EXPECT_EQ(run->steps_executed(), 5U);
}

// OPT-7.69: the speed is that of the motion under way, whenever it began: half way through the
// ramp.
TEST(RunInterface, TheSpeedOfALaterMotion) {
  machine::RunObserver nobody;
  const std::unique_ptr<machine::Run> run =
      RunOf(SetupOf("COORD ABSOL\nPATH LIN\nSPEED 10\nDELAY 1\nMOVE (521.02,2201.2,-350.,0.,0.)\n"),
            nobody);
  run->Advance(At(1.0 + std::sqrt(50.0 / 40000.0)));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 25.0, 1e-4);
}

// motion.md 3.4: the speed of the tip in COORD ROBOT: B turns at SPEED 10 of 6.283 rad/s round L =
// 300 mm; with the head alone about a tip that stands it is 0.
TEST(RunInterface, TipSpeedOfTurningAxes) {
  machine::RunObserver nobody;
  const auto speed = [&](const std::string& text) {
    const std::unique_ptr<machine::Run> run = RunOf(SetupOf(text), nobody);
    run->Advance(At(1.0));
    return run->state().tip_speed_mm_s;
  };
  EXPECT_NEAR(speed("SPEED 10\nMOVE (21.02,2201.2,-50.,0.,2.)\n"), 0.1 * 2.0 * M_PI * 300.0, 1e-3);
  EXPECT_NEAR(speed("COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (21.02,2201.2,-350.,0.,2.)\n"), 0.0,
              1e-3);
}

// A run that does not let time pass comes back after so many instructions, and goes on when it is
// called again. With a breakpoint, of whatever program, each of them is looked at.
TEST(RunInterface, OneCallDoesSoMuch) {
  machine::RunObserver nobody;
  const machine::ProgramStep elsewhere{.program = 99, .step = 1};
  for (const auto& breakpoint : {std::optional<machine::ProgramStep>(), std::optional(elsewhere)}) {
    const std::unique_ptr<machine::Run> run =
        RunOf(SetupOf("10 GOTO 10\n", {.breakpoint = breakpoint}), nobody);
    for (std::uint64_t call = 1; call <= 3; ++call) {
      EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kRunning);
      EXPECT_EQ(run->steps_executed(), call * 20'000U);
      EXPECT_EQ(run->state().time, SimTime(0));
    }
  }
}

// OPT-E.7902: the budget of time is over at its instant, when the run is driven to that instant.
TEST(RunInterface, TheBudgetEndsAtItsInstant) {
  machine::RunObserver nobody;
  const std::unique_ptr<machine::Run> run =
      RunOf(SetupOf("DELAY 100\n", {.budget = {.virtual_time = At(5.0)}}), nobody);
  EXPECT_EQ(run->Advance(At(5.0) - SimTime(1)), RunPhase::kRunning);
  EXPECT_EQ(run->Advance(At(5.0)), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().code, ErrorCode::kTimeBudget);
  EXPECT_EQ(run->state().time, At(5.0));
}

// What is at the terminals: the outputs that are on, table and shutter, and what the beam has.
TEST(RunInterface, TheOutputsOfTheMoment) {
  machine::RunObserver nobody;
  const std::unique_ptr<machine::Run> run =
      RunOf(SetupOf("OL[0]=ON\nOL[99]=ON\nOA[1]=-2.5\nOA[99]=1.5\nFUNCTION 99 (90.)\n"
                    "WORKDEF 2,0 (15)\nWORK 2,0/ON\nDELAY 1\nWORK 0,0/ON\nDELAY 9\n",
                    {.parameters = {{"ROTARY_TABLE", "ON"}},
                     .schedules = {{.number = 15, .power_percent = 60.0}}}),
            nobody);
  const auto shown = [&] {
    std::string text;
    for (const machine::OutputNow& one : run->outputs().on)
      text += one.name + " " + std::to_string(one.value).substr(0, 4) + "; ";
    return text;
  };
  run->Advance(At(0.5));
  const std::string dark = "OL[0] 1.00; OL[99] 1.00; OA[1] -2.5; OA[99] 1.50; rotary_table 90.0; ";
  EXPECT_EQ(shown(), dark);
  EXPECT_EQ(run->outputs().laser_schedule, 15);
  EXPECT_EQ(run->outputs().power_percent, 0.0);
  run->Advance(At(2.0));
  EXPECT_EQ(shown(), dark + "shutter 1.00; ");
  EXPECT_EQ(run->outputs().power_percent, 60.0);
}

// Time stands while a run is halted, until a scripted key comes; where none is to come it stays at
// the halt.
TEST(RunInterface, TimeOfAHaltedRun) {
  machine::RunObserver nobody;
  const std::unique_ptr<machine::Run> waiting = RunOf(
      SetupOf("DELAY 1\nSTOP\nDELAY 1\n", {.inputs = {{At(5.0), InputKind::kStart}}}), nobody);
  EXPECT_EQ(waiting->Advance(At(3.0)), RunPhase::kHalted);
  EXPECT_EQ(waiting->state().time, At(3.0));
  EXPECT_EQ(waiting->Advance(At(5.0)), RunPhase::kRunning);  // the key of that instant, too
  EXPECT_EQ(waiting->Advance(At(5.5)), RunPhase::kRunning);
  EXPECT_EQ(waiting->Advance(At(9.0)), RunPhase::kFinished);
  EXPECT_EQ(waiting->state().time, At(6.0));
  const std::unique_ptr<machine::Run> alone = RunOf(SetupOf("DELAY 1\nSTOP\nDELAY 1\n"), nobody);
  EXPECT_EQ(alone->Advance(At(3.0)), RunPhase::kHalted);
  EXPECT_EQ(alone->state().time, At(1.0));
  alone->Apply({At(3.0), InputKind::kStart});
  EXPECT_EQ(alone->Advance(At(9.0)), RunPhase::kFinished);
  EXPECT_EQ(alone->state().time, At(2.0));
}

// LIVE-6.02: what the program and its FUNCTIONs have set, each level by itself.
TEST(RunInterface, TheStateOfItsPrograms) {
  machine::RunObserver nobody;
  const std::unique_ptr<machine::Run> run = RunOf(
      SetupOf("ERR 800\nTIMER (5.,900)/AUTO\nWORKDEF 1,0 (8.,75.,.2,50.,12)\nWORKDEF 2,9 (15)\n"
              "WORK 0,0/ON\nWORK 2,9/ON\nFUNCTION 44 (1.5,0.,-2.)\nENDTASK\n"
              "800 VI[2]=1\n900 RETURN\n",
              {.programs = {{44, "ERR 700\nFUNCTION 45 (3.)\nENDTASK\n700 RETURN\n"},
                            {45, "DELAY 9\n"}}}),
      nobody);
  run->Advance(At(1.0));
  const std::vector<machine::StateItem> items = run->enterable()->items();
  const auto value = [&](std::string_view name) {
    const auto found = std::ranges::find(items, name, &machine::StateItem::name);
    return found == items.end() ? "none" : found->value;
  };
  EXPECT_EQ(value("stack"), "1/7 44/2 45/1");
  EXPECT_EQ(value("ERR"), "800, 700, OFF");
  EXPECT_EQ(value("PAR[0]"), "none");
  EXPECT_EQ(value("PAR[0] of FUNCTION level 1"), "1.5");
  EXPECT_EQ(value("PAR[1] of FUNCTION level 1"), "none");
  EXPECT_EQ(value("PAR[2] of FUNCTION level 1"), "-2");
  EXPECT_EQ(value("PAR[0] of FUNCTION level 2"), "3");
  EXPECT_EQ(value("TIMER"), "900 in 4.04 s, each 5 s");  // of 105 cycles
  EXPECT_EQ(value("WORKDEF 1,0"), "8, 75, 0.2, 50, 12");
  EXPECT_EQ(value("WORKDEF 0,0"), "none");
  EXPECT_EQ(value("WORKDEF 2,9"), "0, 0, 0, 0, 15");
  EXPECT_EQ(value("WORK"), "0,0 2,9");
  EXPECT_EQ(value("clamps"), "below SAFE_Z");
  EXPECT_EQ(value("caller 1 ERR"), "none");
}

// LIVE-6.05: up to SAFE_Z, across, down; each leg begins where the one before ends, so that a
// machine that stands 400 mm outside of its travel is inside on the last one.
TEST(RunInterface, TheWayToAStep) {
  machine::RunObserver nobody;
  machine::RunSetup setup = SetupOf(kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nVI[2]=1\n");
  MachineState stands = NewMachine(Resolve(setup.parameters));
  stands.axes.column = {4000.0, 1000.0, -200.0};
  const std::unique_ptr<machine::Run> run = RunOf(std::move(setup), nobody);
  machine::EnterableRun& entered = *run->enterable();
  ASSERT_TRUE(entered.HaltBefore({.at = {1, 4}}).ok());
  EXPECT_EQ(run->Advance(At(1000.0)), RunPhase::kHalted);
  const auto legs = entered.PlanApproach(EncodeMachineState(stands), machine::ApproachWay::kSafe);
  ASSERT_EQ(legs.size(), 3U);
  std::string text;
  for (const machine::ApproachMotion& leg : legs) {
    text += std::string(leg.path) + " to " + std::to_string(std::lround(leg.to.column.x())) + "," +
            std::to_string(std::lround(leg.to.column.z())) + " at " +
            std::to_string(std::lround(leg.feed_mm_s)) + ":";
    for (const auto& one : leg.beyond) {
      text += " axis " + std::to_string(one.axis) + " by " +
              std::to_string(std::lround(one.excess)) + (one.at_target ? " there" : "");
    }
    text += "; ";
  }
  EXPECT_EQ(text,
            "PTP to 4000,-50 at 0: axis 0 by 400 there; PTP to 1000,-50 at 0: axis 0 by 400; "
            "LIN to 1000,-100 at 50:; ");
  EXPECT_TRUE(
      entered.PlanApproach(EncodeMachineState(stands), machine::ApproachWay::kDirect).empty());
  // Who stands straight above need but go down, and who stands as high beside it need not go up.
  const auto legs_from = [&](double aside_mm) {
    stands.axes = legs.back().to;
    stands.axes.column.x() += aside_mm;
    stands.axes.column.z() = -50.0;
    return entered.PlanApproach(EncodeMachineState(stands), machine::ApproachWay::kSafe).size();
  };
  EXPECT_EQ(legs_from(0.0), 1U);
  EXPECT_EQ(legs_from(10.0), 2U);
}

// A finished run takes no more keys, and ends only once.
TEST(RunInterface, NothingComesAfterTheEnd) {
  machine::RunObserver nobody;
  const std::unique_ptr<machine::Run> run = RunOf(SetupOf("DELAY 1\n"), nobody);
  EXPECT_EQ(run->Advance(At(3.0)), RunPhase::kFinished);
  run->Apply({At(3.0), InputKind::kEmergencyStop});
  run->End(machine::OutcomeKind::kCancelled, ErrorCode::kCancelled);
  run->WriteVariable("VI[5]", 7.0);
  EXPECT_EQ(run->ReadVariable("VI[5]")->text, "0");
  EXPECT_EQ(run->outcome().kind, machine::OutcomeKind::kCompleted);
  EXPECT_FALSE(run->outcome().code.has_value());
  EXPECT_EQ(run->ReadVariable("VI[99]")->text, "0");
}

// Inputs beyond the last index act on the last one, those below the first on the first.
TEST(RunInterface, InputsOutOfRange) {
  const Ran ran = RunText("VL[0]=IL[0]\nVL[1]=IL[86]\nVL[2]=IL[99]\n",
                          {.inputs = {{SimTime(0), InputKind::kLogical, -5, 1.0},
                                      {SimTime(0), InputKind::kLogical, 500, 1.0}},
                           .variables = {"VL[0]", "VL[1]", "VL[2]"}});
  EXPECT_EQ(ran.variables.at("VL[0]") + ran.variables.at("VL[1]") + ran.variables.at("VL[2]"),
            "101");
}

machine::RunSetup WithSource(const std::string& text, machine::SourceNotes notes) {
  machine::RunSetup setup = SetupOf(text);
  setup.programs[1].source = std::make_shared<const machine::SourceNotes>(std::move(notes));
  return setup;
}

// Steps have the lines of their source, as far as that is known.
TEST(RunInterface, LinesOfSteps) {
  Findings findings;
  const std::unique_ptr<machine::Run> run =
      RunOf(WithSource("VI[2]=1\nVI[3]=1\nVR[0]=1/0\n", {.step_lines = {7, 9}}), findings);
  run->Advance(At(1.0));
  EXPECT_EQ(findings.lines, (std::vector{7, 9, 0}));
  Findings waits;
  const std::unique_ptr<machine::Run> waiting =
      RunOf(WithSource("DELAY 0\nDELAY 0\nDELAY 0\n", {.step_lines = {7, 9}}), waits);
  waiting->Advance(At(1.0));
  EXPECT_EQ(waits.lines, (std::vector{7, 9, 0}));
  Findings errors;
  const std::unique_ptr<machine::Run> failing =
      RunOf(WithSource("VI[2]=1\nVR[0]=1/0\n", {.step_lines = {7, 9}}), errors);
  failing->Advance(At(1.0));
  ASSERT_EQ(errors.found.size(), 1U);
  EXPECT_EQ(errors.found[0].where.line, 9);
  EXPECT_EQ(failing->outcome().place.line, 9);
}

// A comment lets a warning pass that it names, on its line or in the whole file; another one, or on
// another line, it does not, and an error never.
TEST(RunInterface, WhatACommentLetsPass) {
  const auto told = [](const std::string& text, int number, int line) {
    Findings findings;
    RunOf(WithSource(text, {.step_lines = {5, 6}, .allowed = {{.line = line, .number = number}}}),
          findings)
        ->Advance(At(1.0));
    return findings.found.size();
  };
  const std::string warns = "VI[2]=1\nTCP (0,0,0/0,0,5)\n";
  EXPECT_EQ(told(warns, 7315, 0), 0U);
  EXPECT_EQ(told(warns, 7315, 6), 0U);
  EXPECT_EQ(told(warns, 7315, 5), 1U);
  EXPECT_EQ(told(warns, 7312, 0), 1U);
  EXPECT_EQ(told("VI[2]=1\nVR[0]=1/0\n", 7201, 0), 1U);
}

// OPT-B.30: a time of a whole number of cycles is over at that cycle: 6 s are 125 of 0.048 s,
// though the division does not come out even. 300 mm at 50 mm/s.
TEST(RunInterface, WholeCycles) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/TIME (6.,900)\nENDTASK\n900 RETURN\n");
  EXPECT_NEAR(ran.end.tip.tip.x(), 21.02 + 300.0, 1e-6);
  EXPECT_NEAR(ran.time_s, 6.0 + 2.0 * std::sqrt(50.0 / 40000.0), 1e-6);
  const Ran timer = RunText("TIMER (6.,900)\nDELAY 6\nVI[2]=VI[3]\nENDTASK\n900 VI[3]=1\nRETURN\n",
                            {.variables = {"VI[2]"}});
  EXPECT_EQ(timer.variables.at("VI[2]"), "1");
}

// OPT-9.19: FUNCTION 99 turns the table to its degrees; without a value, to 0. The position is
// kept.
TEST(RunInterface, TheRotaryTable) {
  const RunOptions fitted{.parameters = {{"ROTARY_TABLE", "ON"}}};
  const Ran ran = RunText("FUNCTION 99 (90.)\nFUNCTION 99 (-45.5)\nFUNCTION 99\n", fitted);
  EXPECT_EQ(ran.Count("table 90.0") + ran.Count("table -45.5") + ran.Count("table 0.0"), 3);
  EXPECT_EQ(CodeOf(RunText("FUNCTION 99 (1./VR[0])\n", fitted)), 7201);
}

// Steps behind the last line that is known have none, also those that go through without an error.
TEST(RunInterface, StepsBehindTheLastKnownLine) {
  Findings steps;
  const std::unique_ptr<machine::Run> run =
      RunOf(WithSource("VI[2]=1\nVI[3]=1\nVI[4]=1\nVI[5]=1\n", {.step_lines = {7, 9}}), steps);
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kFinished);
  EXPECT_EQ(steps.lines, (std::vector{7, 9, 0, 0}));
}

// LIVE-6.05: up and across at SPEED 40, down at SPEED 10, and the override applies.
TEST(RunInterface, TheSpeedsOfTheWayToAStep) {
  for (const double percent : {100.0, 50.0}) {
    machine::RunObserver nobody;
    machine::RunSetup setup = SetupOf(kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nVI[2]=1\n");
    MachineState stands = NewMachine(Resolve(setup.parameters));
    stands.axes.column = {3000.0, 1000.0, -200.0};
    const std::unique_ptr<machine::Run> run = RunOf(std::move(setup), nobody);
    machine::EnterableRun& entered = *run->enterable();
    ASSERT_TRUE(entered.HaltBefore({.at = {1, 4}}).ok());
    ASSERT_EQ(run->Advance(At(1000.0)), RunPhase::kHalted);
    entered.Enter({.machine_state = EncodeMachineState(stands), .override_percent = percent});
    double across = 0.0;
    double down = 0.0;
    SimTime now = run->state().time;
    for (int n = 0; n < 10'000 && run->state().approaching; ++n) {
      now += At(0.01);
      run->Advance(now);
      const machine::RunState state = run->state();
      double& highest = state.axes.column.x() > 1000.001 ? across : down;
      highest = std::max(highest, state.tip_speed_mm_s);
    }
    EXPECT_NEAR(across, 0.4 * 500.0 * percent / 100.0, 1e-3) << percent;
    EXPECT_NEAR(down, 0.1 * 500.0 * percent / 100.0, 1e-3) << percent;
  }
}

// docs/verdict.md: "no power" is none at all at the programmed speed, however slow and short the
// way: half a percent is little power, half a millimetre at 0.5 mm/s is a way.
TEST(RunInterface, NoPowerIsNoneAtAll) {
  const auto length = [](const std::string& power, const std::string& speed,
                         const std::string& to_x) {
    machine::RunObserver nobody;
    const std::unique_ptr<machine::Run> run =
        RunOf(SetupOf(kThere + "WORKDEF 1,0 (10.," + power + ",0.,50.)\nSPEED " + speed +
                      "\nWORK 1,0/ON\nMOVE (" + to_x + ",1000.,-400.,0.,0.)\nWORK 1,0/OFF\n"),
              nobody);
    run->Advance(At(1000.0));
    double found = -1.0;
    for (const machine::Figure& one : run->figures()) {
      if (one.name == "no_power_length") found = one.value;
    }
    return found;
  };
  EXPECT_NEAR(length(".5", "10", "1100."), 0.0, 1e-9);
  EXPECT_NEAR(length("0.", "10", "1100."), 100.0, 1e-3);
  EXPECT_NEAR(length("0.", ".1", "1000.5"), 0.5, 1e-3);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::run_interface
