#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/optimo/machine/machine_state.h"
#include "tests/engine/optimo/control/run_text.h"

// SIMUL: the dry run up to a step, chapter 6.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using machine::OutcomeKind;
using machine::ProgramStep;
using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

ProgramStep Step(int step, int program = 1) { return {.program = program, .step = step}; }

MachineState StateOf(const Ran& ran) {
  const Result<MachineState> state = DecodeMachineState(ran.machine_state);
  EXPECT_TRUE(bool(state));
  return state ? *state : MachineState();
}

std::string Encoded(void (*change)(MachineState&)) {
  MachineState state = NewMachine(Resolve(machine::Parameters(OptimoParameterTable())));
  change(state);
  return EncodeMachineState(state);
}

bool TellsOf(const Ran& ran, std::string_view word) {
  return std::ranges::any_of(
      ran.told, [&](const std::string& what) { return what.find(word) != std::string::npos; });
}

double Travelled(const Ran& ran) {
  double length = 0.0;
  for (const Ran::Part& part : ran.parts) length += part.done.travelled - part.done.from;
  return length;
}

std::string Times(int count, const std::string& line) {
  std::string text;
  for (int n = 0; n < count; ++n) text += line;
  return text;
}

// OPT-6.13: SIM 45/10 simulates steps 1 to 9; 10 and all after it run, also those of the caller.
TEST(SimulRules, StepsBeforeTheStepAreDry) {
  const Ran ran = RunText("DELAY 100\nCALL 45\nDELAY 7\n",
                          {.programs = {{45, Times(12, "DELAY 1\n")}}, .simul = Step(10, 45)});
  EXPECT_THAT(ran.told,
              ElementsAre("compiling 1", "compiling 45", "call 45", "wait dwell 1.0",
                          "wait dwell 1.0", "wait dwell 1.0", "return 1", "wait dwell 7.0"));
  EXPECT_EQ(ran.steps, 2U + 12U + 1U);  // simulated steps are executed steps
}

// OPT-6.13: the first time that control comes to the step ends it: the second pass is real.
TEST(SimulRules, ALoopIsRealFromTheFirstTimeOn) {
  const Ran ran = RunText("10 VI[2]=VI[2]+1\nDELAY 1\nVI[3]=VI[3]+1\nIF VI[2] < 3 THEN 10\n",
                          {.variables = {"VI[2]", "VI[3]"}, .simul = Step(3)});
  EXPECT_NEAR(ran.time_s, 2.0, 1e-9);
  EXPECT_EQ(ran.variables.at("VI[2]"), "3");
  EXPECT_EQ(ran.variables.at("VI[3]"), "3");
}

// OPT-6.05: step 3 of 44 is not step 3 of 32.
TEST(SimulRules, EachModuleHasItsOwnSteps) {
  const RunOptions two{.programs = {{44, Times(3, "DELAY 1\n")}, {32, Times(3, "DELAY 2\n")}}};
  RunOptions dry = two;
  dry.simul = Step(3, 32);
  EXPECT_NEAR(RunText("FUNCTION 44\nFUNCTION 32\n", dry).time_s, 2.0, 1e-9);
  RunOptions stops = two;
  stops.breakpoint = Step(3, 32);
  const Ran ran = RunText("FUNCTION 44\nFUNCTION 32\n", stops);
  EXPECT_EQ(ran.Count("halt BREAK"), 1);
  EXPECT_EQ(ran.First("halt BREAK").program, 32);
  EXPECT_EQ(ran.First("halt BREAK").step, 3);
  EXPECT_NEAR(ran.First("halt BREAK").at_s, 3.0 + 6.0, 1e-9);
}

