#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

// Modes and keys: what START, HOLD, STOP and the emergency stop do in each mode, and where a run
// then stands. New machines stand with the tip at (21.02, 2201.2, -350).
namespace rmlcell::optimo::testing::mode_rules {
namespace {

using machine::InputKind;
using machine::Mode;
using machine::OutcomeKind;
using machine::RunPhase;
using ::testing::ElementsAre;

constexpr double kExact = 1e-6;
constexpr double kReal_mm = 1e-4;  // literals have seven digits
// From rest to 50 mm/s: motion.md 5.2, 2 sqrt(v / j).
const double kRamp_s = 2.0 * std::sqrt(50.0 / 40000.0);
// 100 and 500 mm at 50 mm/s, from rest to rest.
const double kHundred_s = 100.0 / 50.0 + kRamp_s + kSettle_s;
const double kFiveHundred_s = 500.0 / 50.0 + kRamp_s + kSettle_s;

// Steps 1 to 3; along X at 50 mm/s.
const std::string kAlongX = "COORD ABSOL\nPATH LIN\nSPEED 10\n";
std::string MoveTo(double x_mm, const std::string& attributes = {}) {
  return "MOVE (" + std::to_string(x_mm) + ",2201.2,-350.,0.,0.)" + attributes + "\n";
}
const std::string kFar = kAlongX + MoveTo(521.02) + "OL[16]=ON\nDELAY 100\n";  // 500 mm as step 4

machine::InputChange Key(double at_s, InputKind kind) { return {At(at_s), kind}; }

// STARTs so many times, `every_s` apart.
machine::InputScript Starts(int count, double every_s) {
  machine::InputScript script;
  for (int n = 1; n <= count; ++n) script.push_back(Key(n * every_s, InputKind::kStart));
  return script;
}

// Where the tip came to rest behind the parts told before `time_s`.
double RestX(const Ran& ran, double time_s) {
  double x = 21.02;
  for (const Ran::Part& part : ran.parts) {
    if (ToSeconds(part.done.end) > time_s + kExact) break;
    x = part.motion.path.At(part.done.travelled).point.x();
  }
  return x;
}

// OPT-4.17: the current instruction is finished, and then execution halts: at the target.
TEST(ModeRules, HoldFinishesTheInstruction) {
  const Ran ran = RunText(kFar, {.inputs = {Key(1.0, InputKind::kHold)}});
  EXPECT_NEAR(ran.First("halt HOLD").at_s, kFiveHundred_s, kExact);
  EXPECT_EQ(ran.First("halt HOLD").step, 4);
  EXPECT_NEAR(ran.end.tip.tip.x(), 521.02, kReal_mm);
  EXPECT_EQ(ran.end.phase, RunPhase::kHalted);
  EXPECT_FALSE(ran.Told("OL[16] 1"));
}

// OPT-4.17: an instruction that waits for its /START is finished with its motion, and WORK with its
// switching; START goes on behind it.
TEST(ModeRules, HoldWhileAConditionIsWaitedFor) {
  const machine::InputScript script{Key(1.0, InputKind::kHold),
                                    {At(2.0), InputKind::kLogical, 20, 1.0},
                                    Key(30.0, InputKind::kStart)};
  const Ran move =
      RunText(kAlongX + MoveTo(121.02, "/START (IL[20])") + "OL[16]=ON\n", {.inputs = script});
  EXPECT_NEAR(move.First("halt HOLD").at_s, 2.0 + kHundred_s, kExact);
  EXPECT_EQ(move.First("halt HOLD").step, 4);
  EXPECT_NEAR(move.First("OL[16] 1").at_s, 30.0, kExact);
  EXPECT_EQ(move.Count("halt HOLD"), 1);
  const Ran work = RunText("WORK 0,0/ON/START (IL[20])\nOL[16]=ON\nWORK 0,0/OFF\n",
                           {.inputs = script, .variables = {"IL[87]"}});
  EXPECT_NEAR(work.First("beam on 100.0").at_s, 2.0, kExact);
  EXPECT_NEAR(work.First("halt HOLD").at_s, 2.0, kExact);
  EXPECT_NEAR(work.First("OL[16] 1").at_s, 30.0, kExact);
  const Ran wait = RunText("WAIT IL[20]\nOL[16]=ON\n", {.inputs = script});
  EXPECT_NEAR(wait.First("halt HOLD").at_s, 2.0, kExact);
  EXPECT_EQ(wait.First("halt HOLD").step, 1);
  EXPECT_NEAR(wait.First("OL[16] 1").at_s, 30.0, kExact);
}

// OPT-4.11, OPT-4.12: HOLD is a key of SINGLE, CYCLE and REPEAT. In REMOTE it does nothing, also no
// later.
TEST(ModeRules, HoldIsDeadInRemote) {
  const Ran ran = RunText(kFar, {.inputs = {Key(1.0, InputKind::kHold)}, .mode = Mode::kRemote});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.Count("halt HOLD"), 0);
  EXPECT_NEAR(ran.time_s, kFiveHundred_s + 100.0, kExact);
}

// OPT-4.14, OPT-E.7610: the emergency stop works in every mode: nothing moves from there on, beam
// off, shutter closed, alarm.
TEST(ModeRules, TheEmergencyStopWorksInEveryMode) {
  const std::string text = kAlongX + "WORK 0,0/ON\n" + MoveTo(521.02);
  for (const Mode mode : {Mode::kRemote, Mode::kCycle, Mode::kSingle, Mode::kRepeat}) {
    machine::InputScript script = Starts(4, 0.1);
    script.push_back(Key(2.0, InputKind::kEmergencyStop));
    script.push_back(Key(3.0, InputKind::kStart));
    const Ran ran = RunText(text, {.inputs = script, .mode = mode});
    SCOPED_TRACE(static_cast<int>(mode));
    EXPECT_EQ(CodeOf(ran), 7610);
    EXPECT_EQ(ran.outcome.kind, OutcomeKind::kFailed);
    EXPECT_EQ(ran.outcome.place.step, 5);
    EXPECT_NEAR(ran.time_s, 2.0, kExact);
    // In SINGLE the MOVE begins at the fourth START.
    const double begin = mode == Mode::kSingle ? 0.4 : 0.0;
    EXPECT_NEAR(ran.end.tip.tip.x(), 21.02 + 50.0 * (2.0 - begin - 0.5 * kRamp_s), kExact);
    ASSERT_GE(ran.told.size(), 2U);
    EXPECT_EQ(ran.told.back(), "shutter closed");
    EXPECT_EQ(ran.told[ran.told.size() - 2], "beam off");
    EXPECT_NEAR(ran.events.back().at_s, 2.0, kExact);
  }
}

// OPT-4.14: also where the run is halted; the alarm ends it.
TEST(ModeRules, TheEmergencyStopEndsAHaltedRun) {
  const Ran ran =
      RunText("STOP\nVI[2]=1\n",
              {.inputs = {Key(1.0, InputKind::kEmergencyStop), Key(2.0, InputKind::kStart)},
               .variables = {"VI[2]", "VI[99]"}});
  EXPECT_EQ(CodeOf(ran), 7610);
  EXPECT_EQ(ran.variables.at("VI[99]"), "7610");
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
  EXPECT_NEAR(ran.time_s, 1.0, kExact);
}

// OPT-4.18, OPT-6.31: STOP in the middle of a LIN move, in SINGLE, CYCLE and REPEAT: at once a ramp
// to rest over half a ramp of way, so that it stands at just 50 mm/s times the time under way;
// START makes the rest, over the same line.
TEST(ModeRules, StopHaltsAtOnceAndStartFinishesTheInstruction) {
  for (const Mode mode : {Mode::kCycle, Mode::kSingle, Mode::kRepeat}) {
    SCOPED_TRACE(static_cast<int>(mode));
    machine::InputScript script;
    if (mode == Mode::kSingle) script = Starts(3, 0.1);
    const double begin = mode == Mode::kSingle ? 0.3 : 0.0;
    script.push_back(Key(begin + 5.0, InputKind::kStop));
    script.push_back(Key(9.0, InputKind::kStart));
    script.push_back(Key(15.0, InputKind::kHold));
    const Ran ran = RunText(kFar, {.inputs = script, .mode = mode});
    EXPECT_NEAR(ran.First("halt STOP").at_s, begin + 5.0 + kRamp_s, kExact);
    EXPECT_EQ(ran.First("halt STOP").step, 4);
    EXPECT_NEAR(RestX(ran, 9.0), 21.02 + 250.0, kExact);
    EXPECT_LT(ran.DistanceTo({271.02, 2201.2, -350.0}), kReal_mm);
    ASSERT_GE(ran.moves.size(), 1U);
    EXPECT_NEAR(ToSeconds(ran.moves[0].at), 9.0 + 250.0 / 50.0 + kRamp_s + kSettle_s, kExact);
    EXPECT_NEAR(ran.moves[0].tip.tip.x(), 521.02, kReal_mm);
    for (const Ran::Part& part : ran.parts) {
      if (ToSeconds(part.done.end) > 14.5) break;
      EXPECT_NEAR(part.motion.path.At(part.done.travelled).point.y(), 2201.2, kReal_mm);
    }
    if (mode == Mode::kSingle) {
      EXPECT_EQ(ran.First("halt SINGLE").step, 1);
      EXPECT_EQ(ran.Count("halt SINGLE"), 4);  // the last one after the MOVE that was interrupted
      EXPECT_FALSE(ran.Told("OL[16] 1"));
    }
  }
}

// OPT-4.18: on a circle it stands on the circle, in a hole too, and the whole of it is cut: the
// length of all parts is that of the path.
TEST(ModeRules, StopAndStartOnCurvesKeepThePath) {
  const double quarter = 0.5 * M_PI * 100.0;
  const Ran arc = RunText(
      "COORD ABSOL\nPATH CIR\nSPEED 10\n"
      "MOVE (121.02,2301.2,-350.,0.,0.)/VIA (50.30932,2271.911,-350.,0.,0.)\n",
      {.inputs = {Key(1.5, InputKind::kStop), Key(9.0, InputKind::kStart)}});
  double length = 0.0;
  for (const Ran::Part& part : arc.parts) {
    length += part.done.travelled - part.done.from;
    const motion::MachinePoint at = part.motion.path.At(part.done.travelled).point;
    EXPECT_NEAR(std::hypot(at.x() - 121.02, at.y() - 2201.2), 100.0, 1e-3);
  }
  EXPECT_NEAR(length, quarter, 1e-3);
  EXPECT_NEAR(arc.time_s, 9.0 + (quarter - 75.0) / 50.0 + kRamp_s + kSettle_s,
              2e-3);  // the curve takes some of the jerk
  EXPECT_EQ(arc.moves.size(), 1U);

  const std::string hole =
      "COORD ABSOL\nPATH HOLE (40.)\nSPEED 10\n"
      "MOVE (121.02,2201.2,-350.,0.,0.)/VIA (121.02,2201.2,-150.,0.,0.)\n";
  const Ran free = RunText(hole);
  const Ran lead =
      RunText(hole, {.inputs = {Key(0.5, InputKind::kStop), Key(9.0, InputKind::kStart)}});
  // 60 mm of lead, then the turn. What is stopped on the lead turns whole afterwards.
  EXPECT_NEAR(RestX(lead, 9.0), 21.02 + 25.0, kExact);
  EXPECT_NEAR(lead.time_s, 9.0 + free.time_s - 0.5, kExact);
}

// OPT-4.18: a STOP while nothing moves halts at once, whatever is waited for; the rest of a DELAY
// comes after START, and a WAIT looks again.
TEST(ModeRules, StopWhereNothingMoves) {
  const Ran delay = RunText("DELAY 4\nOL[16]=ON\n",
                            {.inputs = {Key(1.0, InputKind::kStop), Key(3.0, InputKind::kStart)}});
  EXPECT_NEAR(delay.First("halt STOP").at_s, 1.0, kExact);
  EXPECT_NEAR(delay.First("OL[16] 1").at_s, 6.0, kExact);
  const Ran wait =
      RunText("WAIT IL[20]\nOL[16]=ON\n", {.inputs = {Key(1.0, InputKind::kStop),
                                                      {At(2.0), InputKind::kLogical, 20, 1.0},
                                                      Key(3.0, InputKind::kStart)}});
  EXPECT_NEAR(wait.First("halt STOP").at_s, 1.0, kExact);
  EXPECT_NEAR(wait.First("OL[16] 1").at_s, 3.0, 0.048 + kExact);
  EXPECT_GE(wait.First("OL[16] 1").at_s, 3.0);
}

// OPT-4.18: STOP beside a motion of /NEXT halts both, and START goes on with both.
TEST(ModeRules, StopBesideANextMove) {
  const Ran ran = RunText(kAlongX + MoveTo(521.02, "/NEXT") + "DELAY 4\nOL[16]=ON\n",
                          {.inputs = {Key(1.0, InputKind::kStop), Key(5.0, InputKind::kStart)}});
  EXPECT_NEAR(ran.First("halt STOP").at_s, 1.0 + kRamp_s, kExact);
  EXPECT_EQ(ran.First("halt STOP").step, 5);
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, 5.0 + 3.0 - kRamp_s, kExact);
  EXPECT_NEAR(ran.time_s, 5.0 + 450.0 / 50.0 + kRamp_s + kSettle_s, kExact);
  EXPECT_NEAR(ran.end.tip.tip.x(), 521.02, kReal_mm);
}

