// Keys that start and stop runs, and those that move axes.
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class RunKeys : public HandboxTest {
 protected:
  motion::AxisPose axes() const { return machine->status().run.axes; }
};

// OPT-4.19 OPT-4.59 OPT-E.7602: START in CYCLE runs the program that is selected.
TEST_F(RunKeys, StartRunsTheSelectedProgram) {
  Have({{45, "DELAY 1\nDELAY 2\nENDTASK\n"}}, Mode::kCycle);
  Keys("START");
  EXPECT_EQ(Said(), 7602);
  Keys("JOB 7 7 ENT START");
  EXPECT_EQ(Said(), 7102);
  Keys("JOB 4 5 ENT");
  EXPECT_EQ(Shows(), "P=45S=0000I=********");
  Keys("START");
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(state(), MachineState::kRunning);
  EXPECT_EQ(machine->status().open->source, machine::StartSource::kPanel);
  GoOn(At(2.0));
  EXPECT_EQ(Shows(), "P=45S=0002I=DELAY");
  GoOn(At(5.0));
  EXPECT_EQ(Over().outcome.kind, machine::OutcomeKind::kCompleted);
}

// OPT-4.61: it begins at step 1, whatever step is shown.
TEST_F(RunKeys, StartBeginsAtStepOne) {
  Have({{45, "DELAY 1\nDELAY 1\nDELAY 1\n"}}, Mode::kCycle);
  Keys("JOB 4 5 NEXT 3 ENT");
  EXPECT_EQ(Shows(), "P=45S=0003I=DELAY");
  Keys("START");
  GoOn(At(0.5));
  EXPECT_EQ(Shows(), "P=45S=0001I=DELAY");
}

// OPT-4.08 OPT-6.34 LIVE-7.07: at the first START after a change, and not at the next one.
TEST_F(RunKeys, CompilingIsShownAtTheFirstStart) {
  Have({{3, "DELAY 1\nDELAY 1\n"}}, Mode::kSingle);
  Keys("JOB 3 ENT START");
  EXPECT_EQ(Shows(), "COMPILING");
  GoOn(At(0.3));
  EXPECT_EQ(Shows(), "P=03S=0001I=DELAY");
  GoOn(At(2.0));
  Keys("START");
  EXPECT_EQ(Shows(), "P=03S=0001I=DELAY");
  GoOn(At(4.0));
  EXPECT_EQ(Over().outcome.kind, machine::OutcomeKind::kCompleted);
  Keys("START");  // anew, with the executable that is there
  GoOn(At(4.1));
  EXPECT_EQ(Shows(), "P=03S=0001I=DELAY");
}

// OPT-4.62 OPT-6.31: in SINGLE each START is a step; one that comes too early is ignored.
TEST_F(RunKeys, SingleAdvancesByAStep) {
  Have({{3, "DELAY 1\nDELAY 1\nDELAY 1\n"}}, Mode::kSingle);
  Keys("JOB 3 ENT");
  for (int step = 1; step <= 3; ++step) {
    Keys("START START");
    EXPECT_EQ(Said(), 0);
    GoOn(At(2.0 * step));
    EXPECT_EQ(Shows(), "P=03S=000" + std::to_string(step) + "I=DELAY");
  }
}