// OPT-6.14: a step that is not reached leaves SIMUL on: run 1 and run 2 do not move; one that is
// reached switches it off.
TEST(SimulRules, StaysOnUntilItsStepIsReached) {
  const std::string text = kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nDELAY 3\n";
  const Ran first = RunText(text, {.simul = Step(9)});
  const Ran second = RunText(text, {.machine_state = first.machine_state});
  for (const Ran* ran : {&first, &second}) {
    EXPECT_EQ(ran->outcome.kind, OutcomeKind::kCompleted);
    EXPECT_TRUE(ran->parts.empty());
    EXPECT_EQ(ran->time_s, 0.0);
    EXPECT_EQ(ran->steps, 4U);
  }
  ASSERT_TRUE(StateOf(second).simul.has_value());
  EXPECT_EQ(StateOf(second).simul->step, 9);
  EXPECT_EQ(StateOf(second).simul->program, 1);
  const Ran reached = RunText(Times(9, "DELAY 1\n"), {.machine_state = second.machine_state});
  EXPECT_NEAR(reached.time_s, 1.0, 1e-9);
  EXPECT_FALSE(StateOf(reached).simul.has_value());
  EXPECT_FALSE(RunText(text, {.machine_state = reached.machine_state}).parts.empty());
}

// OPT-6.14: however the run ends: by an error, or by a key.
TEST(SimulRules, StaysOnWhenTheRunFails) {
  const Ran failed = RunText("VR[0]=1/0\nDELAY 1\n", {.simul = Step(2)});
  EXPECT_EQ(CodeOf(failed), 7201);
  EXPECT_TRUE(StateOf(failed).simul.has_value());
}

// OPT-6.14: a SIMUL set for a run takes the place of the one that was on.
TEST(SimulRules, ANewSimulTakesThePlaceOfTheOld) {
  const Ran armed = RunText("SIMUL 4\n");
  const Ran reached =
      RunText(Times(3, "DELAY 1\n"), {.simul = Step(2), .machine_state = armed.machine_state});
  EXPECT_NEAR(reached.time_s, 2.0, 1e-9);
  EXPECT_FALSE(StateOf(reached).simul.has_value());
}

// OPT-6.16: the instruction does not affect the running program; the next start is simulated up to
// 45/10. Without a program the module is meant in which it stands.
TEST(SimulRules, TheInstructionArmsTheNextStart) {
  const RunOptions with_45{.programs = {{45, Times(10, "DELAY 1\n")}}};
  const Ran arming = RunText("SIMUL 10, 45\nCALL 45\n", with_45);
  EXPECT_NEAR(arming.time_s, 10.0, 1e-9);
  RunOptions next = with_45;
  next.machine_state = arming.machine_state;
  EXPECT_NEAR(RunText("DELAY 5\nCALL 45\n", next).time_s, 1.0, 1e-9);
  const Ran inner = RunText("CALL 45\n", {.programs = {{45, "SIMUL 10\n"}}});
  EXPECT_EQ(StateOf(inner).simul->program, 45);
  EXPECT_EQ(StateOf(inner).simul->step, 10);
  // Also while a dry run goes on: the later one counts.
  const Ran both = RunText("SIMUL 7\n", {.simul = Step(3)});
  EXPECT_EQ(StateOf(both).simul->step, 7);
}

// OPT-6.08: a breakpoint set for a run stays for the next runs; a new one replaces it.
TEST(SimulRules, ABreakpointOfARunStays) {
  const std::string text = Times(5, "DELAY 1\n");
  const machine::InputScript start{{At(10.0), InputKind::kStart}};
  const Ran first = RunText(text, {.inputs = start, .breakpoint = Step(2)});
  const Ran second = RunText(text, {.inputs = start, .machine_state = first.machine_state});
  EXPECT_EQ(second.First("halt BREAK").step, 2);
  const Ran third = RunText(
      text, {.inputs = start, .breakpoint = Step(4), .machine_state = second.machine_state});
  EXPECT_EQ(third.Count("halt BREAK"), 1);
  EXPECT_EQ(third.First("halt BREAK").step, 4);
  EXPECT_EQ(StateOf(third).breakpoint->step, 4);
}

