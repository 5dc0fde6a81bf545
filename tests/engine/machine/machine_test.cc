// A machine that lives between runs: states, inputs, debugging, what it keeps (live.md 2).
#include "engine/machine/machine.h"

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "tests/engine/core/arguments_text.h"
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(MachineTest, KeepsWhatARunLeavesAndItsTimeGoesOn) {
  Load({"DELAY 1\nVI[2] = VI[2] + 1\n"});
  EXPECT_EQ(state(), MachineState::kIdle);
  GoOn(At(5.0));
  Start();
  EXPECT_EQ(state(), MachineState::kRunning);
  GoOn(At(5.5));
  EXPECT_EQ(machine->status().run.time, At(0.5));
  GoOn(At(20.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  const RunOver first = Over();
  EXPECT_EQ(first.run.number, 1);
  EXPECT_EQ(first.run.begun, At(5.0));
  EXPECT_EQ(first.lasted, At(1.0));
  EXPECT_EQ(first.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(first.steps, 2U);
  Start();
  GoOn(At(22.0));
  EXPECT_EQ(Over().run.number, 2);
  EXPECT_EQ(Value("VI[2]"), "2");
  EXPECT_EQ(Value("VI[98]"), "2");  // executions of the program
}

// LIVE-2.12, OPT-4.17: HOLD of an Optimo in REMOTE is STOP: it halts on the path. In CYCLE it halts
// behind the motion.
TEST_F(MachineTest, HoldInRemoteIsStop) {
  const char* program =
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\nDELAY 1\n";
  const auto held_at = [&](Mode mode, StartSource source) {
    Load({program});
    Good(ChangeMode{mode});
    Good(StartRun{.program = 1, .source = source});
    GoOn(At(2.0));
    Good(HoldRun{});
    while (state() != MachineState::kHeld) GoOn(machine->time() + At(0.1));
    return machine->status().run.axes.column.x();
  };
  const double on_path = held_at(Mode::kRemote, StartSource::kConsole);
  EXPECT_GT(on_path, 21.1);
  EXPECT_LT(on_path, 500.0);
  EXPECT_NEAR(held_at(Mode::kCycle, StartSource::kPanel), 521.02, 1e-4);
}

// LIVE-3.15, LIVE-3.11: a run of the machine is that of a simulation with the same inputs at the
// same times, however time is divided.
TEST_F(MachineTest, RunsAsASimulation) {
  const std::string program =
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)/FLY\n"
      "MOVE (621.02, 2301.2, -350., 0., 0.)\nWAIT IL[5]\nOL[11] = ON\n"
      "MOVE (521.02, 2201.2, -350., 0., 0.)\n";
  Load({program});
  Heard simulated;
  RunSetup setup(parameters());
  setup.programs = machine->memory().programs;
  setup.main_program = 1;
  setup.mode = Mode::kRemote;
  setup.inputs = {{At(3.0), InputKind::kStop, 0, 0.0},
                  {At(4.5), InputKind::kStart, 0, 0.0},
                  {At(9.0), InputKind::kOverride, 0, 50.0},
                  {At(40.0), InputKind::kLogical, 5, 1.0}};
  auto run = family_.NewRun(std::move(setup), simulated);
  ASSERT_TRUE(run);
  while ((*run)->Advance(At(100.0)) != RunPhase::kFinished) {
  }

  std::mt19937 dice(7);
  GoOn(At(2.0));
  Start();
  const auto walk = [&](double until) {
    std::uniform_real_distribution<double> step(0.0, 0.4);
    while (machine->time() < At(2.0 + until))
      GoOn(std::min(At(2.0 + until), machine->time() + At(step(dice)) + SimTime(1)));
  };
  walk(3.0);
  Good(StopRun{});
  walk(4.5);
  EXPECT_EQ(state(), MachineState::kHeld);
  Good(ResumeRun{});
  walk(9.0);
  Good(ChangeOverride{50.0});
  walk(40.0);
  Good(ChangeInput{.kind = InputKind::kLogical, .index = 5, .value = 1.0});
  walk(100.0);
  EXPECT_EQ(heard.told, simulated.told);
  EXPECT_EQ(Over().lasted, (*run)->state().time);
}

// live.md 2.10: START and RESUME by state.
TEST_F(MachineTest, RefusesWhatItsStateDoesNotAllow) {
  Load({"DELAY 5\n", "PAUSE\n"});
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9421 the machine is IDLE"));
  EXPECT_THAT(Refused(StartRun{.program = 7}), HasSubstr("OPT-E7102"));
  EXPECT_THAT(Refused(StartRun{.program = 100}), HasSubstr("OPT-E7101"));
  Start();
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("CELL-E9421 the machine is RUNNING"));
  Good(ResumeRun{});
  GoOn(At(1.0));
  Good(HoldRun{});
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("resume or abort the run"));
  Good(AbortRun{});
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCancelled);
  EXPECT_EQ(state(), MachineState::kIdle);
  // PAUSE in REMOTE ends the run: OPT-3.50.
  Start(2);
  GoOn(At(2.0));
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kStopped);
  EXPECT_EQ(CodeText(*over.outcome.code), "OPT-E7507");
}

