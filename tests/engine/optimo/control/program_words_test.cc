#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/optimo/machine/machine_state.h"
#include "tests/engine/optimo/control/run_text.h"

// What the words of flow and data do when a program runs, each by itself, and that those without
// effect have none (appendix 1).
namespace rmlcell::optimo::testing::program_words {
namespace {

using machine::Mode;
using machine::OutcomeKind;
using ::testing::ElementsAre;

bool Output(const Ran& ran, int number) {
  const Result<MachineState> state = DecodeMachineState(ran.machine_state);
  EXPECT_TRUE(bool(state));
  return state && state->outputs.logical[number];
}

// OPT-W.11, OPT-W.46, OPT-W.21, OPT-W.19, OPT-7.23: a jump of GOTO, and both ways of IF, with ELSE
// and without.
TEST(ProgramWords, Jumps) {
  const std::string after = "VI[3]=9\nENDTASK\n50 VI[3]=5\nENDTASK\n60 VI[3]=6\n";
  ExpectValues({{"GOTO 50\n" + after, "VI[3]", "5"},
                {"VL[0]=ON\nIF VL[0] THEN 50 ELSE 60\n" + after, "VI[3]", "5"},
                {"IF VL[0] THEN 50 ELSE 60\n" + after, "VI[3]", "6"},
                {"IF VL[0] THEN 50\n" + after, "VI[3]", "9"}});
  ExpectValues({{"IF IL[10] THEN 50\n" + after, "VI[3]", "5"}},
               {.inputs = {{SimTime(0), machine::InputKind::kLogical, 10, 1.0}}});
}

// OPT-7.20, OPT-W.20, OPT-W.34, OPT-W.13, OPT-3.47: the subroutine behind ENDTASK runs once,
// between GOSUB and the step that follows.
TEST(ProgramWords, SubroutinesBehindEndtask) {
  const Ran ran =
      RunText("VI[2]=1\nGOSUB 100\nVI[2]=VI[2]*10+3\nENDTASK\n100 VI[2]=VI[2]*10+2\nRETURN\n",
              {.variables = {"VI[2]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "123");
  EXPECT_THAT(ran.steps_begun, ElementsAre(1, 2, 5, 6, 3, 4));
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
}

// OPT-W.04, OPT-W.16, OPT-W.18, OPT-7.07, OPT-9.01: CALL and FUNCTION come back, GO does not. The
// number of a CALL may have zeros before it, or come from a constant or a variable.
TEST(ProgramWords, OtherPrograms) {
  const RunOptions options{.programs = {{2, "VI[3]=VI[3]*10+2\n"}}};
  const std::string after = "\nVI[3]=VI[3]*10+3\n";
  ExpectValues({{"VI[3]=1\nCALL 2" + after, "VI[3]", "123"},
                {"VI[3]=1\nCALL 02" + after, "VI[3]", "123"},
                {"VI[3]=1\nDECLARE SECOND = 2\nCALL SECOND" + after, "VI[3]", "123"},
                {"VI[3]=1\nVI[1]=2\nCALL VI[1]" + after, "VI[3]", "123"},
                {"VI[3]=1\nFUNCTION 2" + after, "VI[3]", "123"},
                {"VI[3]=1\nDECLARE SECOND = 2\nFUNCTION SECOND" + after, "VI[3]", "123"},
                {"VI[3]=1\nGO 2" + after, "VI[3]", "12"}},
               options);
}

// OPT-W.18, OPT-W.65, OPT-W.66: in the program that GO starts, C runs through, R begins again at
// the end, and S waits for START before the first step.
TEST(ProgramWords, ModesOfGo) {
  const auto run = [](const std::string& attribute, Mode mode) {
    return RunText("GO 46 /" + attribute + "\n", {.programs = {{46, "VI[2]=VI[2]+1\nDELAY 1\n"}},
                                                  .inputs = {{At(2.5), machine::InputKind::kHold}},
                                                  .mode = mode,
                                                  .variables = {"VI[2]"}});
  };
  const Ran cycle = run("C", Mode::kSingle);
  EXPECT_EQ(cycle.variables.at("VI[2]"), "1");
  EXPECT_EQ(cycle.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(run("R", Mode::kCycle).variables.at("VI[2]"), "3");  // at 0, 1 and 2 s
  const Ran single = run("S", Mode::kCycle);
  EXPECT_EQ(single.variables.at("VI[2]"), "0");
  EXPECT_EQ(single.Count("halt SINGLE"), 1);
}

// OPT-W.14, OPT-W.28, OPT-W.38: ERR takes an error to its label, NOERR lets it stop the program,
// SETERR is none.
TEST(ProgramWords, Errors) {
  const std::string rest = "\nENDTASK\n900 VI[2]=VI[99]\n";
  const auto run = [&](const std::string& text) {
    return RunText(text + rest, {.variables = {"VI[2]"}});
  };
  const Ran caught = run("ERR 900\nVR[0]=1/0");
  EXPECT_EQ(CodeOf(caught), 0);
  EXPECT_EQ(caught.variables.at("VI[2]"), "7201");
  EXPECT_EQ(CodeOf(run("ERR 900\nNOERR\nVR[0]=1/0")), 7201);
  const Ran shown = run("ERR 900\nSETERR 1234");
  EXPECT_EQ(CodeOf(shown), 0);
  EXPECT_TRUE(shown.Told("ERROR 1234"));
  EXPECT_EQ(shown.variables.at("VI[2]"), "0");
}

// OPT-W.03, OPT-W.27, OPT-W.40: BREAK halts behind its step, and NOBREAK, which has no effect,
// leaves it where it is. SIMUL is for the next run: DELAY 3 is passed over then.
TEST(ProgramWords, BreakAndSimul) {
  const Ran ran = RunText("BREAK 3\nNOBREAK\nVI[2]=1\nVI[2]=2\n", {.variables = {"VI[2]"}});
  EXPECT_EQ(ran.First("halt BREAK").step, 3);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  const Ran arming = RunText("SIMUL 2\nDELAY 3\n");
  EXPECT_NEAR(arming.time_s, 3.0, 1e-9);
  EXPECT_NEAR(RunText("DELAY 3\nDELAY 5\n", {.machine_state = arming.machine_state}).time_s, 5.0,
              1e-9);
}

// OPT-W.07, OPT-W.08, OPT-W.24, OPT-W.44: DECLARE names a variable, DEFINE makes a parameter an
// INTEGER, LET may stand before an assignment, TASK 1 is where a program begins.
TEST(ProgramWords, NamesAndParameters) {
  ExpectValues({{"DECLARE X = VR[7]\nX = 2.5\n", "VR[7]", "2.5"},
                {"CALL 45 (2.7)\n", "VR[0]", "2.0"},
                {"LET VR [12] = -7.52\n", "VR[12]", "-7.52"},
                {"VR [12] = -7.52\n", "VR[12]", "-7.52"},
                {"VI[2]=1\nTASK 1\nVI[3]=1\n", "VI[2]", "0"},
                {"VI[2]=1\nTASK 1\nVI[3]=1\n", "VI[3]", "1"}},
               {.programs = {{45, "DEFINE PAR[0] = INT\nVR[0]=PAR[0]\n"}}});
}

// OPT-W.02, OPT-W.49, OPT-W.22, OPT-W.33: ASSIGN writes 5 as 1, 0, 1 and clears what follows;
// UPDATE OFF and IMAGE hold an output back, ON and REAL let it go.
TEST(ProgramWords, GroupsOfOutputs) {
  const Ran assigned = RunText("OL[29]=ON\nASSIGN OL[22] = 5 /8\n");
  std::string bits;
  for (int n = 22; n < 30; ++n) bits += Output(assigned, n) ? '1' : '0';
  EXPECT_EQ(bits, "10100000");
  EXPECT_FALSE(Output(RunText("ASSIGN OL[22] = 1 /8\nASSIGN OL[22] = 0 /8\n"), 22));
  EXPECT_FALSE(Output(RunText("UPDATE OL /OFF\nOL[16]=ON\n"), 16));
  EXPECT_TRUE(Output(RunText("UPDATE OL /OFF\nOL[16]=ON\nUPDATE OL /ON\n"), 16));
  EXPECT_FALSE(Output(RunText("IMAGE OL\nOL[16]=ON\n"), 16));
  EXPECT_TRUE(Output(RunText("IMAGE OL\nOL[16]=ON\nREAL OL\n"), 16));
}

// OPT-W.67, OPT-W.68, OPT-7.58: six words and two numbers of one meaning.
TEST(ProgramWords, LogicalConstants) {
  for (const std::string one : {"ON", "TRUE", "YES", "1"}) {
    ExpectValues({{"VL[0]=" + one + "\n", "VL[0]", "1"}});
  }
  for (const std::string zero : {"OFF", "FALSE", "NO", "0"}) {
    ExpectValues({{"VL[0]=1\nVL[0]=" + zero + "\n", "VL[0]", "0"}});
  }
}

// OPT-W.69, OPT-W.70, OPT-W.71: every function, in radians, and MOD: known values to six places.
TEST(ProgramWords, Functions) {
  const auto value = [](const std::string& expression) {
    return std::stod(Value("VR[0]=" + expression + "\n", "VR[0]"));
  };
  const std::pair<const char*, double> functions[] = {
      {"SIN(1)", 0.841471},   {"COS(1)", 0.540302},  {"TAN(1)", 1.557408},  {"ASIN(.5)", 0.523599},
      {"ACOS(.5)", 1.047198}, {"ATAN(1)", 0.785398}, {"SQRT(2)", 1.414214}, {"EXP(1)", 2.718282},
      {"LN(2)", 0.693147},    {"LOG(1000)", 3.0},    {"ABS(-3)", 3.0},      {"INT(2.9)", 2.0},
      {"INT(-2.7)", -2.0},    {"-7 MOD 3", -1.0},    {"7.5 MOD 2", 1.5}};
  for (const auto& [expression, wanted] : functions) {
    EXPECT_NEAR(value(expression), wanted, 1e-6) << expression;
  }
}

// OPT-W.72: for 0 0, 0 1, 1 0 and 1 1. AND is the product.
TEST(ProgramWords, LogicalOperators) {
  const std::pair<const char*, const char*> operators[] = {{"VL[1] AND VL[2]", "0001"},
                                                           {"VL[1] OR VL[2]", "0111"},
                                                           {"VL[1] XOR VL[2]", "0110"},
                                                           {"NOT VL[1]", "1100"}};
  for (const auto& [expression, wanted] : operators) {
    std::string got;
    for (const char* left : {"0", "1"}) {
      for (const char* right : {"0", "1"}) {
        got += Value(
            "VL[1]=" + std::string(left) + "\nVL[2]=" + right + "\nVL[3]=" + expression + "\n",
            "VL[3]");
      }
    }
    EXPECT_EQ(got, wanted) << expression;
  }
}

// Nothing happens: a step that takes no time and tells nothing.
void ExpectNoEffect(const std::string& line) {
  const Ran ran =
      RunText("VI[2]=1\n" + line + "\nVI[2]=VI[2]+1\nDELAY 1\n", {.variables = {"VI[2]"}});
  EXPECT_THAT(ran.told, ElementsAre("compiling 1", "wait dwell 1.0")) << line;
  EXPECT_THAT(ran.steps_begun, ElementsAre(1, 2, 3, 4)) << line;
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.variables.at("VI[2]"), "2");
}

// OPT-W.05, OPT-W.10, OPT-W.12, OPT-W.15, OPT-E.7023: words without effect are steps all the same,
// whatever follows them on their line.
TEST(ProgramWords, WordsWithoutEffect) {
  for (const char* line : {"CONT", "CONT 5 ) VR[1]=7.", "DISABLE 3", "ENABLE", "EXTERN FOO"}) {
    ExpectNoEffect(line);
  }
}

// OPT-W.51, OPT-W.52, OPT-W.53: nor do the words of weaving move anything.
TEST(ProgramWords, WordsOfWeaving) {
  for (const char* line : {"WEAV (((", "WEAVDEF 1,2,", "WEAVING"}) ExpectNoEffect(line);
}

// OPT-2.48, OPT-W.05: they do need standstill: /FLY before one is cancelled.
TEST(ProgramWords, WordsWithoutEffectEndAPassage) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)/FLY\nCONT\n"
      "MOVE (121.02,2301.2,-350.,0.,0.)\n");
  EXPECT_EQ(ran.Count("E7304"), 1);
  EXPECT_LT(ran.DistanceTo({121.02, 2201.2, -350.0}), 1e-4);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::program_words