// OPT-6.17: what simulated steps set holds afterwards: SPEED, ACCEL, PATH, COORD, SYSDEF, VR.
TEST(SimulRules, ModalValuesAndVariablesHold) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nACCEL 50\nVR[0]=100.\nSYSDEF "
      "(21.02,2201.2,-350.,0.,0.,0.)\n"
      "MOVE (VR[0],0.,0.,0.,0.)\n",
      {.simul = Step(7)});
  ASSERT_EQ(ran.moves.size(), 1U);
  EXPECT_EQ(ran.moves[0].path, "LIN");
  EXPECT_NEAR(ran.moves[0].feed_mm_s, 50.0, 1e-9);  // 10 % of VMAX
  EXPECT_NEAR(ran.moves[0].tip.tip.x(), kHomeTip.x() + 100.0, 1e-4);
  EXPECT_NEAR(ran.moves[0].tip.tip.y(), kHomeTip.y(), 1e-3);
  ASSERT_EQ(ran.parts.size(), 1U);
  EXPECT_NEAR(ran.parts[0].motion.limits.acceleration, 1000.0, 1e-9);  // 50 % of AMAX
}

// OPT-6.17: the tool offset of a simulated TCP holds, too: 10 mm more of it lifts the column.
TEST(SimulRules, TheToolOffsetHolds) {
  const Ran ran = RunText("COORD ABSOL\nTCP (0,0,-10./0,0,-15.)\nMOVE (21.02,2201.2,-350.,0.,0.)\n",
                          {.simul = Step(3)});
  const Ran real =
      RunText("COORD ABSOL\nTCP (0,0,-10./0,0,-15.)\nMOVE (21.02,2201.2,-350.,0.,0.)\n");
  EXPECT_NEAR(std::abs(ran.end.axes.column.z() - -50.0), 10.0, 1e-4);
  EXPECT_EQ(ran.end.axes.column.z(), real.end.axes.column.z());
}

// OPT-6.17: jumps, GOSUB, FUNCTION, CALL and GO are followed.
TEST(SimulRules, JumpsAndCallsAreFollowed) {
  const Ran ran = RunText(
      "GOTO 20\nVI[2]=99\n20 GOSUB 30\nFUNCTION 44\nCALL 45\nGO 46\n30 VI[2]=VI[2]+1\nRETURN\n",
      {.programs = {{44, "VI[2]=VI[2]+10\n"},
                    {45, "VI[2]=VI[2]+100\n"},
                    {46, "DELAY 2\nDELAY 3\n"}},
       .variables = {"VI[2]"},
       .simul = Step(2, 46)});
  EXPECT_EQ(ran.variables.at("VI[2]"), "111");
  EXPECT_NEAR(ran.time_s, 3.0, 1e-9);
  EXPECT_TRUE(ran.Told("call 45"));
  EXPECT_TRUE(ran.Told("go 46"));
}

// OPT-6.17: loading a CALLed program takes its time in reality only.
TEST(SimulRules, ASimulatedCallLoadsAtOnce) {
  RunOptions options{.programs = {{45, "VI[2]=1\n"}}, .parameters = {{"CALL_TIME", "4"}}};
  EXPECT_NEAR(RunText("CALL 45\n", options).time_s, 4.0, 1e-9);
  options.simul = Step(9);
  EXPECT_EQ(RunText("CALL 45\n", options).time_s, 0.0);
}

// OPT-6.18: nine simulated steps leave the machine where it stands; the first real MOVE starts
// there, not at the target of a simulated one.
TEST(SimulRules, TheMachineDoesNotMove) {
  const Ran ran = RunText(kAbsol + "SPEED 10\n" + Times(6, "MOVE (1000.,1000.,-400.,0.5,0.5)\n") +
                              "MOVE (121.02,2201.2,-350.,0.,0.)\n",
                          {.simul = Step(10)});
  ASSERT_EQ(ran.parts.size(), 1U);
  EXPECT_EQ(ran.parts[0].done.start, SimTime(0));
  EXPECT_NEAR((ran.parts[0].motion.path.At(0.0).point - kHomeTip).norm(), 0.0, 1e-6);
  EXPECT_NEAR(Travelled(ran), 100.0, 1e-4);
  EXPECT_EQ(ran.moves.size(), 1U);
  EXPECT_EQ(ran.moves[0].place.step, 10);
}

