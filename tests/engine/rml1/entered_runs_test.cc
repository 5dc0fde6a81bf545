// Runs that are led to a command and begin there, and all that a mill is at.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "engine/machine/standing.h"
#include "engine/machine/step_entry.h"
#include "engine/rml1/rml1_family.h"
#include "engine/rml1/state_items.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, Z0 20 mm below the top, 200 mm/s2, travel at 60 mm/s.
namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::RunPhase;
using namespace std::chrono_literals;

// Down to 1 mm in the work at (20, 5), and 10 mm on from there. The seventh command is the second
// PD.
const std::string kTwoCuts = "VS10;V10;!PZ-100,200;!MC1;PU1000,500;PD2000,500;PD3000,500;PU0,0;";
constexpr int kSecondCut = 7;

machine::Parameters WithRunUp() {
  machine::Parameters parameters = ParametersOf("t1");
  EXPECT_TRUE(parameters.Set("SPIN_UP", 2.0).ok());
  return parameters;
}

std::string StandingNow() { return Rml1Family().NewStanding(WithRunUp(), {}).value()->Save(); }

// A run that has come to the second cut.
struct LedToTheCut : TestRun {
  LedToTheCut() : TestRun(WithRunUp(), kTwoCuts) {
    EXPECT_TRUE((*this)->enterable()->HaltBefore({.at = {1, kSecondCut}}));
    EXPECT_EQ(AdvanceToEnd(), RunPhase::kHalted);
  }
};

class EntryTold final : public machine::RunObserver {
 public:
  void OnEntered(SimTime at) override { entered.push_back(at); }
  void OnHalt(const machine::Halt& halt) override { halts.emplace_back(halt.why); }
  void OnMotion(const machine::MotionDone& motion) override {
    if (motion.approach) ++approaches;
    if (motion.in_work) ++in_work;
  }

  int approaches = 0;
  int in_work = 0;
  std::vector<SimTime> entered;
  std::vector<std::string> halts;
};

// One that begins there, as the order says.
std::unique_ptr<machine::Run> EnteredAtTheCut(const machine::EntryOrder& order, EntryTold& told) {
  LedToTheCut there;
  auto run = Rml1Family().NewRun(SetupOf(WithRunUp(), kTwoCuts), told).value();
  run->Restore(*there->Save());
  run->enterable()->Enter(order);
  return run;
}

RunPhase AdvanceOn(machine::Run& run) {
  RunPhase phase = RunPhase::kRunning;
  while (phase == RunPhase::kRunning) phase = run.Advance(kForever);
  return phase;
}

double FigureNamed(const machine::Run& run, const std::string& name) {
  return ByName(run.figures()).at(name);
}

// From rest to rest, where the speed is reached.
double WayTime(double length_mm, double speed_mm_s) {
  return length_mm / speed_mm_s + speed_mm_s / 200.0;
}
const double kAcross_mm = std::hypot(20.0, 5.0);  // from the origin to where the cut begins