// OPT-4.18, OPT-2.44: STOP in a chain: the corner keeps its shape (C01: 1.358847515 mm), stopped
// before it, in it or behind it.
TEST(ModeRules, StopInAChainKeepsTheCorner) {
  const std::string text =
      kAlongX + MoveTo(121.02, "/FLY") + "MOVE (121.02,2301.2,-350.,0.,0.)\nOL[16]=ON\n";
  for (const double at : {1.0, 1.99, 2.03, 3.0}) {
    const Ran ran =
        RunText(text, {.inputs = {Key(at, InputKind::kStop), Key(9.0, InputKind::kStart)}});
    SCOPED_TRACE(at);
    EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
    EXPECT_NEAR(ran.First("halt STOP").at_s, at + kRamp_s, 1e-3);
    EXPECT_NEAR(ran.DistanceTo({121.02, 2201.2, -350.0}), 1.358847515, 1e-4);
    EXPECT_NEAR(ran.moves.back().tip.tip.y(), 2301.2, kReal_mm);
  }
}

// OPT-4.19, OPT-6.31: START goes on with a halted run and is ignored while a step is under way.
TEST(ModeRules, StartIsIgnoredUntilTheStepIsFinished) {
  const Ran ran = RunText("DELAY 2\nVI[2]=1\nVI[3]=1\n",
                          {.inputs = {Key(0.5, InputKind::kStart), Key(1.0, InputKind::kStart),
                                      Key(3.0, InputKind::kStart)},
                           .mode = Mode::kSingle,
                           .variables = {"VI[2]", "VI[3]"}});
  EXPECT_NEAR(ran.First("halt SINGLE").at_s, 2.0, kExact);
  EXPECT_EQ(ran.Count("halt SINGLE"), 2);
  EXPECT_EQ(ran.variables.at("VI[2]") + ran.variables.at("VI[3]"), "10");
  EXPECT_EQ(ran.end.phase, RunPhase::kHalted);
}

