// Keys, override, budgets, snapshots and the division of time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/machine/step_entry.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::InputScript;
using machine::OutcomeKind;
using machine::RunPhase;
using namespace std::chrono_literals;

constexpr double kAcceleration = 200.0;  // of T1

double TrapezoidTime(double length, double speed) {
  if (length < speed * speed / kAcceleration) return 2.0 * std::sqrt(length / kAcceleration);
  return length / speed + speed / kAcceleration;
}

// A program with everything that takes time, for properties.
const std::string kVaried =
    "!MC1;VS20;V10;PU1000,1000;PD3000,1000,3000,3000;W30;PD1000,3000;!RC15;W0;Z500,500,-300,"
    "900,900,-100;PU25000,0;PD19000,500;XX;!ZE X5000Z-50;!MC0;IN;PU0,0;H;";

// And one of short lines, with commands between them that need no standstill.
const std::string kChained = [] {
  std::string stream = "!MC0;!ZM-2000;PD;";
  for (int k = 0; k < 400; ++k) {
    stream += k % 50 == 0 ? "VS" + std::to_string(5 + k / 50 * 7) + ";" : "";
    stream += k % 90 == 80 ? "XX;" : "";
    stream += k % 140 == 139 ? "W20;" : k % 140 == 0 ? "W0;" : "";
    const double angle = 0.05 * k;
    stream += "PD" + std::to_string(static_cast<int>(3000 + 2000 * std::cos(angle) + k)) + "," +
              std::to_string(static_cast<int>(3000 + 2000 * std::sin(angle))) + ";";
  }
  return stream + "PU;PU0,0,100,100,0,300;Z0,0,0,10,10,-10,500,300,-100,600,900,-100;";
}();

machine::Parameters VariedMachine() {
  machine::Parameters parameters = ParametersOf("t1");
  EXPECT_TRUE(parameters.Set("SPIN_UP", 0.7).ok());
  EXPECT_TRUE(parameters.Set("SPIN_DOWN", 0.3).ok());
  return parameters;
}

const InputScript kVariedInputs = {
    {.at = 300ms, .kind = InputKind::kHold},
    {.at = 2s, .kind = InputKind::kStart},
    {.at = 2500ms, .kind = InputKind::kOverride, .index = 0, .value = 50.0},
    {.at = 4s, .kind = InputKind::kStop},
    {.at = 5s, .kind = InputKind::kStart},
    {.at = 6s, .kind = InputKind::kOverride, .index = 0, .value = 180.0},
    {.at = 7s, .kind = InputKind::kStop},
    {.at = 7001ms, .kind = InputKind::kStart},
    {.at = 9s, .kind = InputKind::kOverride, .index = 0, .value = 30.0}};

// How time is divided into calls of Advance changes nothing that is told: RML1-7.01.
void ExpectSameInParts(const std::string& stream) {
  TestRun whole(VariedMachine(), stream, kVariedInputs);
  ASSERT_EQ(whole.AdvanceToEnd(), RunPhase::kFinished);
  std::mt19937 random(11);
  for (int round = 0; round < 30; ++round) {
    TestRun parts(VariedMachine(), stream, kVariedInputs);
    SimTime until{0};
    while (parts->Advance(until) != RunPhase::kFinished) {
      until += std::chrono::microseconds(1 + random() % (round < 3 ? 3000 : 2'000'000));
    }
    ASSERT_EQ(parts.seen().text(), whole.seen().text());
    EXPECT_EQ(parts.figures(), whole.figures());
    EXPECT_EQ(parts->SaveMachine(), whole->SaveMachine());
  }
}
TEST(MillRunControl, DependsNotOnTheCallsOfAdvance) {
  ExpectSameInParts(kVaried);
  ExpectSameInParts(kChained);
}

// Inputs applied by the caller act as scripted ones of the same time do.
TEST(MillRunControl, TreatsAppliedInputsAsScripted) {
  const InputScript inputs = {
      {.at = 2500ms, .kind = InputKind::kOverride, .index = 0, .value = 50.0},
      {.at = 6s, .kind = InputKind::kOverride, .index = 0, .value = 180.0}};
  for (const std::string& stream : {kVaried, kChained}) {
    TestRun scripted(VariedMachine(), stream, inputs);
    scripted.AdvanceToEnd();
    TestRun applied(VariedMachine(), stream);
    for (const machine::InputChange& input : inputs) {
      applied->Advance(input.at);
      ASSERT_EQ(applied->state().time, input.at);
      applied->Apply(input);
    }
    ASSERT_EQ(applied.AdvanceToEnd(), RunPhase::kFinished);
    EXPECT_EQ(applied.seen().text(), scripted.seen().text());
  }
}

