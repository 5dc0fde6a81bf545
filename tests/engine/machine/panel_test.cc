// What is to be seen at a machine that stands, runs, or is in alarm.
#include "engine/machine/panel.h"

#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::ElementsAre;

class HandboxDisplay : public MachineTest {
 protected:
  std::string Display() const { return machine->panel().display; }
  void Store(int slot, const std::string& text) {
    Good(StoreProgram{.slot = slot, .program = Translated(text)});
  }
  void Tap(const std::vector<std::string_view>& keys) {
    for (const std::string_view key : keys) ASSERT_TRUE(machine->PressKey(key)) << key;
  }
  // In MANUAL, at the last step of program 12, with this FUNCTION 44.
  void AtStep4(const std::string& function) {
    Load({});
    Store(12, "SPEED 1\nSPEED 2\nSPEED 3\nENDTASK\n");
    Store(44, function);
    Good(ChangeMode{Mode::kManual});
    Tap({"JOB", "1", "2", "NEXT", "4", "ENT"});
    ASSERT_EQ(Display(), "P=12S=0004I=ENDTASK ");
  }
};

// OPT-4.02 OPT-4.03 OPT-4.04 OPT-3.48 OPT-4.08: nothing is selected after power-up; a run selects
// its program, makes its executable, and behind its end the display stands at ENDTASK.
TEST_F(HandboxDisplay, PointsAtProgramAndStep) {
  Load({});
  EXPECT_EQ(Display(), "P=00S=0000I=********");
  Store(12, "DELAY 1\nDELAY 2\nMOVE (100.,0.,-400.,0.,0.)\nENDTASK\n");
  Start(12);
  EXPECT_EQ(Display(), "COMPILING           ");
  GoOn(At(0.249));
  EXPECT_EQ(Display(), "COMPILING           ");
  GoOn(At(0.25));
  EXPECT_EQ(Display(), "P=12S=0001I=DELAY   ");
  GoOn(At(2.0));
  EXPECT_EQ(Display(), "P=12S=0002I=DELAY   ");
  GoOn(At(3.001));
  EXPECT_EQ(Display(), "P=12S=0003I=MOVE    ");
  GoOn(At(100.0));
  EXPECT_EQ(Display(), "P=12S=0004I=ENDTASK ");
  Good(SwitchPower{false});
  EXPECT_EQ(Display(), std::string(20, ' '));
  Good(SwitchPower{true});
  EXPECT_EQ(Display(), "P=00S=0000I=********");
}

// OPT-4.05 OPT-1.22: the name alone, LET for an assignment; a sequence number is not seen.
TEST_F(HandboxDisplay, ShowsNamesWithoutParameters) {
  Load({"10 VI[3] = 7\nPAUSE\n"});
  Good(ChangeMode{Mode::kSingle});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(1.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Display(), "P=01S=0001I=LET     ");
}

// OPT-4.07: in a FUNCTION P is the number of that.
TEST_F(HandboxDisplay, FollowsTheModule) {
  Load({});
  Store(44, "DELAY 3\nRETURN\n");
  Store(32, "DELAY 1\nFUNCTION 44\nENDTASK\n");
  Start(32);
  GoOn(At(0.5));
  EXPECT_EQ(Display(), "P=32S=0001I=DELAY   ");
  GoOn(At(2.0));
  EXPECT_EQ(Display(), "P=44S=0001I=DELAY   ");
}

