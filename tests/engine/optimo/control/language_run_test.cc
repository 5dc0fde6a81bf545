#include <gtest/gtest.h>

#include <ostream>

#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/printer.h"
#include "tests/engine/optimo/control/run_text.h"

// What sentences of the language mean when they are carried out: small programs, and what is left
// in the variables.
namespace rmlcell::optimo::testing::language_run {
namespace {

using machine::InputKind;

// OPT-7.24, OPT-7.25: a numeric condition is true when it is not zero; THEN and ELSE go to sequence
// numbers.
TEST(LanguageRun, ConditionsOfIf) {
  const std::string after = " THEN 50 ELSE 60\nVI[3]=9\nENDTASK\n50 VI[3]=5\nENDTASK\n60 VI[3]=6\n";
  ExpectValues({{"VI[2]=-3\nIF VI[2]" + after, "VI[3]", "5"},
                {"VI[2]=0\nIF VI[2]" + after, "VI[3]", "6"},
                {"VR[2]=0.001\nIF VR[2]" + after, "VI[3]", "5"},
                {"IF 1" + after, "VI[3]", "5"},
                {"IF 0" + after, "VI[3]", "6"},
                {"VL[2]=ON\nIF VL[2]" + after, "VI[3]", "5"},
                {"IF VL[2]" + after, "VI[3]", "6"}});
  const std::string only = " THEN 50\nVI[3]=9\nENDTASK\n50 VI[3]=5\n";
  ExpectValues({{"IF VI[2]" + only, "VI[3]", "9"}, {"IF 2" + only, "VI[3]", "5"}});
}

// OPT-7.26, OPT-B.44: a relation binds tighter than AND; 100 is not more than 100.
TEST(LanguageRun, RelationsInConditions) {
  const std::string dist = "DECLARE DIST = VR[2]\nDIST = ";
  const std::string far = "\nIF DIST > 100 THEN 50\nVI[3]=9\nENDTASK\n50 VI[3]=5\n";
  const std::string both =
      "\nIF (VR[1] > 0.) AND IL[3] THEN 50 ELSE 60\n50 VI[3]=5\nENDTASK\n60 VI[3]=6\n";
  const std::string open =
      "\nIF IL[3] AND VR[1] > 5. THEN 50 ELSE 60\n50 VI[3]=5\nENDTASK\n60 VI[3]=6\n";
  ExpectValues({{dist + "100.5" + far, "VI[3]", "5"},
                {dist + "100" + far, "VI[3]", "9"},
                {"VR[1]=1." + both, "VI[3]", "6"},
                {"VR[1]=6." + open, "VI[3]", "6"}});
  const RunOptions on{.inputs = {{SimTime(0), InputKind::kLogical, 3, 1.0}}};
  ExpectValues({{"VR[1]=1." + both, "VI[3]", "5"},
                {"VR[1]=0." + both, "VI[3]", "6"},
                {"VR[1]=6." + open, "VI[3]", "5"},
                {"VR[1]=5." + open, "VI[3]", "6"}},
               on);
}

// OPT-7.85, OPT-B.87: all relations, on both sides of equality; both forms of "not equal".
TEST(LanguageRun, EveryRelation) {
  const std::pair<const char*, const char*> relations[] = {
      {"<", "100"}, {"<=", "110"}, {"=", "010"}, {">=", "011"},
      {">", "001"}, {"<>", "101"}, {"><", "101"}};
  for (const auto& [relation, wanted] : relations) {
    std::string got;
    for (const char* left : {"1.5", "2.", "2.5"}) {
      got += Value("VR[1]=" + std::string(left) + "\nVL[1]=VR[1]" + relation + "2.\n", "VL[1]");
    }
    EXPECT_EQ(got, wanted) << relation;
  }
}

// OPT-7.86, OPT-B.43, OPT-B.45: the first '=' assigns, a further one compares, logically with 0
// and 1.
TEST(LanguageRun, EqualsComparesAndAssigns) {
  ExpectValues({{"VR[1]=2.\nVL[3] = VR[1] = 2.\n", "VL[3]", "1"},
                {"VR[1]=3.\nVL[3] = VR[1] = 2.\n", "VL[3]", "0"},
                {"VL[3] = IL[3] = 1\n", "VL[3]", "0"},
                {"VL[3] = IL[3] = 0\n", "VL[3]", "1"},
                {"VL[3] = (1 < 2) = (3 < 4)\n", "VL[3]", "1"}});
  ExpectValues({{"VL[3] = IL[3] = 1\n", "VL[3]", "1"}},
               {.inputs = {{SimTime(0), InputKind::kLogical, 3, 1.0}}});
}

// OPT-7.88, OPT-7.92: logical assignments from inputs.
TEST(LanguageRun, LogicalAssignments) {
  for (int bits = 0; bits < 4; ++bits) {
    const RunOptions options{
        .inputs = {{SimTime(0), InputKind::kLogical, 32, static_cast<double>(bits & 1)},
                   {SimTime(0), InputKind::kLogical, 27, static_cast<double>(bits >> 1)}}};
    ExpectValues({{"OL [15] = IL [32] AND IL [27]\n", "OL[15]", bits == 3 ? "1" : "0"},
                  {"OL [16] = IL [32] or IL [27]\n", "OL[16]", bits != 0 ? "1" : "0"},
                  {"VL[16] = IL[32] XOR IL[27]\n", "VL[16]", bits == 1 || bits == 2 ? "1" : "0"},
                  {"VL[16] = NOT IL[32]\n", "VL[16]", (bits & 1) == 0 ? "1" : "0"}},
                 options);
  }
}

// OPT-7.93, OPT-7.94, OPT-7.84: an INTEGER in a REAL place is converted; functions take their
// argument in parentheses, with blanks before them or not.
TEST(LanguageRun, NumericAssignments) {
  ExpectValues({{"VR[1]=1\n", "VR[1]", "1.0"},
                {"VI[2]=-7\nVR[0]=VI[2]\n", "VR[0]", "-7.0"},
                {"VR[5]=PI/2\nVR[0] = SIN (VR [5]) +8\n", "VR[0]", "9.0"},
                {"VI[2]=7\nVI[3]=VI[2]/2\n", "VI[3]", "3"}});
}

// OPT-B.42, OPT-7.54: every form of number, also with exponent; the comma of WORK 1,00 separates.
TEST(LanguageRun, FormsOfNumbers) {
  ExpectValues({{"VR[0]=5\n", "VR[0]", "5.0"},
                {"VR[0]=5.\n", "VR[0]", "5.0"},
                {"VR[0]=.5\n", "VR[0]", "0.5"},
                {"VR[0]=5.0\n", "VR[0]", "5.0"},
                {"VR[0]=5E2\n", "VR[0]", "500.0"},
                {"VR[0]=5.E-1\n", "VR[0]", "0.5"},
                {"VR[0]=.5E+1\n", "VR[0]", "5.0"},
                {"VR[0]=5.0 E 1\n", "VR[0]", "50.0"}});
  EXPECT_NEAR(RunText("DELAY .5\n").time_s, 0.5, 1e-9);
  EXPECT_EQ(CodeOf(RunText("WORKDEF 1,00 (5.,80.,0.,90.)\nWORK 1,0/ON\nWORK 1,00/OFF\n")), 0);
}

// OPT-B.39: what a variable shows and what the decompiler writes is the shortest form that reads
// back to the same value, with a decimal, without an exponent from 1E-4 to 1E7; integers have no
// point.
TEST(LanguageRun, RealsAreShownShort) {
  const std::pair<const char*, const char*> reals[] = {{"1262.139005", "1262.139"},
                                                       {"80.", "80.0"},
                                                       {"-0.5", "-0.5"},
                                                       {"0.0001", "0.0001"},
                                                       {"0.00009", "9.0E-5"},
                                                       {"9999999.", "9999999.0"},
                                                       {"1E7", "10000000.0"},
                                                       {"1.5E7", "1.5E7"},
                                                       {"33.333333", "33.333332"},
                                                       {"0.", "0.0"}};
  for (const auto& [written, shown] : reals) {
    EXPECT_EQ(Value("VR[0]=" + std::string(written) + "\n", "VR[0]"), shown) << written;
    EXPECT_EQ(Value("VR[0]=" + std::string(shown) + "\nVL[0]=VR[0]=" + written + "\n", "VL[0]"),
              "1");
  }
  EXPECT_EQ(Value("VI[2]=5\n", "VI[2]"), "5");
  EXPECT_EQ(Value("VI[2]=80.\n", "VI[2]"), "80");
}

// OPT-W.73, OPT-7.57: PI is 3.14159, by itself, declared, and in expressions.
TEST(LanguageRun, PiIsFiveDecimals) {
  ExpectValues({{"VR[0]=PI\n", "VR[0]", "3.14159"},
                {"DECLARE P = PI\nVR[0]=P\n", "VR[0]", "3.14159"},
                {"VR[30]=PI/2\n", "VR[30]", "1.570795"},
                {"VR[0]=2*PI\n", "VR[0]", "6.28318"}});
  EXPECT_EQ(CodeOf(RunText("MOVE (1000.,1000.,-50.,PI/2,0.)\n")), 0);
  EXPECT_NEAR(RunText("MOVE (1000.,1000.,-50.,PI/2,0.)\n").end.axes.a_rad, 1.570795, 1e-6);
}

// OPT-B.47: overflow, division by zero and domain errors: nothing is assigned, and ERR catches
// them.
TEST(LanguageRun, ArithmeticErrorsAreCaught) {
  const std::pair<const char*, const char*> errors[] = {
      {"VR[1]=1/0", "7201"},       {"VR[1]=5 MOD 0", "7201"},  {"VI[1]=32767+1", "7203"},
      {"VR[1]=1E18*100.", "7202"}, {"VR[1]=SQRT(-1)", "7204"}, {"VR[1]=LN(0)", "7204"}};
  for (const auto& [statement, code] : errors) {
    const Ran ran = RunText("VR[1]=4.5\nVI[1]=4\nERR 900\n" + std::string(statement) +
                                "\nVI[5]=1\nENDTASK\n900 VI[4]=VI[99]\n",
                            {.variables = {"VR[1]", "VI[1]", "VI[4]", "VI[5]"}});
    EXPECT_EQ(CodeOf(ran), 0);
    EXPECT_EQ(ran.variables.at("VI[4]"), code) << statement;
    EXPECT_EQ(ran.variables.at("VR[1]") + ran.variables.at("VI[1]"), "4.54");
    EXPECT_EQ(ran.variables.at("VI[5]"), "0");
  }
}

// OPT-B.49, OPT-7.46: the first eight characters of a name count when the program runs.
TEST(LanguageRun, NamesAreCut) {
  ExpectValues({{"DECLARE POSITION1 = VR[1]\nPOSITION = 5.\n", "VR[1]", "5.0"}});
}

// OPT-7.19, OPT-7.16, OPT-E.7008: of the labels of a GOTO only the one that is taken must exist.
TEST(LanguageRun, OnlyTheTakenLabelMustExist) {
  const std::string text = "GOTO VI[2] (20,999)\nVI[3]=9\nENDTASK\n20 VI[3]=2\n";
  ExpectValues({{"VI[2]=1\n" + text, "VI[3]", "2"}, {"VI[2]=3\n" + text, "VI[3]", "9"}});
  EXPECT_EQ(CodeOf(RunText("VI[2]=2\n" + text)), 60);
  EXPECT_EQ(CodeOf(RunText("IF VL[1] THEN 99 ELSE 5\n5 VI[2]=1\n")), 0);
  EXPECT_EQ(CodeOf(RunText("IF VL[1] THEN 5 ELSE 99\n5 VI[2]=1\n")), 60);
}

// OPT-7.108: a REAL is truncated as a program number and as the value of ASSIGN.
TEST(LanguageRun, RealNumbersOfPrograms) {
  const RunOptions options{.programs = {{46, "VI[3]=46\n"}, {47, "VI[3]=47\n"}}};
  ExpectValues(
      {{"VR[1]=46.9\nGO VR[1]\n", "VI[3]", "46"},
       {"VR[1]=46.9\nCALL VR[1]\n", "VI[3]", "46"},
       {"VR[1]=5.9\nASSIGN VL[22]=VR[1] /8\nVI[3]=0\nIF VL[22] AND VL[24] AND NOT VL[23] THEN 5\nENDTASK\n"
        "5 VI[3]=1\n",
        "VI[3]", "1"}},
      options);
}

// OPT-B.86, OPT-7.02: the number of GO ends at the attribute, that of CALL at its parameters.
TEST(LanguageRun, NumbersOfProgramsEndWhereTheyShould) {
  const RunOptions options{.programs = {{46, "VI[3]=46\n"}, {45, "VR[3]=PAR[0]\n"}}};
  ExpectValues({{"GO 46/C\n", "VI[3]", "46"}, {"CALL 45(7.)\n", "VR[3]", "7.0"}}, options);
}

// OPT-7.28, OPT-B.50: each of the six values of SYSDEF is its own; the word alone cancels.
TEST(LanguageRun, ValuesOfSysdef) {
  const auto tip = [](const std::string& text) {
    return RunText("COORD ABSOL\n" + text + "MOVE (10.,20.,-500.,0.,0.)\n").end.tip.tip;
  };
  const auto near = [](const motion::MachinePoint& at, const motion::MachineVector& wanted) {
    EXPECT_NEAR(at.x(), wanted.x(), 1e-3);
    EXPECT_NEAR(at.y(), wanted.y(), 1e-3);
    EXPECT_NEAR(at.z(), wanted.z(), 1e-3);
  };
  near(tip("SYSDEF (50.8,101.6,0,0,0,0)\n"), {60.8, 121.6, -500.0});
  near(tip("SYSDEF (0,0,30.5,0,0,0)\n"), {10.0, 20.0, -469.5});
  // Quarter turns: Z takes (x,y,z) to (-y,x,z), Y to (z,y,-x), X to (x,-z,y).
  near(tip("SYSDEF (1000.,1000.,0,1.5707963,0,0)\n"), {980.0, 1010.0, -500.0});
  near(tip("SYSDEF (1000.,1000.,-500.,0,1.5707963,0)\n"), {500.0, 1020.0, -510.0});
  near(tip("SYSDEF (1000.,1000.,-500.,0,0,1.5707963)\n"), {1010.0, 1500.0, -480.0});
  near(tip("SYSDEF (50.8,101.6,0,0,0,0)\nSYSDEF\n"), {10.0, 20.0, -500.0});
}

// OPT-7.38, OPT-7.37, OPT-B.55: six values or none; a value that cannot be had leaves the old
// offset, whichever of the six it is. A warning only when all six are zero.
TEST(LanguageRun, SixValuesOfSysdef) {
  for (int n = 0; n < 6; ++n) {
    std::string failing = "SYSDEF (", one = "SYSDEF (";
    for (int k = 0; k < 6; ++k) {
      failing += std::string(k == 0 ? "" : ",") + (k == n ? "1./VR[0]" : "2.");
      one += std::string(k == 0 ? "" : ",") + (k == n ? "0.001" : "0.");
    }
    const Ran ran = RunText("COORD ABSOL\nSYSDEF (50.,60.,0.,0.,0.,0.)\nERR 9\n" + failing +
                            ")\nENDTASK\n9 MOVE (10.,20.,-500.,0.,0.)\n");
    EXPECT_NEAR(ran.end.tip.tip.x(), 60.0, 1e-4) << failing;
    EXPECT_NEAR(ran.end.tip.tip.y(), 80.0, 1e-4) << failing;
    EXPECT_FALSE(RunText(one + ")\n").Told("E7311")) << one;
  }
  EXPECT_TRUE(RunText("SYSDEF (0,0,0,0,0,0)\n").Told("E7311"));
  EXPECT_FALSE(RunText("SYSDEF\n").Told("E7311"));
}

// OPT-2.56: a label of /TIME that does not exist matters only when the time runs out.
TEST(LanguageRun, TheLabelOfTimeIsLookedUpLate) {
  const std::string move = kThere + "MOVE (1050.,1000.,-400.,0.,0.)/TIME (";
  EXPECT_EQ(CodeOf(RunText(move + "60., 999)\nVI[2]=1\n")), 0);
  const Ran late = RunText(move + "0.5, 999)\nVI[2]=1\n", {.variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(late), 60);
  EXPECT_EQ(late.variables.at("VI[2]"), "0");
}

// OPT-2.50, OPT-2.48: at a piercing point /FLY stays for WORK 0 and for WORK 1 with a DELAY of 0:
// the beam comes on at the passage; WORK 1 with a dwell cancels it, and so does a DELAY behind
// WORK 0.
TEST(LanguageRun, FlyAtAPiercingPoint) {
  const auto pierce = [](const std::string& between) {
    return RunText("WORKDEF 1,0 (8.,75.,0.,50.)\nWORKDEF 1,1 (8.,75.,1.,50.)\n" + kThere +
                   "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n" + between +
                   "MOVE (1100.,1100.,-400.,0.,0.)\nWORK 0,0/OFF\nWORK 1,0/OFF\nWORK 1,1/OFF\n");
  };
  const motion::MachinePoint corner{1100.0, 1000.0, -400.0};
  for (const char* flying : {"WORK 0,0/ON\n", "WORK 1,0/ON\n"}) {
    const Ran ran = pierce(flying);
    EXPECT_EQ(ran.Count("E7304"), 0) << flying;
    EXPECT_NEAR(ran.DistanceTo(corner), 1.358847515, 1e-5);  // case C01
    EXPECT_NEAR(ran.First("shutter open").at_s, ToSeconds(ran.moves[1].at), 1e-6);
  }
  for (const char* standing :
       {"WORK 1,1/ON\n", "WORK 0,0/ON\nDELAY 1\n", "WORK 1,0/ON\nDELAY 1\n"}) {
    const Ran ran = pierce(standing);
    EXPECT_EQ(ran.Count("E7304"), 1) << standing;
    EXPECT_LT(ran.DistanceTo(corner), 1e-4);
  }
  EXPECT_EQ(pierce("WORK 1,1/ON\n").Count("wait pierce 1.0"), 1);
}

// OPT-3.07: the values of a WORKDEF are those of its own moment, and a REAL schedule is truncated.
TEST(LanguageRun, WorkdefTakesItsValuesAtOnce) {
  EXPECT_TRUE(RunText("VR[30]=11.\nWORKDEF 2,0 (VR[30])\nVR[30]=12.\nWORK 2,0/ON\nWORK 2,0/OFF\n")
                  .Told("schedule 11"));
  EXPECT_TRUE(RunText("VR[30]=11.9\nWORKDEF 2,0 (VR[30])\nWORK 2,0/ON\nWORK 2,0/OFF\n")
                  .Told("schedule 11"));
  const Ran ran = RunText(
      "VR[1]=8.\nVR[2]=75.\nVR[3]=1.5\nVR[4]=50.\nWORKDEF 1,0 (VR[1],VR[2],VR[3],VR[4])\n"
      "VR[1]=1.\nVR[2]=1.\nVR[3]=1.\nVR[4]=1.\nWORK 1,0/ON\nSPEED 8\nCOORD ABSOL\nPATH LIN\n"
      "MOVE (121.02,2201.2,-350.,0.,0.)\nWORK 1,0/OFF\n");
  EXPECT_TRUE(ran.Told("beam on 50.0"));
  EXPECT_TRUE(ran.Told("wait pierce 1.5"));
  EXPECT_NEAR(ran.parts.back().PowerAt(1.0), 75.0, 1e-9);
}

// OPT-3.05: what each value of WORKDEF 1 means: power 95 at 4.5 % of the machine's speed (22.5
// mm/s), before it 1.2 s with the shutter open at 99 %. At 2.25 % the power is half.
TEST(LanguageRun, MeaningOfTheValuesOfWorkdef) {
  const auto cut = [](const std::string& speed) {
    return RunText("VR[65]=4.5\nVR[66]=95.\nVR[67]=1.2\nVR[68]=99.\n" + kThere +
                   "WORKDEF 1,01 (VR[65],VR[66],VR[67],VR[68])\nWORK 1,01/ON\nSPEED " + speed +
                   "\nMOVE (1045.,1000.,-400.,0.,0.)\nWORK 1,01/OFF\n");
  };
  const Ran full = cut("VR[65]");
  EXPECT_EQ(full.First("shutter open").at_s, full.First("beam on 99.0").at_s);
  EXPECT_TRUE(full.Told("wait pierce 1.2"));
  EXPECT_NEAR(full.parts.back().SpeedAt(1.0), 22.5, 1e-9);
  EXPECT_NEAR(full.parts.back().PowerAt(1.0), 95.0, 1e-9);
  EXPECT_NEAR(cut("2.25").parts.back().PowerAt(1.0), 47.5, 1e-9);
}

// OPT-2.43: the order of attributes changes nothing of the run: it waits for the input, and the tip
// passes the corner both ways.
TEST(LanguageRun, OrderOfAttributes) {
  const auto run = [](const std::string& attributes) {
    return RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)" + attributes +
                       "\nMOVE (1100.,1100.,-400.,0.,0.)\n",
                   {.inputs = {{At(9.0), InputKind::kLogical, 16, 1.0}}});
  };
  const Ran one = run("/FLY/START (IL[16])"), other = run("/START (IL[16]) /FLY");
  EXPECT_EQ(one.end.time, other.end.time);
  EXPECT_EQ(one.told, other.told);
  for (const Ran& ran : {one, other}) {
    EXPECT_GE(ToSeconds(ran.parts[1].done.start), 9.0);
    EXPECT_NEAR(ran.DistanceTo({1100.0, 1000.0, -400.0}), 1.358847515, 1e-5);  // case C01
  }
}

// OPT-7.27: WAIT is over at once when its condition is true already.
TEST(LanguageRun, AWaitThatIsTrueTakesNoTime) {
  EXPECT_EQ(RunText("VI[2]=1\nWAIT VI[2]\n").time_s, 0.0);
  EXPECT_EQ(RunText("WAIT (NOT IL[16])\n").waits.size(), 0U);
}

// OPT-9.22, OPT-9.23, OPT-9.27, OPT-B.46: DEFINE decides about each parameter by itself: 2.7 as
// FLOAT, INT and LOGIC.
TEST(LanguageRun, TypesOfParameters) {
  const Ran ran = RunText(
      "CALL 45 (2.7,-2.7,2.7,0.,ON,OFF)\n",
      {.programs = {{45,
                     "DEFINE PAR[1] = INT\nDEFINE PAR[2] = LOGIC\nDEFINE PAR[3] = LOGIC\n"
                     "DEFINE PAR[5] = INT\nVR[0]=PAR[0]\nVR[1]=PAR[1]\nVL[2]=PAR[2]\nVL[3]=PAR[3]\n"
                     "VR[4]=PAR[4]\nVR[5]=PAR[5]\nVR[6]=PAR[6]\nPAR[1]=3.9\nVR[7]=PAR[1]\n"}},
       .variables = {"VR[0]", "VR[1]", "VL[2]", "VL[3]", "VR[4]", "VR[5]", "VR[6]", "VR[7]"}});
  const std::map<std::string, std::string> wanted = {
      {"VR[0]", "2.7"}, {"VR[1]", "-2.0"}, {"VL[2]", "1"},   {"VL[3]", "0"},
      {"VR[4]", "1.0"}, {"VR[5]", "0.0"},  {"VR[6]", "0.0"}, {"VR[7]", "3.0"}};
  EXPECT_EQ(ran.variables, wanted);
}

// OPT-9.20, OPT-9.21: eight parameters, in their order, for CALL and for FUNCTION.
TEST(LanguageRun, EightParametersInOrder) {
  std::string callee;
  RunOptions options;
  for (int n = 0; n < 8; ++n) {
    callee += "VR[" + std::to_string(n) + "]=PAR[" + std::to_string(n) + "]\n";
    options.variables.push_back("VR[" + std::to_string(n) + "]");
  }
  options.programs = {{45, callee}};
  for (const std::string word : {"CALL", "FUNCTION"}) {
    const Ran ran = RunText(word + " 45 (1.,2.,3.,4.,5.,6.,7.,8.)\n", options);
    for (int n = 0; n < 8; ++n) {
      EXPECT_EQ(ran.variables.at("VR[" + std::to_string(n) + "]"), std::to_string(n + 1) + ".0")
          << word;
    }
  }
}

// OPT-6.15, OPT-6.11, OPT-6.16: program 0, or none, is the module in which BREAK and SIMUL stand.
TEST(LanguageRun, BreakAndSimulWithoutAProgram) {
  for (const std::string none : {"", ",0"}) {
    RunOptions options{.programs = {{44, "BREAK 2" + none + "\nVI[2]=1\nVI[2]=2\n"}}};
    EXPECT_EQ(RunText("FUNCTION 44\nVI[3]=1\nVI[3]=2\n", options).First("halt BREAK").program, 44);
    const Ran arming = RunText("SIMUL 2" + none + "\nVI[2]=1\n");
    EXPECT_NEAR(RunText("DELAY 1\nDELAY 2\n", {.machine_state = arming.machine_state}).time_s, 2.0,
                1e-9);
  }
  const Ran named =
      RunText("BREAK 1,44\nFUNCTION 44\nVI[3]=1\n", {.programs = {{44, "VI[2]=1\nVI[2]=2\n"}}});
  EXPECT_EQ(named.First("halt BREAK").program, 44);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::language_run
