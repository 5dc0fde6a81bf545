#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// Both sides of every limit that the control looks at when a program runs: the last legal value,
// and the first that is refused.
namespace rmlcell::optimo::testing::limit_rules {
namespace {

using machine::OutcomeKind;

// What one value does: the code that the run ends with, 0 for none.
int CodeWith(const std::string& value, const std::string& text, const RunOptions& options = {}) {
  std::string whole = text;
  for (std::size_t at = whole.find('?'); at != std::string::npos; at = whole.find('?')) {
    whole.replace(at, 1, value);
  }
  return CodeOf(RunText(whole, options));
}

struct Bound {
  std::string text;  // '?' is the value
  std::vector<std::string> legal;
  std::vector<std::string> refused;
  int code = 7205;
  RunOptions options{};
};

void Expect(const Bound& bound) {
  for (const std::string& value : bound.legal) {
    EXPECT_EQ(CodeWith(value, bound.text, bound.options), 0) << value << " in\n" << bound.text;
  }
  for (const std::string& value : bound.refused) {
    EXPECT_EQ(CodeWith(value, bound.text, bound.options), bound.code) << value << " in\n"
                                                                      << bound.text;
  }
}

// OPT-2.35, OPT-E.7205: SPEED, ACCEL and OVERSH: 0 and 100 are legal, what is beyond is not.
TEST(LimitRules, PercentagesOfMotion) {
  for (const std::string word : {"SPEED", "ACCEL", "OVERSH"}) {
    Expect({"VR[0]=?\n" + word + " VR[0]\n", {"0.", "100."}, {"-0.001", "100.001", "1E15"}});
  }
}

// OPT-2.35: the value goes to its own instruction: SPEED 20 for 100 mm/s, ACCEL 50 for the longer
// ramp (2 sqrt(v / j), j half), OVERSH 50 for the smaller corner of case C02.
TEST(LimitRules, EachPercentageIsItsOwn) {
  const std::string line = "COORD ABSOL\nPATH LIN\nVR[0]=20.\nVR[1]=50.\nSPEED VR[0]\n";
  const std::string move = "MOVE (521.02,2201.2,-350.,0.,0.)\n";
  EXPECT_NEAR(RunText(line + move).time_s, 5.0 + 2.0 * std::sqrt(100.0 / 40000.0) + kSettle_s,
              1e-6);
  EXPECT_NEAR(RunText(line + "SPEED 10\nACCEL VR[1]\n" + move).time_s,
              10.0 + 2.0 * std::sqrt(50.0 / 20000.0) + kSettle_s, 1e-6);
  const Ran corner = RunText(kThere +
                             "VR[1]=50.\nOVERSH VR[1]\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
                             "MOVE (1100.,1100.,-400.,0.,0.)\n");
  EXPECT_NEAR(corner.DistanceTo({1100.0, 1000.0, -400.0}), 0.480425146, 1e-5);
}

// OPT-3.08, OPT-E.7205: the four values of WORKDEF 1.
TEST(LimitRules, ValuesOfWorkdef) {
  Expect({"VR[0]=?\nWORKDEF 1,0 (VR[0],80.,1.,90.)\n", {"0.001", "100."}, {"0.", "-1.", "100.01"}});
  Expect({"VR[0]=?\nWORKDEF 1,0 (5.,VR[0],1.,90.)\n", {"0.", "100."}, {"-0.01", "100.01"}});
  Expect({"VR[0]=?\nWORKDEF 1,0 (5.,80.,VR[0],90.)\n", {"0.", "1000."}, {"-0.01"}});
  Expect({"VR[0]=?\nWORKDEF 1,0 (5.,80.,1.,VR[0])\n", {"0.", "100."}, {"-0.01", "100.01"}});
}

// OPT-3.06, OPT-3.07, OPT-E.7403: schedules are 1 to 63, after truncation.
TEST(LimitRules, SchedulesOfWorkdef) {
  Expect({"VR[0]=?\nWORKDEF 2,0 (VR[0])\n",
          {"1.", "63.", "63.9"},
          {"0.", "0.9", "64.", "-5.", "1E9"},
          7403});
  Expect(
      {"VR[0]=?\nWORKDEF 1,0 (5.,80.,1.,90.,VR[0])\n", {"1.", "63."}, {"0.", "64.", "-1."}, 7403});
}

// OPT-3.01, OPT-3.02, OPT-E.7402: every process from 0 to 9 of every kind can be defined and used.
TEST(LimitRules, AllProcesses) {
  for (int p = 0; p <= 9; ++p) {
    const std::string n = std::to_string(p);
    EXPECT_EQ(CodeOf(RunText("WORKDEF 0," + n + "\nWORK 0," + n + "/ON\nWORK 0," + n + "/OFF\n")),
              0);
    EXPECT_EQ(CodeOf(RunText("WORKDEF 1," + n + " (5.,80.,0.,90.)\nWORK 1," + n + "/ON\nWORK 1," +
                             n + "/OFF\n")),
              0);
    EXPECT_EQ(
        CodeOf(RunText("WORKDEF 2," + n + " (15)\nWORK 2," + n + "/ON\nWORK 2," + n + "/OFF\n")),
        0);
    // OPT-3.10: only 0,0 needs none.
    EXPECT_EQ(CodeOf(RunText("WORK 0," + n + "/ON\nWORK 0," + n + "/OFF\n")), p == 0 ? 0 : 7401);
    EXPECT_EQ(CodeOf(RunText("WORK 1," + n + "/ON\n")), 7401);
    EXPECT_EQ(CodeOf(RunText("WORK 2," + n + "/ON\n")), 7401);
  }
  // One kind does not define the other, nor one number the next.
  EXPECT_EQ(CodeOf(RunText("WORKDEF 1,3 (5.,80.,0.,90.)\nWORK 1,2/ON\n")), 7401);
  EXPECT_EQ(CodeOf(RunText("WORKDEF 0,3\nWORK 1,3/ON\n")), 7401);
}

// OPT-3.45, OPT-B.59, OPT-2.54, OPT-E.7205: times are 0 or more.
TEST(LimitRules, Times) {
  Expect({"VR[0]=?\nDELAY VR[0]\n", {"0.", "0.01"}, {"-0.001"}});
  Expect({"VR[0]=?\nTIMER (VR[0],9)\nENDTASK\n9 RETURN\n", {"0.", "5."}, {"-0.001"}});
  Expect({kThere + "VR[0]=?\nMOVE (1010.,1000.,-400.,0.,0.)/TIME (VR[0],9)\nENDTASK\n9 RETURN\n",
          {"0.", "5."},
          {"-0.001"}});
  EXPECT_EQ(RunText("DELAY 0\n").time_s, 0.0);
  EXPECT_TRUE(RunText("DELAY 0\n").waits.empty());
}

// OPT-3.61, OPT-E.7505: SETERR takes 1 to 9999, computed values too; they are truncated.
TEST(LimitRules, Seterr) {
  Expect(
      {"VR[0]=?\nSETERR VR[0]\n", {"1.", "9999.", "9999.5"}, {"0.", "0.9", "-1.", "10000."}, 7505});
  EXPECT_TRUE(RunText("VI[2]=9999\nSETERR VI[2]\n").Told("ERROR 9999"));
  EXPECT_TRUE(RunText("SETERR 1\n").Told("ERROR 1"));
  EXPECT_FALSE(RunText("VI[2]=10000\nSETERR VI[2]\n").Told("ERROR 10000"));
}

// OPT-7.102, OPT-7.103, OPT-E.7206: the value fits in n places, and they end at 99.
TEST(LimitRules, AssignGroups) {
  const auto assign = [](int first, int width, int code, const std::vector<std::string>& legal,
                         const std::vector<std::string>& refused) {
    for (const std::string group : {"OL", "VL"}) {
      Expect({"VI[2]=?\nASSIGN " + group + "[" + std::to_string(first) + "]=VI[2] /" +
                  std::to_string(width) + "\n",
              legal, refused, code});
    }
  };
  assign(16, 1, 7206, {"0", "1"}, {"2", "-1"});
  assign(16, 4, 7206, {"15"}, {"16"});
  assign(16, 15, 7206, {"32767"}, {"-32768"});
  assign(16, 16, 7206, {"32767"}, {"-1"});
  assign(84, 16, 7206, {"0"}, {});
  assign(99, 1, 7206, {"1"}, {});
  const Ran last = RunText("ASSIGN VL[92]=129 /8\nVI[2]=0\nASSIGN VL[91]=VI[2] /1\n",
                           {.variables = {"VL[92]", "VL[93]", "VL[98]", "VL[99]"}});
  EXPECT_EQ(last.variables.at("VL[92]") + last.variables.at("VL[93]") +
                last.variables.at("VL[98]") + last.variables.at("VL[99]"),
            "1001");
}

// OPT-7.102: n places, and none beside them.
TEST(LimitRules, AGroupHasItsPlaces) {
  const Ran ran =
      RunText("VL[11]=ON\nVL[16]=ON\nVI[2]=6\nASSIGN VL[12]=VI[2] /4\n",
              {.variables = {"VL[11]", "VL[12]", "VL[13]", "VL[14]", "VL[15]", "VL[16]"}});
  std::string values;
  for (const auto& [name, value] : ran.variables) values += value;
  EXPECT_EQ(values, "101101");
}

// OPT-7.103: of a group that does not fit nothing is written.
TEST(LimitRules, ARefusedGroupIsNotWritten) {
  const Ran ran =
      RunText("VI[2]=17\nASSIGN VL[12]=VI[2] /4\n", {.variables = {"VL[12]", "VL[16]", "VI[99]"}});
  EXPECT_EQ(ran.variables.at("VL[12]") + ran.variables.at("VL[16]"), "00");
  EXPECT_EQ(ran.variables.at("VI[99]"), "7206");
}

// OPT-7.06, OPT-E.7101, OPT-E.7203: programs are 1 to 99; a number beyond 16 bits is none at all.
TEST(LimitRules, ProgramNumbers) {
  const RunOptions options{.programs = {{99, "VI[3]=1\n"}, {2, "VI[3]=1\n"}}};
  for (const std::string word : {"CALL", "GO"}) {
    Expect(
        {"VI[2]=?\n" + word + " VI[2]\n", {"2", "99"}, {"0", "100", "-1", "199"}, 7101, options});
    Expect({"VR[2]=?\n" + word + " VR[2]\n", {"2.9", "99.9"}, {"0.9", "100."}, 7101, options});
    Expect({"VR[2]=?\n" + word + " VR[2]\n", {}, {"40000."}, 7203, options});
    Expect({"VI[2]=?\n" + word + " VI[2]\n", {}, {"3"}, 7102, options});
  }
}

// A breakpoint of whatever program has the control look at each instruction by itself.
const machine::ProgramStep kElsewhere{.program = 99, .step = 1};

// OPT-7.17, OPT-7.18: the k-th label from 1 to the number of labels; 0, less or more go on.
TEST(LimitRules, TheComputedGoto) {
  const std::string text =
      "VR[2]=?\nGOTO VR[2] (20,30,40)\nVI[3]=9\nENDTASK\n20 VI[3]=2\nENDTASK\n30 VI[3]=3\nENDTASK\n"
      "40 VI[3]=4\n";
  const std::pair<const char*, const char*> cases[] = {
      {"0.", "9"}, {"0.9", "9"}, {"1.", "2"}, {"1.9", "2"}, {"2.", "3"},
      {"3.", "4"}, {"3.9", "4"}, {"4.", "9"}, {"-1.", "9"}, {"1E18", "9"}};
  for (const auto& [value, wanted] : cases) {
    std::string whole = text;
    whole.replace(whole.find('?'), 1, value);
    EXPECT_EQ(Value(whole, "VI[3]"), wanted) << value;
    EXPECT_EQ(Value(whole, "VI[3]", {.breakpoint = kElsewhere}), wanted) << value;
  }
}

// OPT-7.21, OPT-E.7503: GOSUB_DEPTH GOSUBs are legal, one more is not; each module counts its own.
TEST(LimitRules, GosubDepth) {
  const std::string text =
      "VI[3]=?\n10 VI[2]=VI[2]+1\nIF VI[2] > VI[3] THEN 20\nGOSUB 10\n20 ENDTASK\n";
  Expect({text, {"16"}, {"17"}, 7503});
  Expect({text, {"16"}, {"17"}, 7503, {.breakpoint = kElsewhere}});
  Expect({text, {"3"}, {"4"}, 7503, {.parameters = {{"GOSUB_DEPTH", "3"}}}});
  const Ran inside = RunText("GOSUB 10\nENDTASK\n10 FUNCTION 44\nRETURN\n",
                             {.programs = {{44, "GOSUB 10\nENDTASK\n10 VI[2]=7\nRETURN\n"}},
                              .parameters = {{"GOSUB_DEPTH", "1"}},
                              .variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(inside), 0);
  EXPECT_EQ(inside.variables.at("VI[2]"), "7");
}

// OPT-7.61, OPT-7.78, OPT-E.7203: what is truncated into 16 bits fits.
TEST(LimitRules, TruncatedIntegers) {
  for (const RunOptions& options : {RunOptions{}, RunOptions{.breakpoint = kElsewhere}}) {
    Expect({"VR[1]=?\nVI[1]=VR[1]\n",
            {"32767.", "32767.9", "-32768.", "-32768.9"},
            {"32768.", "-32769."},
            7203,
            options});
  }
}

// OPT-B.22, OPT-E.7307: at SPEED above 0 and ACCEL of 0.1 and more something moves, or a MOVE to
// where the machine stands is no error.
TEST(LimitRules, TheLeastMotion) {
  Expect({kThere + "ACCEL ?\nMOVE (1000.1,1000.,-400.,0.,0.)\n",
          {"0.1", "0.2"},
          {"0.", "0.0999"},
          7307});
  Expect({kThere + "SPEED ?\nMOVE (1000.1,1000.,-400.,0.,0.)\n", {"0.1", "0.01"}, {"0."}, 7307});
  Expect({kThere + "SPEED ?\nMOVE (1000.,1000.,-400.,0.,0.)\n", {"0."}, {}});
}

// OPT-2.27, OPT-E.348: any radius above 0 is one, also of a hole that has no /VIA.
TEST(LimitRules, TheRadiusOfAHole) {
  for (const std::string via : {"", "/VIA (1000.,1000.,-300.,0.,0.)"}) {
    Expect({"COORD ABSOL\nVR[0]=?\nPATH HOLE (VR[0])\nMOVE (1000.,1000.,-400.,0.,0.)" + via + "\n",
            {"0.001", "50."},
            {"0.", "-1."},
            348});
  }
}

// OPT-2.48: behind a /FLY move the shortest way is passed into; a MOVE to the same place is none.
TEST(LimitRules, TheShortestWayBehindAPassage) {
  const auto cancelled = [](const std::string& y) {
    return RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.," + y +
                   ",-400.,0.,0.)\n")
        .Count("E7304");
  };
  EXPECT_EQ(cancelled("1000.5"), 0);
  EXPECT_EQ(cancelled("1000."), 1);
}

// OPT-4.38, OPT-E.7320: 100 % is not limited, more is, and once a run; the machine never goes
// faster.
TEST(LimitRules, TheSpeedOfTheMachine) {
  const std::string text =
      "COORD ABSOL\nPATH LIN\nSPEED ?\nMOVE (1021.02,2201.2,-350.,0.,0.)\n"
      "MOVE (21.02,2201.2,-350.,0.,0.)\n";
  const auto with = [&](const std::string& speed, double percent) {
    std::string whole = text;
    whole.replace(whole.find('?'), 1, speed);
    return RunText(whole, {.override_percent = percent});
  };
  EXPECT_EQ(with("100", 100.0).Count("E7320"), 0);
  EXPECT_EQ(with("50", 145.0).Count("E7320"), 0);
  const Ran limited = with("100", 145.0);
  EXPECT_EQ(limited.Count("E7320"), 1);
  EXPECT_NEAR(limited.parts[0].SpeedAt(limited.parts[0].duration_s() / 2), 500.0, 1e-6);
  EXPECT_EQ(limited.time_s, with("100", 100.0).time_s);
  EXPECT_EQ(with("70", 145.0).Count("E7320"), 1);  // 101.5 %
  EXPECT_EQ(with("68.9", 145.0).Count("E7320"), 0);
}

// OPT-9.10, OPT-B.72, OPT-E.7106: an executable must be smaller than its limit: 16 bytes, 200 steps
// of 4, a target and two variables of 2, an operator of 1, and the end as a step of 4.
TEST(LimitRules, TheSizeOfAnExecutable) {
  std::string text;
  for (int n = 0; n < 200; ++n) text += "VR[1]=VR[2]+VR[3]\n";
  constexpr int kSize = 16 + 200 * (4 + 6 + 1) + 4;
  const auto with = [&](int limit) {
    return CodeOf(RunText(text, {.parameters = {{"EXECUTABLE_LIMIT", std::to_string(limit)}}}));
  };
  EXPECT_EQ(with(kSize), 7106);
  EXPECT_EQ(with(kSize + 1), 0);
}

// OPT-B.73, OPT-E.7109: objects and executables together may fill CMOS to its last byte, not
// beyond.
TEST(LimitRules, CmosToTheLastByte) {
  std::string text;
  for (int n = 0; n < 100; ++n) text += "VR[0]=VR[1]+1.5\n";
  RunOptions options{.programs = {{45, text}, {46, text}}};
  const machine::RunSetup setup = SetupOf("CALL 45\nCALL 46\n", options);
  const Ran free = RunText("CALL 45\nCALL 46\n", options);
  ASSERT_EQ(CodeOf(free), 0);
  std::size_t bytes = 0;
  for (const auto& [slot, program] : setup.programs) bytes += program.object->size();
  for (const auto& [slot, executable] : free.executables) bytes += executable.size();
  options.parameters = {{"CMOS_SIZE", std::to_string(bytes)}};
  EXPECT_EQ(CodeOf(RunText("CALL 45\nCALL 46\n", options)), 0);
  options.parameters = {{"CMOS_SIZE", std::to_string(bytes - 1)}};
  const Ran full = RunText("CALL 45\nCALL 46\n", options);
  EXPECT_EQ(CodeOf(full), 7109);
  EXPECT_EQ(full.outcome.place.step, 2);
  EXPECT_EQ(full.executables.size(), 2U);  // those of 1 and 45
  // What is stored already counts as well.
  options.executables[45] = free.executables.at(45);
  options.parameters = {{"CMOS_SIZE", std::to_string(bytes)}};
  EXPECT_EQ(CodeOf(RunText("CALL 45\nCALL 46\n", options)), 0);
  options.parameters = {{"CMOS_SIZE", std::to_string(bytes - 1)}};
  EXPECT_EQ(CodeOf(RunText("CALL 45\nCALL 46\n", options)), 7109);
}

// OPT-B.67, OPT-E.7901: as many steps as the budget has, not one more.
TEST(LimitRules, TheBudgetOfSteps) {
  const std::string text = "VI[2]=1\nVI[3]=1\nVI[4]=1\nVI[5]=1\n";
  EXPECT_EQ(CodeOf(RunText(text, {.budget = {.steps = 4}})), 0);
  const Ran cut = RunText(text, {.variables = {"VI[4]", "VI[5]"}, .budget = {.steps = 3}});
  EXPECT_EQ(CodeOf(cut), 7901);
  EXPECT_EQ(cut.steps, 3U);
  EXPECT_EQ(cut.variables.at("VI[4]") + cut.variables.at("VI[5]"), "10");
}

// OPT-B.67, OPT-E.7902: a run that takes just the budget of time is within it.
TEST(LimitRules, TheBudgetOfTime) {
  const auto with = [](std::chrono::milliseconds time) {
    return CodeOf(RunText("DELAY 5\n", {.budget = {.virtual_time = time}}));
  };
  EXPECT_EQ(with(std::chrono::milliseconds(5000)), 0);
  EXPECT_EQ(with(std::chrono::milliseconds(4999)), 7902);
  const Ran loop =
      RunText("10 DELAY 1\nGOTO 10\n", {.budget = {.virtual_time = std::chrono::seconds(5)}});
  EXPECT_EQ(CodeOf(loop), 7902);
  EXPECT_NEAR(loop.time_s, 5.0, 1e-9);
}

// OPT-9.08, OPT-7.09: levels are counted where they are: four FUNCTIONs inside each other, again
// and again, are no fifth.
TEST(LimitRules, LevelsEndWithTheirModules) {
  const RunOptions options{.programs = {{41, "FUNCTION 42\nFUNCTION 42\n"},
                                        {42, "FUNCTION 43\n"},
                                        {43, "FUNCTION 44\nFUNCTION 44\n"},
                                        {44, "VI[2]=VI[2]+1\n"},
                                        {11, "CALL 12\nCALL 12\n"},
                                        {12, "VI[3]=VI[3]+1\n"}},
                           .variables = {"VI[2]", "VI[3]"}};
  const Ran ran = RunText("FUNCTION 41\nFUNCTION 41\nCALL 11\nCALL 11\nCALL 11\n", options);
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[2]"), "8");
  EXPECT_EQ(ran.variables.at("VI[3]"), "6");
}

}  // namespace
}  // namespace rmlcell::optimo::testing::limit_rules