// OPT-9.36, OPT-9.37: a FUNCTION that runs by hand shows where it is; halted, ended or behind its
// end it is ready to be recorded in the program that is selected.
TEST_F(HandboxDisplay, FollowsAFunctionByHand) {
  AtStep4("DELAY 4\nDELAY 4\nRETURN\n");
  const auto ready = [this] {
    EXPECT_EQ(Display(), "P=12 S=0004 FUNC=44 ");
    EXPECT_TRUE(machine->panel().flashing);
  };
  for (const bool ended : {false, true}) {
    Tap({"F3", "4", "4", "ENT", "ENT", "1"});
    GoOn(machine->time() + At(1.0));
    EXPECT_EQ(Display(), "P=44S=0001I=DELAY   ");
    EXPECT_FALSE(machine->panel().flashing);
    EXPECT_EQ(machine->selected_program(), 12);
    EXPECT_EQ(Refused(ChangeMode{Mode::kCycle}),
              "CELL-E9421 the machine is RUNNING: a FUNCTION of the handbox is open; go on with "
              "it, or end it");
    GoOn(machine->time() + At(4.0));
    EXPECT_EQ(Display(), "P=44S=0002I=DELAY   ");
    Tap({"STOP"});
    GoOn(machine->time() + At(5.0));
    ASSERT_EQ(state(), MachineState::kHeld);
    ready();
    if (ended) {
      Tap({"SHIFT", "STOP"});
    } else {
      Tap({"START"});
    }
    GoOn(machine->time() + At(9.0));
    EXPECT_EQ(Over().outcome.kind, ended ? OutcomeKind::kCancelled : OutcomeKind::kCompleted);
    ready();
    Tap({"F3", "ERR"});
  }
}

// OPT-4.06, OPT-9.37: one that fails is not ready to be recorded: its number is shown, and behind
// that what is selected.
TEST_F(HandboxDisplay, AFunctionThatFailsIsNotReady) {
  AtStep4("RETURN\n");
  Tap({"F3", "4", "5", "ENT", "ENT", "1"});
  EXPECT_EQ(Display(), "ERROR 7103          ");  // at once
  GoOn(At(1.0));
  EXPECT_EQ(Over().outcome.code, ErrorCode::kFunctionMissing);
  EXPECT_EQ(Display(), "ERROR 7103          ");
  EXPECT_FALSE(machine->panel().flashing);
  Tap({"ERR"});
  EXPECT_EQ(Display(), "P=12S=0004I=ENDTASK ");
}

// OPT-E.7310: none begins without the reference of the axes.
TEST_F(HandboxDisplay, AFunctionNeedsTheReference) {
  AtStep4("RETURN\n");
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  Tap({"F3", "4", "4", "ENT", "ENT"});
  const Result<KeyAnswer> yes = machine->PressKey("1");
  ASSERT_TRUE(yes);
  EXPECT_EQ(yes->message, family_.info().not_zeroed);
  EXPECT_EQ(machine->open_run(), nullptr);
}

// OPT-4.06: the number stands there until ERR; what it was about is not over with that.
TEST_F(HandboxDisplay, TellsAnErrorUntilItIsCleared) {
  Load({"VI[1] = 2\nGOTO VI[1] (20,999)\n20 ENDTASK\n"});
  Start();
  GoOn(At(1.0));
  const Outcome failed = Over().outcome;
  ASSERT_EQ(failed.code, ErrorCode::kLabelNotFound);
  EXPECT_EQ(Display(), "ERROR 60            ");
  EXPECT_EQ(machine->panel().message, ErrorCode::kLabelNotFound);
  Good(ClearMessage{});
  EXPECT_EQ(Display(), "P=01S=0002I=GOTO    ");
  Good(EmergencyStop{true});
  EXPECT_EQ(Display(), "ERROR 7610          ");
  Good(ClearMessage{});
  EXPECT_EQ(machine->panel().message, std::nullopt);
  EXPECT_EQ(state(), MachineState::kAlarm);
}

// OPT-4.01, in every state: and a machine that was saved shows the same when it is read.
TEST_F(HandboxDisplay, Has20CharactersAndIsKept) {
  const auto look = [this] {
    EXPECT_EQ(Display().size(), 20U);
    const Panel before = machine->panel();
    MachineMemory memory = machine->memory();
    RunObserver nobody;
    const auto again = Machine::Make(family_, parameters(), memory, machine->Save(), nobody);
    ASSERT_TRUE(again);
    EXPECT_EQ((*again)->panel(), before);
  };
  Load({"FUNCTION 2\nDELAY 1\nMOVE (9.,0.,-400.,0.,0.)\n", "PATH LIN\nRETURN\n"});
  look();
  Start();
  for (int i = 2; i < 8; ++i) {  // behind COMPILING, which is of the run
    GoOn(At(0.2 * i));
    look();
  }
  Good(EmergencyStop{true});
  look();
  Good(SwitchPower{false});
  look();
}

