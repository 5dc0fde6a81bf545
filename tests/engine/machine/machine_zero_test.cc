// ZERO on a machine that stands: from the console and at the machine itself (OPT-4.48 to 4.51).
#include <gmock/gmock.h>

#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

constexpr const char* kHome = "COORD ABSOL\nMOVE (100.,200.,-30.,0.,0.)\n";

class MachineZeroTest : public MachineTest {
 protected:
  // Four programs, and axes without reference.
  void LoadWithoutReference(const std::string& fourth = kHome) {
    Load({"STOP\n", "STOP\n", "STOP\n", fourth});
    Good(SwitchPower{false});
    Good(SwitchPower{true});
    ASSERT_EQ(state(), MachineState::kNotZeroed);
  }
  // The time at which the axes have their reference, in steps of a tenth of a second.
  double ZeroedAfter() {
    const SimTime begun = machine->time();
    while (!machine->status().run.zeroed && machine->time() < begun + At(600.0))
      GoOn(machine->time() + At(0.1));
    return ToSeconds(machine->time() - begun);
  }
};

// OPT-4.50: it ends at the mechanical zero and then runs program 4. LIVE-2.03: until then it moves
// by hand.
TEST_F(MachineZeroTest, FromTheConsoleTheMachineGoesHome) {
  LoadWithoutReference();
  Good(ZeroAxes{});
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_TRUE(machine->status().open->by_hand);
  GoOn(At(300.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  const std::vector<RunOver> over = machine->TakeRunsOver();
  ASSERT_EQ(over.size(), 2U);
  EXPECT_EQ(over[0].outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(over[1].run.program, 4);
  EXPECT_FALSE(over[1].run.by_hand);
  EXPECT_EQ(over[1].run.begun, over[0].run.begun + over[0].lasted);
  EXPECT_EQ(over[1].outcome.kind, OutcomeKind::kCompleted);
  const motion::AxisPose axes = machine->status().run.axes;
  EXPECT_NEAR(axes.column.x(), 100.0, 1e-6);
  EXPECT_NEAR(axes.column.y(), 200.0, 1e-6);
  // Nothing of the procedure is in the memory.
  EXPECT_EQ(*machine->memory().programs.at(4).object, *Translated(kHome).object);
  EXPECT_EQ(machine->TakeMadeExecutables().size(), 1U);
}

// It selects nothing, and is nothing that could be entered again: it is nobody's program.
TEST_F(MachineZeroTest, WhatWasSelectedStays) {
  Load({"STOP\n", "STOP\n"});
  Start(2);
  GoOn(At(5.0));
  Good(ChangeMode{Mode::kManual});
  Good(ZeroAxes{});
  GoOn(At(5.1));
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_FALSE(machine->base());
  EXPECT_EQ(machine->selected_program(), 2);
  GoOn(At(300.0));
  EXPECT_EQ(machine->selected_program(), 2);
}

// OPT-4.50: without program 4 it says so, and stands at its zero.
TEST_F(MachineZeroTest, WithoutAHomeProgramItStandsAtItsZero) {
  LoadWithoutReference();
  Good(DeleteProgram{.slot = 4});
  Good(ZeroAxes{});
  GoOn(At(300.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  // What was called for has failed, though the axes have their reference.
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(over.outcome.code, ErrorCode::kProgramMissing);
  EXPECT_EQ(over.outcome.place.program, 4);
  EXPECT_TRUE(machine->status().run.zeroed);
  EXPECT_EQ(CodeText(*machine->status().message), "OPT-E7102");
  EXPECT_NEAR(machine->status().run.axes.column.norm(), 0.0, 1e-9);
  // Who hears of runs is told, too: nobody at the console sees the display.
  EXPECT_THAT(heard.told.back(), EndsWith(" 0/0 finding OPT-E7102"));
}

// LIVE-3.16: the procedure is no program of the memory.
TEST_F(MachineZeroTest, TheProcedureIsNoProgram) {
  LoadWithoutReference();
  Good(ZeroAxes{});
  GoOn(At(1.0));
  EXPECT_EQ(machine->status().open->program, 0);
  EXPECT_EQ(machine->status().run.place, Place());
}

// OPT-4.49: in MANUAL it ends at the reference.
TEST_F(MachineZeroTest, InManualItEndsAtTheReference) {
  LoadWithoutReference();
  Good(ChangeMode{Mode::kManual});
  Good(ZeroAxes{});
  GoOn(At(300.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(machine->TakeRunsOver().size(), 1U);
  EXPECT_NEAR(machine->status().run.axes.column.norm(), 0.0, 1e-9);
}

// LIVE-2.10 x7: not in the other modes, and not while a program runs.
TEST_F(MachineZeroTest, OtherModesAndOpenRunsRefuseIt) {
  LoadWithoutReference("DELAY 5\n");
  Good(ChangeMode{Mode::kCycle});
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9423"));
  Good(ChangeMode{Mode::kRemote});
  Good(StartRun{.program = 4, .unzeroed = true});
  EXPECT_NE(Refused(ZeroAxes{}), "it was taken");
  GoOn(At(10.0));
  Good(EmergencyStop{});
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr(CodeText(machine->status().alarms.front().code)));
}

// What is moved by hand is over where it comes to rest: nothing goes on behind it.
TEST_F(MachineZeroTest, StopEndsIt) {
  for (const MachineInput& halt :
       {MachineInput(StopRun{}), MachineInput(HoldRun{}), MachineInput(MoveDoor{.open = true})}) {
    LoadWithoutReference();
    Good(ZeroAxes{});
    GoOn(At(0.5));
    Good(halt);
    EXPECT_EQ(state(), MachineState::kStopping);
    GoOn(At(20.0));
    EXPECT_EQ(state(), MachineState::kNotZeroed) << halt.index();
    EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCancelled);
    GoOn(At(60.0));
    EXPECT_EQ(state(), MachineState::kNotZeroed);
    EXPECT_FALSE(machine->status().open);
  }
}

// LIVE-2.05: no program begins that was not asked for; nor is a dry run used up.
TEST_F(MachineZeroTest, TheModeStaysWhileItMoves) {
  LoadWithoutReference();
  Good(ChangeMode{Mode::kManual});
  Good(SetSimulation{ProgramStep{4, 2}});
  Good(ZeroAxes{});
  EXPECT_THAT(Refused(ChangeMode{Mode::kRemote}), HasSubstr("CELL-E9421"));
  GoOn(At(300.0));
  EXPECT_EQ(machine->TakeRunsOver().size(), 1U);
  EXPECT_EQ(machine->simulation_until(), (ProgramStep{4, 2}));
}

// OPT-4.51: the override has no effect on it.
TEST_F(MachineZeroTest, TheOverrideHasNoEffect) {
  LoadWithoutReference();
  Good(ChangeOverride{10.0});
  Good(ZeroAxes{});
  const double slow = ZeroedAfter();
  LoadWithoutReference();
  Good(ChangeOverride{145.0});
  Good(ZeroAxes{});
  EXPECT_EQ(ZeroedAfter(), slow);
  EXPECT_GT(slow, 1.0);
}

class MillZeroTest : public MachineTest {
 protected:
  MillZeroTest() : MachineTest("rml1") {}
};

// RML1-7.08: a mill has its reference always.
TEST_F(MillZeroTest, AMillHasNothingToFind) {
  Load({"PA;PU100,0;"});
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9424"));
}

// LIVE-3.16: nor has what ends it a place in a program.
TEST_F(MachineZeroTest, WhatEndsTheProcedureHasNoPlace) {
  LoadWithoutReference();
  Good(ZeroAxes{});
  GoOn(At(1.0));
  Good(EmergencyStop{});
  EXPECT_EQ(Over().outcome.place, Place());
  ASSERT_EQ(machine->status().alarms.size(), 1U);
  EXPECT_EQ(machine->status().alarms[0].place, Place());
}

}  // namespace
}  // namespace rmlcell::machine