// OPT-4.23: REPEAT begins again from its first step at the end, until HOLD or STOP.
TEST(ModeRules, RepeatRunsTheStepsAgain) {
  const std::string text = "VI[2]=VI[2]+1\nDELAY 1\n";
  const Ran held = RunText(text, {.inputs = {Key(2.5, InputKind::kHold)}, .mode = Mode::kRepeat});
  EXPECT_THAT(held.steps_begun, ElementsAre(1, 2, 1, 2, 1, 2));
  EXPECT_NEAR(held.First("halt HOLD").at_s, 3.0, kExact);
  const Ran stopped =
      RunText(text, {.inputs = {Key(2.25, InputKind::kStop), Key(4.0, InputKind::kStart),
                                Key(5.0, InputKind::kStop)},
                     .mode = Mode::kRepeat,
                     .variables = {"VI[2]"}});
  EXPECT_THAT(stopped.steps_begun, ElementsAre(1, 2, 1, 2, 1, 2, 1, 2));
  EXPECT_EQ(stopped.Count("halt STOP"), 2);  // 0.75 s were left of the third DELAY
  EXPECT_EQ(stopped.variables.at("VI[2]"), "4");
  EXPECT_EQ(RunText(text).steps, 2U);  // CYCLE: once
}

// OPT-4.23, OPT-B.53, OPT-3.16: each repetition begins with the defaults, and the shutter is closed
// between them.
TEST(ModeRules, EachRepetitionBeginsAnew) {
  const Ran ran = RunText(
      "MOVE (121.02,2201.2,-50.,0.,0.)\nMOVE (21.02,2201.2,-50.,0.,0.)\nSPEED 10\nWORK 0,0/ON\n"
      "WORK 0,0/OFF\n",
      {.inputs = {Key(1.0, InputKind::kHold), Key(2.0, InputKind::kStart),
                  Key(2.1, InputKind::kHold)},
       .mode = Mode::kRepeat});
  EXPECT_EQ(ran.Count("shutter closed"), 1);
  ASSERT_GE(ran.moves.size(), 3U);
  // 70 % of 500 mm/s in both passes.
  EXPECT_NEAR(ran.parts[0].duration_s(), 100.0 / 350.0 + 0.175 + 0.05 + kSettle_s, 1e-5);
  EXPECT_NEAR(ran.parts[2].duration_s(), ran.parts[0].duration_s(), kExact);
}

