// The same machine with streams: commands in place of steps, no inputs and no variables to write.
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class MillMachine : public MachineTest {
 protected:
  MillMachine() : MachineTest("rml1") {}
};

constexpr const char* kStrokes =
    "VS10;!VZ10;!PZ-100,200;!MC1;PU2010,1510;PD4010,1510;PD4010,3510;PD2010,3510;PU0,0;!MC0;";

// HOLD in REMOTE lets the stroke in progress end; a held mill stands as long as nobody resumes.
TEST_F(MillMachine, IsHeldAndGoesOn) {
  Load({kStrokes});
  Start();
  GoOn(At(60.0));
  const SimTime plain = Over().lasted;
  Load({kStrokes});
  Start();
  GoOn(At(3.0));
  Good(HoldRun{});
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOn(At(60.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  const SimTime halted = machine->status().run.time;
  EXPECT_EQ(halted, At(60.0));
  EXPECT_EQ(heard.halts.size(), 1U);
  Good(ResumeRun{});
  GoOn(At(120.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_GT(Over().lasted, At(60.0));
  EXPECT_LT(plain, At(60.0));
}

// A pause of the stream is a halt that RESUME ends: RML1-3C.08. Its SINGLE and its breakpoints are
// commands.
TEST_F(MillMachine, HaltsBehindCommands) {
  Load({"PU100,100;!NR;PU200,200;PU300,300;PU400,400;"});
  Start();
  GoOn(At(20.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().run.halted_by, HaltReason::kProgram);
  Good(SetBreakpoints{{{.at = {1, 5}}, {.at = {1, 3}}, {.at = {2, 4}}}});
  Good(ResumeRun{});
  GoOn(At(40.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(heard.halts, (std::vector<int>{2, 3}));
  EXPECT_EQ(machine->stack().at(0).step, 3);
  Good(ResumeRun{});
  GoOn(At(60.0));
  EXPECT_EQ(heard.halts, (std::vector<int>{2, 3, 5}));
  Good(ResumeRun{});
  GoOn(At(80.0));
  EXPECT_EQ(state(), MachineState::kIdle);
}

// Set where the tool passes without standing: it halts as HOLD would, behind that command.
TEST_F(MillMachine, ABreakpointThatComesLate) {
  std::string chain = "VS10;!VZ10;!PZ-100,200;!MC1;PU0,0;";
  for (int i = 1; i <= 60; ++i)  // one straight line in parts of 0.1 mm: command 5 + i
    chain += "PD" + std::to_string(10 * i) + ",0;";
  Load({chain});
  Start();
  while (machine->status().run.place.step < 15) GoOn(machine->time() + At(0.001));
  Good(SetBreakpoints{{{.at = {1, 18}}}});
  GoOn(At(100.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().run.halted_by, HaltReason::kBreakpoint);
  EXPECT_GE(machine->status().run.place.step, 18);
  EXPECT_LE(machine->status().run.place.step, 30);
  EXPECT_EQ(machine->status().run.tip_speed_mm_s, 0.0);
  Good(ResumeRun{});
  GoOn(At(200.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(Value("X"), "600");
}

// live.md 2.10 a2, LIVE-3.15: START takes a HOLD back that has not halted it yet, as in a
// simulation.
TEST_F(MillMachine, TakesAHoldBack) {
  Load({kStrokes});
  Start();
  GoOn(At(60.0));
  const SimTime plain = Over().lasted;
  Load({kStrokes});
  Start();
  GoOn(At(3.0));
  Good(HoldRun{});
  Good(ResumeRun{});
  EXPECT_EQ(state(), MachineState::kRunning);
  GoOn(At(60.0));
  EXPECT_TRUE(heard.halts.empty());
  EXPECT_EQ(Over().lasted, plain);
}

// LIVE-5.08
TEST_F(MillMachine, AnEmergencyStopFailsTheRun) {
  Load({kStrokes});
  Start();
  GoOn(At(3.0));
  Good(EmergencyStop{});
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(CodeText(*over.outcome.code), "CELL-E9437");
  EXPECT_FALSE(machine->status().run.spindle_on);
}

// LIVE-2.04, LIVE-3.30: a spindle that a stream left on, or that turned when it was saved, stands
// in IDLE; the next stream that cuts switches it on.
TEST_F(MillMachine, ItsSpindleTurnsInRunsOnly) {
  Load({"VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD200,100;"});
  Start();
  GoOn(At(3.0));
  EXPECT_TRUE(machine->status().run.spindle_on);
  const std::string saved = machine->Save();
  GoOn(At(60.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_FALSE(machine->status().run.spindle_on);
  EXPECT_EQ(Value("SPINDLE"), "off");
  Load({"PD300,100;"}, saved);
  EXPECT_FALSE(machine->status().run.spindle_on);
  EXPECT_EQ(Value("MC"), "on");
  Start();
  GoOn(At(5.0));
  EXPECT_TRUE(machine->status().run.spindle_on);
}

TEST_F(MillMachine, RefusesWhatAMillDoesNotHave) {
  Load({kStrokes});
  EXPECT_THAT(Refused(ChangeMode{Mode::kRepeat}),
              AllOf(StartsWith("CELL-E9423"), HasSubstr("no mode REPEAT")));
  EXPECT_THAT(Refused(SetSimulation{ProgramStep{1, 2}}),
              AllOf(StartsWith("CELL-E9424"), HasSubstr("no dry run")));
  EXPECT_THAT(Refused(SetBreakpoints{{{.at = {1, 2}, .condition = "X > 3"}}}),
              HasSubstr("no expressions"));
  EXPECT_THAT(Refused(SetBreakpoints{{{.at = {1, 2}, .from_pass = 2}}}),
              HasSubstr("comes to each command once"));
  EXPECT_THAT(Refused(WriteVariable{"VS", 5.0}), HasSubstr("by the machine alone"));
  EXPECT_THAT(Refused(WriteVariable{"VI[1]", 5.0}), HasSubstr("no variable"));
  EXPECT_THAT(Refused(ChangeInput{.kind = InputKind::kLogical, .index = 1, .value = 1.0}),
              AllOf(StartsWith("CELL-E9003"), HasSubstr("no input")));
  EXPECT_THAT(Refused(ChangeOverride{0.0}),
              AllOf(StartsWith("CELL-E9003"), HasSubstr("it is 10 to 145 %")));
  const Result<KeyAnswer> pressed = machine->PressKey("ENT", KeyAction::kPress);
  ASSERT_FALSE(pressed);
  EXPECT_EQ(pressed.error().code, ErrorCode::kCellNotLive);
}

// RML1-7.08: speeds and the place stay from stream to stream; behind a power cycle it is a new one,
// at the work origin with Z at the top, 20 mm above Z0. It has its reference all the time.
TEST_F(MillMachine, KeepsItsRegisters) {
  Load({"VS7;PU300,200;"});
  const std::string fresh = Value("VS");
  Start();
  GoOn(At(30.0));
  EXPECT_EQ(Value("VS"), "7");
  EXPECT_EQ(Value("X"), "300");
  const std::string saved = machine->Save();
  Load({"PU0,0;"}, saved);
  EXPECT_EQ(machine->Save(), saved);
  EXPECT_EQ(Value("VS"), "7");
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(Value("VS"), fresh);
  EXPECT_EQ(Value("X") + " " + Value("Y"), "0 0");
  EXPECT_EQ(machine->status().run.tip.tip.z(), 0.0);
  Good(EmergencyStop{});
  EXPECT_EQ(CodeText(machine->status().alarms.at(0).code), "CELL-E9437");
}

}  // namespace
}  // namespace rmlcell::machine