// OPT-4.17 OPT-4.18: HOLD behind the instruction, STOP at once; START goes on.
TEST_F(RunKeys, HoldStopAndStart) {
  Have(
      {{1,
        "COORD ABSOL\nPATH PTP\nMOVE (0.,2000.,-400.,0.,0.)\nPATH LIN\nSPEED 10\nMOVE (100.,2000.,-400.,0.,0.)\n"
        "MOVE (200.,2000.,-400.,0.,0.)\n"}},
      Mode::kCycle);
  Keys("JOB 1 ENT START");
  GoOn(At(1.0));
  while (machine->status().shown.step < 6) GoOn(machine->time() + At(0.1));
  GoOn(machine->time() + At(1.0));
  Keys("STOP");
  GoOn(machine->time() + At(1.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  const double stopped = axes().column.x();
  EXPECT_GT(stopped, 10.0);
  EXPECT_LT(stopped, 90.0);
  Keys("START HOLD");
  GoOn(machine->time() + At(9.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_NEAR(axes().column.x(), 100.0, 1e-6);
  Keys("START");
  GoOn(machine->time() + At(9.0));
  EXPECT_NEAR(axes().column.x(), 200.0, 1e-6);
}

// OPT-4.24: to SINGLE at the end of the instruction, to MANUAL as HOLD.
TEST_F(RunKeys, TheModeIsChangedAtTheEndOfTheInstruction) {
  Have({{1, "DELAY 2\nDELAY 2\nDELAY 2\nDELAY 2\n"}}, Mode::kCycle);
  Keys("JOB 1 ENT START");
  GoOn(At(1.0));
  Keys("MODE_RIGHT");
  EXPECT_THAT(Lamps(), ElementsAre("SINGLE", "ROB"));
  EXPECT_EQ(state(), MachineState::kRunning);
  GoOn(At(5.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Shows(), "P=01S=0001I=DELAY");
  Keys("MODE_LEFT START");
  GoOn(At(6.0));
  Keys("MODE_LEFT MODE_LEFT");
  GoOn(At(10.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Shows(), "P=01S=0002I=DELAY");
}

// OPT-4.23
TEST_F(RunKeys, RepeatBeginsAgain) {
  Have({{1, "DELAY 1\nDELAY 1\n"}}, Mode::kRepeat);
  Keys("JOB 1 ENT START");
  std::string steps;
  for (int i = 0; i < 4; ++i) {
    GoOn(At(0.5 + i));
    steps += Shows()[9];
  }
  EXPECT_EQ(steps, "1212");
  Keys("STOP");
  GoOn(At(6.0));
  EXPECT_EQ(state(), MachineState::kHeld);
}

// OPT-4.14 OPT-E.7610: it acts in every mode.
TEST_F(RunKeys, EmergencyStopEndsTheRun) {
  for (const Mode mode : {Mode::kCycle, Mode::kSingle, Mode::kRepeat}) {
    Have({{1, "DELAY 9\n"}}, mode);
    Keys("JOB 1 ENT START");
    GoOn(machine->time() + At(1.0));
    Do("EMERGENCY_STOP", KeyAction::kPress);
    EXPECT_EQ(state(), MachineState::kAlarm);
    EXPECT_EQ(Shows(), "ERROR 7610");
    EXPECT_EQ(Over().outcome.code, ErrorCode::kEmergencyStop);
    Keys("START");
    EXPECT_EQ(Said(), 7610);
    Do("EMERGENCY_STOP", KeyAction::kRelease);
    Keys("ERR");
    EXPECT_EQ(state(), MachineState::kAlarm);  // ERR clears the display alone, OPT-4.06
  }
}

// OPT-4.48 OPT-6.22 OPT-E.7310
TEST_F(RunKeys, StartNeedsZeroedAxes) {
  Have({{1, "DELAY 1\n"}});
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  Good(machine::ChangeMode{Mode::kCycle});
  Keys("JOB 1 ENT START");
  EXPECT_EQ(Said(), 7310);
  EXPECT_EQ(Shows(), "ERROR 7310");
  Good(machine::SetSimulation{.until = machine::ProgramStep{.program = 1, .step = 9}});
  Keys("START");
  EXPECT_EQ(Said(), 0);
}

// OPT-4.16 OPT-4.49 OPT-4.51: asked first; the display flashes meanwhile, and the override is as it
// was.
TEST_F(RunKeys, ZeroAsksAndRuns) {
  Have({});
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  Keys("ZERO");
  EXPECT_EQ(Shows(), "ZERO AXIS?");
  Keys("0");
  EXPECT_EQ(Shows(), "P=00S=0000I=********");
  Keys("ZERO 5");
  EXPECT_EQ(Said(), 7601);
  Keys("1");
  EXPECT_EQ(Shows(), "*ZERO AXES");
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB", "ZERO AXES"));
  Keys("OVERRIDE_MINUS");
  EXPECT_EQ(Said(), 7601);
  EXPECT_EQ(machine->status().override_percent, 100.0);
  Keys("MODE_RIGHT");
  EXPECT_EQ(Said(), 7601);
  GoOn(At(300.0));
  EXPECT_TRUE(machine->status().run.zeroed);
  EXPECT_EQ(state(), MachineState::kIdle);
  Keys("ERR");
  EXPECT_EQ(Shows(), "P=00S=0000I=********");
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB"));
}

// OPT-4.16 OPT-4.29: ERR is NO.
TEST_F(RunKeys, ErrAnswersNo) {
  Have({});
  Keys("ZERO ERR");
  EXPECT_EQ(Shows(), "P=00S=0000I=********");
  EXPECT_EQ(state(), MachineState::kIdle);
}

// OPT-4.20 OPT-4.12 LIVE-7.03: while it is down, in MANUAL alone; the C keys do nothing.
TEST_F(RunKeys, JogKeysMoveWhileTheyAreDown) {
  Have({});
  Hold("X+", 1.0);
  const double moved = axes().column.x();
  EXPECT_GT(moved, 50.0);
  GoOn(machine->time() + At(5.0));
  EXPECT_EQ(axes().column.x(), moved);
  Keys("X-");  // a TAP leaves no motion
  GoOn(machine->time() + At(2.0));
  EXPECT_EQ(axes().column.x(), moved);
  EXPECT_EQ(state(), MachineState::kIdle);
  const motion::AxisPose before = axes();
  Hold("C+", 1.0);
  EXPECT_EQ(axes(), before);
  for (const Mode mode : {Mode::kRepeat, Mode::kCycle, Mode::kSingle}) {
    Good(machine::ChangeMode{mode});
    Hold("X+", 1.0);
    EXPECT_EQ(axes(), before);
    Do("X+", KeyAction::kPress);
    EXPECT_EQ(Said(), 7601);
  }
}

// OPT-4.21 LIVE-7.06: three lamps; another reference stops keys that are down.
TEST_F(RunKeys, ReferenceHasLampsAndStops) {
  Have({});
  for (const auto& [key, lamp] :
       {std::pair{"JOG_TCP", "TCP"}, std::pair{"JOG_ABS", "ABS"}, std::pair{"JOG_ROB", "ROB"}}) {
    Keys(key);
    EXPECT_THAT(Lamps(), ElementsAre("MANUAL", lamp));
  }
  Do("X+", KeyAction::kPress);
  GoOn(At(1.0));
  Keys("JOG_ROB");  // the same one
  EXPECT_EQ(state(), MachineState::kJogging);
  Keys("JOG_ABS");
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOn(At(3.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  Do("X+", KeyAction::kPress);
  EXPECT_EQ(Said(), 7601);  // it was down when it stopped
  Do("X+", KeyAction::kRelease);
  Do("X+", KeyAction::kPress);
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(state(), MachineState::kJogging);
}

// OPT-4.53: the reference goes with the key.
TEST_F(RunKeys, JogFollowsTheReference) {
  Have({});
  Hold("Z-", 1.0);
  Keys("JOG_ABS");
  const motion::TipPose before = machine->status().run.tip;
  Hold("B+", 1.0);
  const motion::TipPose after = machine->status().run.tip;
  EXPECT_GT(after.b_rad, before.b_rad + 0.1);
  EXPECT_NEAR(after.tip.x(), before.tip.x(), 1e-3);
  EXPECT_NEAR(after.tip.z(), before.tip.z(), 1e-3);
}

// LIVE-7.06: a mode key while a jog key is down stops it and changes the mode.
TEST_F(RunKeys, TheModeStopsAJogKey) {
  Have({});
  Do("X+", KeyAction::kPress);
  GoOn(At(1.0));
  Keys("MODE_RIGHT");
  EXPECT_EQ(Said(), 0);
  EXPECT_THAT(Lamps(), ElementsAre("REPEAT", "ROB"));
  GoOn(At(3.0));
  EXPECT_EQ(state(), MachineState::kIdle);
}

// LIVE-8.01: how far it runs on, at the present override; only where keys move something.
TEST_F(RunKeys, ThePanelTellsHowFarAxesRunOn) {
  Have({});
  const auto fast = machine->panel().run_on;
  ASSERT_TRUE(fast);
  EXPECT_GT(fast->mm, 1.0);
  Keys("OVERRIDE_MINUS");
  EXPECT_LT(machine->panel().run_on->mm, fast->mm);
  Keys("MODE_RIGHT");
  EXPECT_FALSE(machine->panel().run_on);
}

// OPT-4.09 LIVE-7.07: SHIFT STOP ends a run that was started here.
TEST_F(RunKeys, ShiftStopAborts) {
  Have({{1, "DELAY 9\n"}}, Mode::kCycle);
  Keys("JOB 1 ENT START");
  GoOn(At(1.0));
  Keys("SHIFT STOP");
  EXPECT_THAT(Lamps(), ElementsAre("CYCLE", "ROB"));
  GoOn(At(2.0));
  EXPECT_EQ(Over().outcome.kind, machine::OutcomeKind::kCancelled);
}

// LIVE-7.01: the same keys at the same times on the same machine give the same.
TEST_F(RunKeys, AreRepeated) {
  const auto session = [this] {
    Have({{1, "DELAY 1\nMOVE (50.,0.,-300.,0.,0.)\n"}});
    Keys("JOB 1 ENT");
    Hold("X+", 0.7);
    Keys("REC MODE_RIGHT MODE_RIGHT JOB 1 ENT START");
    GoOn(machine->time() + At(0.5));
    Keys("STOP OVERRIDE_MINUS NOTE");
    GoOn(machine->time() + At(3.0));
    return machine->Save();
  };
  const std::string first = session();
  EXPECT_EQ(session(), first);
}

// LIVE-7.01: a key is an input like others: with the programs that it led to, it does the same
// again.
TEST_F(RunKeys, AreInputsOfTheMachine) {
  Have({});
  Keys("JOB 7 ENT REC");
  Hold("X+", 0.5);
  Keys("REC MODE_RIGHT MODE_RIGHT START");
  GoOn(machine->time() + At(0.5));
  const std::string pressed = machine->Save();
  Have({});
  std::size_t stored = 0;
  const auto apply = [this, &stored](const std::string& key, KeyAction action,
                                     std::size_t edit_count) {
    Good(machine::PressedKey{.key = key, .action = action});
    while (stored < edit_count) Store(edits.at(stored++));
  };
  for (const char* key : {"JOB", "7", "ENT"}) apply(key, KeyAction::kTap, 0);
  apply("REC", KeyAction::kTap, 1);
  apply("X+", KeyAction::kPress, 1);
  GoOn(machine->time() + At(0.5));
  apply("X+", KeyAction::kRelease, 1);
  GoOn(machine->time() + At(2.0));
  apply("REC", KeyAction::kTap, 2);
  for (const char* key : {"MODE_RIGHT", "MODE_RIGHT", "START"}) apply(key, KeyAction::kTap, 2);
  GoOn(machine->time() + At(0.5));
  EXPECT_EQ(machine->Save(), pressed);
  EXPECT_FALSE(machine->Apply(machine::PressedKey{.key = "F9"}));
}

// LIVE-2.11: a job of the queue goes on in REMOTE only.
TEST_F(RunKeys, AJobOfTheQueueIsNotContinued) {
  Have({{1, "DELAY 9\nDELAY 9\n"}}, Mode::kRemote);
  Good(machine::StartRun{.program = 1, .source = machine::StartSource::kQueue});
  GoOn(At(1.0));
  Keys("MODE_LEFT");
  GoOn(At(20.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  Keys("START");
  EXPECT_EQ(Said(), 7601);
  EXPECT_EQ(state(), MachineState::kHeld);
}

}  // namespace
}  // namespace rmlcell::optimo