// OPT-4.23, OPT-2.47: the end of the program takes the passage of its last move away, also where
// the program begins again there: in each pass the tip comes to its target, and past those before.
TEST(ModeRules, NothingIsPassedBetweenRepetitions) {
  const Ran ran = RunText(kAlongX + MoveTo(121.02, "/FLY") +
                              "MOVE (121.02,2301.2,-350.,0.,0.)/FLY\n" + MoveTo(21.02, "/FLY"),
                          {.inputs = {Key(16.0, InputKind::kHold)}, .mode = Mode::kRepeat});
  EXPECT_EQ(ran.Finding(7304).step, 6);
  int passes = 0;
  for (const machine::MoveDone& move : ran.moves) {
    if (move.place.step != 6) continue;
    ++passes;
    EXPECT_NEAR(move.tip.tip.x(), 21.02, kReal_mm);
    EXPECT_NEAR(move.tip.tip.y(), 2201.2, kReal_mm);
  }
  EXPECT_EQ(passes, 2);  // 341 mm at 50 mm/s each, and the third is held at its second target
  EXPECT_GT(ran.DistanceTo({121.02, 2201.2, -350.0}), 0.1);
}

// OPT-4.23, OPT-6.10: the run halts behind the step of the breakpoint, in each pass.
TEST(ModeRules, ABreakpointHaltsInEachRepetition) {
  const Ran ran = RunText("VI[2]=VI[2]+1\nDELAY 1\n", {.inputs = Starts(2, 10.0),
                                                       .mode = Mode::kRepeat,
                                                       .variables = {"VI[2]"},
                                                       .breakpoint = machine::ProgramStep{1, 1}});
  EXPECT_THAT(ran.steps_begun, ElementsAre(1, 2, 1, 2, 1));
  EXPECT_EQ(ran.variables.at("VI[2]"), "3");
  EXPECT_EQ(ran.end.phase, RunPhase::kHalted);
}

