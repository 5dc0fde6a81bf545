// What was asked for last, and what is over: a HOLD that is taken back, keys that nobody holds any
// more, the mode behind ZERO.
#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "engine/machine/handbox.h"
#include "tests/engine/machine/held_bed.h"

namespace rmlcell::machine {
namespace {

class LastWord : public HeldTest {
 protected:
  void Tap(std::string_view key) { ASSERT_TRUE(machine->PressKey(key)) << key; }
};

// live.md 2.10 a2: START takes a HOLD back as it does a STOP: halted behind its instruction the
// program goes on at once.
TEST_F(LastWord, AHoldIsTakenBack) {
  Load({kCorner});
  Good(ChangeMode{Mode::kCycle});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(5.0));
  Good(HoldRun{});
  ASSERT_EQ(state(), MachineState::kStopping);
  Good(ResumeRun{.source = StartSource::kPanel});
  GoOn(At(60.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// LIVE-2.03: keys against each other stand: STOP leaves nothing that comes to rest yet.
TEST_F(LastWord, WhatStandsIsNotStopping) {
  Load({});
  Good(ChangeMode{Mode::kManual});
  Good(PressJog{.key = kHeldXPlus});
  Good(PressJog{.key = kHeldXMinus});
  ASSERT_EQ(state(), MachineState::kJogging);
  Good(StopRun{});
  EXPECT_EQ(state(), MachineState::kIdle);
}

// LIVE-7.05: for HOME a key is down; a FUNCTION goes on though nobody holds one.
TEST_F(LastWord, ReleasedKeysEndNoFunction) {
  Load({kCorner, "DELAY 20\nRETURN\n"});
  Good(ChangeMode{Mode::kManual});
  for (const char* key : {"JOB", "1", "ENT", "F3", "0", "2", "ENT", "ENT", "1"}) Tap(key);
  GoOnFor(1.0);
  ASSERT_EQ(machine->status().by_hand, HandRun::kFunction);
  Good(ReleaseJogs{});
  EXPECT_EQ(state(), MachineState::kRunning);
  GoOnFor(60.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// LIVE-2.10: ZERO is over, and the machine stands: its mode may be another one.
TEST_F(LastWord, BehindZeroTheModeMayChange) {
  Load({"STOP\n"});
  Good(ChangeMode{Mode::kManual});
  Good(ZeroAxes{});
  GoOnFor(300.0);
  ASSERT_EQ(state(), MachineState::kIdle);
  Good(ChangeMode{Mode::kCycle});
  EXPECT_EQ(machine->status().mode, Mode::kCycle);
}

// OPT-4.51: no override acts on ZERO, and none is made of that which is selected.
TEST_F(LastWord, ZeroHasNoOverrideOfItsOwn) {
  Load({"STOP\n"});
  Good(ChangeMode{Mode::kManual});
  Good(ChangeOverride{60.0});
  Good(ZeroAxes{});
  EXPECT_EQ(machine->status().run.override_percent, 60.0);
}

// LIVE-3.01, OPT-4.35: nobody waits for a machine that lives: at 0.05 % of 1 mm/s it is on its way
// home beside a held run for more than the 30 days of a job.
TEST_F(LastWord, TheWayHomeHasNoEnd) {
  Load({"COORD ABSOL\nPATH LIN\nSPEED 100\nMOVE (2521.02, 2201.2, -350., 0., 0.)\nDELAY 90\n"});
  MachineMemory memory = machine->memory();
  Parameters slow = *MakeParameters(family_, std::string(family_.info().default_profile),
                                    {{"VMAX", "1"}, {"AXIS_SPEED_X", "1"}});
  machine = *Machine::Make(family_, std::move(slow), std::move(memory), {}, heard);
  HoldAt(2530.0);
  ASSERT_NEAR(Axes().column.x(), 2521.02, 1e-3);
  Good(ChangeOverride{10.0});
  const Result<KeyAnswer> home = machine->PressKey("HOME", KeyAction::kPress);
  ASSERT_TRUE(home);
  ASSERT_EQ(home->message, std::nullopt);
  GoOn(machine->time() + std::chrono::hours(24 * 40));
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_GT(Axes().column.x(), 500.0);
}

class LastWordOfMill : public MachineTest {
 protected:
  LastWordOfMill() : MachineTest("rml1") {}
};

// LIVE-7.02: a mill has no display that would show a step again: what is selected stays so,
// whatever is stored there, and when it is deleted.
TEST_F(LastWordOfMill, AStreamIsStoredAnewAndDeleted) {
  Load({"PU100,100;"});
  Start();
  GoOn(At(30.0));
  Over();
  ASSERT_EQ(machine->selected_program(), 1);
  Good(StoreProgram{.slot = 1, .program = Translated("PU200,200;")});
  EXPECT_EQ(machine->selected_program(), 1);
  Start();
  GoOn(At(60.0));
  EXPECT_EQ(Value("X"), "200");
  Good(DeleteProgram{1});
  EXPECT_EQ(machine->selected_program(), 1);
}

}  // namespace
}  // namespace rmlcell::machine