// OPT-6.18: /START and /END are ignored: nothing is waited for, and the place stays.
TEST(SimulRules, StartAndEndOfAMoveAreIgnored) {
  const Ran ran = RunText(kAbsol +
                              "MOVE (1000.,1000.,-400.,0.,0.)/START (IL[20])\n"
                              "MOVE (1000.,1000.,-400.,0.,0.)/END (IL[20])\n"
                              "MOVE (1000.,1000.,-400.,0.,0.)/START (1/VI[2])\n"
                              "VI[3]=1\n",
                          {.variables = {"VI[3]"}, .simul = Step(9)});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.time_s, 0.0);
  EXPECT_TRUE(ran.waits.empty());
  EXPECT_TRUE(ran.parts.empty());
  EXPECT_EQ(ran.variables.at("VI[3]"), "1");
}

// OPT-6.18: /TIME does not arm the time-out: it would come due in the DELAY behind.
TEST(SimulRules, TheTimeOutOfAMoveIsNotArmed) {
  const std::string text =
      kAbsol +
      "MOVE (1000.,1000.,-400.,0.,0.)/TIME (1., 900)/NEXT\nDELAY 5\nVI[3]=VI[2]\n"
      "ENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n";
  const Ran dry = RunText(text, {.variables = {"VI[3]"}, .simul = Step(4)});
  EXPECT_EQ(dry.variables.at("VI[3]"), "0");
  EXPECT_NEAR(dry.time_s, 5.0, 1e-9);
  EXPECT_EQ(RunText(text, {.variables = {"VI[3]"}}).variables.at("VI[3]"), "1");
}

// OPT-6.18: a MOVE that the real machine could not make is no error while nothing moves; what it
// is computed of is evaluated all the same.
TEST(SimulRules, ASimulatedMoveChecksItsValuesOnly) {
  EXPECT_EQ(CodeOf(RunText(kAbsol + "MOVE (9000.,1000.,-400.,0.,0.)\n", {.simul = Step(9)})), 0);
  EXPECT_EQ(CodeOf(RunText(kAbsol + "MOVE (9000.,1000.,-400.,0.,0.)\n")), 7301);
  EXPECT_EQ(CodeOf(RunText(kAbsol + "MOVE (1/VI[2],1000.,-400.,0.,0.)\n", {.simul = Step(9)})),
            7201);
}

// OPT-6.19: a real CIR first: an arc through the actual position, via and target. Here half a
// circle of radius 50 whatever the simulated MOVE before it asked for.
TEST(SimulRules, ACircleFirstBeginsAtTheActualPosition) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH CIR\nSPEED 10\nMOVE (1000.,1000.,-400.,0.,0.)\n"
      "MOVE (121.02,2201.2,-350.,0.,0.)/VIA (71.02,2251.2,-350.,0.,0.)\n",
      {.simul = Step(5)});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_NEAR(Travelled(ran), 50.0 * kPi, 1e-3);
  EXPECT_NEAR(ran.DistanceTo({71.02, 2251.2, -350.0}), 0.0, 1e-4);
  EXPECT_NEAR(ran.end.tip.tip.x(), 121.02, 1e-4);
}

// OPT-6.20: the process counts as ON or OFF, the beam stays off and the shutter closed, in the
// whole dry run. IL[89] is that of process 2.
TEST(SimulRules, ASimulatedWorkOnlyCounts) {
  const Ran ran = RunText(
      "WORKDEF 1,2 (8.,75.,1.5,50.)\nWORK 0,0/ON\nVL[0]=IL[87]\nWORK 0,0/OFF\nVL[1]=IL[87]\n"
      "WORK 1,2/ON\nVL[2]=IL[89]\nVL[3]=IL[87]\nWORK 1,2/OFF\nVL[4]=IL[89]\n",
      {.variables = {"VL[0]", "VL[1]", "VL[2]", "VL[3]", "VL[4]"}, .simul = Step(11)});
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
  EXPECT_EQ(ran.variables.at("VL[1]"), "0");
  EXPECT_EQ(ran.variables.at("VL[2]"), "1");
  EXPECT_EQ(ran.variables.at("VL[3]"), "0");
  EXPECT_EQ(ran.variables.at("VL[4]"), "0");
  EXPECT_THAT(ran.told, ElementsAre("compiling 1"));  // no beam, no shutter, no pierce
  EXPECT_EQ(ran.time_s, 0.0);
}