// OPT-4.23: a program that carries nothing out takes a CYCLE each time, so that time goes on.
TEST(ModeRules, ARepetitionOfNothingTakesACycle) {
  const Ran ran =
      RunText("; nothing\n", {.mode = Mode::kRepeat,
                              .variables = {"VI[98]"},
                              .budget = {.virtual_time = std::chrono::milliseconds(500)}});
  EXPECT_EQ(ran.variables.at("VI[98]"), "12");  // and again at 0, 0.048 ... 0.480 s
  ASSERT_FALSE(ran.waits.empty());
  EXPECT_EQ(ran.waits[0].end - ran.waits[0].start, std::chrono::milliseconds(48));
}

// OPT-4.24, OPT-7.02, OPT-B.62: a change of mode takes effect at the end of the instruction that is
// under way: GO /S halts behind the GO, GO /C does not; without an attribute the mode stays.
TEST(ModeRules, GoChangesTheModeAtItsEnd) {
  const RunOptions options{.programs = {{46, "VI[2]=1\nVI[3]=1\n"}}, .variables = {"VI[2]"}};
  const Ran single = RunText("GO 46/S\n", options);
  EXPECT_EQ(single.Count("halt SINGLE"), 1);
  EXPECT_EQ(single.First("halt SINGLE").program, 1);
  EXPECT_EQ(single.variables.at("VI[2]"), "0");
  RunOptions from_single = options;
  from_single.mode = Mode::kSingle;
  EXPECT_EQ(RunText("GO 46/C\n", from_single).Count("halt SINGLE"), 0);
  const Ran stays = RunText("GO 46\n", from_single);
  EXPECT_EQ(stays.Count("halt SINGLE"), 1);
  EXPECT_EQ(stays.variables.at("VI[2]"), "0");
  RunOptions repeat = options;
  repeat.inputs = {Key(1.0, InputKind::kHold)};
  repeat.programs[46] = "VI[2]=VI[2]+1\nDELAY .6\n";
  EXPECT_EQ(RunText("GO 46/R\n", repeat).variables.at("VI[2]"), "2");
}