// OPT-4.11, OPT-4.24, LIVE-2.11: sources by mode; leaving for MANUAL holds.
TEST_F(MachineTest, ModesAndSources) {
  Load({"DELAY 5\n"});
  EXPECT_THAT(Refused(StartRun{.program = 1, .source = StartSource::kPanel}),
              HasSubstr("CELL-E9423 the mode is REMOTE"));
  for (const Mode mode : {Mode::kCycle, Mode::kSingle, Mode::kRepeat}) {
    Good(ChangeMode{mode});
    for (const StartSource source :
         {StartSource::kConsole, StartSource::kQueue, StartSource::kGate1, StartSource::kGate2}) {
      EXPECT_THAT(Refused(StartRun{.program = 1, .source = source}), HasSubstr("CELL-E9423"));
    }
  }
  Good(ChangeMode{Mode::kManual});
  EXPECT_THAT(Refused(StartRun{.program = 1, .source = StartSource::kPanel}),
              HasSubstr("nothing starts in it"));
  Good(ChangeMode{Mode::kRemote});
  Start();
  GoOn(At(1.0));
  Good(ChangeMode{Mode::kManual});
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9423"));
  GoOn(At(10.0));
  Good(ChangeMode{Mode::kRemote});
  Good(ResumeRun{});
  GoOn(At(14.0) - SimTime(1));
  EXPECT_EQ(state(), MachineState::kRunning);
  GoOn(At(14.0));
  EXPECT_EQ(state(), MachineState::kIdle);
}

