#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/optimo/machine/machine_state.h"
#include "tests/engine/optimo/control/run_text.h"

// Which instruction is carried out next: programs, functions, errors, timers, START and HOLD.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using machine::Mode;
using machine::OutcomeKind;
using ::testing::ElementsAre;

// The scripted STARTs at 1 s, 2 s ... that many.
machine::InputScript Starts(int count) {
  machine::InputScript script;
  for (int n = 1; n <= count; ++n) script.push_back({At(n), InputKind::kStart});
  return script;
}

// OPT-7.01, OPT-7.03, OPT-7.04: GO ends the program, keeps the variables and drops pending returns.
TEST(FlowRules, GoDropsTheCallers) {
  const Ran ran = RunText("VR[5]=1.5\nCALL 45\nVI[2]=1\n",
                          {.programs = {{45, "GO 46\nVI[3]=1\n"}, {46, "VR[6]=VR[5]\n"}},
                           .variables = {"VR[6]", "VI[2]", "VI[3]"}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.variables.at("VR[6]"), "1.5");
  EXPECT_EQ(ran.variables.at("VI[2]") + ran.variables.at("VI[3]"), "00");
}

// OPT-7.02: GO /C runs on in CYCLE, whatever the mode before.
TEST(FlowRules, GoCycleRunsThrough) {
  const Ran ran = RunText(
      "GO 46/C\n", {.programs = {{46, "VI[2]=1\nVI[3]=1\nVI[4]=1\n"}}, .mode = Mode::kSingle});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.Count("halt SINGLE"), 0);
}

// OPT-B.62: GO /S waits for START before the first step, and after each; GO /R repeats.
TEST(FlowRules, GoSingleAndRepeat) {
  const Ran single = RunText("GO 46/S\n", {.programs = {{46, "VI[2]=1\nVI[3]=1\n"}},
                                           .inputs = Starts(2),
                                           .variables = {"VI[2]", "VI[3]"}});
  EXPECT_EQ(single.Count("halt SINGLE"), 2);
  EXPECT_EQ(single.variables.at("VI[2]") + single.variables.at("VI[3]"), "11");
  const Ran repeat = RunText("GO 46/R\n", {.programs = {{46, "VI[2]=VI[2]+1\nDELAY 1\n"}},
                                           .inputs = {{At(2.5), InputKind::kHold}},
                                           .variables = {"VI[2]"}});
  EXPECT_EQ(repeat.variables.at("VI[2]"), "3");
  EXPECT_EQ(repeat.Count("halt HOLD"), 1);
}

// OPT-7.08, OPT-7.107: variables are common to caller and CALLed program, in both directions.
TEST(FlowRules, VariablesCrossACall) {
  const Ran ran =
      RunText("VR[64]=5.5\nCALL 45\nVR[86]=30.\nCALL 46\n",
              {.programs = {{45, "VR[5]=VR[64]\n"}, {46, "VR[6]=VR[86]\nVR[7]=VR[5]\n"}},
               .variables = {"VR[6]", "VR[7]"}});
  EXPECT_EQ(ran.variables.at("VR[6]"), "30.0");
  EXPECT_EQ(ran.variables.at("VR[7]"), "5.5");
}