// OPT-4.59, OPT-E.7102: START of a program that does not exist.
TEST(ModeRules, StartOfAMissingProgram) {
  machine::RunSetup setup = SetupOf("VI[2]=1\n");
  setup.main_program = 77;
  machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(std::move(setup), nobody);
  ASSERT_TRUE(bool(run));
  EXPECT_EQ((*run)->Advance(At(1.0)), RunPhase::kFinished);
  EXPECT_EQ((*run)->outcome().kind, OutcomeKind::kFailed);
  EXPECT_EQ((*run)->outcome().code, ErrorCode::kProgramMissing);
  EXPECT_EQ((*run)->steps_executed(), 0U);
}

// OPT-4.61: START begins at step 1, wherever the run before was broken off; a suspended run goes
// on.
TEST(ModeRules, StartBeginsAtTheFirstStep) {
  const std::string text = "VI[2]=VI[2]+1\nSTOP\nVI[3]=VI[3]+1\n";
  const Ran broken = RunText(text, {.mode = Mode::kRemote});
  EXPECT_THAT(broken.steps_begun, ElementsAre(1, 2));
  const Ran again = RunText(text, {.inputs = {Key(1.0, InputKind::kStart)},
                                   .variables = {"VI[2]", "VI[3]"},
                                   .machine_state = broken.machine_state});
  EXPECT_THAT(again.steps_begun, ElementsAre(1, 2, 3));
  EXPECT_EQ(again.variables.at("VI[2]") + again.variables.at("VI[3]"), "21");
}

