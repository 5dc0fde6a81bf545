// What a machine says when it refuses, and what a run before, or a key too many, leaves behind.
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

class SecondRuns : public MachineTest {};

class MillRefusals : public MachineTest {
 protected:
  MillRefusals() : MachineTest("rml1") {}
};

// LIVE-2.10: whoever is refused is told what is possible instead, and that is another thing with a
// run open than without one.
TEST_F(SecondRuns, ARefusalSaysWhatIsPossible) {
  Load({"DELAY 5\n"});
  EXPECT_EQ(Refused(ResumeRun{}), "CELL-E9421 the machine is IDLE: no run is open; start one");
  Start();
  ASSERT_EQ(state(), MachineState::kRunning);
  EXPECT_EQ(Refused(StartRun{.program = 1}),
            "CELL-E9421 the machine is RUNNING: a run is open; hold or abort it");
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  ASSERT_EQ(state(), MachineState::kNotZeroed);
  EXPECT_EQ(Refused(StartRun{.program = 1}), "OPT-E7310 START with axes that have no reference");
  EXPECT_EQ(Refused(ResumeRun{}),
            "CELL-E9421 the machine is NOT_ZEROED: no run is open; start one");
}

// A mill has no code of its own for axes without reference, and never says so.
TEST_F(MillRefusals, ARefusalSaysWhatIsPossible) {
  Load({"PU100,100;"});
  EXPECT_EQ(Refused(ResumeRun{}), "CELL-E9421 the machine is IDLE: no run is open; start one");
}

// The display follows the run that is open, also where another one was before it: what is left of
// that one is no selection of a person.
TEST_F(SecondRuns, TheDisplayFollowsEachOfThem) {
  Load({"DELAY 1\nDELAY 5\n"});
  Start();
  GoOn(At(10.0));
  ASSERT_EQ(state(), MachineState::kIdle);
  Over();
  const ShownStep first = machine->status().shown;
  Start();
  GoOn(At(12.0));
  ASSERT_EQ(state(), MachineState::kRunning);
  EXPECT_EQ(machine->status().shown.program, 1);
  EXPECT_EQ(machine->status().shown.step, 2);
  EXPECT_EQ(machine->status().shown.instruction, "DELAY");
  GoOn(At(20.0));
  ASSERT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(machine->status().shown, first);
}

// LIVE-2.10, LIVE-6.01: STOP and HOLD of a run that is held are nothing that it was given: whoever
// goes to one of its steps later must not meet them again.
TEST_F(SecondRuns, AHeldRunIsNotStoppedAgain) {
  Load({"DELAY 5\n"});
  Start();
  GoOn(At(1.0));
  Good(StopRun{});
  GoOn(At(2.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  ASSERT_TRUE(machine->base());
  ASSERT_EQ(machine->base()->inputs.size(), 1U);
  Good(StopRun{});
  Good(HoldRun{});
  EXPECT_EQ(state(), MachineState::kHeld);
  ASSERT_TRUE(machine->base());
  EXPECT_EQ(machine->base()->inputs.size(), 1U);
  Good(ResumeRun{});
  GoOn(At(10.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// LIVE-2.10: keys that halt nothing leave nothing behind for the run that begins next.
TEST_F(SecondRuns, KeysWithoutARunHaltNothingLater) {
  Load({"DELAY 5\n"});
  Good(StopRun{});
  Good(HoldRun{});
  EXPECT_EQ(state(), MachineState::kIdle);
  Start();
  EXPECT_EQ(state(), MachineState::kRunning);
  GoOn(At(10.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

}  // namespace
}  // namespace rmlcell::machine
