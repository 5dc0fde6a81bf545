#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/engine/optimo/control/run_text.h"

// How the text of a program decides what runs: sequence numbers, steps, declared names, numbers and
// the programs of FUNCTION.
namespace rmlcell::optimo::testing::program_text {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

// OPT-1.23, OPT-1.25, OPT-1.26, OPT-1.28: 0 and 9999 are reached, 010 is 10, numbers go up and
// down and may be idle; digits before an E are a number of their own.
TEST(ProgramText, SequenceNumbers) {
  ExpectValues(
      {{"GOTO 0\nVI[2]=9\nENDTASK\n0 VI[2]=1\n", "VI[2]", "1"},
       {"GOTO 9999\nVI[2]=9\nENDTASK\n9999 VI[2]=1\n", "VI[2]", "1"},
       {"GOTO 10\nVI[2]=9\nENDTASK\n010 VI[2]=1\n", "VI[2]", "1"},
       {"7 GOTO 30\n10 VI[2]=VI[2]*10+1\nENDTASK\n30 VI[2]=VI[2]*10+3\n5 GOTO 10\n", "VI[2]", "31"},
       {"DECLARE E1 = VR[1]\nGOTO 10\nVI[2]=9\n10 E1 = 5.\n", "VR[1]", "5.0"},
       {"DECLARE E1 = VR[1]\nGOTO 10\nVI[2]=9\n10 E1 = 5.\n", "VI[2]", "0"}});
}

// OPT-6.01, OPT-6.03, OPT-1.01, OPT-1.20, OPT-1.30: DECLAREs, comments, blank lines and lone
// sequence numbers are no steps; DEFINE, TASK and ENDTASK are, and a statement of several lines is
// one.
TEST(ProgramText, WhatIsAStep) {
  EXPECT_THAT(RunText("SPEED 20\n").steps_begun, ElementsAre(1));
  EXPECT_THAT(RunText("DECLARE X = VR[0]\n; text\n\n10\nDEFINE PAR[0] = INT\nX = 1.\nENDTASK\n")
                  .steps_begun,
              ElementsAre(1, 2, 3));
  EXPECT_THAT(
      RunText("500 TASK 1\nVR[1] =\n; text\n\n1. +\n2.\nMOVE\n(500.,500.,\n-50.,0.,0.)\n/ FLY\n"
              "VI[2]=1\n")
          .steps_begun,
      ElementsAre(1, 2, 3, 4));
}

// OPT-6.04: the implied ENDTASK of three instructions stands at step 4 and is not counted.
TEST(ProgramText, TheImpliedEndIsNotCounted) {
  const Ran ran = RunText("VI[2]=1\nVI[3]=1\nVI[4]=1\n");
  EXPECT_EQ(ran.steps, 3U);
  EXPECT_THAT(ran.steps_begun, ElementsAre(1, 2, 3));
}

// OPT-6.02, OPT-6.43, OPT-7.51: the manual's table: six DECLAREs, then steps 1 to 11, the MOVE as
// step 10.
TEST(ProgramText, TheTableOfSteps) {
  const Ran ran = RunText(
      "DECLARE XAXIS = VR[0]\nDECLARE YAXIS = VR[1]\nDECLARE ZAXIS = VR[2]\nDECLARE RAPID = VR[64]\n"
      "DECLARE APPROACH = VR[69]\nDECLARE FEED = VR[74]\nXAXIS = 500.0\nYAXIS = 375.0\n"
      "ZAXIS = -50.5\nRAPID = 70.0\nAPPROACH = 20.0\nFEED = 12.0\nCOORD ABSOL\nPATH PTP\n"
      "SPEED RAPID\nMOVE (XAXIS, YAXIS, ZAXIS, 0., 0.) / FLY\nSPEED APPROACH\n");
  EXPECT_THAT(ran.steps_begun, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
  ASSERT_EQ(ran.moves.size(), 1U);
  EXPECT_EQ(ran.moves[0].place.step, 10);
  EXPECT_NEAR((ran.end.tip.tip - motion::MachinePoint(500.0, 375.0, -50.5)).norm(), 0.0, 1e-4);
}

// OPT-1.18: a comment takes the rest of its line away, and nothing else.
TEST(ProgramText, Comments) {
  const Ran ran = RunText("VI[2]=1 ; VI[2]=2\n;VI[3]=3\n;\nVI[4]=4;VI[5]=5\n",
                          {.variables = {"VI[2]", "VI[3]", "VI[4]", "VI[5]"}});
  EXPECT_THAT(ran.steps_begun, ElementsAre(1, 2));
  EXPECT_EQ(ran.variables, (std::map<std::string, std::string>{
                               {"VI[2]", "1"}, {"VI[3]", "0"}, {"VI[4]", "4"}, {"VI[5]", "0"}}));
}

// OPT-1.02, OPT-1.29: small letters and any blanks run as the rest does.
TEST(ProgramText, LettersAndBlanks) {
  const Ran plain = RunText(
      "COORD ABSOL\nPATH HOLE (5.)\nMOVE (121.02,2201.2,-350.,0.,0.)/VIA (121.02,2201.2,-250.,0.,"
      "0.)\nWORK 0,00/ON\nWORK 0,0/OFF\nVR[12]=1.5E2\n",
      {.variables = {"VR[12]"}});
  const Ran other = RunText(
      "Coord absol\npath  hole(5.)\nmove(121.02 , 2201.2,-350. , 0.,0.)  /\tvia(121.02,2201.2, "
      "-250.,0.,0.)\nwork 0 , 00 / on\nWork 0, 0 /Off\nvr [ 12 ] = 1.5 e 2\n",
      {.variables = {"VR[12]"}});
  EXPECT_EQ(other.told, plain.told);
  EXPECT_EQ(other.end.time, plain.end.time);
  EXPECT_EQ(other.variables, plain.variables);
  EXPECT_EQ(plain.variables.at("VR[12]"), "150.0");
}

// OPT-7.41, OPT-7.44, OPT-7.50, OPT-7.60, OPT-7.95: names of everything that may have one, declared
// anywhere before their use; a name for a number is an index too.
TEST(ProgramText, DeclaredNames) {
  ExpectValues({{"DECLARE YHOME = -45.0\nVR[1] = YHOME\n", "VR[1]", "-45.0"},
                {"VI[2]=1\nDECLARE CAXIS = OL [16]\nCAXIS = ON\n", "OL[16]", "1"},
                {"DECLARE GO1 = IL[20]\nVL[1] = NOT GO1\n", "VL[1]", "1"},
                {"DECLARE COUNT = VI[5]\nCOUNT = COUNT + 4\n", "VI[5]", "4"},
                {"DECLARE FLAG = VL[9]\nFLAG = YES\n", "VL[9]", "1"},
                {"DECLARE TUNE = OA[5]\nTUNE = 2.5\n", "OA[5]", "2.5"},
                {"DECLARE HEIGHT = IA[2]\nCOORD ROBOT\nVR[1] = HEIGHT\n", "VR[1]", "-50.0"},
                {"DECLARE YESNO = ON\nVL[9] = YESNO\n", "VL[9]", "1"},
                {"CALL 45 (7.)\n", "VR[1]", "7.0"},
                {"DECLARE N = 5\nVR[N] = 2.\n", "VR[5]", "2.0"},
                {"DECLARE X = VR[0]\nDECLARE XHOME = 10.5\nX = XHOME + 200.0\n", "VR[0]", "210.5"}},
               {.programs = {{45, "DECLARE radius = PAR[0]\nVR[1] = radius\n"}}});
}

// OPT-7.53, OPT-7.55, OPT-7.56, OPT-B.41: a large number without point is a REAL one; blanks around
// the E; digits beyond the seventh are rounded away, not refused.
TEST(ProgramText, Numbers) {
  ExpectValues({{"VR[0]=40000\n", "VR[0]", "40000.0"},
                {"VR[0]=.256 E -3\n", "VR[0]", "0.000256"},
                {"VR[0]=-2.5 E -3\n", "VR[0]", "-0.0025"},
                {"VR[0]=1262.139005\nVL[0] = VR[0] = 1262.139\n", "VL[0]", "1"},
                {"VR[0]=1262.1391\nVL[0] = VR[0] = 1262.139\n", "VL[0]", "0"}});
}

// OPT-B.52, OPT-7.90, OPT-7.87: REALs are compared bit for bit; both sides of OR are computed, also
// where the first decides; AND before OR.
TEST(ProgramText, Conditions) {
  const std::string after = " THEN 5\nENDTASK\n5 VI[2]=1\n";
  ExpectValues({{"VR[0]=0.1\nIF VR[0] = 0.1" + after, "VI[2]", "1"},
                {"VR[0]=0.9999999\nIF VR[0] = 1." + after, "VI[2]", "0"},
                {"IF ON OR ON AND OFF" + after, "VI[2]", "1"}});
  EXPECT_EQ(CodeOf(RunText("VL[0]=ON\nIF VL[0] OR (1/0 > 0)" + after)), 7201);
}

// OPT-7.104, OPT-7.105, OPT-7.106: variables and outputs of the system are advised against when the
// program is compiled, and written when it runs.
TEST(ProgramText, VariablesOfTheSystemAreWritten) {
  ExpectValues({{"VI[75]=1\n", "VI[75]", "1"},
                {"VL[85]=ON\n", "VL[85]", "1"},
                {"VR[50]=2.5\n", "VR[50]", "2.5"}});
  EXPECT_TRUE(RunText("OL[20]=ON\n").Told("OL[20] 1"));
}

// OPT-9.24, OPT-9.25, OPT-9.29, OPT-E.7036: DEFINE without index is of PAR[0], and holds also where
// the run jumps over it; a parameter may be an expression.
TEST(ProgramText, Parameters) {
  const RunOptions options{.programs = {{6, "VR[5]=PAR[0]\n"},
                                        {7, "DEFINE PAR = INT\nVR[5]=PAR[0]\nVR[6]=PAR[1]\n"},
                                        {8, "GOTO 10\nDEFINE PAR[0] = INT\n10 VR[5]=PAR[0]\n"}}};
  ExpectValues({{"VR[1]=1.5\nFUNCTION 6 (VR[1]+1.)\n", "VR[5]", "2.5"},
                {"CALL 6 (SQRT(VR[1]+16.)*2)\n", "VR[5]", "8.0"},
                {"FUNCTION 7 (2.7,3.7)\n", "VR[5]", "2.0"},
                {"FUNCTION 7 (2.7,3.7)\n", "VR[6]", "3.7"},
                {"FUNCTION 8 (2.7)\n", "VR[5]", "2.0"}},
               options);
}

// OPT-9.03, OPT-9.06, OPT-9.11, OPT-E.7103: what FUNCTION cannot have ends the run before its first
// step; that the function has no executable of its own does not matter.
TEST(ProgramText, FunctionsThatCannotBeLinked) {
  const auto run = [](const std::string& main, const std::string& of_44) {
    RunOptions options{.variables = {"VI[2]"}};
    if (!of_44.empty()) options.programs[44] = of_44;
    const Ran ran = RunText("VI[2]=1\n" + main, options);
    EXPECT_EQ(ran.variables.at("VI[2]"), CodeOf(ran) == 0 ? "1" : "0");
    return CodeOf(ran);
  };
  EXPECT_EQ(run("FUNCTION 44\n", ""), 7103);
  EXPECT_EQ(run("FUNCTION 44\n", "VI[3]=1\n"), 0);
  EXPECT_EQ(run("FUNCTION 1\n", ""), 7104);
  EXPECT_EQ(run("FUNCTION 44\n", "FUNCTION 1\n"), 7104);
  EXPECT_EQ(run("FUNCTION 44\n", "TASK 2\nVI[3]=1\n"), 7108);
}

// OPT-9.05, OPT-9.02: 32 functions run, each as often as it is asked for; one more is refused.
TEST(ProgramText, ThirtyTwoFunctions) {
  RunOptions options{.variables = {"VI[2]"}};
  std::string main;
  for (int n = 2; n < 34; ++n) {
    options.programs[n] = "VI[2]=VI[2]+1\n";
    main += "FUNCTION " + std::to_string(n) + "\n";
  }
  EXPECT_EQ(RunText(main + "FUNCTION 2\n", options).variables.at("VI[2]"), "33");
  options.programs[34] = "VI[2]=VI[2]+1\n";
  EXPECT_EQ(CodeOf(RunText(main + "FUNCTION 34\n", options)), 7105);
}

// OPT-9.07, OPT-9.08: a function that runs itself, three times in all, counts down to its end.
TEST(ProgramText, AFunctionRunsItself) {
  ExpectValues(
      {{"FUNCTION 44\nVI[3]=VI[2]\n", "VI[3]", "3"}},
      {.programs = {{44, "VI[2]=VI[2]+1\nIF VI[2] < 3 THEN 5\nENDTASK\n5 FUNCTION 44\n"}}});
}

}  // namespace
}  // namespace rmlcell::optimo::testing::program_text