// A snapshot taken anywhere, restored into the same run or an equal one, goes on the same way, also
// when the run it came from is gone.
void ExpectSameFromASnapshot(const std::string& stream) {
  TestRun whole(VariedMachine(), stream, kVariedInputs);
  whole.AdvanceToEnd();
  std::mt19937 random(12);
  const double total = whole.time_s();
  for (int round = 0; round < 40; ++round) {
    const SimTime at = FromSeconds(total * static_cast<double>(random() % 1000) / 1000.0);
    auto first = std::make_unique<TestRun>(VariedMachine(), stream, kVariedInputs);
    (*first)->Advance(at);
    const std::string before = first->seen().text();
    const std::unique_ptr<machine::RunSnapshot> snapshot = (*first)->Save();
    first->AdvanceToEnd();
    EXPECT_EQ(first->seen().text(), whole.seen().text());
    first.reset();
    TestRun second(VariedMachine(), stream, kVariedInputs);
    second->Restore(*snapshot);
    EXPECT_EQ(second->state().time, at);
    second.AdvanceToEnd();
    ASSERT_EQ(before + second.seen().text(), whole.seen().text());
    EXPECT_EQ(second.figures(), whole.figures());
  }
}
TEST(MillRunControl, GoesOnFromASnapshot) {
  ExpectSameFromASnapshot(kVaried);
  ExpectSameFromASnapshot(kChained);
}

// What watchers see between events: the tool never jumps, never exceeds the feed, and stays in the
// travel; progress only grows.
TEST(MillRunControl, MovesSteadilyBetweenEvents) {
  TestRun run(VariedMachine(), kVaried, kVariedInputs);
  constexpr SimTime kTick = 1ms;
  machine::RunState last = run->state();
  double fastest = 0.0;
  while (run->Advance(last.time + kTick) != RunPhase::kFinished) {
    const machine::RunState now = run->state();
    const double step = (last.tip.tip - now.tip.tip).norm();
    ASSERT_LE(step, 60.0 * ToSeconds(now.time - last.time) + 1e-9);
    fastest = std::max(fastest, now.tip_speed_mm_s);
    EXPECT_GE(now.tip.tip.x(), 0.0);
    EXPECT_LE(now.tip.tip.x(), 200.0);
    EXPECT_LE(now.tip.tip.z(), 0.0);
    EXPECT_GE(now.progress, last.progress);
    last = now;
  }
  EXPECT_NEAR(fastest, 60.0, 0.2);
  EXPECT_EQ(run->state().progress, 1.0);
  EXPECT_FALSE(run->state().spindle_on);
}

// HOLD: the motion in progress ends, then the run stands.
TEST(MillRunControl, HoldsAtTheEndOfTheMotion) {
  TestRun run(ParametersOf("t1"), "!MC0;PU6000,0,6000,6000;");
  const double lower = TrapezoidTime(15, 2);
  run->Advance(FromSeconds(lower + 0.1));
  run.Press(InputKind::kHold);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run.time_s(), lower + TrapezoidTime(60, 60), 1e-8);
  EXPECT_EQ(run.variable("X"), "6000");
  EXPECT_EQ(run->state().tip_speed_mm_s, 0.0);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), lower + 2 * TrapezoidTime(60, 60), 1e-8);
}

// STOP: braking begins at once, v2/2a = 9 mm at 60 mm/s; START goes on from there on the same path.
TEST(MillRunControl, StopsOnThePath) {
  TestRun run(ParametersOf("t1"), "!MC0;PU6000,0;");
  const double lower = TrapezoidTime(15, 2);
  run->Advance(FromSeconds(lower + 0.5));  // 0.3 s to speed and 9 mm, 0.2 s at speed
  run.Press(InputKind::kStop);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run.time_s(), lower + 0.5 + 0.3, 1e-6);
  EXPECT_NEAR(run->state().tip.tip.x(), 9 + 12 + 9, 1e-5);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), lower + 0.8 + TrapezoidTime(30, 60), 1e-6);
  EXPECT_EQ(run.variable("X"), "6000");
  ASSERT_EQ(run.seen().moves().size(), 2U);  // one motion for who counts motions
  EXPECT_EQ(run.figures().at("motions"), 2);
  EXPECT_NEAR(run.figures().at("travel_length"), 75.0, 1e-9);
}

