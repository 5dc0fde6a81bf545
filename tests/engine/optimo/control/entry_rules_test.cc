// A run that is entered at a step: what it takes from the machine that stands
// there, what it has from the run to the step, and how its outputs come to what
// they are there. LIVE-6, step_entry.h
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "engine/machine/step_entry.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::entry_rules {
namespace {

using machine::EntryOrder;
using machine::InputKind;
using machine::RunPhase;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// What the run tells from its entry on: what is switched, with its value, and
// when it was entered.
class Told final : public machine::RunObserver {
 public:
  void OnSignal(const machine::SignalChange& change) override {
    if (change.signal == machine::Signal::kOutput)
      lines.push_back("OL[" + std::to_string(change.index) + "] " + std::to_string(change.value));
    if (change.signal == machine::Signal::kBeam)
      lines.push_back("beam " + std::to_string(change.value));
    if (change.signal == machine::Signal::kSchedule)
      lines.push_back("schedule " + std::to_string(change.value));
  }
  void OnEntered(SimTime at) override { entered.push_back(at); }
  void OnDiagnostic(SimTime, const Diagnostic& finding) override {
    if (finding.code == ErrorCode::kSpeedHeldByAxis) held_at.push_back(finding.step);
    if (finding.code == ErrorCode::kSpeedLimited) limited_at.push_back(finding.step);
  }
  std::vector<std::string> lines;
  std::vector<SimTime> entered;
  std::vector<int> held_at;  // steps of contours that an axis holds back
  std::vector<int> limited_at;
};

struct Entry {
  std::string main;
  int step = 1;
  RunOptions options{};
  std::uint64_t occurrence = 1;
};

MachineState NewState(const Entry& entry) {
  return NewMachine(Resolve(SetupOf(entry.main, entry.options).parameters));
}

// One run goes to the step with nobody looking; another one is given its
// snapshot, and entered.
class Entered {
 public:
  Entered(const Entry& entry, const MachineState& stands, EntryOrder order = {},
          const machine::InputScript& later = {}) {
    machine::RunSetup setup = SetupOf(entry.main, entry.options);
    const std::unique_ptr<machine::Run> there = *OptimoFamily().NewRun(setup, nobody_);
    EXPECT_TRUE(there->enterable()
                    ->HaltBefore({.at = {1, entry.step}, .occurrence = entry.occurrence})
                    .ok());
    EXPECT_EQ(there->Advance(At(10'000.0)), RunPhase::kHalted);
    EXPECT_TRUE(there->enterable()->reached().has_value());
    setup.inputs = later;
    run = *OptimoFamily().NewRun(setup, told);
    told.lines.clear();
    run->Restore(*there->Save());
    order.machine_state = EncodeMachineState(stands);
    begun = run->state().time;
    run->enterable()->Enter(order);
  }
  // Until the approach is over, or the run halts or ends on it.
  void Approach() {
    while (run->state().approaching && run->state().phase == RunPhase::kRunning)
      run->Advance(run->state().time + SimTime(std::chrono::milliseconds(10)));
  }
  void ToEnd() {
    for (int n = 0; n < 100 && run->state().phase == RunPhase::kRunning; ++n)
      run->Advance(run->state().time + At(100.0));
  }
  void Press(InputKind kind, double value = 1.0) {
    run->Apply({.at = run->state().time, .kind = kind, .value = value});
  }
  std::string Shows() const {
    std::string text;
    for (const machine::OutputNow& one : run->outputs().on) text += one.name + " ";
    return text;
  }
  MachineState Kept() const { return *DecodeMachineState(run->SaveMachine()); }

  Told told;
  std::unique_ptr<machine::Run> run;
  SimTime begun{0};

 private:
  machine::RunObserver nobody_;
};

// The tip stands at (1000, 1000, -400) at step 4, and step 5 is its next.
std::string ThereAnd(const std::string& rest) {
  return kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\n" + rest;
}

// LIVE-6.03: on the way the outputs are those of the machine, with the shutter
// closed; at the entry they are switched to what the program has there, each
// told as on or off.
TEST(EntryRules, OutputsAreSwitchedAtTheEntry) {
  const Entry entry{.main = ThereAnd("OL[16]=ON\nOA[3]=1.5\nDELAY 1\n"), .step = 6};
  MachineState stands = NewState(entry);
  stands.outputs.logical[20] = true;
  stands.outputs.analogue[7] = 2.5F;
  stands.outputs.schedule = 15;
  Entered one(entry, stands);
  EXPECT_EQ(one.Shows(), "OL[20] OA[7] ");
  EXPECT_EQ(one.run->outputs().laser_schedule, 15);
  EXPECT_THAT(one.told.entered, IsEmpty());
  one.Approach();
  EXPECT_EQ(one.Shows(), "OL[16] OA[3] ");
  EXPECT_EQ(one.run->outputs().laser_schedule, 0);
  EXPECT_THAT(one.told.lines, ElementsAre("OL[20] 0.000000", "OL[16] 1.000000",
                                          "schedule "
                                          "0.000000"));
  ASSERT_EQ(one.told.entered.size(), 1U);
  EXPECT_EQ(one.told.entered[0], one.begun + one.run->state().approached);
  EXPECT_GT(one.told.entered[0], one.begun);
}

// OPT-5.40, LIVE-6.03: an assist gas makes way for the other, whichever of the
// two it is.
TEST(EntryRules, OneGasIsOffBeforeTheOtherIsOn) {
  for (const auto& [there, here] : {std::pair{8, 9}, std::pair{9, 8}}) {
    const Entry entry{.main = ThereAnd("OL[" + std::to_string(there) + "]=ON\nDELAY 1\n"),
                      .step = 5,
                      .options = {.parameters = {{"GAS_CHANNELS", "3"}}}};
    MachineState stands = NewState(entry);
    stands.outputs.logical[static_cast<std::size_t>(here)] = true;
    Entered one(entry, stands);
    one.Approach();
    EXPECT_EQ(one.Shows(), "OL[" + std::to_string(there) + "] ");
    EXPECT_THAT(one.told.lines, ElementsAre("OL[" + std::to_string(here) + "] 0.000000",
                                            "OL[" + std::to_string(there) + "] 1.000000"));
  }
}

// LIVE-6.03: inputs are those of the machine, not those that the run to the
// step had.
TEST(EntryRules, InputsAreThoseOfTheMachine) {
  const Entry entry{.main = ThereAnd("VR[1]=IA[40]\nVR[2]=IA[40]\nVL[2]=IL[20]\nDELAY 1\n"),
                    .step = 5,
                    .options = {.inputs = {{SimTime(0), InputKind::kAnalogue, 40, 1.5},
                                           {SimTime(0), InputKind::kLogical, 20, 1.0}}}};
  MachineState stands = NewState(entry);
  stands.data.ia_physical[40] = 2.5F;
  Entered one(entry, stands);
  one.ToEnd();
  EXPECT_EQ(one.run->ReadVariable("VR[1]")->text, "1.5");
  EXPECT_EQ(one.run->ReadVariable("VR[2]")->text, "2.5");
  EXPECT_EQ(one.run->ReadVariable("VL[2]")->text, "0");
}

// What comes from outside from the entry on is the script of the run that was
// entered, from its first input on, however many the run to the step had.
TEST(EntryRules, ItsScriptBeginsAnew) {
  const Entry entry{.main = ThereAnd("DELAY 5\nWAIT IL[20]\nVI[2]=1\n"),
                    .step = 5,
                    .options = {.inputs = {{At(0.1), InputKind::kLogical, 21, 1.0},
                                           {At(0.2), InputKind::kLogical, 22, 1.0}}}};
  Entered one(entry, NewState(entry), {},
              {{At(900.0), InputKind::kLogical, 20, 1.0}, {At(950.0), InputKind::kStop}});
  one.ToEnd();
  EXPECT_EQ(one.run->state().phase, RunPhase::kFinished);
  EXPECT_EQ(one.run->state().time, At(900.0));
  EXPECT_EQ(one.run->ReadVariable("VI[2]")->text, "1");
}

// OPT-4.48: zeroed or not is the machine's: a MOVE behind the entry needs the
// reference.
TEST(EntryRules, WithoutReferenceItsNextMoveIsRefused) {
  const Entry entry{.main = ThereAnd("VI[2]=1\nMOVE (1100.,1000.,-400.,0.,0.)\n"), .step = 4};
  MachineState stands = NewState(entry);
  for (const bool zeroed : {true, false}) {
    stands.zeroed = zeroed;
    Entered one(entry, stands);
    EXPECT_EQ(one.run->state().zeroed, zeroed);
    one.ToEnd();
    EXPECT_EQ(one.run->outcome().code.has_value(), !zeroed);
    if (!zeroed) {
      EXPECT_EQ(one.run->outcome().code, ErrorCode::kNotZeroed);
    }
    EXPECT_EQ(one.Kept().zeroed, zeroed);
  }
}

// OPT-6.16: SIMUL is armed for a whole run: what the machine has stays armed,
// unless the program had armed another one on the way to the step.
TEST(EntryRules, AnArmedSimulStays) {
  for (const auto& [text, program] : {std::pair{"VI[2]=1\n", 45}, std::pair{"SIMUL 7, 46\n", 46}}) {
    const Entry entry{.main = ThereAnd(std::string(text) + "VI[3]=1\n"), .step = 5};
    MachineState stands = NewState(entry);
    stands.simul = machine::ProgramStep{.program = 45, .step = 9};
    Entered one(entry, stands);
    one.ToEnd();
    EXPECT_FALSE(one.run->state().dry);
    ASSERT_TRUE(one.Kept().simul.has_value()) << text;
    EXPECT_EQ(one.Kept().simul->program, program);
  }
}

// OPT-3.19: the door is that of the machine: with it open no beam comes on
// behind the entry.
TEST(EntryRules, TheDoorIsThatOfTheMachine) {
  const Entry entry{.main = ThereAnd("VI[2]=1\nWORK 0,0/ON\nWORK 0,0/OFF\n"), .step = 4};
  MachineState stands = NewState(entry);
  for (const bool open : {false, true}) {
    stands.door_open = open;
    Entered one(entry, stands);
    EXPECT_EQ(one.run->state().door_open, open);
    one.ToEnd();
    EXPECT_EQ(one.run->outcome().code.has_value(), open);
    if (open) {
      EXPECT_EQ(one.run->outcome().code, ErrorCode::kShutterInterlock);
    }
  }
}

// OPT-6.21, LIVE-6.04: a process that is ON there has no beam before the next
// WORK ON, also where the run halts at the entry and START is pressed, and the
// shutter is closed until then.
TEST(EntryRules, NoBeamComesWithStartAtTheEntry) {
  const Entry entry{
      .main = ThereAnd("WORK 0,0/ON\nMOVE (1100.,1000.,-400.,0.,0.)\nWORK 0,0/ON\nDELAY 1\n"
                       "WORK 0,0/OFF\n"),
      .step = 5};
  Entered one(entry, NewState(entry), {.halt_at_entry = true});
  EXPECT_EQ(one.Shows(), "");
  one.Approach();
  ASSERT_EQ(one.run->state().phase, RunPhase::kHalted);
  EXPECT_FALSE(one.run->state().approaching);
  one.Press(InputKind::kStart);
  one.run->Advance(one.run->state().time + At(0.5));
  EXPECT_FALSE(one.run->state().beam_on);
  EXPECT_EQ(one.Shows(), "");
  one.ToEnd();
  EXPECT_THAT(one.told.lines, ElementsAre("beam 1.000000", "beam 0.000000"));
}

// OPT-2.16: nobody was told on the way to the step, so the axis that holds the
// contour back there is told behind the entry, once.
TEST(EntryRules, WhatNobodyWasToldIsToldThere) {
  const Entry entry{.main = kAbsol +
                            "10 MOVE (1000.,1000.,-400.,0.,0.)\nVI[1]=VI[1]+1\n"
                            "SPEED 100\nMOVE (1010.,1000.,-400.,3.,0.)\nIF VI[1] < 3 THEN 10\n",
                    .step = 4,
                    .occurrence = 2};
  Entered one(entry, NewState(entry));
  one.ToEnd();
  EXPECT_EQ(std::ranges::count(one.told.held_at, 6), 1);
}

// OPT-4.38: nor that SPEED x override was too much there.
TEST(EntryRules, TooMuchSpeedIsToldBehindTheEntry) {
  const Entry entry{.main = kAbsol +
                            "SPEED 100\nMOVE (1000.,1000.,-400.,0.,0.)\nVI[2]=1\n"
                            "MOVE (1100.,1000.,-400.,0.,0.)\nMOVE (1000.,1000.,-400.,0.,0.)\n",
                    .step = 5,
                    .options = {.override_percent = 115.0}};
  Entered one(entry, NewState(entry), {.override_percent = 115.0});
  one.ToEnd();
  EXPECT_THAT(one.told.limited_at, ElementsAre(6));
}

// docs/verdict.md: what was cut wrongly before the step is nothing that this run did.
TEST(EntryRules, WhatWasDoneBeforeTheStepIsNotCounted) {
  const std::string cut = "SPEED 10\nWORK 0,0/ON\nMOVE (1100.,1000.,-400.,0.,0.)\nWORK 0,0/OFF\n";
  const Entry entry{.main = ThereAnd("OL[8]=ON\nOL[9]=ON\n" + cut + "VI[2]=1\n"),
                    .step = 10,
                    .options = {.parameters = {{"GAS_CHANNELS", "3"}}}};
  Entered one(entry, NewState(entry));
  one.ToEnd();
  for (const machine::Figure& figure : one.run->figures()) {
    if (figure.name == "other_gas_length") {
      EXPECT_EQ(figure.value, 0.0);
    }
  }
}

// LIVE-6.09: HOLD on the last motion of the approach: it halts behind that,
// still approaching, and nothing is switched before START.
TEST(EntryRules, AHoldOnTheLastMotionOfTheApproach) {
  const Entry entry{.main = ThereAnd("OL[16]=ON\nDELAY 1\n"), .step = 5};
  Entered one(entry, NewState(entry));
  while (one.run->state().axes.column.z() > -60.0)
    one.run->Advance(one.run->state().time + At(0.01));
  one.Press(InputKind::kHold);
  one.Approach();
  ASSERT_EQ(one.run->state().phase, RunPhase::kHalted);
  EXPECT_NEAR(one.run->state().axes.column.z(), -100.0, 1e-9);
  EXPECT_TRUE(one.run->state().approaching);
  EXPECT_EQ(one.Shows(), "");
  EXPECT_THAT(one.told.entered, IsEmpty());
  one.Press(InputKind::kStart);
  one.Approach();
  EXPECT_EQ(one.Shows(), "OL[16] ");
}

// OPT-B.22: a way that can never end is no way: the run fails where it stands.
TEST(EntryRules, AnApproachWithoutSpeedFails) {
  const Entry entry{.main = ThereAnd("VI[2]=1\n"), .step = 4};
  const MachineState stands = NewState(entry);
  Entered one(entry, stands, {.override_percent = 0.0});
  one.ToEnd();
  EXPECT_EQ(one.run->outcome().kind, machine::OutcomeKind::kFailed);
  EXPECT_EQ(one.run->outcome().code, ErrorCode::kNoMotion);
  EXPECT_EQ(one.run->outcome().place.step, 4);
  EXPECT_EQ(one.run->ReadVariable("VI[2]")->text, "0");
  EXPECT_EQ(one.run->state().axes, stands.axes);
}

// OPT-B.30, OPT-3.38: the ticks at which the /END of a WORK is looked at are
// counted from the WORK on; the way to the entry takes none of their time: 20
// ms are over, 28 ms are left to the first.
TEST(EntryRules, TicksOfABackgroundWorkGoOnAtTheEntry) {
  const Entry entry{.main = ThereAnd("WORK 0,0/ON/END (1 > 0)\nDELAY .02\nDELAY "
                                     ".027\nVL[1]=IL[87]\nDELAY .002\n"
                                     "VL[2]=IL[87]\n"),
                    .step = 6};
  Entered one(entry, NewState(entry));
  one.ToEnd();
  EXPECT_EQ(one.run->ReadVariable("VL[1]")->text, "1");
  EXPECT_EQ(one.run->ReadVariable("VL[2]")->text, "0");
}

// docs/verdict.md, OPT-5.40: a gas that was refused on the way to the step is
// refused behind the entry: what is cut there is cut with another one than the
// program asks for.
TEST(EntryRules, ARefusedGasIsStillRefused) {
  const Entry entry{.main = ThereAnd("OL[8]=ON\nOL[9]=ON\nSPEED 10\nVI[2]=1\nWORK 0,0/ON\n"
                                     "MOVE (1100.,1000.,-400.,0.,0.)\nWORK 0,0/OFF\n"),
                    .step = 7,
                    .options = {.parameters = {{"GAS_CHANNELS", "3"}}}};
  Entered one(entry, NewState(entry));
  one.ToEnd();
  double length = -1.0;
  for (const machine::Figure& figure : one.run->figures()) {
    if (figure.name == "other_gas_length") length = figure.value;
  }
  EXPECT_NEAR(length, 100.0, 1e-3);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::entry_rules