// OPT-6.20: /START and /END are ignored, and no dwell of /NEXT begins: the processes are ON at
// once, and what becomes true later switches none of them.
TEST(SimulRules, ConditionsOfASimulatedWorkAreIgnored) {
  const Ran ran = RunText(
      "WORKDEF 1,2 (8.,75.,1.5,50.)\nWORKDEF 0,1\nWORK 0,0/ON/START (IL[20])\nVL[0]=IL[87]\n"
      "WORK 0,1/ON/END (IL[21])\nVL[1]=IL[88]\nWORK 1,2/ON/NEXT\nVL[2]=IL[89]\nDELAY 5\n"
      "VL[3]=IL[88]\n",
      {.inputs = {{At(1.0), InputKind::kLogical, 21, 1.0}, {At(2.0), InputKind::kLogical, 20, 1.0}},
       .variables = {"VL[0]", "VL[1]", "VL[2]", "VL[3]"},
       .simul = Step(9)});
  for (const char* flag : {"VL[0]", "VL[1]", "VL[2]", "VL[3]"}) {
    EXPECT_EQ(ran.variables.at(flag), "1") << flag;
  }
  EXPECT_NEAR(ran.time_s, 5.0, 1e-9);
  EXPECT_FALSE(TellsOf(ran, "beam"));
  EXPECT_FALSE(TellsOf(ran, "shutter"));
}

// OPT-6.20: a CALL with a process ON is an error in the dry run as in a real one (OPT-3.33).
TEST(SimulRules, ASimulatedProcessCountsAtACall) {
  const RunOptions options{.programs = {{45, "VI[2]=1\n"}}, .simul = Step(9)};
  EXPECT_EQ(CodeOf(RunText("WORK 0,0/ON\nCALL 45\n", options)), 7407);
  EXPECT_EQ(CodeOf(RunText("WORK 0,0/ON\nWORK 0,0/OFF\nCALL 45\n", options)), 0);
}

// OPT-6.20: with the door open a simulated WORK is no alarm: nothing opens.
TEST(SimulRules, ASimulatedWorkMayHaveTheDoorOpen) {
  const std::string open = Encoded([](MachineState& state) { state.door_open = true; });
  EXPECT_EQ(CodeOf(RunText("WORK 0,0/ON\nVI[2]=1\n", {.machine_state = open})), 7410);
  EXPECT_EQ(
      CodeOf(RunText("WORK 0,0/ON\nWORK 0,0/OFF\n", {.simul = Step(9), .machine_state = open})), 0);
}

// OPT-6.21: resumed in the middle of a contour the machine moves without the beam, also behind a
// STOP, until the next WORK ON.
TEST(SimulRules, TheBeamStaysOffUntilTheNextWorkOn) {
  const Ran ran = RunText(kAbsol +
                              "SPEED 10\nWORK 0,0/ON\nMOVE (1000.,1000.,-400.,0.,0.)\n"
                              "MOVE (121.02,2201.2,-350.,0.,0.)\nVL[0]=IL[87]\n"
                              "WORK 0,0/ON\nMOVE (171.02,2201.2,-350.,0.,0.)\nWORK 0,0/OFF\n",
                          {.inputs = {{At(1.0), InputKind::kStop}, {At(2.0), InputKind::kStart}},
                           .variables = {"VL[0]"},
                           .simul = Step(6)});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");  // the process counts as ON
  EXPECT_EQ(ran.Count("beam on 100.0"), 1);
  EXPECT_EQ(ran.First("beam on 100.0").step, 8);
  EXPECT_EQ(ran.First("shutter open").step, 8);
  EXPECT_NEAR(ran.BeamOnLength(), 50.0, 1e-4);
  EXPECT_NEAR(Travelled(ran), 150.0, 1e-4);
}

