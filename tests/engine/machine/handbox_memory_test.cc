// The memory of a machine and the handbox on it: what keys ask for, what is shown again, what is in
// use.
#include <gmock/gmock.h>

#include "engine/machine/handbox.h"
#include "engine/machine/start_preview.h"
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

class HandboxMemory : public MachineTest {
 protected:
  // A tap each; what the last one said.
  KeyAnswer Keys(const std::vector<std::string_view>& keys) {
    KeyAnswer last;
    for (const std::string_view key : keys) {
      Result<KeyAnswer> answer = machine->PressKey(key);
      EXPECT_TRUE(answer) << key;
      if (answer) last = *std::move(answer);
    }
    return last;
  }
  ShownStep Shown() const { return machine->status().shown; }
};

// LIVE-7.08: an edit is open until its own program is stored in its own slot, and no other.
TEST_F(HandboxMemory, AnEditEndsWhenItsOwnProgramIsStored) {
  Load({"DELAY 1\nDELAY 2\nSPEED 5\n", "DELAY 4\n"});
  Good(ChangeMode{Mode::kManual});
  const KeyAnswer answer = Keys({"JOB", "0", "1", "NEXT", "2", "ENT", "DEL", "1"});
  ASSERT_TRUE(answer.edit);
  EXPECT_EQ(answer.edit->program, 1);
  ASSERT_TRUE(machine->settles());
  const StoredProgram edited{.name = "taught", .object = Bytes::Of(answer.edit->object)};
  Good(StoreProgram{.slot = 2, .program = edited});
  EXPECT_TRUE(machine->settles());
  Good(StoreProgram{.slot = 1, .program = Translated("DELAY 1\nDELAY 2\n")});
  EXPECT_TRUE(machine->settles());
  Good(DeleteProgram{1});
  EXPECT_TRUE(machine->settles());
  Good(StoreProgram{.slot = 1, .program = edited});
  EXPECT_FALSE(machine->settles());
  EXPECT_EQ(Shown(), (ShownStep{.program = 1, .step = 2, .instruction = "SPEED"}));
}

// LIVE-7.02: the program that is selected is shown as it is now, whoever changed it; another one
// changes nothing.
TEST_F(HandboxMemory, WhatIsShownIsReadAgain) {
  Load({"DELAY 1\nDELAY 2\n", "DELAY 1\nDELAY 2\n"});
  Good(ChangeMode{Mode::kManual});
  Keys({"JOB", "0", "1", "NEXT", "2", "ENT"});
  ASSERT_EQ(Shown(), (ShownStep{.program = 1, .step = 2, .instruction = "DELAY"}));
  Good(StoreProgram{.slot = 2, .program = Translated("DELAY 1\nSPEED 5\n")});
  EXPECT_EQ(Shown().instruction, "DELAY");
  Good(StoreProgram{.slot = 1, .program = Translated("DELAY 1\nSPEED 5\n")});
  EXPECT_EQ(Shown(), (ShownStep{.program = 1, .step = 2, .instruction = "SPEED"}));
  Good(DeleteProgram{2});
  EXPECT_EQ(Shown().instruction, "SPEED");
  Good(DeleteProgram{1});
  EXPECT_EQ(Shown().program, 1);
  EXPECT_EQ(Shown().instruction, "");
}