// live.md 2.10 a11: the mode at the end of the instruction counts, also of one that a STOP
// interrupted; a breakpoint that is due stays one.
TEST_F(MachineTest, SingleTakenBackOrSetWhileHeld) {
  const auto begin = [&](const std::string& first) {
    Load({first + "VI[1] = 1\nVI[1] = 2\n"});
    Good(ChangeMode{Mode::kCycle});
    Good(StartRun{.program = 1, .source = StartSource::kPanel});
    GoOn(At(2.0));
  };
  const std::string move =
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\n";
  begin(move);
  Good(ChangeMode{Mode::kSingle});
  Good(ChangeMode{Mode::kCycle});
  GoOn(At(100.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  for (const std::string& first : {move, std::string("DELAY 5\n")}) {
    begin(first);
    Good(StopRun{});
    GoOn(At(3.0));
    EXPECT_EQ(state(), MachineState::kHeld) << first;
    Good(ChangeMode{Mode::kSingle});
    Good(ResumeRun{.source = StartSource::kPanel});
    GoOn(At(100.0));
    EXPECT_EQ(machine->status().run.halted_by, HaltReason::kSingle) << first;
    EXPECT_EQ(Value("VI[1]"), "0") << first;
  }
  Load({move + "VI[1] = 1\n"});
  Good(ChangeMode{Mode::kCycle});
  Good(SetBreakpoints{{{.at = {1, 4}}}});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(2.0));
  Good(ChangeMode{Mode::kSingle});
  GoOn(At(100.0));
  EXPECT_EQ(machine->status().run.halted_by, HaltReason::kBreakpoint);
}

// OPT-6.31: a run that goes over to SINGLE halts behind the move under way, then behind each step.
TEST_F(MachineTest, SingleOnTheWay) {
  Load(
      {"COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\nVI[1] = 1\n"
       "VI[1] = 2\n"});
  Good(ChangeMode{Mode::kCycle});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(2.0));
  Good(ChangeMode{Mode::kSingle});
  GoOn(At(100.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().run.halted_by, HaltReason::kSingle);
  EXPECT_EQ(Value("VI[1]"), "0");
  Good(ResumeRun{.source = StartSource::kPanel});
  GoOn(At(101.0));
  EXPECT_EQ(Value("VI[1]"), "1");
  EXPECT_EQ(state(), MachineState::kHeld);
}

// live.md 2.10 a2, a4: RESUME takes back a STOP that has not halted yet; a run that is aborted on
// the way comes to rest first.
TEST_F(MachineTest, ComesToRestBeforeItGoesOnOrEnds) {
  const std::string move =
      "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (1521.02, 2201.2, -350., 0., 0.)\n";
  Load({move});
  Start();
  GoOn(At(3.0));
  EXPECT_GT(machine->status().run.tip_speed_mm_s, 10.0);
  Good(StopRun{});
  EXPECT_EQ(state(), MachineState::kStopping);
  Good(ResumeRun{});
  GoOn(At(3.0) + std::chrono::milliseconds(500));
  EXPECT_EQ(state(), MachineState::kRunning);
  EXPECT_EQ(heard.halts, std::vector<int>{4});
  for (const double percent : {0.0, 9.9, 145.1, std::nan("")})
    EXPECT_THAT(Refused(ChangeOverride{percent}), HasSubstr("it is 10 to 145 %"));
  Good(AbortRun{});
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("the run ends as soon as it stands"));
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOn(At(5.0));
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kCancelled);
  EXPECT_GT(over.lasted, At(3.5));
  EXPECT_EQ(machine->status().run.tip_speed_mm_s, 0.0);
  EXPECT_EQ(heard.halts.size(), 2U);
}

// The last word counts: a HOLD, or MANUAL, behind a RESUME of a run that is not at rest yet.
TEST_F(MachineTest, WhatIsAskedForLastCounts) {
  const std::string move =
      "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (1521.02, 2201.2, -350., 0., 0.)\n";
  for (const MachineInput& last : {MachineInput(HoldRun{}), MachineInput(StopRun{}),
                                   MachineInput(ChangeMode{Mode::kManual})}) {
    Load({move});
    Start();
    GoOn(At(3.0));
    Good(StopRun{});
    Good(ResumeRun{});
    Good(last);
    GoOn(At(10.0));
    EXPECT_EQ(state(), MachineState::kHeld) << last.index();
  }
}

// live.md 2.10 a9, LIVE-2.05: a door that opens behind a RESUME keeps the run where it comes to
// rest; the key START that the open door makes an alarm ends the run at once, with its own time.
// From afar it is refused, and the run stays held.
TEST_F(MachineTest, ADoorBehindAResume) {
  Load({"COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (1521.02, 2201.2, -350., 0., 0.)\n"});
  Start();
  GoOn(At(3.0));
  Good(StopRun{});
  Good(ResumeRun{});
  Good(MoveDoor{true});
  GoOn(At(10.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  const char* cuts =
      "COORD ABSOL\nPATH LIN\nSPEED 20\nWORK 0,0/ON\nMOVE (1521.02, 2201.2, -350., 0., 0.)\n";
  Load({cuts});
  Start();
  GoOn(At(3.0));
  Good(MoveDoor{true});
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9433"));
  GoOn(At(10.0));
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("OPT-E7410"));
  EXPECT_EQ(state(), MachineState::kHeld);
  Load({cuts});
  Good(ChangeMode{Mode::kCycle});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(3.0));
  Good(MoveDoor{true});
  Good(ResumeRun{.source = StartSource::kPanel});
  GoOn(At(33.0));
  EXPECT_EQ(state(), MachineState::kAlarm);
  const RunOver over = Over();
  EXPECT_EQ(CodeText(*over.outcome.code), "OPT-E7410");
  EXPECT_LT(over.lasted, At(4.0));
  EXPECT_EQ(machine->status().alarms.at(0).at, over.lasted);
}