// OPT-7.107: 45 takes SYSDEF, TCP, WORKDEF and SPEED from variables: a warning for the six zeros,
// the tip 5 mm up the beam, 95 % at 4.5 %.
TEST(FlowRules, ACalledProgramTakesItsSetUpFromVariables) {
  const Ran ran = RunText(
      "VR[64]=5.5\nVR[65]=4.5\nVR[66]=95.\nVR[67]=1.2\nVR[68]=99.\nVR[82]=5.\nCALL 45\n",
      {.programs = {{45,
                     "SYSDEF (VR[86],VR[87],VR[88],0.,0.,0.)\nTCP (0.,0.,VR[82]/0.,0.,-5.)\n"
                     "WORKDEF 1,01 (VR[65],VR[66],VR[67],VR[68])\nCOORD ABSOL\nPATH "
                     "LIN\nVR[0]=IA[2]\nWORK 1,1/ON\n"
                     "SPEED VR[64]\nMOVE (100.,2201.2,-345.,0.,0.)\nWORK 1,1/OFF\n"}},
       .variables = {"VR[0]"}});
  EXPECT_TRUE(ran.Told("E7311"));
  EXPECT_TRUE(ran.Told("beam on 99.0"));
  EXPECT_TRUE(ran.Told("wait pierce 1.2"));
  EXPECT_EQ(ran.variables.at("VR[0]"), "-345.0");  // -350 + 5
  ASSERT_EQ(ran.parts.size(), 1U);
  EXPECT_NEAR(ran.parts[0].SpeedAt(ran.parts[0].duration_s() / 2), 27.5, 1e-6);
  EXPECT_NEAR(ran.parts[0].done.power.percent_per_mm_s, 95.0 / 22.5, 1e-6);
}

// OPT-7.09, OPT-7.10: four CALLs inside each other; the program at the fourth level must have its
// executable.
TEST(FlowRules, TheFourthLevelNeedsAnExecutable) {
  RunOptions options{
      .programs = {{11, "CALL 12\n"}, {12, "CALL 13\n"}, {13, "CALL 14\n"}, {14, "VI[2]=1\n"}},
      .variables = {"VI[2]"}};
  EXPECT_EQ(CodeOf(RunText("CALL 11\n", options)), 7107);
  options.executables[14] = RunText("CALL 14\n", options).executables.at(14);
  const Ran ran = RunText("CALL 11\n", options);
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  options.programs[14] = "CALL 15\n";
  options.programs[15] = "VI[2]=1\n";
  options.executables.clear();
  options.executables[14] = RunText("CALL 14\n", options).executables.at(14);
  EXPECT_EQ(CodeOf(RunText("CALL 11\n", options)), 7501);
}

// OPT-7.11: the CALLed program is compiled, loaded in CALL_TIME, and the caller comes back after
// it.
TEST(FlowRules, ACallTakesItsTime) {
  const Ran ran =
      RunText("CALL 45\n", {.programs = {{45, "VI[2]=1\n"}}, .parameters = {{"CALL_TIME", "1.5"}}});
  EXPECT_THAT(ran.told,
              ElementsAre("compiling 1", "compiling 45", "call 45", "wait load 1.5", "return 1"));
  EXPECT_NEAR(ran.time_s, 1.5, 1e-9);
}

// OPT-7.52, OPT-9.15: names and sequence numbers are local to each module.
TEST(FlowRules, LabelsAndNamesAreLocal) {
  const Ran ran =
      RunText("DECLARE X = VR[1]\n10 X = X + 1.\nFUNCTION 44\nIF X < 2.5 THEN 10\n",
              {.programs = {{44, "DECLARE X = VR[2]\n10 X = X + 10.\nIF X < 15. THEN 10\n"}},
               .variables = {"VR[1]", "VR[2]"}});
  EXPECT_EQ(ran.variables.at("VR[1]"), "3.0");
  EXPECT_EQ(ran.variables.at("VR[2]"), "40.0");  // 20 after the first FUNCTION, then 10 more each
}