// LIVE-7.02: beside a run that is held, and while ZERO moves the axes, as well.
TEST_F(HandboxMemory, WhatIsShownBesideARunIsReadAgain) {
  Load({"DELAY 5\nDELAY 5\n", "DELAY 1\nDELAY 2\n"});
  Start();
  GoOn(At(1.0));
  Good(ChangeMode{Mode::kManual});
  GoOn(At(7.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  Keys({"JOB", "0", "2", "NEXT", "2", "ENT"});
  ASSERT_EQ(Shown(), (ShownStep{.program = 2, .step = 2, .instruction = "DELAY"}));
  Good(StoreProgram{.slot = 2, .program = Translated("DELAY 1\nSPEED 5\n")});
  EXPECT_EQ(Shown(), (ShownStep{.program = 2, .step = 2, .instruction = "SPEED"}));
  Load({"DELAY 1\nDELAY 2\n"});
  Good(ChangeMode{Mode::kManual});
  Keys({"JOB", "0", "1", "NEXT", "2", "ENT"});
  Good(ZeroAxes{});
  ASSERT_EQ(state(), MachineState::kJogging);
  Good(StoreProgram{.slot = 1, .program = Translated("DELAY 1\nSPEED 5\n")});
  EXPECT_EQ(Shown(), (ShownStep{.program = 1, .step = 2, .instruction = "SPEED"}));
}

// LIVE-5.04, LIVE-7.02: where a job is in the program that is selected is not what is selected: the
// step stays the one that a person chose, and is read again when the program is stored meanwhile.
TEST_F(HandboxMemory, WhereAJobIsIsNotSelected) {
  Load({"DELAY 3\nDELAY 4\n"});
  Good(ChangeMode{Mode::kManual});
  Keys({"JOB", "0", "1", "NEXT", "2", "ENT"});
  ASSERT_EQ(Shown(), (ShownStep{.program = 1, .step = 2, .instruction = "DELAY"}));
  Good(ChangeMode{Mode::kRemote});
  Good(StartRun{.program = 1, .source = StartSource::kQueue});
  GoOn(At(1.0));
  ASSERT_EQ(Shown().step, 1);
  Good(StoreProgram{.slot = 1, .program = Translated("DELAY 3\nSPEED 5\n")});
  GoOn(At(30.0));
  ASSERT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(Shown(), (ShownStep{.program = 1, .step = 2, .instruction = "SPEED"}));
}

// OPT-4.63: a program that runs, or that called the one that does, is not deleted by a key either.
TEST_F(HandboxMemory, WhatARunIsInIsNotDeletedByAKey) {
  Load({"CALL 2\n", "CALL 3\n", "DELAY 5\n", "DELAY 1\n"});
  Start();
  EXPECT_THAT(machine->loaded_programs(), testing::ElementsAre(1));
  GoOn(At(1.0));
  Good(ChangeMode{Mode::kManual});
  GoOn(At(7.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  for (const std::string_view slot : {"1", "2", "3"}) {
    const KeyAnswer refused = Keys({"JOB", "0", slot, "ENT", "SHIFT", "DEL"});
    EXPECT_EQ(refused.message, ErrorCode::kProgramInUse) << slot;
  }
  EXPECT_EQ(Keys({"JOB", "0", "4", "ENT", "SHIFT", "DEL"}).message, std::nullopt);
  EXPECT_TRUE(Keys({"1"}).edit);
}

class MillMemory : public MachineTest {
 protected:
  MillMemory() : MachineTest("rml1") {}
};

// LIVE-5.03: of a mill it is the stream that was started, from its first command on.
TEST_F(MillMemory, TheStreamThatRunsIsInUse) {
  Load({"PU0,0;", "PA;VS10;PU1000,1000;PU2000,2000;"});
  EXPECT_THAT(machine->loaded_programs(), testing::IsEmpty());
  Start(2);
  EXPECT_THAT(machine->loaded_programs(), testing::ElementsAre(2));
  GoOn(At(0.5));
  EXPECT_THAT(machine->loaded_programs(), testing::ElementsAre(2));
}

// LIVE-5.01: as a program that a job brings says it, and not as that of its slot does, wherever it
// begins; the slot may be empty.
TEST_F(HandboxMemory, AStartAtAStepIsOfWhatWasBrought) {
  for (const int slot : {1, 7}) {
    Load({"DELAY 1\nDELAY 1\nVI[5]=3\n"});
    const StartAtStep input{.program = slot,
                            .source = StartSource::kQueue,
                            .target = {.at = {slot, 3}},
                            .acknowledged = {"clamps"},
                            .brought = Translated("DELAY 2\nDELAY 3\nVI[5]=8\nDELAY 1\n")};
    const Result<StartPreview> preview = machine->Preview(input);
    ASSERT_TRUE(preview) << preview.error().detail;
    EXPECT_EQ(preview->run_time, At(5.0));
    Good(input);
    GoOn(machine->time() + At(60.0));
    EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
    EXPECT_EQ(Value("VI[5]"), "8");
  }
}

}  // namespace
}  // namespace rmlcell::machine