// live.md 2.10 a7: in alarm until it is released and acknowledged.
TEST_F(MachineTest, EmergencyStopIsAnAlarm) {
  Load({"DELAY 5\n"});
  Start();
  GoOn(At(1.0));
  Good(EmergencyStop{});
  EXPECT_EQ(state(), MachineState::kAlarm);
  EXPECT_EQ(CodeText(*Over().outcome.code), "OPT-E7610");
  const std::vector<Alarm> alarms = machine->status().alarms;
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_EQ(alarms[0].at, At(1.0));
  EXPECT_EQ(alarms[0].place.step, 1);
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("OPT-E7610"));
  EXPECT_THAT(Refused(Acknowledge{alarms[0].id}), HasSubstr("release it first"));
  Good(EmergencyStop{.pressed = false});
  EXPECT_EQ(state(), MachineState::kAlarm);
  Good(Acknowledge{alarms[0].id});
  EXPECT_EQ(state(), MachineState::kIdle);
  Good(EmergencyStop{});  // standing
  EXPECT_EQ(machine->status().alarms.at(0).id, 2);
}

// An alarm of the program stays, too; a fatal error of it does not: live.md 2.10.
TEST_F(MachineTest, AlarmsOfARunStay) {
  Load({"COORD ROBOT\nMOVE (99999., 0., 0., 0., 0.)\n", "RETURN\n"});
  Start();
  GoOn(At(1.0));
  EXPECT_EQ(CodeText(*Over().outcome.code), "OPT-E7301");
  EXPECT_EQ(state(), MachineState::kAlarm);
  Good(Acknowledge{1});
  Start(2);
  GoOn(At(2.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(state(), MachineState::kIdle);
}

// OPT-4.68, OPT-6.08, OPT-7.63: what a power cycle takes away, and what it leaves.
TEST_F(MachineTest, PowerCycle) {
  Load({"TCP (0., 0., -10., 0., 0., -15.)\nVR[3] = 2.5\nOL[16] = ON\nOA[5] = 3.\nDELAY 5\n"});
  Good(SetBreakpoints{{{.at = {1, 4}}}});
  Start();
  GoOn(At(1.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Value("OL[16]") + Value("OA[5]"), "13.0");
  Good(SwitchPower{false});
  EXPECT_EQ(CodeText(*Over().outcome.code), "CELL-E9438");
  EXPECT_EQ(state(), MachineState::kOff);
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("CELL-E9424"));
  for (const MachineInput& input :
       {MachineInput(ChangeMode{Mode::kCycle}), MachineInput(ResumeRun{}),
        MachineInput(ChangeOverride{50.0}), MachineInput(Acknowledge{1}),
        MachineInput(WriteVariable{"VR[3]", 1.0}), MachineInput(SetBreakpoints{{{.at = {1, 1}}}}),
        MachineInput(SetSimulation{ProgramStep{1, 2}})}) {
    EXPECT_THAT(Refused(input), HasSubstr("CELL-E9424")) << input.index();
  }
  Good(AbortRun{});  // nothing to do
  EXPECT_THAT(machine->breakpoints(), IsEmpty());
  GoOn(At(2.0));
  Good(SwitchPower{true});
  EXPECT_EQ(state(), MachineState::kNotZeroed);
  EXPECT_EQ(Value("VR[3]"), "2.5");
  EXPECT_EQ(Value("OL[16]") + Value("OA[5]"), "00.0");
  EXPECT_EQ(machine->modal_values().at(0).value, "(0.0, 0.0, 0.0, 0.0, 0.0, -5.0)");
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("OPT-E7310"));
  Good(StartRun{.program = 1, .unzeroed = true});
  EXPECT_EQ(state(), MachineState::kRunning);
}

// LIVE-2.10: without power a machine takes nothing itself; what is done to it from outside acts.
TEST_F(MachineTest, WithoutPowerItTakesNothing) {
  Load({"DELAY 1\n"});
  Good(SwitchPower{false});
  for (const MachineInput& input :
       {MachineInput(StartRun{.program = 1}), MachineInput(ZeroAxes{}), MachineInput(ResumeRun{}),
        MachineInput(Acknowledge{1}), MachineInput(ChangeMode{Mode::kCycle}),
        MachineInput(ChangeOverride{50.0}), MachineInput(WriteVariable{"VR[3]", 1.0}),
        MachineInput(SetBreakpoints{}), MachineInput(SetSimulation{}),
        MachineInput(StartAtStep{.program = 1}), MachineInput(ClearMessage{}),
        MachineInput(PressJog{}), MachineInput(SetGates{}), MachineInput(PressGate{.gate = 1}),
        MachineInput(PressPanel{PanelKey::kHome})}) {
    EXPECT_EQ(Refused(input), "CELL-E9424 the machine is OFF") << input.index();
  }
  for (const MachineInput& input :
       {MachineInput(HoldRun{}), MachineInput(StopRun{}), MachineInput(AbortRun{}),
        MachineInput(MoveDoor{.open = true}), MachineInput(ReleaseJogs{}),
        MachineInput(EmergencyStop{.pressed = false}),
        MachineInput(StoreProgram{.slot = 2, .program = Translated("DELAY 2\n")}),
        MachineInput(DeleteProgram{.slot = 2})}) {
    Good(input);
    EXPECT_EQ(state(), MachineState::kOff) << input.index();
  }
}

// LIVE-9.07: written while it runs, a condition sees it before the next tick.
TEST_F(MachineTest, VariablesAreWritten) {
  Load({"WAIT VI[1] = 7\nVI[2] = VI[1]\n"});
  Good(WriteVariable{"VR[5]", 1e-30});
  EXPECT_EQ(Value("VR[5]"), "0.0");  // below 2^-64: OPT-7.62
  Good(WriteVariable{"OL[12]", 1.0});
  EXPECT_EQ(Value("OL[12]"), "1");
  Start();
  GoOn(At(3.0));
  Good(WriteVariable{"vi[1]", 7.0});
  GoOn(At(3.0));
  EXPECT_EQ(Over().lasted, At(3.0));
  EXPECT_EQ(Value("VI[2]"), "7");
  const auto refused = [&](const std::string& name, double value) {
    return Refused(WriteVariable{name, value});
  };
  EXPECT_THAT(refused("VI[1]", 40000.0), HasSubstr("whole numbers from -32768 to 32767"));
  EXPECT_THAT(refused("VI[1]", 0.5), HasSubstr("whole numbers"));
  EXPECT_THAT(refused("VL[1]", 2.0), HasSubstr("is 0 or 1"));
  EXPECT_THAT(refused("IL[5]", 1.0), HasSubstr("is an input"));
  EXPECT_THAT(refused("VI[98]", 1.0), HasSubstr("by the machine alone"));
  EXPECT_THAT(refused("VR[100]", 1.0), HasSubstr("no variable is called 'VR[100]'"));
  EXPECT_THAT(refused("OL[9]", 1.0), HasSubstr("OPT-E931"));  // two gas channels
  EXPECT_THAT(Refused(ChangeInput{.kind = InputKind::kLogical, .index = 100, .value = 1.0}),
              HasSubstr("no input IL[100]"));
  for (const double value : {std::nan(""), 1e300, -std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(Refused(ChangeInput{.kind = InputKind::kAnalogue, .index = 7, .value = value}),
                HasSubstr("CELL-E9003 IA[7]"));
  }
}

// LIVE-9.09
TEST_F(MachineTest, StackAndModalValues) {
  Load({"SPEED 25\nCALL 2\n",
        "COORD ABSOL\nPATH HOLE (12.5)\nGOSUB 10\nGO 99\n10 DELAY 5\nRETURN\n"});
  EXPECT_THAT(machine->stack(), IsEmpty());
  Start();
  GoOn(At(2.0));
  std::vector<std::pair<int, int>> stack;
  for (const Place& place : machine->stack()) stack.emplace_back(place.program, place.step);
  EXPECT_THAT(stack, ElementsAre(std::pair(1, 2), std::pair(2, 3), std::pair(2, 5)));
  std::map<std::string, std::string> modal;
  for (const ModalValue& value : machine->modal_values()) modal[value.name] = value.value;
  EXPECT_EQ(modal["COORD"], "ABSOL");
  EXPECT_EQ(modal["PATH"], "HOLE (12.5)");
  EXPECT_EQ(modal["SPEED"], "70.0");  // each program has its own
  EXPECT_EQ(modal["UPDATE"], "IL, OL, IA, OA");
  EXPECT_EQ(modal["IMAGE"], "OFF");
  EXPECT_EQ(modal["SYSDEF"], "OFF");
}

// OPT-B.65, OPT-1.11: a run has what it began with; what it made of an object that was replaced
// meanwhile is dropped.
TEST_F(MachineTest, MemoryChangesActAtTheNextStart) {
  Load({"DELAY 1\nVI[1] = 1\n", "VI[1] = 3\n"});
  Start();
  Good(StoreProgram{.slot = 1, .program = Translated("VI[1] = 2\n")});
  GoOn(At(2.0));
  EXPECT_EQ(Value("VI[1]"), "1");
  EXPECT_THAT(machine->TakeMadeExecutables(), IsEmpty());
  Start();
  GoOn(At(3.0));
  EXPECT_EQ(Value("VI[1]"), "2");
  const std::vector<MadeExecutable> made = machine->TakeMadeExecutables();
  ASSERT_EQ(made.size(), 1U);
  EXPECT_EQ(made[0].slot, 1);
  EXPECT_TRUE(family_.CheckExecutable(made[0].bytes, 1));
  EXPECT_EQ(*machine->memory().programs.at(1).executable, made[0].bytes);
  Start();  // the executable is there
  GoOn(At(4.0));
  EXPECT_THAT(machine->TakeMadeExecutables(), IsEmpty());
  Good(DeleteProgram{2});
  EXPECT_THAT(machine->memory().deleted, ElementsAre(2));
  EXPECT_THAT(Refused(StartRun{.program = 2}), HasSubstr("OPT-E7102"));
  EXPECT_THAT(Refused(DeleteProgram{2}), HasSubstr("OPT-E7102"));
}

// Stored while no run is open, and run for the first time.
TEST_F(MachineTest, TheExecutableOfANewProgramIsKept) {
  Load({"VI[1] = 1\n"});
  Good(StoreProgram{.slot = 2, .program = Translated("VI[1] = 2\n")});
  Start(2);
  GoOn(At(1.0));
  EXPECT_EQ(machine->TakeMadeExecutables().size(), 1U);
}

// LIVE-3.23, OPT-6.14: SIMUL whose step was not reached is kept by a mark in the dry run, too.
TEST_F(MachineTest, ADryRunIsSavedAsOne) {
  Load({"VI[1] = 1\nDELAY 5\nOL[12] = ON\n"});
  Good(SetSimulation{ProgramStep{1, 77}});
  Start();
  GoOn(At(1.0));
  Load({"OL[12] = ON\n"}, machine->Save());
  EXPECT_EQ(machine->simulation_until(), (ProgramStep{1, 77}));
  heard.told.clear();
  Start();
  GoOn(At(8.0));
  for (const std::string& line : heard.told) EXPECT_THAT(line, testing::Not(HasSubstr("signal")));
}

// LIVE-3.23: what a mark keeps, standing and in the middle of a run.
TEST_F(MachineTest, IsSavedAndMadeAnew) {
  Load({"VR[3] = 2.5\nCOORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\n"});
  Good(ChangeOverride{60.0});
  Good(SetBreakpoints{{{.at = {1, 9}, .condition = "VI[1] > 2", .from_pass = 3}}});
  Good(SetSimulation{ProgramStep{1, 2}});
  const std::string standing = machine->Save();
  Load({"DELAY 1\n"}, standing);
  EXPECT_EQ(machine->Save(), standing);
  EXPECT_EQ(machine->status().override_percent, 60.0);
  EXPECT_EQ(machine->breakpoints().at(0).condition, "VI[1] > 2");
  EXPECT_EQ(machine->simulation_until(), (ProgramStep{1, 2}));

  Load({"VR[3] = 2.5\nCOORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\n"});
  GoOn(At(1.0));
  Good(ChangeMode{Mode::kCycle});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(4.0));
  const RunState moving = machine->status().run;
  EXPECT_GT(moving.tip_speed_mm_s, 1.0);
  Load({"DELAY 1\n"}, machine->Save());
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(machine->time(), At(4.0));
  EXPECT_EQ(machine->status().mode, Mode::kCycle);
  EXPECT_EQ(Value("VR[3]"), "2.5");
  EXPECT_EQ(machine->status().run.tip.tip, moving.tip.tip);
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(6.0));
  EXPECT_EQ(Over().run.number, 2);  // numbers are never used twice
}