// OPT-4.62, OPT-4.07, OPT-6.05: after each START in SINGLE program, step and instruction are those
// of the module that the step belongs to: step 1 of 44 is not step 1 of the main program.
TEST(ModeRules, TheStepInExecutionIsShown) {
  struct Shown {
    int program, step;
    std::string_view name;
  };
  constexpr Shown kShown[] = {
      {1, 1, "LET"}, {1, 2, "FUNCTION"}, {44, 1, "DELAY"}, {44, 2, "LET"}, {1, 3, "COORD"}};
  for (int starts = 0; starts < 5; ++starts) {
    const Ran ran = RunText("VI[2]=1\nFUNCTION 44\nCOORD ABSOL\nVI[4]=1\n",
                            {.programs = {{44, "DELAY .1\nVI[3]=1\n"}},
                             .inputs = Starts(starts, 1.0),
                             .mode = Mode::kSingle});
    EXPECT_EQ(ran.end.place.program, kShown[starts].program) << starts;
    EXPECT_EQ(ran.end.place.step, kShown[starts].step) << starts;
    EXPECT_EQ(ran.end.instruction, kShown[starts].name) << starts;
    EXPECT_EQ(ran.Count("halt SINGLE"), starts + 1);
  }
}

// OPT-4.08, OPT-6.34: making the executable is told once; a program that has one is not compiled.
TEST(ModeRules, CompilingIsToldAtTheFirstStartOnly) {
  RunOptions single{.inputs = Starts(2, 1.0), .mode = Mode::kSingle};
  const Ran first = RunText("VI[2]=1\nVI[3]=1\nVI[4]=1\n", single);
  EXPECT_EQ(first.Count("compiling 1"), 1);
  EXPECT_EQ(first.told.front(), "compiling 1");
  single.executables = first.executables;
  EXPECT_EQ(RunText("VI[2]=1\nVI[3]=1\nVI[4]=1\n", single).Count("compiling 1"), 0);
}

// OPT-6.32, OPT-B.29: in SINGLE the machine stops at every target, whatever its /FLY, and settles.
TEST(ModeRules, InSingleEveryTargetIsReached) {
  const std::string text = kAlongX + MoveTo(121.02, "/FLY") +
                           "MOVE (121.02,2301.2,-350.,0.,0.)/FLY\n" +
                           "MOVE (221.02,2301.2,-350.,0.,0.)\n";
  const Ran ran = RunText(text, {.inputs = Starts(5, 10.0), .mode = Mode::kSingle});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.Count("halt SINGLE"), 5);
  ASSERT_EQ(ran.moves.size(), 3U);
  EXPECT_NEAR(ToSeconds(ran.moves[0].at), 30.0 + kHundred_s, kExact);
  EXPECT_NEAR(ToSeconds(ran.moves[1].at), 40.0 + kHundred_s, kExact);
  EXPECT_LT(ran.DistanceTo({121.02, 2201.2, -350.0}), kReal_mm);
  EXPECT_LT(ran.DistanceTo({121.02, 2301.2, -350.0}), kReal_mm);
}

// OPT-6.33, OPT-4.34: in CYCLE the bend hangs on the actual speed: at 10 % of 50 mm/s the corner of
// case C01 shrinks with the power 1.5 of the speed (motion.md 4.3).
TEST(ModeRules, InCycleTheBendHangsOnTheOverride) {
  const std::string text = kAlongX + MoveTo(121.02, "/FLY") + "MOVE (121.02,2301.2,-350.,0.,0.)\n";
  const motion::MachinePoint corner{121.02, 2201.2, -350.0};
  EXPECT_NEAR(RunText(text).DistanceTo(corner), 1.358847515, kReal_mm);
  EXPECT_NEAR(RunText(text, {.override_percent = 10.0}).DistanceTo(corner),
              1.358847515 * std::pow(0.1, 1.5), kReal_mm);
}

