// What of the memory a run that starts at a step has: programs, executables, schedules.
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::IsEmpty;

class StartAtMemory : public StartTest {};

// LIVE-5.04, OPT-1.11: a program that a job brings is nobody's choice and in no slot, wherever it
// begins: it is not in use, and its executable is not that of the slot.
TEST_F(StartAtMemory, WhatAJobBringsIsNotOfTheMemory) {
  Load({"DELAY 1\nDELAY 60\n", "DELAY 1\nDELAY 5\n"});
  Start(2);
  GoOn(At(10.0));
  Over();
  ASSERT_EQ(machine->TakeMadeExecutables().size(), 1U);
  StartAtStep input = At1(2);
  input.source = StartSource::kQueue;
  input.brought = Translated("VI[5]=7\nDELAY 20\nDELAY 1\n");
  Good(input);
  GoOn(At(15.0));
  ASSERT_EQ(state(), MachineState::kRunning);
  EXPECT_THAT(machine->loaded_programs(), IsEmpty());
  EXPECT_EQ(machine->selected_program(), 2);
  GoOn(At(100.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(machine->selected_program(), 2);
  EXPECT_THAT(machine->TakeMadeExecutables(), IsEmpty());
  EXPECT_TRUE(machine->memory().programs.at(1).executable == nullptr);
}

// What was stored before it began is what its executable is made of.
TEST_F(StartAtMemory, TheExecutableOfANewProgramIsKept) {
  Load({"DELAY 1\n"});
  Good(StoreProgram{.slot = 2, .program = Translated("DELAY 1\nDELAY 2\n")});
  StartAtStep input = At1(2);
  input.program = 2;
  input.target.at = {2, 2};
  Good(input);
  EXPECT_EQ(machine->selected_program(), 2);
  GoOn(At(60.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(machine->TakeMadeExecutables().size(), 1U);
}

// LIVE-6.01: with the schedules that are stored.
TEST_F(StartAtMemory, HasTheSchedulesThatAreStored) {
  Load({"WORKDEF 2,1 (7)\nWORK 2,1/ON\nWORKDEF 0,0\nWORK 0,0/ON\nDELAY 5\nWORK 0,0/OFF\n"});
  LaserSchedule schedule;
  schedule.number = 7;
  schedule.power_percent = 60.0;
  Good(SetSchedules{.schedules = std::vector{schedule}});
  Good(At1(2));
  double most = 0.0;
  for (int n = 0; n < 100; ++n) {
    GoOn(machine->time() + At(0.25));
    most = std::max(most, machine->outputs().power_percent);
  }
  EXPECT_EQ(most, 60.0);
}

}  // namespace
}  // namespace rmlcell::machine