// A STOP in the last ramp ends where the motion would have ended.
TEST(MillRunControl, StopsNoLaterThanTheMotionItself) {
  TestRun run(ParametersOf("t1"), "!MC0;PU6000,0;!RC15;PD;");
  const double end = TrapezoidTime(15, 2) + TrapezoidTime(60, 60);
  run->Advance(FromSeconds(end - 0.01));
  run.Press(InputKind::kStop);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run->state().tip.tip.x(), 60.0, 1e-6);
  EXPECT_NEAR(run.time_s(), end, 1e-6);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.seen().moves().size(), 3U);
}

// A STOP in a dwell stops its clock.
TEST(MillRunControl, StopsTheClockOfADwell) {
  TestRun run(ParametersOf("t1"), "!MC0;W1000;PD;",
              {{.at = 400ms, .kind = InputKind::kStop}, {.at = 10s, .kind = InputKind::kStart}});
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), 10 + 0.6 + TrapezoidTime(20, 2), 1e-8);
  EXPECT_NEAR(run.figures().at("dwell_time"), 1.0, 1e-9);
  EXPECT_NEAR(run.figures().at("halted_time"), 9.6, 1e-9);
}

// A STOP and the START that takes it back before the tool stands: the rest is ridden from rest.
TEST(MillRunControl, TakesBackAStop) {
  TestRun run(ParametersOf("t1"), "!MC0;PU6000,0;");
  run->Advance(FromSeconds(TrapezoidTime(15, 2) + 0.5));
  run.Press(InputKind::kStop);
  run->Advance(run->state().time + 10ms);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), TrapezoidTime(15, 2) + 0.8 + TrapezoidTime(30, 60), 1e-6);
}

// Override scales F and V speeds, not the travel speed, and stays within the machine.
TEST(MillRunControl, ScalesFeedsByTheOverride) {
  machine::RunSetup setup =
      SetupOf(ParametersOf("t1"), "!MC0;VS20;V40;PU1000,0;PD3000,0;F60;PD5000,0;");
  setup.override_percent = 50.0;
  TestRun run(std::move(setup));
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  std::vector<double> feeds;
  for (const machine::MoveDone& move : run.seen().moves()) feeds.push_back(move.feed_mm_s);
  EXPECT_EQ(feeds, (std::vector<double>{20, 60, 20, 10, 30}));
  EXPECT_EQ(run.seen().motions()[1].programmed_mm_s, 0.0);  // as fast as the axes can
  EXPECT_EQ(run.seen().motions()[3].programmed_mm_s, 10.0);

  machine::RunSetup fast = SetupOf(ParametersOf("t1"), "!MC0;VS50;PD3000,0;");
  fast.override_percent = 1000.0;  // 200 at most, and the axes allow 60
  TestRun limited(std::move(fast));
  limited.AdvanceToEnd();
  EXPECT_EQ(limited->state().override_percent, 200.0);
  EXPECT_EQ(limited.seen().moves().back().feed_mm_s, 60.0);
}