// OPT-6.22: ZERO counts as performed but is not: nothing moves, no later simulated step gives 7310,
// the first real MOVE does, and the machine is as little zeroed afterwards as before.
TEST(SimulRules, ZeroIsNotPerformed) {
  const std::string cold = Encoded([](MachineState& state) { state.zeroed = false; });
  const std::string text = "ZERO\nMOVE (10.,0.,0.,0.,0.)\nVI[2]=1\nMOVE (20.,0.,0.,0.,0.)\n";
  const Ran ran = RunText(text, {.simul = Step(3), .machine_state = cold});
  EXPECT_EQ(CodeOf(ran), 7310);
  EXPECT_EQ(ran.outcome.place.step, 4);
  EXPECT_TRUE(ran.moves.empty());
  EXPECT_TRUE(ran.parts.empty());
  EXPECT_EQ(ran.time_s, 0.0);
  EXPECT_FALSE(StateOf(ran).zeroed);
  EXPECT_EQ(StateOf(ran).axes.column.x(), 21.02);
  const Ran zeroed = RunText(text, {.simul = Step(3)});  // a zeroed machine stays so
  EXPECT_EQ(CodeOf(zeroed), 0);
  EXPECT_TRUE(StateOf(zeroed).zeroed);
}

// OPT-6.23: DELAY takes no time, WAIT is passed at once, TIMER is not performed, also not later.
TEST(SimulRules, WaitsTakeNoTime) {
  const Ran ran = RunText(
      "DELAY 10\nWAIT IL[20]\nTIMER (1., 900)\nVI[3]=1\nDELAY 5\nENDTASK\n"
      "900 VI[2]=VI[2]+1\nRETURN\n",
      {.variables = {"VI[2]"}, .simul = Step(4)});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_THAT(ran.told, ElementsAre("compiling 1", "wait dwell 5.0"));
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
}

// OPT-6.24: only the images change; the outputs are set from them at the step where normal
// operation resumes, those that were switched back not at all.
TEST(SimulRules, OutputsAreSetAtTheResume) {
  const Ran ran = RunText(
      "OL[11]=ON\nVL[0]=OL[11]\nOL[16]=ON\nOL[16]=OFF\nOA[5]=3.5\nVR[0]=OA[5]\nOL[8]=ON\nVI[2]=1\n"
      "DELAY 2\n",
      {.variables = {"VL[0]", "VR[0]"}, .simul = Step(8)});
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
  EXPECT_EQ(ran.variables.at("VR[0]"), "3.5");
  EXPECT_THAT(ran.told, UnorderedElementsAre("compiling 1", "OL[8] 1", "gas 2", "OL[11] 1",
                                             "sensor on", "OA[5] 3.5", "wait dwell 2.0"));
  EXPECT_EQ(ran.told.back(), "wait dwell 2.0");
  for (const char* what : {"OL[8] 1", "gas 2", "OL[11] 1", "sensor on", "OA[5] 3.5"}) {
    EXPECT_EQ(ran.First(what).step, 8) << what;
    EXPECT_EQ(ran.First(what).program, 1) << what;
  }
  EXPECT_TRUE(StateOf(ran).outputs.logical[11]);
  EXPECT_FALSE(StateOf(ran).outputs.logical[16]);
}

// OPT-6.24: in a run that does not resume the outputs stay as they are, on or off.
TEST(SimulRules, OutputsOfADryRunStay) {
  const Ran before = RunText("OL[16]=ON\nOA[5]=2.\n");
  const Ran ran = RunText("OL[11]=ON\nOL[16]=OFF\nOA[5]=3.5\n",
                          {.simul = Step(9), .machine_state = before.machine_state});
  EXPECT_THAT(ran.told, ElementsAre("compiling 1"));
  const MachineState state = StateOf(ran);
  EXPECT_TRUE(state.data.ol[11]);
  EXPECT_FALSE(state.data.ol[16]);
  EXPECT_FALSE(state.outputs.logical[11]);
  EXPECT_TRUE(state.outputs.logical[16]);
  EXPECT_EQ(state.data.oa[5], 3.5F);
  EXPECT_EQ(state.outputs.analogue[5], 2.0F);
}

// OPT-6.24, OPT-7.98: a group whose UPDATE is OFF stays disconnected at the resume.
TEST(SimulRules, ADisconnectedGroupIsNotSet) {
  const Ran ran =
      RunText("UPDATE OL /OFF\nOL[16]=ON\nOA[5]=3.5\nDELAY 1\nUPDATE OL /ON\n", {.simul = Step(4)});
  EXPECT_EQ(ran.First("OA[5] 3.5").step, 4);
  EXPECT_EQ(ran.First("OL[16] 1").step, 5);
}