// OPT-9.09: FUNCTION levels start anew in a CALLed program, and CALL levels are counted apart.
TEST(FlowRules, FunctionLevelsStartAnewInACall) {
  const std::string deep = "VI[2]=VI[2]+1\nIF VI[2] >= VI[3] THEN 9\nFUNCTION 41\n9 RETURN\n";
  const Ran ran = RunText("VI[3]=2\nFUNCTION 42\n", {.programs = {{42, "FUNCTION 43\n"},
                                                                  {43, "CALL 50\n"},
                                                                  {50, "VI[3]=4\nFUNCTION 41\n"},
                                                                  {41, deep}},
                                                     .variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[2]"), "4");
}

// OPT-9.14, OPT-9.12: a function program runs by itself too; with TASK 1 it begins there.
TEST(FlowRules, AFunctionProgramRunsByItself) {
  EXPECT_EQ(Value("CALL 44\n", "VI[3]",
                  {.programs = {{44, "VI[3]=9\nENDTASK\nTASK 1\nVI[3]=VI[3]+1\n"}}}),
            "1");
  EXPECT_EQ(Value("FUNCTION 44\n", "VI[3]",
                  {.programs = {{44, "VI[3]=9\nENDTASK\nTASK 1\nVI[3]=VI[3]+1\n"}}}),
            "1");
}

// OPT-9.13, OPT-1.13: a changed function is not seen by executables that hold the old one; 7110
// says so.
TEST(FlowRules, AnOldFunctionStaysInTheExecutable) {
  RunOptions options{.programs = {{44, "VI[2]=1\n"}}, .variables = {"VI[2]"}};
  options.executables[1] = RunText("FUNCTION 44\n", options).executables.at(1);
  options.programs[44] = "VI[2]=2\n";
  const Ran old = RunText("FUNCTION 44\n", options);
  EXPECT_TRUE(old.Told("E7110"));
  EXPECT_EQ(old.variables.at("VI[2]"), "1");
  options.executables.clear();
  EXPECT_EQ(RunText("FUNCTION 44\n", options).variables.at("VI[2]"), "2");
}

// OPT-9.26, OPT-9.31: parameters are copies; a function that writes its PAR leaves the caller's
// value alone.
TEST(FlowRules, ParametersAreNeverCopiedBack) {
  const Ran ran = RunText(
      "DECLARE DATO = VI[30]\nVI[30]=17\nFUNCTION 44(DATO)\n",
      {.programs =
           {{44, "DEFINE PAR = INT\nDECLARE DATO1 = PAR[0]\nVI[2]=DATO1\nDATO1=9\nVI[3]=DATO1\n"}},
       .variables = {"VI[2]", "VI[3]", "VI[30]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "17");
  EXPECT_EQ(ran.variables.at("VI[3]"), "9");
  EXPECT_EQ(ran.variables.at("VI[30]"), "17");
}

// OPT-9.26: each activation has its own PAR.
TEST(FlowRules, EachActivationHasItsOwnParameters) {
  EXPECT_EQ(Value("FUNCTION 44 (3)\n", "VR[5]",
                  {.programs = {{44,
                                 "DEFINE PAR[0] = INT\nIF PAR[0] = 0 THEN 9\nFUNCTION 44 "
                                 "(PAR[0]-1)\nVR[5]=VR[5]*10.+PAR[0]\n9 ENDTASK\n"}}}),
            "123.0");
}

// OPT-3.46: ENDTASK ends a run, a CALLed program and a function; at the end of the text it is
// assumed.
TEST(FlowRules, EndtaskEndsWhateverRuns) {
  EXPECT_EQ(Value("VI[2]=1\nENDTASK\nVI[2]=2\n", "VI[2]"), "1");
  const RunOptions both{.programs = {{44, "VI[3]=VI[3]+1\nENDTASK\nVI[3]=50\n"}}};
  EXPECT_EQ(Value("CALL 44\nFUNCTION 44\nVI[3]=VI[3]+10\n", "VI[3]", both), "12");
  EXPECT_EQ(RunText("VI[2]=1\n").told, RunText("VI[2]=1\nENDTASK\n").told);
}

// OPT-3.56: NOERR disarms.
TEST(FlowRules, NoerrCancels) {
  const Ran ran =
      RunText("ERR 900\nNOERR\nVR[0]=1/0\nENDTASK\n900 VI[2]=1\n", {.variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
}

// OPT-3.57, OPT-B.57: an error climbs to the module that armed ERR; the functions above it are
// gone, so four levels are free again, while pending GOSUB returns of the catching module stay.
TEST(FlowRules, ACaughtErrorDropsTheFunctionsAbove) {
  const Ran ran = RunText(
      "ERR 900\nGOSUB 100\nVI[5]=5\nENDTASK\n100 FUNCTION 41\nENDTASK\n900 VI[2]=1\nFUNCTION "
      "51\nRETURN\n",
      {.programs = {{41, "FUNCTION 42\n"},
                    {42, "FUNCTION 43\n"},
                    {43, "VR[0]=1/0\n"},
                    {51, "FUNCTION 52\n"},
                    {52, "FUNCTION 53\n"},
                    {53, "FUNCTION 54\n"},
                    {54, "VI[3]=3\n"}},
       .variables = {"VI[2]", "VI[3]", "VI[5]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[2]") + ran.variables.at("VI[3]") + ran.variables.at("VI[5]"),
            "135");
}

// OPT-3.60: SETERR shows its number and does nothing else.
TEST(FlowRules, SeterrOnlyShows) {
  const Ran ran =
      RunText("ERR 900\nWORK 0,0/ON\nSETERR 1234\nVI[2]=1\nWORK 0,0/OFF\nENDTASK\n900 VI[2]=9\n",
              {.variables = {"VI[2]", "VI[99]"}});
  EXPECT_EQ(ran.First("ERROR 1234").step, 3);
  EXPECT_EQ(ran.variables.at("VI[2]") + ran.variables.at("VI[99]"), "10");
  EXPECT_EQ(ran.Count("beam off"), 1);
}

// OPT-3.53, OPT-B.55: an error that is raised behind a /FLY move is handled when the motion is
// over; the handler finds the machine at the target.
TEST(FlowRules, AnErrorBehindAFlyMoveWaitsForTheMotion) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nERR 900\nMOVE (1000.,1000.,-400.,0.,0.)/FLY\nVR[1]=1/0\n"
      "MOVE (1100.,1000.,-400.,0.,0.)\nENDTASK\n900 VR[0]=IA[0]\n",
      {.variables = {"VR[0]"}});
  EXPECT_EQ(ran.variables.at("VR[0]"), "1000.0");
  EXPECT_EQ(ran.First("E7201").step, 5);
  EXPECT_EQ(ran.moves.size(), 1U);
}

// OPT-B.54: outputs stay at the end of the run.
TEST(FlowRules, OutputsOutliveTheRun) {
  const Ran ran = RunText("OL[16]=ON\n");
  EXPECT_EQ(ran.Count("OL[16] 0"), 0);
  const Result<MachineState> state = DecodeMachineState(ran.machine_state);
  ASSERT_TRUE(bool(state));
  EXPECT_TRUE(state->outputs.logical[16]);
}

// OPT-B.64: HOLD in a CALLed program halts there, after the current instruction.
TEST(FlowRules, HoldHaltsInsideACall) {
  const Ran ran = RunText("CALL 45\nVI[3]=1\n", {.programs = {{45, "DELAY 2\nVI[2]=1\n"}},
                                                 .inputs = {{At(1.0), InputKind::kHold}},
                                                 .variables = {"VI[2]"}});
  EXPECT_EQ(ran.First("halt HOLD").program, 45);
  EXPECT_NEAR(ran.First("halt HOLD").at_s, 2.0, 1e-9);
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
}

// OPT-B.66, OPT-3.50: a job in REMOTE that meets STOP ends as stopped, at that step.
TEST(FlowRules, StopEndsARemoteJob) {
  const Ran ran = RunText("VI[2]=1\nSTOP\nVI[2]=2\n",
                          {.inputs = Starts(1), .mode = Mode::kRemote, .variables = {"VI[2]"}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kStopped);
  EXPECT_EQ(CodeOf(ran), 7507);
  EXPECT_EQ(ran.outcome.place.step, 2);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
}

// OPT-7.70, OPT-B.63: VI[98] counts the runs of the program since it was selected, and its
// repetitions.
TEST(FlowRules, ExecutionsAreCounted) {
  const RunOptions second{.variables = {"VI[98]"}};
  const Ran first = RunText("VI[2]=1\n", second);
  EXPECT_EQ(first.variables.at("VI[98]"), "1");
  RunOptions again = second;
  again.machine_state = first.machine_state;
  EXPECT_EQ(RunText("VI[2]=1\n", again).variables.at("VI[98]"), "2");
  RunOptions other = again;
  other.programs = {{46, "VI[3]=VI[98]\n"}};
  other.variables = {"VI[3]"};
  EXPECT_EQ(RunText("GO 46\n", other).variables.at("VI[3]"), "1");
  const Ran repeat = RunText(
      "VI[3]=VI[98]\nDELAY 1\n",
      {.inputs = {{At(2.5), InputKind::kHold}}, .mode = Mode::kRepeat, .variables = {"VI[3]"}});
  EXPECT_EQ(repeat.variables.at("VI[3]"), "3");
}

// OPT-4.23: REPEAT of a program that carries nothing out does not hang: time passes, and the budget
// ends it.
TEST(FlowRules, RepeatOfNothingEnds) {
  const Ran ran = RunText(
      "; nothing\n", {.mode = Mode::kRepeat, .budget = {.virtual_time = std::chrono::seconds(2)}});
  EXPECT_EQ(CodeOf(ran), 7902);
}

// OPT-7.71: VI[99] stays until the next error, over programs too.
TEST(FlowRules, TheLastErrorStays) {
  const Ran first = RunText("ERR 900\nGOTO 77\nENDTASK\n900 VI[2]=VI[99]\nVI[3]=1\n",
                            {.variables = {"VI[2]", "VI[99]"}});
  EXPECT_EQ(first.variables.at("VI[2]"), "60");
  EXPECT_EQ(Value("VI[3]=1\n", "VI[99]", {.machine_state = first.machine_state}), "60");
}

// OPT-B.59: TIMER /AUTO repeats, between instructions: two DELAYs of 5 s with a period of 2 s, one
// GOSUB after each; TIMER /DIS cancels.
TEST(FlowRules, TimerRepeatsAndIsCancelled) {
  const std::string handler = "ENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n";
  EXPECT_EQ(
      Value("TIMER (2.,900) /AUTO\nDELAY 5\nDELAY 5\nTIMER /DIS\nDELAY 5\nVI[3]=VI[2]\n" + handler,
            "VI[3]"),
      "2");
  EXPECT_EQ(Value("TIMER (2.,900)\nTIMER /DIS\nDELAY 5\nVI[3]=VI[2]\n" + handler, "VI[3]"), "0");
}

// OPT-B.59, OPT-B.89: a handler longer than its period is not interrupted by itself; a CALLed
// program stops the clock.
TEST(FlowRules, TimerDoesNotRunIntoItself) {
  const Ran ran = RunText(
      "TIMER (1.,900) /AUTO\nDELAY 2\nTIMER /DIS\nENDTASK\n900 VI[2]=VI[2]+1\nDELAY 3\nDELAY "
      "3\nRETURN\n",
      {.variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[2]"),
            "1");  // after the DELAY of 2 s; at 8 s the next is due at 9 s
  EXPECT_EQ(Value("TIMER (3.,900)\nDELAY 1\nCALL 45\nDELAY 1\nVI[3]=VI[2]\nENDTASK\n900 "
                  "VI[2]=VI[2]+1\nRETURN\n",
                  "VI[3]", {.programs = {{45, "DELAY 10\n"}}}),
            "0");
}

// OPT-B.59: the sequence number of TIMER is one of the module that set it: in a FUNCTION it waits.
TEST(FlowRules, TimerWaitsForItsOwnModule) {
  const Ran ran =
      RunText("TIMER (1.,900)\nFUNCTION 44\nVI[4]=VI[2]\nENDTASK\n900 VI[2]=1\nRETURN\n",
              {.programs = {{44, "DELAY 2\nVI[3]=VI[2]\n"}}, .variables = {"VI[3]", "VI[4]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[3]") + ran.variables.at("VI[4]"), "01");
}

// OPT-7.97, OPT-7.27: a loop that asks for an input sees it when it comes: the control samples each
// cycle.
TEST(FlowRules, APollingLoopSeesItsInput) {
  const Ran ran = RunText("10 IF NOT IL[16] THEN 10\nVI[2]=1\n",
                          {.inputs = {{At(3.0), InputKind::kLogical, 16, 1.0}},
                           .variables = {"VI[2]"},
                           .budget = {.steps = 100'000}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_GE(ran.time_s, 3.0);
  EXPECT_LE(ran.time_s, 3.0 + 0.048);
  // A loop that reads an input but counts to an end takes no time.
  EXPECT_EQ(RunText("10 VI[2]=VI[2]+1\nIF IL[16] OR (VI[2] >= 900) THEN 20\nGOTO 10\n20 VI[3]=1\n")
                .time_s,
            0.0);
}

// OPT-7.97: also where another input was read at the instant at which the loop begins, and where
// the loop reads more of them than that.
TEST(FlowRules, APollingLoopBehindAnotherReadSeesItsInput) {
  std::string reads;
  for (int n = 0; n < 1200; ++n) reads += "VL[3]=IL[20]\n";
  for (const std::string& text :
       {std::string("IF IL[1] THEN 50\n10 IF NOT IL[16] THEN 10\n50 VI[2]=1\n"),
        "VL[3]=IL[20]\n10 " + reads + "IF NOT IL[16] THEN 10\nVI[2]=1\n"}) {
    const Ran ran = RunText(text, {.inputs = {{At(3.0), InputKind::kLogical, 16, 1.0}},
                                   .variables = {"VI[2]"},
                                   .budget = {.steps = 5'000'000}});
    EXPECT_EQ(CodeOf(ran), 0);
    EXPECT_EQ(ran.variables.at("VI[2]"), "1");
    EXPECT_GE(ran.time_s, 3.0);
    EXPECT_LE(ran.time_s, 3.0 + 0.048);
  }
}

// OPT-2.60: the end of a /NEXT move can be asked for in a loop too.
TEST(FlowRules, APollingLoopSeesTheEndOfAMove) {
  const Ran ran =
      RunText("MOVE (521.02,2201.2,-50.,0.,0.)/NEXT\n10 IF IL[95] THEN 10\nVR[0]=IA[0]\n",
              {.variables = {"VR[0]"}, .budget = {.steps = 100'000}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_NEAR(std::stod(ran.variables.at("VR[0]")), 521.02, 1e-4);
}

// OPT-6.16, OPT-6.14: SIMUL arms the next start, not this run; when its step is not reached it
// stays armed.
TEST(FlowRules, SimulArmsTheNextStart) {
  const Ran arming = RunText("SIMUL 3\nDELAY 1\nDELAY 1\n");
  EXPECT_NEAR(arming.time_s, 2.0, 1e-9);
  const Ran short_run = RunText("DELAY 1\nDELAY 1\n", {.machine_state = arming.machine_state});
  EXPECT_EQ(short_run.time_s, 0.0);
  const Ran reached =
      RunText("DELAY 1\nDELAY 1\nDELAY 1\n", {.machine_state = short_run.machine_state});
  EXPECT_NEAR(reached.time_s, 1.0, 1e-9);
  EXPECT_NEAR(RunText("DELAY 1\n", {.machine_state = reached.machine_state}).time_s, 1.0, 1e-9);
}

// OPT-6.08, OPT-6.11, OPT-6.09: BREAK of the program stays for its next runs; a new one replaces
// it.
TEST(FlowRules, ABreakpointStays) {
  const Ran first = RunText("BREAK 3\nBREAK 4\nVI[2]=1\nVI[2]=2\nVI[2]=3\n", {.inputs = Starts(1)});
  EXPECT_EQ(first.Count("halt BREAK"), 1);
  EXPECT_EQ(first.First("halt BREAK").step, 4);
  const Ran second = RunText("VI[2]=1\nVI[2]=2\nVI[2]=3\nVI[2]=4\nVI[2]=5\n",
                             {.inputs = Starts(1), .machine_state = first.machine_state});
  EXPECT_EQ(second.First("halt BREAK").step, 4);
}

// OPT-3.45: a halt stops the clock of DELAY; what is told adds up: 2 s, the halt, 3 s.
TEST(FlowRules, DelayStandsStillWhileHalted) {
  const Ran ran = RunText("DELAY 5\n",
                          {.inputs = {{At(2.0), InputKind::kStop}, {At(10.0), InputKind::kStart}}});
  EXPECT_THAT(ran.told, ElementsAre("compiling 1", "wait dwell 2.0", "halt STOP",
                                    "wait operator 8.0", "wait dwell 3.0"));
  EXPECT_NEAR(ran.time_s, 13.0, 1e-9);
}

// OPT-9.19: FUNCTION 99 turns the rotary table where one is fitted.
TEST(FlowRules, FunctionNinetyNineTurnsTheTable) {
  EXPECT_TRUE(
      RunText("FUNCTION 99 (90.)\n", {.parameters = {{"ROTARY_TABLE", "ON"}}}).Told("table 90.0"));
  EXPECT_EQ(CodeOf(RunText("FUNCTION 99 (90.)\n")), 7103);
}

// OPT-B.65: a run uses what it was started with, whatever is stored meanwhile: the setup is its
// own.
TEST(FlowRules, ARunKeepsItsPrograms) {
  const Ran ran = RunText("10 VI[2]=VI[2]+1\nCALL 45\nIF VI[2] < 3 THEN 10\n",
                          {.programs = {{45, "VI[3]=VI[3]+1\n"}}, .variables = {"VI[3]"}});
  EXPECT_EQ(ran.variables.at("VI[3]"), "3");
  EXPECT_EQ(ran.Count("compiling 45"), 1);  // once, OPT-1.11
}

// OPT-B.73, OPT-E.7109: an executable that finds no room in CMOS is not made, and ends the run.
TEST(FlowRules, CmosMayBeFull) {
  const std::string long_text = [] {
    std::string text;
    for (int n = 0; n < 60; ++n) text += "VR[0]=VR[1]+1.5\n";
    return text;
  }();
  const Ran ran = RunText(long_text, {.parameters = {{"CMOS_SIZE", "1000"}}});
  EXPECT_EQ(CodeOf(ran), 7109);
  EXPECT_TRUE(ran.executables.empty());
  EXPECT_EQ(CodeOf(RunText(long_text)), 0);
}

// OPT-9.19, OPT-E.7103: FUNCTION 99 needs no object where a rotary table is fitted; an executable
// that was made there finds none on a machine without.
TEST(FlowRules, AnExecutableOfAMachineWithATable) {
  const std::string text = "VI[2]=1\nFUNCTION 99 (90.)\n";
  RunOptions options{.parameters = {{"ROTARY_TABLE", "ON"}}};
  options.executables[1] = RunText(text, options).executables.at(1);
  EXPECT_TRUE(RunText(text, options).Told("table 90.0"));
  options.parameters.clear();
  const Ran ran = RunText(text, options);
  EXPECT_EQ(CodeOf(ran), 7103);
  EXPECT_EQ(ran.outcome.place.step, 2);
}

// OPT-1.15: the executable that was brought is the program: that its own object is another one is
// no reason for a warning.
TEST(FlowRules, AnExecutableStandsForItsProgram) {
  RunOptions options{.variables = {"VI[2]"}};
  options.executables[1] = RunText("VI[2]=1\n").executables.at(1);
  const Ran ran = RunText("VI[2]=2\n", options);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_TRUE(ran.findings.empty());
}

}  // namespace
}  // namespace rmlcell::optimo::testing