// An override in the middle of a motion: 20 mm at 10 mm/s; after 1.025 s, at 10 mm, the speed goes
// to 5 mm/s (0.025 s, 0.1875 mm), then 9.8125 mm with the last ramp.
TEST(MillRunControl, ChangesSpeedInTheMiddleOfAMotion) {
  TestRun run(ParametersOf("t1"), "!MC0;VS10;PD2000,0;");
  const double lower = TrapezoidTime(20, 2);
  run->Advance(FromSeconds(lower + 1.025));
  EXPECT_NEAR(run->state().tip.tip.x(), 10.0, 1e-6);
  run.Press(InputKind::kOverride, 50.0);
  run->Advance(FromSeconds(lower + 1.5));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 5.0, 1e-9);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  const double rest = 20.0 - 10.0 - 0.1875;
  const double last_ramp = 5.0 * 5.0 / (2 * kAcceleration);
  EXPECT_NEAR(run.time_s(), lower + 1.025 + 0.025 + (rest - last_ramp) / 5.0 + 0.025, 1e-6);
  double ridden = 0.0;
  for (std::size_t i = 1; i < run.seen().motions().size(); ++i) {
    ridden += run.seen().motions()[i].travelled;
  }
  EXPECT_NEAR(ridden, 20.0, 1e-9);
  EXPECT_EQ(run.seen().moves().size(), 2U);

  TestRun faster(ParametersOf("t1"), "!MC0;VS10;PD2000,0;");
  faster->Advance(FromSeconds(lower + 1.025));
  faster.Press(InputKind::kOverride, 200.0);  // 10 mm left: up 0.75, down 1 with the last ramp
  ASSERT_EQ(faster.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(faster.time_s(), lower + 1.025 + 0.05 + (10 - 0.75 - 1.0) / 20 + 0.1, 1e-6);
}

// A turn of the rotary axis alone is stopped and resumed too.
TEST(MillRunControl, StopsATurn) {
  TestRun run(ParametersOf("t1a"), "!MC0;!ZE A90;");
  run->Advance(900ms);  // 9 degrees of ramp, then 36 at 60 deg/s: 45
  run.Press(InputKind::kStop);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run->state().tip.a_rad / kRadPerDegree, 45.0 + 9.0, 1e-6);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), 0.9 + 0.3 + 36.0 / 60 + 0.3, 1e-6);
  EXPECT_EQ(run.variable("A"), "90");
}

// An emergency stop freezes the run where it is; the spindle stops.
TEST(MillRunControl, FreezesOnAnEmergencyStop) {
  TestRun run(ParametersOf("t1"), "PU6000,0;");
  run->Advance(FromSeconds(TrapezoidTime(15, 2) + 0.5));
  run.Press(InputKind::kEmergencyStop);
  EXPECT_EQ(run->state().phase, RunPhase::kFinished);
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kStopped);
  EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run->state().tip.tip.x(), 21.0, 1e-6);
  EXPECT_FALSE(run->state().spindle_on);
  EXPECT_EQ(run.seen().Events().back(), "stop");
  EXPECT_NEAR(run.seen().motions().back().travelled, 21.0, 1e-6);
}

// End: a cancelled job leaves the tool where it stands.
TEST(MillRunControl, EndsAtOnce) {
  TestRun run(ParametersOf("t1"), "PD6000,0;");
  run->Advance(11s);
  run->End(OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
  EXPECT_EQ(run->outcome().code, ErrorCode::kCellCancelled);
  EXPECT_EQ(run->outcome().place.step, 1);
  run->End(OutcomeKind::kFailed, ErrorCode::kCellInternal);  // it has ended: nothing changes
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kCancelled);
  run.Press(InputKind::kStart);
  EXPECT_EQ(run->state().phase, RunPhase::kFinished);
}

// Budgets of the setup: one command or one nanosecond more ends the run.
TEST(MillRunControl, KeepsItsBudgets) {
  machine::RunSetup exact = SetupOf(ParametersOf("t1"), "PU;PD;PU;");
  exact.budget.steps = 3;
  TestRun fits(std::move(exact));
  fits.AdvanceToEnd();
  EXPECT_EQ(fits->outcome().kind, OutcomeKind::kCompleted);
  const SimTime whole = fits->state().time;

  machine::RunSetup fewer = SetupOf(ParametersOf("t1"), "PU;PD;PU;");
  fewer.budget.steps = 2;
  TestRun steps(std::move(fewer));
  steps.AdvanceToEnd();
  EXPECT_EQ(steps->outcome().kind, OutcomeKind::kBudgetExceeded);
  EXPECT_EQ(steps->outcome().code, ErrorCode::kCellStepBudget);

  machine::RunSetup in_time = SetupOf(ParametersOf("t1"), "PU;PD;PU;");
  in_time.budget.virtual_time = whole;
  TestRun timely(std::move(in_time));
  timely.AdvanceToEnd();
  EXPECT_EQ(timely->outcome().kind, OutcomeKind::kCompleted);

  machine::RunSetup shorter = SetupOf(ParametersOf("t1"), "PU;PD;PU;");
  shorter.budget.virtual_time = whole - 1ns;
  TestRun late(std::move(shorter));
  late.AdvanceToEnd();
  EXPECT_EQ(late->outcome().code, ErrorCode::kCellTimeBudget);
  EXPECT_EQ(late->state().time, whole - 1ns);

  // Up to the end of the budget a caller may advance; what lies behind belongs to the next call.
  machine::RunSetup watched = SetupOf(ParametersOf("t1"), "PU;PD;PU;");
  watched.budget.virtual_time = 1s;
  TestRun run(std::move(watched));
  EXPECT_EQ(run->Advance(1s), RunPhase::kRunning);
  EXPECT_EQ(run->state().time, 1s);
  EXPECT_EQ(run->Advance(1s + 1ns), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().code, ErrorCode::kCellTimeBudget);
  EXPECT_EQ(run->state().time, 1s);
}