// OPT-6.24, OPT-5.41: an output that the machine answers with an alarm ends the run where it would
// resume; nothing is set after it.
TEST(SimulRules, AnAlarmAtTheResumeEndsTheRun) {
  const Ran ran = RunText(
      "ERR 900\nOL[9]=ON\nOL[16]=ON\nOA[5]=3.5\nWORKDEF 2,0 (11)\nWORK 2,0/ON\n"
      "VI[2]=1\nENDTASK\n900 VI[2]=2\n",
      {.variables = {"VI[2]"}, .simul = Step(7)});
  EXPECT_EQ(CodeOf(ran), 931);
  EXPECT_EQ(ran.outcome.place.step, 7);
  EXPECT_EQ(ran.told.back(), "E931");
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
}

// OPT-6.25: inputs are used as they are in their images, nothing is read; from the resume on they
// are read again.
TEST(SimulRules, InputsAreNotRead) {
  const machine::InputScript on{{SimTime(0), InputKind::kLogical, 20, 1.0},
                                {SimTime(0), InputKind::kAnalogue, 20, 2.5}};
  const std::string text =
      "VL[0]=IL[20]\nVR[0]=IA[20]\nVR[1]=IA[0]\nVL[1]=IL[20]\nVR[2]=IA[20]\n"
      "VR[3]=IA[0]\n";
  const Ran ran =
      RunText(text, {.inputs = on,
                     .variables = {"VL[0]", "VR[0]", "VR[1]", "VL[1]", "VR[2]", "VR[3]"},
                     .simul = Step(4)});
  EXPECT_EQ(ran.variables.at("VL[0]"), "0");
  EXPECT_EQ(ran.variables.at("VR[0]"), "0.0");
  EXPECT_EQ(ran.variables.at("VR[1]"), "0.0");
  EXPECT_EQ(ran.variables.at("VL[1]"), "1");
  EXPECT_EQ(ran.variables.at("VR[2]"), "2.5");
  EXPECT_EQ(ran.variables.at("VR[3]"), "21.02");
  // An image that is 1 stays so, whatever the input is meanwhile.
  const Ran kept =
      RunText("VL[0]=IL[20]\n", {.inputs = {{SimTime(0), InputKind::kLogical, 20, 0.0}},
                                 .variables = {"VL[0]"},
                                 .simul = Step(9),
                                 .machine_state = ran.machine_state});
  EXPECT_EQ(kept.variables.at("VL[0]"), "1");
}

// OPT-6.25: a loop that reads an input is not slowed in the dry run: no time passes in it.
TEST(SimulRules, APollingLoopTakesNoTime) {
  const Ran ran =
      RunText("10 VI[2]=VI[2]+1\nVL[0]=IL[20]\nIF VI[2] < 3000 THEN 10\n", {.simul = Step(9)});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.time_s, 0.0);
}

// OPT-6.26: no schedule is selected; the last one is activated at the resume.
TEST(SimulRules, TheLastScheduleIsActivatedAtTheResume) {
  const std::string text =
      "WORKDEF 2,0 (12)\nWORKDEF 2,1 (11)\nWORK 2,0/ON\nWORK 2,1/ON\nVI[2]=1\n";
  const Ran ran = RunText(text, {.simul = Step(5)});
  EXPECT_EQ(ran.Count("schedule 12"), 0);
  EXPECT_EQ(ran.Count("schedule 11"), 1);
  EXPECT_EQ(ran.First("schedule 11").step, 5);
  EXPECT_EQ(StateOf(ran).outputs.schedule, 11);
  const Ran dry = RunText(text, {.simul = Step(9)});
  EXPECT_FALSE(TellsOf(dry, "schedule"));
  EXPECT_EQ(StateOf(dry).outputs.schedule, 0);
  EXPECT_FALSE(TellsOf(RunText("VI[2]=1\nVI[2]=2\n", {.simul = Step(2)}), "schedule"));
}

// OPT-6.26: it is that schedule whose power a real WORK 0 has then (OPT-3.26).
TEST(SimulRules, TheScheduleOfTheResumeGivesThePower) {
  const Ran ran =
      RunText("WORKDEF 2,0 (11)\nWORK 2,0/ON\nWORK 0,0/ON\n",
              {.simul = Step(3), .schedules = {{{.number = 11, .power_percent = 60.0}}}});
  EXPECT_EQ(ran.First("beam on 60.0").step, 3);
}