// What an order is refused for is known as numbers and words.
TEST_F(MachineTest, RefusalsKnowWhatTheyAreAbout) {
  Load({"COORD ROBOT\n"});
  const auto told = [&](const MachineInput& input) {
    const Status done = machine->Apply(input);
    return done ? std::string("taken") : ArgumentsText(done.error().detail);
  };
  EXPECT_EQ(told(ChangeOverride{200.0}), "override=200 % least=10 % most=145 %");
  EXPECT_EQ(told(StartRun{.program = 100}), "program=100");
  EXPECT_EQ(told(StartRun{.program = 44}), "program=44");
  EXPECT_EQ(told(DeleteProgram{44}), "program=44");
  EXPECT_EQ(told(ChangeInput{InputKind::kLogical, 100, 1.0}), "input='IL[100]'");
  EXPECT_EQ(told(SetBreakpoints{{{.at = {0, 3}}}}), "step=3");
  EXPECT_EQ(told(WriteVariable{"IL[3]", 1.0}), "variable='IL[3]'");
}

// OPT-4.03, LIVE-2.10: without power there is no alarm, no message and no dry run left; an
// emergency stop that is pressed is one alarm, and one again behind it.
TEST_F(MachineTest, WhatEndsWithThePower) {
  Load({"VI[1] = 2\nGOTO VI[1] (20,999)\n20 ENDTASK\n"});
  Start();
  GoOn(At(1.0));
  ASSERT_TRUE(machine->status().message);
  Good(SetSimulation{ProgramStep{1, 2}});
  Good(EmergencyStop{});
  Good(EmergencyStop{.pressed = false});
  ASSERT_EQ(state(), MachineState::kAlarm);
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  EXPECT_EQ(state(), MachineState::kNotZeroed);
  EXPECT_THAT(machine->status().alarms, IsEmpty());
  EXPECT_EQ(machine->status().message, std::nullopt);
  EXPECT_EQ(machine->simulation_until(), std::nullopt);
  Good(EmergencyStop{});
  Good(EmergencyStop{});
  EXPECT_EQ(machine->status().alarms.size(), 1U);
  Good(SwitchPower{false});
  EXPECT_THAT(machine->status().alarms, IsEmpty());
  Good(SwitchPower{true});
  EXPECT_EQ(state(), MachineState::kAlarm);
  ASSERT_EQ(machine->status().alarms.size(), 1U);
  EXPECT_EQ(CodeText(machine->status().alarms[0].code), "OPT-E7610");
  // Pressed while it is off it is none before it is on.
  Load({"DELAY 1\n"});
  Good(SwitchPower{false});
  Good(EmergencyStop{});
  EXPECT_THAT(machine->status().alarms, IsEmpty());
  Good(SwitchPower{true});
  EXPECT_EQ(state(), MachineState::kAlarm);
}

// OPT-1.10, OPT-1.13: slots are 1 to 99; what is stored again is not deleted any more.
TEST_F(MachineTest, StoresIntoTheSlotsThatThereAre) {
  Load({"DELAY 1\n", "DELAY 1\n"});
  for (const int slot : {0, 100}) {
    EXPECT_EQ(Refused(StoreProgram{.slot = slot, .program = Translated("DELAY 2\n")}),
              "OPT-E7101 program " + std::to_string(slot) + ", allowed are 1 to 99");
  }
  EXPECT_EQ(machine->memory().programs.size(), 2U);
  Good(DeleteProgram{2});
  EXPECT_THAT(machine->memory().deleted, ElementsAre(2));
  Good(StoreProgram{.slot = 2, .program = Translated("DELAY 2\n")});
  EXPECT_THAT(machine->memory().deleted, IsEmpty());
}

}  // namespace
}  // namespace rmlcell::machine