// LIVE-6.05: the way there is across at the top, where the tool stands, and down by V.
TEST(EnteredRuns, TheWayThere) {
  LedToTheCut there;
  const std::vector<machine::ApproachMotion> way =
      there->enterable()->PlanApproach(StandingNow(), machine::ApproachWay::kSafe);
  ASSERT_EQ(way.size(), 2U);
  for (const machine::ApproachMotion& motion : way) {
    EXPECT_EQ(motion.to.a_rad, 0.0);
    EXPECT_EQ(motion.to.b_rad, 0.0);
    EXPECT_TRUE(motion.beyond.empty());
  }
  EXPECT_EQ(way[0].path, "PU");
  EXPECT_EQ(way[0].feed_mm_s, 0.0);
  EXPECT_NEAR((way[0].to.column - motion::MachinePoint(20.0, 5.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(way[1].path, "PD");
  EXPECT_EQ(way[1].feed_mm_s, 10.0);
  EXPECT_NEAR((way[1].to.column - motion::MachinePoint(20.0, 5.0, -21.0)).norm(), 0.0, 1e-9);
}

// LIVE-6.09: right behind its entry it is on its way, at its command, at the time of the run that
// led there, and the spindle stands yet.
TEST(EnteredRuns, RightBehindTheEntry) {
  const SimTime there = LedToTheCut()->state().time;
  ASSERT_GT(there, SimTime::zero());
  for (const double percent : {50.0, 1000.0, 1.0}) {
    EntryTold told;
    const auto run = EnteredAtTheCut(
        {.machine_state = StandingNow(), .override_percent = percent, .halt_at_entry = true}, told);
    const machine::RunState state = run->state();
    EXPECT_EQ(state.phase, RunPhase::kRunning);
    EXPECT_TRUE(state.approaching);
    EXPECT_FALSE(state.halted_by);
    EXPECT_FALSE(state.spindle_on);
    EXPECT_EQ(state.place.step, kSecondCut);
    EXPECT_EQ(state.time, there);
    EXPECT_EQ(state.tip.tip.x(), 0.0);
    EXPECT_EQ(state.override_percent, percent == 50.0 ? 50.0 : percent > 50.0 ? 200.0 : 10.0);
    EXPECT_FALSE(run->enterable()->reached());
  }
}

// LIVE-6.09: the way there takes its time, at half of V with an override of 50 %, and is no work
// of the program: that begins with nothing done.
TEST(EnteredRuns, TheWayThereIsNoWork) {
  const SimTime there = LedToTheCut()->state().time;
  EntryTold told;
  const auto run = EnteredAtTheCut(
      {.machine_state = StandingNow(), .override_percent = 50.0, .halt_at_entry = true}, told);
  ASSERT_EQ(AdvanceOn(*run), RunPhase::kHalted);
  EXPECT_EQ(told.halts, std::vector<std::string>{"ENTRY"});
  EXPECT_EQ(run->state().halted_by, machine::HaltReason::kBreakpoint);
  EXPECT_FALSE(run->state().approaching);
  EXPECT_TRUE(run->state().spindle_on);
  ASSERT_EQ(told.entered.size(), 1U);
  EXPECT_EQ(run->state().approached, told.entered[0] - there);
  EXPECT_NEAR(ToSeconds(run->state().approached), WayTime(kAcross_mm, 60) + 2.0 + WayTime(21, 5),
              1e-7);
  for (const char* name : {"motions", "travel_length", "cut_length", "motion_time", "spindle_time",
                           "tool_up_time", "tool_down_time", "halted_time", "plunges"})
    EXPECT_EQ(FigureNamed(*run, name), 0.0) << name;
  EXPECT_EQ(told.approaches, 2);  // across and down
  EXPECT_EQ(told.in_work, 0);
  run->Apply({.at = run->state().time, .kind = InputKind::kStart});
  ASSERT_EQ(AdvanceOn(*run), RunPhase::kFinished);
  EXPECT_EQ(FigureNamed(*run, "motions"), 3.0);  // the cut, up 3 mm, and across
  EXPECT_EQ(told.approaches, 2);
  EXPECT_EQ(told.in_work, 1);
  EXPECT_NEAR(FigureNamed(*run, "cut_length"), 10.0, 1e-9);
  EXPECT_NEAR(FigureNamed(*run, "travel_length"), 3.0 + std::hypot(30.0, 5.0), 1e-9);
  EXPECT_EQ(FigureNamed(*run, "spindle_time"), 0.0);
}

// Nor is a halt on the way there one of the program.
TEST(EnteredRuns, AHaltOnTheWayThere) {
  EntryTold told;
  const auto run = EnteredAtTheCut({.machine_state = StandingNow(), .halt_at_entry = true}, told);
  run->Advance(run->state().time + 100ms);
  run->Apply({.at = run->state().time, .kind = InputKind::kStop});
  ASSERT_EQ(AdvanceOn(*run), RunPhase::kHalted);
  EXPECT_TRUE(run->state().approaching);
  run->Stand(run->state().time + 5s);
  run->Apply({.at = run->state().time, .kind = InputKind::kStart});
  ASSERT_EQ(AdvanceOn(*run), RunPhase::kHalted);
  EXPECT_EQ(told.halts, (std::vector<std::string>{"STOP", "ENTRY"}));
  EXPECT_EQ(FigureNamed(*run, "halted_time"), 0.0);
  EXPECT_GT(ToSeconds(run->state().approached), 5.0 + WayTime(kAcross_mm, 60) + 2.0);
}

// step_entry.h: who forgets the command has a run as any other one.
TEST(EnteredRuns, ATargetThatIsForgotten) {
  TestRun before(WithRunUp(), kTwoCuts);
  ASSERT_TRUE(before->enterable()->HaltBefore({.at = {1, kSecondCut}}));
  before->enterable()->ForgetTarget();
  EXPECT_EQ(before.AdvanceToEnd(), RunPhase::kFinished);
  LedToTheCut behind;
  ASSERT_TRUE(behind->enterable()->reached());
  behind->enterable()->ForgetTarget();
  EXPECT_FALSE(behind->enterable()->reached());
  behind.Press(InputKind::kStart);
  EXPECT_EQ(behind.AdvanceToEnd(), RunPhase::kFinished);
}

// LIVE-6.04: the tool is down by its state, at the surface too, or where it stands below that.
TEST(EnteredRuns, WhenTheToolIsDown) {
  const auto down = [](const std::string& first) {
    TestRun run(ParametersOf("t1"), first + "PA;");
    EXPECT_TRUE(run->enterable()->HaltBefore({.at = {1, 2}}));
    EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
    EXPECT_TRUE(run->enterable()->reached()->stands);
    return run->enterable()->reached()->tool_down;
  };
  EXPECT_FALSE(down("PU100,0;"));
  EXPECT_TRUE(down("PD100,0;"));
  EXPECT_TRUE(down("Z100,0,-50;"));
  EXPECT_FALSE(down("Z100,0,0;"));
}

class StepsDue final : public machine::StepWatcher {
 public:
  void OnStepDue(const machine::StepFacts& facts) override {
    told += std::to_string(facts.place.step) + (facts.inside_command ? " inside " : " clean ");
  }
  std::string told;
};

// Behind a command that ESC.K cut off no run can halt, whether it had done anything or not.
TEST(EnteredRuns, CommandsBehindOneThatWasCutOff) {
  const auto told = [](const std::string& stream) {
    StepsDue watcher;
    TestRun run(ParametersOf("t1"), stream);
    run->enterable()->WatchSteps(&watcher);
    EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    return watcher.told;
  };
  EXPECT_EQ(told("PU100,100;PD200,200;PU300,300;"), "1 clean 2 clean 3 clean ");
  EXPECT_EQ(told("PU100,1\x1b.KPU200,200;PU300,300;"), "2 inside 3 clean ");
  EXPECT_EQ(told("PU100,100,5\x1b.KPD200,200;PU300,300;"), "1 clean 2 inside 3 clean ");
}

std::vector<std::string> TextsOf(const std::vector<machine::StateItem>& items) {
  std::vector<std::string> texts;
  for (const machine::StateItem& item : items) texts.push_back(item.name + ": " + item.value);
  return texts;
}

// LIVE-6.02: all that a mill is at, before the second cut.
TEST(MillItems, OfARun) {
  LedToTheCut there;
  EXPECT_EQ(TextsOf(there->enterable()->items()),
            (std::vector<std::string>{"pose: X 2000 Y 500 Z -2100 A 0",
                                      "spindle: on",
                                      "origin: 0, 0",
                                      "command set: auto",
                                      "pending: 0 bytes",
                                      "tool: as the program means",
                                      "clamps: as the program means",
                                      "VS: 10",
                                      "VZ: 10",
                                      "DW: 0",
                                      "MC: on",
                                      "RPM: 4500",
                                      "Z0: -2000",
                                      "Z1: -100",
                                      "Z2: 200",
                                      "MODE: abs",
                                      "TOOL: down",
                                      "ERR: 0",
                                      "COM: 0",
                                      "ESC.M: default default default default default default",
                                      "ESC.T: default default default default default",
                                      "logical: X 2000 Y 500 Z -2100 A 0"}));
}

// Of one that stands nobody knows what is fitted. The origin is that of its parameters.
TEST(MillItems, OfAMillThatStands) {
  machine::Parameters parameters = ParametersOf("t1f");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", 12.5).ok());
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", 7.0).ok());
  ASSERT_TRUE(parameters.Set("COMMAND", std::string_view("MODE2")).ok());
  const auto mill = Rml1Family().NewStanding(parameters, {}).value();
  const std::vector<std::string> texts = TextsOf(mill->items());
  ASSERT_EQ(texts.size(), 22U);
  EXPECT_EQ(std::vector<std::string>(texts.begin(), texts.begin() + 7),
            (std::vector<std::string>{"pose: X 1250 Y 700 Z 0 A 0", "spindle: off",
                                      "origin: 1250, 700", "command set: mode 2",
                                      "pending: 0 bytes", "tool: not known", "clamps: not known"}));
  EXPECT_EQ(texts.back(), "logical: X 1250 Y 700 Z 0 A 0");
}

// Places are told to a millionth of a unit, and what rounds to nothing has no sign.
TEST(MillItems, PlacesAreRounded) {
  const Profile profile = MakeProfile(ParametersOf("t1a")).value();
  const Device device(profile);
  const auto items = ItemsOf(device, profile, {.at = {-4e-7, 12.0000004, -1234.5678914, 0.25}}, "");
  EXPECT_EQ(items.front().value, "X 0 Y 12 Z -1234.567891 A 0.25");
}

// registers.h: what holds until a command changes it, of a run as of a mill that stands.
TEST(MillItems, ModalValues) {
  const auto texts = [](const std::vector<machine::ModalValue>& values) {
    std::string told;
    for (const machine::ModalValue& one : values) told += one.name + " " + one.value + "; ";
    return told;
  };
  TestRun run(ParametersOf("t1"), "PR;VS7;V8;W9;!RC15;!MC0;!ZO-1000;!PZ-7,40;PD;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  // In relative coordinates !ZO counts from where the tool stands, which is the top.
  const std::string told =
      "VS 7; VZ 8; DW 9; MC off; RPM 15000; Z0 -1000; Z1 -7; Z2 40; MODE rel; TOOL down; ";
  EXPECT_EQ(texts(run->modal_values()), told);
  const auto mill = Rml1Family().NewStanding(ParametersOf("t1"), run->SaveMachine()).value();
  EXPECT_EQ(texts(mill->modal_values()), told);
}

// LIVE-6.05: the way there begins where the machine stands: up to the top first, and across.
TEST(EnteredRuns, TheWayThereFromElsewhere) {
  const auto mill = Rml1Family().NewStanding(WithRunUp(), {}).value();
  mill->MoveTo({.column = {50.0, 60.0, -30.0}, .a_rad = 0.0, .b_rad = 0.0});
  LedToTheCut there;
  const std::vector<machine::ApproachMotion> way =
      there->enterable()->PlanApproach(mill->Save(), machine::ApproachWay::kSafe);
  ASSERT_EQ(way.size(), 3U);
  EXPECT_NEAR((way[0].to.column - motion::MachinePoint(50.0, 60.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((way[1].to.column - motion::MachinePoint(20.0, 5.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((way[2].to.column - motion::MachinePoint(20.0, 5.0, -21.0)).norm(), 0.0, 1e-9);
}

// LIVE-6.09: in SINGLE it halts behind each motion of the way there, once: not behind the start of
// the spindle, and not before anything moved.
TEST(EnteredRuns, SingleStepsOfTheWayThere) {
  EntryTold told;
  const auto run = EnteredAtTheCut({.machine_state = StandingNow(), .halt_at_entry = true}, told);
  run->SetMode(machine::Mode::kSingle);
  for (const std::size_t halts : {1U, 2U, 3U}) {
    ASSERT_EQ(AdvanceOn(*run), RunPhase::kHalted);
    ASSERT_EQ(told.halts.size(), halts);
    run->Apply({.at = run->state().time, .kind = InputKind::kStart});
  }
  EXPECT_EQ(told.halts, (std::vector<std::string>{"SINGLE", "SINGLE", "ENTRY"}));
  EXPECT_FALSE(run->state().approaching);
}

// RML1-3C.08: a pause behind the entry that no key of a script ends is told as one of any other
// run.
TEST(EnteredRuns, APauseBehindTheEntry) {
  const std::string stream = kTwoCuts + "!NR;PU100,0;";
  TestRun there(WithRunUp(), stream);
  ASSERT_TRUE(there->enterable()->HaltBefore({.at = {1, kSecondCut}}));
  ASSERT_EQ(there.AdvanceToEnd(), RunPhase::kHalted);
  TestRun run(WithRunUp(), stream);
  run->Restore(*there->Save());
  run->enterable()->Enter({.machine_state = StandingNow()});
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run.variable("X"), "0");
  EXPECT_EQ(run.seen().CountOf(ErrorCode::kRml1PausedAtEnd), 1);
}

// The same where the run that led there had a key of its own: the script begins anew, too.
TEST(EnteredRuns, TheScriptBeginsAnew) {
  const std::string stream = kTwoCuts + "!NR;PU100,0;";
  TestRun there(WithRunUp(), stream,
                {{.at = 1s, .kind = InputKind::kOverride, .index = 0, .value = 100.0}});
  ASSERT_TRUE(there->enterable()->HaltBefore({.at = {1, kSecondCut}}));
  ASSERT_EQ(there.AdvanceToEnd(), RunPhase::kHalted);
  ASSERT_GT(there->state().time, SimTime(1s));
  TestRun run(WithRunUp(), stream);
  run->Restore(*there->Save());
  run->enterable()->Enter({.machine_state = StandingNow()});
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run.seen().Events().back(), "diagnostic RML1-E8006");
  EXPECT_EQ(run.seen().CountOf(ErrorCode::kRml1PausedAtEnd), 1);
}

// LIVE-6.09: the way there takes its time from when it is begun, however long the run that led to
// the command stood there.
TEST(EnteredRuns, TheWayThereTakesItsTimeBehindAHalt) {
  LedToTheCut there;
  there->Stand(there->state().time + 20s);
  EntryTold told;
  const auto run = Rml1Family().NewRun(SetupOf(WithRunUp(), kTwoCuts), told).value();
  run->Restore(*there->Save());
  run->enterable()->Enter({.machine_state = StandingNow(), .halt_at_entry = true});
  const SimTime begun = run->state().time;
  EXPECT_EQ(begun, there->state().time);
  ASSERT_EQ(AdvanceOn(*run), RunPhase::kHalted);
  const double way_s = WayTime(kAcross_mm, 60) + 2.0 + WayTime(21, 10);
  EXPECT_NEAR(ToSeconds(run->state().approached), way_s, 1e-7);
  EXPECT_NEAR(ToSeconds(run->state().time - begun), way_s, 1e-7);
}

// step_entry.h: what is fitted to it, and where its zero is, a person sees to; it goes to its
// place, switches its spindle, and is set to all the rest.
TEST(MillItems, WhatIsDoneWithThem) {
  LedToTheCut there;
  for (const machine::StateItem& item : there->enterable()->items()) {
    const bool asked =
        item.name == "origin" || item.name == "tool" || item.name == "clamps" || item.name == "Z0";
    const machine::StartAction wanted = item.name == "pose"      ? machine::StartAction::kMove
                                        : item.name == "spindle" ? machine::StartAction::kSwitch
                                        : asked                  ? machine::StartAction::kAsk
                                                                 : machine::StartAction::kSet;
    EXPECT_EQ(item.action, wanted) << item.name;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