// What the cell itself says has no number that the handbox knows.
TEST_F(HandboxDisplay, KnowsItsOwnNumbersOnly) {
  Load({"DELAY 5\n"});
  Start();
  GoOn(At(1.0));
  Good(AbortRun{});
  GoOn(At(2.0));
  ASSERT_EQ(Over().outcome.code, ErrorCode::kCellCancelled);
  EXPECT_EQ(Display(), "P=01S=0001I=DELAY   ");
  EXPECT_EQ(machine->panel().message, std::nullopt);
}

// ... and takes nothing from the display that nobody has cleared. OPT-4.06
TEST_F(HandboxDisplay, AnErrorOutlivesARunThatIsCancelled) {
  Load({"VI[1] = 2\nGOTO VI[1] (20,999)\n20 ENDTASK\n", "DELAY 5\n"});
  Start();
  GoOn(At(1.0));
  EXPECT_EQ(Display(), "ERROR 60            ");
  Start(2);
  GoOn(At(2.0));
  Good(AbortRun{});
  GoOn(At(3.0));
  EXPECT_EQ(Display(), "ERROR 60            ");
}

TEST_F(HandboxDisplay, LightsTheLampOfTheMode) {
  Load({});
  EXPECT_THAT(machine->panel().lamps, ElementsAre("REMOTE", "ROB"));
  for (const auto& [mode, lamp] :
       {std::pair{Mode::kManual, "MANUAL"}, std::pair{Mode::kRepeat, "REPEAT"},
        std::pair{Mode::kCycle, "CYCLE"}, std::pair{Mode::kSingle, "SINGLE"}}) {
    Good(ChangeMode{mode});
    EXPECT_THAT(machine->panel().lamps, ElementsAre(lamp, "ROB"));
  }
  Good(SwitchPower{false});
  EXPECT_TRUE(machine->panel().lamps.empty());
  EXPECT_EQ(machine->Apply(ClearMessage{}).error().code, ErrorCode::kCellNotLive);
}

class MillPanel : public MachineTest {
 protected:
  MillPanel() : MachineTest("rml1") {}
};

TEST_F(MillPanel, LightsWhatIsSo) {
  Load({"!MC1;PU2000,0;PD4000,0;!NR;PU0,0;!MC0;"});
  EXPECT_THAT(machine->panel().lamps, ElementsAre("POWER"));
  EXPECT_EQ(machine->panel().display, "");
  Start();
  GoOn(At(3.0));
  EXPECT_THAT(machine->panel().lamps, ElementsAre("POWER", "SPINDLE"));
  GoOn(At(100.0));
  ASSERT_EQ(state(), MachineState::kHeld);  // RML1-3C.08
  EXPECT_THAT(machine->panel().lamps, ElementsAre("POWER", "PAUSE", "SPINDLE"));
  Good(SwitchPower{false});
  EXPECT_TRUE(machine->panel().lamps.empty());
}

// OPT-4.03: behind a power cycle the handbox is as it was delivered.
TEST_F(HandboxDisplay, ForgetsTheReferenceWithThePower) {
  using testing::Contains;
  Load({});
  Good(ChangeMode{Mode::kManual});
  ASSERT_TRUE(machine->PressKey("JOG_ABS"));
  EXPECT_THAT(machine->panel().lamps, Contains("ABS"));
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  EXPECT_THAT(machine->panel().lamps, Contains("ROB"));
  EXPECT_THAT(machine->panel().lamps, testing::Not(Contains("ABS")));
}

// LIVE-8.01: the panel tells how far axes run on, where its keys move some.
TEST_F(HandboxDisplay, TellsHowFarAxesRunOn) {
  Load({"STOP\n"});
  Good(ChangeMode{Mode::kManual});
  Good(ChangeOverride{145.0});
  ASSERT_TRUE(machine->panel().run_on);
  EXPECT_NEAR(machine->panel().run_on->mm, 15.0, 1e-9);
  Good(ChangeMode{Mode::kRemote});
  EXPECT_FALSE(machine->panel().run_on);
  Good(ChangeMode{Mode::kManual});
  Good(SwitchPower{false});
  EXPECT_FALSE(machine->panel().run_on);
}

}  // namespace
}  // namespace rmlcell::machine