// OPT-6.27: the rotary table is not turned and its position not updated, also after the resume.
TEST(SimulRules, TheRotaryTableStays) {
  const std::string at_45 = Encoded([](MachineState& state) { state.outputs.table_deg = 45.0; });
  const Ran ran =
      RunText("FUNCTION 99 (90.)\nDELAY 1\n",
              {.parameters = {{"ROTARY_TABLE", "ON"}}, .simul = Step(2), .machine_state = at_45});
  EXPECT_FALSE(TellsOf(ran, "table"));
  EXPECT_EQ(StateOf(ran).outputs.table_deg, 45.0);
  EXPECT_NEAR(ran.time_s, 1.0, 1e-9);
}

// OPT-6.28: SIM 1/20 and BREAK 1/5: halted behind 5, the simulation goes on after START.
TEST(SimulRules, ABreakpointHaltsTheSimulation) {
  const Ran ran =
      RunText(Times(21, "DELAY 1\n"),
              {.inputs = {{At(3.0), InputKind::kStart}}, .breakpoint = Step(5), .simul = Step(20)});
  EXPECT_THAT(ran.told, ElementsAre("compiling 1", "halt BREAK", "wait operator 3.0",
                                    "wait dwell 1.0", "wait dwell 1.0"));
  EXPECT_EQ(ran.First("halt BREAK").step, 5);
  EXPECT_NEAR(ran.First("halt BREAK").at_s, 0.0, 1e-12);
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
}

// OPT-6.29: STOP and PAUSE halt in simulation as well; START goes on with it.
TEST(SimulRules, StopAndPauseHaltTheSimulation) {
  const Ran ran = RunText(
      "DELAY 1\nSTOP\nDELAY 1\nPAUSE\nDELAY 1\nDELAY 4\n",
      {.inputs = {{At(2.0), InputKind::kStart}, {At(5.0), InputKind::kStart}}, .simul = Step(6)});
  EXPECT_THAT(ran.told, ElementsAre("compiling 1", "halt STOP", "wait operator 2.0", "halt PAUSE",
                                    "wait operator 3.0", "wait dwell 4.0"));
  EXPECT_EQ(ran.First("halt STOP").step, 2);
  EXPECT_EQ(ran.First("halt PAUSE").step, 4);
}

// OPT-6.29: halted in a dry run with a process ON, START brings no beam: none was on (OPT-6.21).
TEST(SimulRules, AHaltOfTheSimulationBringsNoBeam) {
  const Ran ran = RunText("WORK 0,0/ON\nSTOP\nWORK 0,0/OFF\n",
                          {.inputs = {{At(2.0), InputKind::kStart}}, .simul = Step(9)});
  EXPECT_EQ(ran.Count("halt STOP"), 1);
  EXPECT_FALSE(TellsOf(ran, "beam"));
  EXPECT_FALSE(TellsOf(ran, "shutter"));
}

// OPT-6.30: a machine that was switched off and on is a new one: its next run is normal, while the
// one that stayed on simulates.
TEST(SimulRules, ANewMachineDoesNotSimulate) {
  const Ran armed = RunText("DELAY 1\n", {.simul = Step(99)});
  EXPECT_EQ(RunText("DELAY 1\n", {.machine_state = armed.machine_state}).time_s, 0.0);
  EXPECT_NEAR(RunText("DELAY 1\n").time_s, 1.0, 1e-9);
}

// A run that is saved in the dry part and restored goes on as it did.
TEST(SimulRules, ASnapshotKeepsTheSimulation) {
  const RunOptions options{.inputs = {{At(2.0), InputKind::kStart}}, .simul = Step(5)};
  RunOptions restored = options;
  restored.restore_at = At(1.0);
  const std::string text = "OL[16]=ON\nWORKDEF 2,0 (11)\nWORK 2,0/ON\nSTOP\nDELAY 1\n";
  EXPECT_EQ(RunText(text, options).told, RunText(text, restored).told);
  EXPECT_EQ(RunText(text, restored).First("OL[16] 1").step, 5);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