// OPT-6.07, OPT-B.29: a breakpoint at a /FLY move makes its target exact, as HOLD does; one at the
// same step of another program does not.
TEST(ModeRules, ABreakpointCancelsThePassage) {
  const std::string text =
      kAlongX + MoveTo(121.02, "/FLY") + "OL[16]=ON\n" + "MOVE (121.02,2301.2,-350.,0.,0.)\n";
  const motion::MachinePoint corner{121.02, 2201.2, -350.0};
  RunOptions options{.inputs = {Key(9.0, InputKind::kStart)}};
  options.breakpoint = machine::ProgramStep{.program = 1, .step = 4};
  const Ran here = RunText(text, options);
  EXPECT_NEAR(here.First("halt BREAK").at_s, kHundred_s, kExact);
  EXPECT_EQ(here.First("halt BREAK").step, 4);
  EXPECT_LT(here.DistanceTo(corner), kReal_mm);
  EXPECT_NEAR(here.First("OL[16] 1").at_s, 9.0, kExact);
  EXPECT_EQ(here.outcome.kind, OutcomeKind::kCompleted);
  for (const machine::ProgramStep other : {machine::ProgramStep{.program = 44, .step = 4},
                                           machine::ProgramStep{.program = 1, .step = 3}}) {
    options.breakpoint = other;
    EXPECT_NEAR(RunText(text, options).DistanceTo(corner), 1.358847515, kReal_mm);
  }
  // One behind it: the passage before it stays, as far as it can be reached.
  options.breakpoint = machine::ProgramStep{.program = 1, .step = 5};
  const Ran behind = RunText(text, options);
  EXPECT_EQ(behind.First("halt BREAK").step, 5);
  EXPECT_LT(behind.DistanceTo(corner), kReal_mm);
}

// OPT-6.07, OPT-6.31: in a FUNCTION and at the last step; the end of the run needs no START then.
TEST(ModeRules, ABreakpointOfAnotherModule) {
  RunOptions options{.programs = {{44, "VI[2]=1\nVI[2]=2\n"}}, .variables = {"VI[2]"}};
  options.breakpoint = machine::ProgramStep{.program = 44, .step = 1};
  const Ran inside = RunText("VI[2]=9\nFUNCTION 44\n", options);
  EXPECT_EQ(inside.First("halt BREAK").program, 44);
  EXPECT_EQ(inside.variables.at("VI[2]"), "1");
  options.breakpoint = machine::ProgramStep{.program = 44, .step = 2};
  const Ran last = RunText("VI[2]=9\nFUNCTION 44\n", options);
  EXPECT_EQ(last.Count("halt BREAK"), 1);  // the main program goes on behind it
  options.breakpoint = machine::ProgramStep{.program = 1, .step = 2};
  EXPECT_EQ(RunText("VI[2]=9\nVI[3]=9\n", options).outcome.kind, OutcomeKind::kCompleted);
}

// OPT-B.34: between the steps of SINGLE the beam is off; it returns with START, before the motion.
TEST(ModeRules, TheBeamIsOffBetweenTheStepsOfSingle) {
  const Ran ran = RunText("WORK 0,0/ON\nDELAY 1\nWORK 0,0/OFF\nVI[2]=1\n",
                          {.inputs = Starts(3, 5.0), .mode = Mode::kSingle});
  EXPECT_THAT(ran.told,
              ElementsAre("compiling 1", "shutter open", "beam on 100.0", "beam off", "halt SINGLE",
                          "wait operator 5.0", "beam on 100.0", "wait dwell 1.0", "beam off",
                          "halt SINGLE", "wait operator 4.0", "beam on 100.0", "beam off",
                          "halt SINGLE", "wait operator 5.0", "shutter closed"));
}

}  // namespace
}  // namespace rmlcell::optimo::testing::mode_rules