// Single steps and a breakpoint halt between commands.
TEST(MillRunControl, HaltsBetweenCommands) {
  machine::RunSetup single = SetupOf(ParametersOf("t1"), "PU1,1;XX;VS5;PD2,2,3,3;");
  single.mode = machine::Mode::kSingle;
  TestRun run(std::move(single));
  std::vector<int> steps;
  while (run.AdvanceToEnd() == RunPhase::kHalted) {
    steps.push_back(run->state().place.step);
    run.Press(InputKind::kStart);
  }
  EXPECT_EQ(steps, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(run.variable("X"), "3");

  machine::RunSetup to_break = SetupOf(ParametersOf("t1"), "PU1,1;VS5;PD2,2;");
  to_break.breakpoint = machine::ProgramStep{.program = 1, .step = 2};
  TestRun halted(std::move(to_break));
  ASSERT_EQ(halted.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(halted.variable("VS"), "5");
  EXPECT_EQ(halted.variable("X"), "1");
  halted.Press(InputKind::kStart);
  EXPECT_EQ(halted.AdvanceToEnd(), RunPhase::kFinished);
}

// Every halt tells what caused it, once; a breakpoint of another program is none.
TEST(MillRunControl, TellsTheCauseOfAHalt) {
  const auto first_halt = [](TestRun run, InputKind key) {
    run->Advance(1s);
    if (key != InputKind::kStart) run.Press(key);
    EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
    std::vector<std::string> halts;
    for (const std::string& event : run.seen().Events()) {
      if (event.starts_with("halt ")) halts.push_back(event);
    }
    return halts;
  };
  const auto setup_of = [](machine::Mode mode, int breakpoint_program) {
    machine::RunSetup setup = SetupOf(ParametersOf("t1"), "!MC0;PD100,0;!NR;PU;");
    setup.mode = mode;
    setup.breakpoint = machine::ProgramStep{.program = breakpoint_program, .step = 1};
    return setup;
  };
  using Halts = std::vector<std::string>;
  const auto plain = [&] { return TestRun(setup_of(machine::Mode::kCycle, 2)); };
  EXPECT_EQ(first_halt(plain(), InputKind::kStart), (Halts{"halt !NR"}));
  EXPECT_EQ(first_halt(plain(), InputKind::kHold), (Halts{"halt HOLD"}));
  EXPECT_EQ(first_halt(plain(), InputKind::kStop), (Halts{"halt STOP"}));
  EXPECT_EQ(first_halt(TestRun(setup_of(machine::Mode::kSingle, 2)), InputKind::kStart),
            (Halts{"halt SINGLE"}));
  EXPECT_EQ(first_halt(TestRun(setup_of(machine::Mode::kCycle, 1)), InputKind::kStart),
            (Halts{"halt BREAKPOINT"}));
}

// RML1-9.11, RML1-3B.06: what a machine keeps between jobs.
TEST(MillRunControl, KeepsTheMachineBetweenJobs) {
  TestRun first(ParametersOf("t1a"), "PR;!ZO-500;@-3,7;VS9;V8;W6;!RC15;PD100,200;!ZE A30;XX;");
  first.AdvanceToEnd();
  EXPECT_EQ(first.variable("ERR"), "1");
  machine::RunSetup setup = SetupOf(ParametersOf("t1a"), ";");
  setup.machine_state = first->SaveMachine();
  TestRun second(std::move(setup));
  second.AdvanceToEnd();
  for (const char* name : {"X", "Y", "Z", "A", "LX", "LY", "LZ", "Z0", "Z1", "Z2", "VS", "VZ", "DW",
                           "RPM", "MC", "MODE", "TOOL", "SPINDLE"}) {
    EXPECT_EQ(second.variable(name), first.variable(name)) << name;
  }
  EXPECT_EQ(second.variable("ERR"), "0");
  EXPECT_EQ(second->SaveMachine(), first->SaveMachine());
}

// A machine that was changed since: what it kept is limited to what it can do now.
TEST(MillRunControl, LimitsAKeptStateToTheMachine) {
  TestRun first(ParametersOf("t1"), "!ZO-5500;VS60;V60;!RC15;PU20000,15000;");
  first.AdvanceToEnd();
  machine::RunSetup setup = SetupOf(ParametersOf("srm-20"), ";");
  ASSERT_TRUE(setup.parameters.Set("X_MAX", 100.0).ok());
  ASSERT_TRUE(setup.parameters.Set("Z_MIN", -40.0).ok());
  setup.machine_state = first->SaveMachine();
  TestRun second(std::move(setup));
  second.AdvanceToEnd();
  EXPECT_EQ(second.variable("X"), "10000");
  EXPECT_EQ(second.variable("Z0"), "-4000");
  EXPECT_EQ(second.variable("VS"), "30");
  EXPECT_EQ(second.variable("VZ"), "30");
  EXPECT_EQ(second.variable("RPM"), "7000");
}

// An override that is no number changes nothing.
TEST(MillRunControl, IgnoresAnOverrideThatIsNoNumber) {
  machine::RunSetup setup = SetupOf(ParametersOf("t1"), "PD100,0;");
  setup.override_percent = std::nan("");
  TestRun run(std::move(setup));
  run.Press(InputKind::kOverride, std::nan(""));
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run->state().override_percent, 100.0);
}

// Setups that make no sense are refused; a missing program ends the run.
TEST(MillRunControl, RefusesImpossibleSetups) {
  const machine::MachineFamily& family = Rml1Family();
  machine::RunObserver observer;
  machine::RunSetup dry = SetupOf(ParametersOf("t1"), "PU;");
  dry.simul = machine::ProgramStep{.program = 1, .step = 1};
  EXPECT_EQ(family.NewRun(dry, observer).error().code, ErrorCode::kCellUnimplemented);
  machine::RunSetup repeat = SetupOf(ParametersOf("t1"), "PU;");
  repeat.mode = machine::Mode::kRepeat;
  EXPECT_EQ(family.NewRun(repeat, observer).error().code, ErrorCode::kCellUnimplemented);
  machine::RunSetup narrow = SetupOf(ParametersOf("t1"), "PU;");
  ASSERT_TRUE(narrow.parameters.Set("X_MAX", -5.0).ok());
  EXPECT_EQ(family.NewRun(narrow, observer).error().code, ErrorCode::kCellParameterRange);
  machine::RunSetup foreign = SetupOf(ParametersOf("t1"), "PU;");
  foreign.machine_state = "something else";
  EXPECT_EQ(family.NewRun(foreign, observer).error().code, ErrorCode::kCellBadText);

  machine::RunSetup empty = SetupOf(ParametersOf("t1"), "PU;");
  empty.main_program = 2;
  const auto run = family.NewRun(empty, observer).value();
  EXPECT_EQ(run->Advance(kForever), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kFailed);
  EXPECT_EQ(run->outcome().code, ErrorCode::kCellNotFound);
}

// What happens exactly where a call ends belongs to the next one: HOLD applied at the beginning, or
// where a dwell ends, stands before the motion that would begin there, as a scripted one does.
TEST(MillRunControl, LeavesWhatHappensAtTheEndOfACallToTheNext) {
  TestRun first(ParametersOf("t1"), "!MC0;PU1000,0;");
  ASSERT_EQ(first->Advance(SimTime::zero()), RunPhase::kRunning);
  EXPECT_TRUE(first.seen().Events().empty());
  first.Press(InputKind::kHold);
  ASSERT_EQ(first.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(first->state().time, SimTime::zero());
  EXPECT_TRUE(first.seen().motions().empty());

  TestRun second(ParametersOf("t1"), "!MC0;W250;PU1000,0;");
  second->Advance(250ms);
  EXPECT_EQ(second->state().time, SimTime(250ms));
  second.Press(InputKind::kHold);
  ASSERT_EQ(second.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(second->state().time, SimTime(250ms));
  EXPECT_TRUE(second.seen().motions().empty());
}

// motion.md 8.2: keys cut a motion in parts, and what it does to the work does not hang on that: a
// line of 30 mm down through the surface cuts, and a plunge is one.
TEST(RunControl, KeysDoNotChangeWhatIsCut) {
  const std::string stream =
      "!MC1;VS10;V10;!PZ-100,200;PU1000,1000;PD1000,1100;Z2000,1000,100,4000,1000,-100;PU;!MC0;";
  TestRun whole(ParametersOf("t1"), stream);
  ASSERT_EQ(whole.AdvanceToEnd(), RunPhase::kFinished);
  const Figures wanted = whole.figures();
  ASSERT_EQ(wanted.at("skimmed_length"), 0.0);
  double oblique_s = 0.0;
  double plunge_s = 0.0;
  for (const RunRecord::Motion& motion : whole.seen().motions()) {
    if (motion.use == machine::MotionUse::kPlunge) plunge_s = 0.5 * (motion.start_s + motion.end_s);
    const auto from = motion.planned.path.tip_from().tip;
    const auto to = motion.planned.path.TipAt(motion.travelled).tip;
    if (to.z() < from.z() && to.x() != from.x())
      oblique_s = motion.start_s + 0.1 * (motion.end_s - motion.start_s);
  }
  ASSERT_GT(oblique_s, 0.0);
  ASSERT_GT(plunge_s, 0.0);
  for (const double at : {oblique_s, plunge_s}) {
    for (const InputScript& keys :
         {InputScript{{.at = FromSeconds(at), .kind = InputKind::kStop},
                      {.at = FromSeconds(at + 60.0), .kind = InputKind::kStart}},
          InputScript{{.at = FromSeconds(at), .kind = InputKind::kHold},
                      {.at = FromSeconds(at + 60.0), .kind = InputKind::kStart}},
          InputScript{
              {.at = FromSeconds(at), .kind = InputKind::kOverride, .index = 0, .value = 50.0}}}) {
      TestRun run(ParametersOf("t1"), stream, keys);
      ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
      const Figures figures = run.figures();
      for (const char* name : {"cut_length", "skimmed_length", "travel_length", "plunges"})
        EXPECT_NEAR(figures.at(name), wanted.at(name), 1e-6) << name << " with a key at " << at;
    }
  }
}

// RML1-5A.36: START at the very instant of a halt is for that halt.
TEST(RunControl, StartAtTheInstantOfAHalt) {
  const std::string stream = "!MC0;VS10;PU1000,0;!NR;PU2000,0;";
  TestRun halted(ParametersOf("t1"), stream);
  ASSERT_EQ(halted.AdvanceToEnd(), RunPhase::kHalted);
  TestRun run(ParametersOf("t1"), stream,
              {{.at = halted->state().time, .kind = InputKind::kStart}});
  EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.seen().moves().size(), halted.seen().moves().size() + 1);
}

// A dry run up to no step is none, and so a mill can carry it out; a run begins at a command from 1
// on, that of its own stream, and for the first time.
TEST(MillRunControl, StepsThatAreNone) {
  machine::RunObserver observer;
  machine::RunSetup dry = SetupOf(ParametersOf("t1"), "PU;");
  dry.simul = machine::ProgramStep{.program = 1, .step = 0};
  EXPECT_TRUE(Rml1Family().NewRun(dry, observer));
  TestRun run(ParametersOf("t1"), "PU1,1;PU2,2;");
  machine::EnterableRun* const entry = run->enterable();
  ASSERT_NE(entry, nullptr);
  const auto refused = [&](int program, int step, std::uint64_t occurrence) {
    const Status halts =
        entry->HaltBefore({.at = {.program = program, .step = step}, .occurrence = occurrence});
    if (halts) return false;
    EXPECT_EQ(halts.error().code, ErrorCode::kCellStepUnreachable);
    return true;
  };
  EXPECT_TRUE(refused(1, 0, 1));
  EXPECT_TRUE(refused(2, 1, 1));
  EXPECT_TRUE(refused(1, 1, 2));
  EXPECT_FALSE(refused(1, 1, 1));
}

}  // namespace
}  // namespace rmlcell::rml1
