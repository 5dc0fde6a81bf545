#include "engine/optimo/offline/project.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

class Project : public testing::Test {
 protected:
  void Add(int slot, std::string_view text, bool inch = false) {
    bundle_.programs.push_back({slot, {std::to_string(slot) + (inch ? ".SI" : ".S"), text}, inch});
  }
  void AddSchedule(int number) { bundle_.schedules.push_back({.number = number, .name = {}}); }
  void Define(int kind, int process, std::vector<double> values) {
    bundle_.processes.push_back({kind, process, std::move(values), ""});
  }
  machine::TransferPlan Plan(bool insert = false) {
    return PlanTransfer(bundle_, {.insert_missing_definitions = insert});
  }
  // Numbers of the findings, without advice that is not about the project.
  std::vector<int> Findings(bool insert = false) {
    std::vector<int> numbers;
    for (const Diagnostic& d : Plan(insert).diagnostics) {
      const int number = Lookup(d.code).number;
      if (number != 7033 || d.rule == "OPT-7.39") numbers.push_back(number);
    }
    return numbers;
  }
  machine::ProjectBundle bundle_;
};

// OPT-8.69, OPT-8.68
TEST_F(Project, InchProgramsAreConverted) {
  Add(45, "PATH HOLE (.5)\n", true);
  Add(46, "PATH HOLE (12.7)\n");
  const machine::TransferPlan plan = Plan();
  ASSERT_TRUE(plan.ok);
  ASSERT_EQ(plan.programs.size(), 2U);
  EXPECT_EQ(plan.programs[0].source, "PATH HOLE (12.7)\n");
  EXPECT_EQ(plan.programs[0].object, plan.programs[1].object);
}

// OPT-8.71
TEST_F(Project, OneWrongProgramStopsAll) {
  Add(45, "SPEED 5\n");
  Add(46, "SPEED 101\n");
  Add(47, "SPEED 6\n");
  const machine::TransferPlan plan = Plan();
  EXPECT_FALSE(plan.ok);
  EXPECT_TRUE(plan.programs.empty());
  ASSERT_EQ(plan.diagnostics.size(), 1U);
  EXPECT_EQ(plan.diagnostics[0].program, 46);
  EXPECT_EQ(plan.diagnostics[0].where.line, 1);
}

// OPT-E.7861, OPT-1.10, OPT-E.7101
TEST_F(Project, NumbersAreUniqueAndInRange) {
  Add(45, "SPEED 5\n");
  Add(45, "SPEED 6\n");
  Add(100, "SPEED 7\n");
  EXPECT_EQ(Findings(), (std::vector<int>{7861, 7101}));
  EXPECT_FALSE(Plan().ok);
}

// OPT-E.7862
TEST_F(Project, SchedulesMustBeThere) {
  AddSchedule(11);
  Add(45,
      "WORKDEF 2,0 (11)\nWORKDEF 2,1 (12)\nWORKDEF 1,0 (8.,75.,1.,50.,13)\nWORKDEF 2,2 (VR[26])\n");
  EXPECT_EQ(Findings(), (std::vector<int>{7862, 7862}));
  EXPECT_FALSE(Plan().ok);
}

// OPT-3.44, OPT-8.68: only 1 to 63 are schedules that could be missing.
TEST_F(Project, TheFirstAndTheLastScheduleMayBeMissing) {
  for (const auto& [schedule, missing] :
       std::vector<std::pair<double, bool>>{{0, false}, {1, true}, {63, true}, {64, false}}) {
    bundle_ = {};
    Define(2, 0, {schedule});
    Add(45, "SPEED 5\n");
    const std::vector<int> numbers = Findings();
    EXPECT_EQ(std::ranges::count(numbers, 7862), missing ? 1 : 0) << schedule;
    EXPECT_EQ(std::ranges::count(numbers, 7403), missing ? 0 : 1) << schedule;
  }
}

// OPT-3.06: a program with a schedule that is none is the compiler's alone.
TEST_F(Project, SchedulesThatAreNoneAreNotMissing) {
  for (const char* text : {"WORKDEF 2,0 (0)\n", "WORKDEF 2,0 (64)\n"}) {
    bundle_ = {};
    Add(45, text);
    EXPECT_EQ(Findings(), (std::vector<int>{7403})) << text;
  }
}

// OPT-3.01, OPT-3.02, OPT-3.06, OPT-3.08
TEST_F(Project, DefinitionsAreChecked) {
  const auto errors = [](int kind, int process, std::vector<double> values) {
    std::vector<int> numbers;
    for (const Diagnostic& d : CheckProcess({kind, process, std::move(values), ""}))
      numbers.push_back(Lookup(d.code).number);
    return numbers;
  };
  EXPECT_TRUE(errors(1, 0, {6.5, 80, 1.5, 95}).empty());
  EXPECT_TRUE(errors(1, 9, {6.5, 80, 1.5, 95, 63}).empty());
  EXPECT_TRUE(errors(0, 0, {}).empty());
  EXPECT_EQ(errors(3, 0, {}), (std::vector<int>{7402}));
  EXPECT_EQ(errors(1, 10, {6.5, 80, 1.5, 95}), (std::vector<int>{7402}));
  EXPECT_EQ(errors(0, 0, {5}), (std::vector<int>{7019}));
  EXPECT_EQ(errors(1, 0, {5}), (std::vector<int>{7019}));
  EXPECT_EQ(errors(2, 0, {64}), (std::vector<int>{7403}));
  EXPECT_EQ(errors(2, 0, {0}), (std::vector<int>{7403}));
  EXPECT_EQ(errors(1, 0, {0, 80, 1.5, 95}), (std::vector<int>{7004}));
  EXPECT_EQ(errors(1, 0, {8, 101, -1, 95}), (std::vector<int>{7004, 7004}));
}

// OPT-3.01, OPT-3.02, OPT-3.06, OPT-3.07, OPT-3.08: both sides of each limit.
TEST_F(Project, DefinitionsEndWhereThoseOfTheLanguageDo) {
  struct Row {
    int kind, process;
    std::vector<double> values;
    std::vector<int> errors;
  };
  for (const Row& row : std::vector<Row>{
           {0, 9, {}, {}},
           {-1, 0, {}, {7402}},
           {0, -1, {}, {7402}},
           {2, 10, {5}, {7402}},
           {0, 0, {1}, {7019}},
           {1, 0, {8, 75, 1}, {7019}},
           {1, 0, {8, 75, 1, 50, 5, 6}, {7019}},
           {2, 0, {}, {7019}},
           {2, 0, {5, 6}, {7019}},
           {1, 0, {0.01, 0, 0, 0}, {}},
           {1, 0, {100, 100, 1e6, 100}, {}},
           {1, 0, {0, 75, 1, 50}, {7004}},
           {1, 0, {-0.01, 75, 1, 50}, {7004}},
           {1, 0, {100.01, 75, 1, 50}, {7004}},
           {1, 0, {8, -0.01, 1, 50}, {7004}},
           {1, 0, {8, 100.01, 1, 50}, {7004}},
           {1, 0, {8, 75, -0.01, 50}, {7004}},
           {1, 0, {8, 75, HUGE_VAL, 50}, {7004}},
           {1, 0, {8, 75, 1, -0.01}, {7004}},
           {1, 0, {8, 75, 1, 100.01}, {7004}},
           {1, 0, {8, 75, 1, 50, 1}, {}},
           {1, 0, {8, 75, 1, 50, 0}, {7403}},
           {1, 0, {8, 75, 1, 50, 64}, {7403}},
           {2, 0, {1}, {}},
           {2, 0, {63.99}, {}},
           {2, 0, {0.99}, {7403}},
           {2, 0, {64}, {7403}},
           {1, 0, {101, 101, -1, 101, 64}, {7004, 7004, 7004, 7004, 7403}},
       }) {
    std::vector<int> found;
    for (const Diagnostic& d : CheckProcess({row.kind, row.process, row.values, ""})) {
      found.push_back(Lookup(d.code).number);
      const std::string whose = "process definition " + std::to_string(row.kind) + "," +
                                std::to_string(row.process) + ": ";
      EXPECT_TRUE(d.detail.starts_with(whose)) << d.detail;
      EXPECT_TRUE(IsError(d.severity));
    }
    EXPECT_EQ(found, row.errors) << row.kind << "," << row.process << " " << row.values.size();
  }
}

// OPT-8.68, OPT-8.71: a definition that is wrong stops the transfer, and is none.
TEST_F(Project, WrongDefinitionsAreNone) {
  Define(2, 3, {});
  Define(1, 10, {6.5, 80, 1.5, 95});
  Define(1, 3, {0, 80, 1.5, 95});
  EXPECT_EQ(Findings(), (std::vector<int>{7019, 7402, 7004}));
  EXPECT_FALSE(Plan().ok);
  Add(45, "WORKDEF 1,3 (6.5,80.,1.5,95.)\n");
  EXPECT_EQ(Findings(), (std::vector<int>{7019, 7402, 7004, 7863}));
  EXPECT_EQ(Plan().diagnostics.back().detail, "the project has no definition of process 1,3");
}

// OPT-3.01, OPT-B.39: as canonical source has it; schedules are whole numbers.
TEST_F(Project, DefinitionsAreWrittenAsWorkdefs) {
  EXPECT_EQ(WorkdefText({0, 3, {}, ""}), "WORKDEF 0,3");
  EXPECT_EQ(WorkdefText({1, 0, {6.5, 80, 1.5, 95}, ""}), "WORKDEF 1,0 (6.5, 80.0, 1.5, 95.0)");
  EXPECT_EQ(WorkdefText({1, 9, {6.5, 80, 1.5, 95, 12}, ""}),
            "WORKDEF 1,9 (6.5, 80.0, 1.5, 95.0, 12)");
  EXPECT_EQ(WorkdefText({2, 5, {15}, ""}), "WORKDEF 2,5 (15)");
}

// OPT-3.11; 7863 is a code of our own
TEST_F(Project, DifferencesAreReported) {
  Define(1, 0, {6.5, 80, 1.5, 95});
  Add(45, "WORKDEF 1,0 (6.5, 80., 1.5, 95)\nWORKDEF 1,1 (1.,2.,3.,4.)\n");
  Add(46, "SPEED 5\nWORKDEF 1,0 (6.5, 81., 1.5, 95)\n");
  Add(47, "WORKDEF 1,0 (VR[65], 80., 1.5, 95)\n");
  const machine::TransferPlan plan = Plan();
  EXPECT_TRUE(plan.ok);
  ASSERT_EQ(plan.diagnostics.size(), 2U);
  EXPECT_EQ(plan.diagnostics[0].program, 45);
  EXPECT_EQ(plan.diagnostics[0].where.line, 2);
  EXPECT_EQ(plan.diagnostics[1].program, 46);
  EXPECT_EQ(plan.diagnostics[1].where.line, 2);
  EXPECT_EQ(plan.diagnostics[1].code, ErrorCode::kProjectProcess);
}

// OPT-3.09, OPT-3.10
TEST_F(Project, AWorkNeedsADefinition) {
  Add(45, "WORK 0,0/ON\nWORK 0,0/OFF\n");
  EXPECT_TRUE(Plan().ok);
  Add(46, "SPEED 5\nWORK 1,3/ON\nWORK 1,3/OFF\n");
  const machine::TransferPlan plan = Plan();
  EXPECT_FALSE(plan.ok);
  ASSERT_FALSE(plan.diagnostics.empty());
  EXPECT_EQ(plan.diagnostics[0].code, ErrorCode::kWorkdefMissing);
  EXPECT_EQ(plan.diagnostics[0].where.line, 2);
}

// OPT-3.09: it is the beam that needs one: WORK OFF does not, and of several ON the first is told.
TEST_F(Project, OnlyAWorkOnNeedsADefinition) {
  Add(45, "WORK 1,3/OFF\n");
  EXPECT_TRUE(Plan().ok);
  Define(1, 5, {6.5, 80, 1.5, 95});
  EXPECT_TRUE(Findings().empty());
  Add(46, "WORK 1,3/OFF\nWORK 1,3/ON\nWORK 1,3/OFF\nWORK 1,3/ON\nWORK 1,3/OFF\n");
  const machine::TransferPlan plan = Plan();
  ASSERT_FALSE(plan.diagnostics.empty());
  EXPECT_EQ(plan.diagnostics[0].code, ErrorCode::kWorkdefMissing);
  EXPECT_EQ(plan.diagnostics[0].program, 46);
  EXPECT_EQ(plan.diagnostics[0].where.line, 2);
}

// OPT-3.09: inserted at the beginning, so that every way to a WORK leads through it; comments stay.
TEST_F(Project, MissingDefinitionsAreInserted) {
  Define(1, 3, {6.5, 80, 1.5, 95});
  AddSchedule(11);
  Define(2, 0, {11});
  Add(45,
      "; part\nDECLARE V = 5\n7    SPEED V ; slow\n10   WORK 1,3 /ON ; cut\nWORK 1,3/OFF\n  WORK "
      "2,0/ON\n");
  const machine::TransferPlan plan = Plan(true);
  ASSERT_TRUE(plan.ok);
  EXPECT_EQ(
      plan.programs[0].source,
      "; part\nDECLARE V = 5\n     WORKDEF 1,3 (6.5, 80.0, 1.5, 95.0)\n     WORKDEF 2,0 (11)\n"
      "7    SPEED V ; slow\n10   WORK 1,3 /ON ; cut\nWORK 1,3/OFF\n  WORK 2,0/ON\n");
  EXPECT_EQ(plan.programs[0].object, MustCompile(plan.programs[0].source).object);
  const machine::TransferPlan without = Plan(false);
  EXPECT_TRUE(without.ok);
  EXPECT_EQ(without.programs[0].source.find("WORKDEF"), std::string::npos);
}

// OPT-3.09: the first WORK of the text is not the first that runs.
TEST_F(Project, InsertedDefinitionsAreReachedByJumps) {
  Define(1, 0, {8, 75, 1, 50});
  Add(61,
      "GOSUB 100\nENDTASK\n50 WORK 1,0/ON\nWORK 1,0/OFF\nRETURN\n100 WORK 1,0/ON\nWORK "
      "1,0/OFF\nRETURN\n");
  const machine::TransferPlan plan = Plan(true);
  ASSERT_TRUE(plan.ok);
  EXPECT_EQ(plan.programs[0].source.find("     WORKDEF 1,0 (8.0, 75.0, 1.0, 50.0)\nGOSUB 100"), 0U);
}

// OPT-9.12: what stands before TASK 1 does not run.
TEST_F(Project, InsertedDefinitionsStandBehindTask1) {
  Define(1, 0, {8, 75, 1, 50});
  Add(61, "VI[2]=1\nTASK 1\nWORK 1,0/ON\nWORK 1,0/OFF\n");
  const machine::TransferPlan plan = Plan(true);
  ASSERT_TRUE(plan.ok);
  EXPECT_EQ(
      plan.programs[0].source,
      "VI[2]=1\nTASK 1\n     WORKDEF 1,0 (8.0, 75.0, 1.0, 50.0)\nWORK 1,0/ON\nWORK 1,0/OFF\n");
}

// OPT-9.12: a TASK 1 with nothing behind it is no beginning, and neither is a last declaration.
TEST_F(Project, InsertedDefinitionsStandBeforeSomething) {
  Define(1, 0, {8, 75, 1, 50});
  const std::string work = "WORK 1,0/ON\nWORK 1,0/OFF\n",
                    inserted = "     WORKDEF 1,0 (8.0, 75.0, 1.0, 50.0)\n",
                    task = work + "TASK 1\n", declares = task + "DECLARE X = 5.\n";
  Add(61, task);
  Add(62, declares);
  const machine::TransferPlan plan = Plan(true);
  ASSERT_TRUE(plan.ok);
  EXPECT_EQ(plan.programs[0].source, inserted + task);
  EXPECT_EQ(plan.programs[1].source, task + inserted + "DECLARE X = 5.\n");
}

// OPT-3.12: a FUNCTION shares the WORKDEFs of its callers.
TEST_F(Project, FunctionsShareDefinitions) {
  Add(32, "WORKDEF 1,0 (6.5, 80., 1.5, 95)\nFUNCTION 44\n");
  Add(44, "WORK 1,0/ON\nWORK 1,0/OFF\n");
  EXPECT_TRUE(Plan().ok);
  Add(45, "WORK 1,0/ON\nWORK 1,0/OFF\n");
  EXPECT_FALSE(Plan().ok);
}

// OPT-7.39
TEST_F(Project, AllProgramsOrNoneUseSysdef) {
  Add(45, "COORD ABSOL\nSYSDEF (1.,2.,3.,0.,0.,0.)\nMOVE (1.,2.,3.,0.,0.)\n");
  Add(46, "COORD ABSOL\nMOVE (1.,2.,3.,0.,0.)\n");
  const machine::TransferPlan plan = Plan();
  EXPECT_TRUE(plan.ok);
  int found = 0;
  for (const Diagnostic& d : plan.diagnostics) {
    if (d.rule != "OPT-7.39") continue;
    ++found;
    EXPECT_EQ(d.program, 46);
  }
  EXPECT_EQ(found, 1);
}

// OPT-7.39: a program that moves before its own SYSDEF is reported for that, also when no other
// program uses it.
TEST_F(Project, MovesBeforeTheOwnSysdef) {
  Add(45,
      "COORD ABSOL\nMOVE (1.,2.,3.,0.,0.)\nSYSDEF (1.,2.,3.,0.,0.,0.)\nMOVE (1.,2.,3.,0.,0.)\n");
  Add(46, "SPEED 5\n");
  const machine::TransferPlan plan = Plan();
  const auto found =
      std::ranges::find(plan.diagnostics, std::string("OPT-7.39"), &Diagnostic::rule);
  ASSERT_NE(found, plan.diagnostics.end());
  EXPECT_EQ(found->program, 45);
  EXPECT_EQ(found->detail, "ABSOL moves before the first SYSDEF of the program");
}

// OPT-2.62, OPT-E.7317, OPT-8.69: what `check` says of a corner, the transfer says too, for the
// machine that it goes to. motion.md C01: 90 degrees at 50 mm/s, 1.3588 mm.
TEST_F(Project, PathsAreLookedAtAsTheyAreWhenChecked) {
  Add(45,
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nDELAY 1\n"
      "MOVE (100,0,0,0,0)/FLY\nMOVE (100,100,0,0,0)\nWORK 0,0/OFF\n");
  const auto corner = [](const machine::TransferPlan& plan) {
    const auto found = std::ranges::find(plan.diagnostics, ErrorCode::kFlySharp, &Diagnostic::code);
    return found == plan.diagnostics.end() ? Detail() : found->detail;
  };
  EXPECT_EQ(corner(Plan()),
            "the contour turns by 90.0 degrees; the path stays 1.359 mm away from the corner");
  ContourMachine slow = ContourMachine::Standard();
  slow.limits.tip_speed_mm_s /= 2.0;
  EXPECT_EQ(corner(PlanTransfer(bundle_, {}, kObjectLimitStandard, slow)),
            "the contour turns by 90.0 degrees; the path stays 0.480 mm away from the corner");
}

// OPT-10.17, OPT-E.7413
TEST_F(Project, AmadasNumbersAreReserved) {
  Add(5, "SPEED 5\n");
  EXPECT_EQ(Findings(), (std::vector<int>{7413}));
  EXPECT_TRUE(Plan().ok);
}

// OPT-E.7862
TEST_F(Project, AProgramHasText) {
  Add(45, "");
  EXPECT_EQ(Findings(), (std::vector<int>{7862}));
}

// OPT-1.10, OPT-3.44, OPT-3.09, OPT-3.11, OPT-8.68: what each finding of a project says, and of
// which program and line.
TEST_F(Project, FindingsSayWhatTheyAreAbout) {
  AddSchedule(0);
  AddSchedule(64);
  AddSchedule(63);
  AddSchedule(1);
  AddSchedule(1);
  Define(1, 3, {6.5, 80, 1.5, 95, 63});
  Define(1, 3, {6.5, 80, 1.5, 95});
  Define(2, 4, {7});
  Define(1, 5, {6.5, 80, 1.5, 95, 8});
  Add(0, "SPEED 5\n");
  Add(45, "SPEED 5\nWORKDEF 1,3 (6.5,80.,1.5,96.,63)\nWORKDEF 2,0 (1)\n");
  Add(45, "SPEED 5\nSPEED 6\nWORK 1,4/ON\nWORK 1,4/OFF\n");
  Add(46, "WORK 2,4/ON\nWORK 2,4/OFF\n");
  std::vector<std::string> said;
  for (const Diagnostic& d : Plan().diagnostics) {
    if (d.rule != "OPT-1.10" && d.rule != "OPT-3.44" && d.rule != "OPT-3.11" &&
        d.rule != "OPT-8.68" && d.code != ErrorCode::kWorkdefMissing &&
        d.code != ErrorCode::kProjectProcess) {
      continue;
    }
    if (d.detail.starts_with("no WORKDEF 1,4") || d.detail.starts_with("no WORKDEF 2,4"))
      continue;  // the compiler's
    said.push_back(std::to_string(d.program) + ":" + std::to_string(d.where.line) + " " +
                   std::to_string(Lookup(d.code).number) + " " + d.rule + " " + d.detail);
  }
  const std::vector<std::string> expected = {
      "0:0 7101 OPT-1.10 program number 0 is outside 1..99",
      "0:0 7861 OPT-8.68 program 45 stands twice",
      "0:0 7403 OPT-3.44 laser schedule 0 is outside 1..63",
      "0:0 7403 OPT-3.44 laser schedule 64 is outside 1..63",
      "0:0 7861 OPT-8.68 laser schedule 1 stands twice",
      "0:0 7861 OPT-8.68 process definition 1,3 stands twice",
      "0:0 7862 OPT-8.68 the project has no laser schedule 7",
      "0:0 7862 OPT-8.68 the project has no laser schedule 8",
      "45:2 7863 OPT-3.11 the project defines WORKDEF 1,3 (6.5, 80.0, 1.5, 95.0, 63)",
      "45:3 7863 OPT-3.11 the project has no definition of process 2,0",
      "45:3 7401 OPT-3.09 WORK 1,4 has neither a WORKDEF nor a process definition of the project",
      "46:1 7863 OPT-3.09 no WORKDEF before WORK 2,4; the project defines WORKDEF 2,4 (7)"};
  EXPECT_EQ(said, expected);
}

// OPT-3.12, OPT-9.16: definitions come from callers and from FUNCTIONs, near and far, and from
// nowhere else.
TEST_F(Project, DefinitionsComeFromRelativesOnly) {
  Add(30, "FUNCTION 31\nWORK 1,1/ON\nWORK 1,1/OFF\n");
  Add(31, "FUNCTION 32\n");
  Add(32, "WORKDEF 1,1 (8.,75.,1.,50.)\nWORK 1,2/ON\nWORK 1,2/OFF\n");
  Add(33, "FUNCTION 32\nWORKDEF 1,2 (8.,75.,1.,50.)\n");
  EXPECT_TRUE(Plan().ok);
  Add(40, "CALL 32\nWORKDEF 1,3 (8.,75.,1.,50.)\n");
  Add(41, "WORK 1,3/ON\nWORK 1,3/OFF\n");
  EXPECT_FALSE(Plan().ok);
}

// OPT-3.11: what cannot be compared, and what agrees, is not told.
TEST_F(Project, WorkdefsThatAgreeAreNotTold) {
  AddSchedule(5);
  Define(1, 0, {6.5, 80, 1.5, 95});
  Define(2, 9, {5});
  Add(45,
      "DECLARE P = 80.\nWORKDEF 1,0 (6.5,P,1.5,95.)\nWORKDEF 2,9 (5)\nWORKDEF 0,3\n"
      "WORKDEF 1,0 (VR[65],80.,VR[66],95.)\nWORKDEF 2,9 (VR[26])\n");
  EXPECT_TRUE(Findings().empty());
  Add(46, "WORKDEF 1,0 (VR[65],80.,VR[66],94.)\n");
  EXPECT_EQ(Findings(), (std::vector<int>{7863}));
  Add(47, "WORKDEF 1,0 (6.5,80.,1.5,95.,5)\n");
  EXPECT_EQ(Findings(), (std::vector<int>{7863, 7863}));
}

// OPT-7.39: a FUNCTION moves in the system of its callers, and ROBOT moves in none.
TEST_F(Project, MovesThatNeedNoSysdef) {
  Add(45, "COORD ABSOL\nSYSDEF (1.,2.,3.,0.,0.,0.)\nMOVE (1.,2.,3.,0.,0.)\nFUNCTION 46\n");
  Add(46, "COORD ABSOL\nMOVE (1.,2.,3.,0.,0.)\n");
  Add(47, "COORD ABSOL\nCOORD ROBOT\nPATH PTP\nMOVE (1.,2.,3.,0.,0.)\n");
  Add(48, "MOVE (1.,2.,3.,0.,0.)\n");
  EXPECT_TRUE(Findings().empty());
  Add(49, "COORD ABSOL\nMOVE (1.,2.,3.,0.,0.)\n");
  const machine::TransferPlan plan = Plan();
  const auto found =
      std::ranges::find(plan.diagnostics, std::string("OPT-7.39"), &Diagnostic::rule);
  ASSERT_NE(found, plan.diagnostics.end());
  EXPECT_EQ(found->program, 49);
  EXPECT_EQ(found->file, "49.S");
  EXPECT_EQ(found->detail,
            "ABSOL moves without SYSDEF, while other programs of the project use it");
}

// OPT-8.69: a text is the project's own unless its units, its form or its WORKDEFs are new.
TEST_F(Project, TextsThatTheTransferMadeAreToldFromTheOwn) {
  const std::string object = MustCompile("SPEED 6\n").object;
  Define(1, 0, {6.5, 80, 1.5, 95});
  Add(45, "SPEED 5\n");
  Add(46, "SPEED 5\n", true);                                     // its name tells the units
  bundle_.programs.push_back({47, {"47.S", "SPEED 5\n"}, true});  // its name does not
  bundle_.programs.push_back({48, {"48.O", object}, false});
  Add(49, "WORK 1,0/ON\nWORK 1,0/OFF\n");
  const machine::TransferPlan plan = Plan(true);
  ASSERT_TRUE(plan.ok);
  std::vector<bool> own;
  for (const auto& program : plan.programs) own.push_back(program.own_text);
  EXPECT_EQ(own, (std::vector<bool>{true, true, false, false, false}));
  EXPECT_EQ(plan.programs[3].object, object);
  EXPECT_EQ(plan.programs[3].source, "     SPEED 6\n");
}

// OPT-8.46, OPT-8.71: what may still be inches is told of its program and file, and stops the
// transfer where it is an error; what is no RML is told by the compiler alone.
TEST_F(Project, WhatCouldNotBeConvertedIsTold) {
  Add(45, "SPEED 5\nMOVE (1.+2.*VR[86],0,0,0,0)\n", true);
  Add(46, "SPED 5\n", true);
  const machine::TransferPlan plan = Plan();
  std::vector<std::string> told;
  for (const Diagnostic& d : plan.diagnostics) {
    told.push_back(std::to_string(d.program) + " " + d.file + ":" + std::to_string(d.where.line) +
                   " " + std::to_string(Lookup(d.code).number));
  }
  EXPECT_EQ(std::ranges::count(told, "45 45.SI:2 7709"), 1);
  EXPECT_EQ(
      std::ranges::count_if(told, [](const std::string& text) { return text.ends_with("7711"); }),
      0);
  EXPECT_TRUE(std::ranges::any_of(
      told, [](const std::string& text) { return text.starts_with("46 46.SI:1 "); }));
}

// OPT-3.10: WORK 0,0 alone needs no WORKDEF, 0,1 does.
TEST_F(Project, OfTheFirstKindOneProcessNeedsNoDefinition) {
  Add(45, "WORK 0,1/ON\nWORK 0,1/OFF\n");
  const machine::TransferPlan plan = Plan();
  EXPECT_FALSE(plan.ok);
  const auto said = [](const Diagnostic& d) {
    return d.detail == "WORK 0,1 has neither a WORKDEF nor a process definition of the project";
  };
  EXPECT_EQ(std::ranges::count_if(plan.diagnostics, said), 1);
}

// OPT-B.71, OPT-8.71: an object that is damaged stops the transfer, and is told of its program.
TEST_F(Project, DamagedObjectsAreNone) {
  const std::string object = MustCompile("SPEED 6\n").object;
  const std::string damaged = object.substr(0, object.size() - 1);
  Add(45, "SPEED 5\n");
  bundle_.programs.push_back({48, {"48.O", damaged}, false});
  const machine::TransferPlan plan = Plan();
  EXPECT_FALSE(plan.ok);
  EXPECT_TRUE(plan.programs.empty());
  ASSERT_EQ(plan.diagnostics.size(), 1U);
  EXPECT_EQ(plan.diagnostics[0].code, ErrorCode::kObjectCorrupt);
  EXPECT_EQ(plan.diagnostics[0].rule, "OPT-B.71");
  EXPECT_EQ(plan.diagnostics[0].program, 48);
}

// Of a program that has more errors than are told, the rest are counted, as those of that program.
TEST_F(Project, ErrorsThatHaveNoRoomAreCounted) {
  std::string text;
  for (int n = 0; n < 1100; ++n) text += "SPEED 101\n";
  Add(45, text);
  const machine::TransferPlan plan = Plan();
  EXPECT_FALSE(plan.ok);
  EXPECT_EQ(plan.diagnostics.size() + plan.diagnostics_dropped.count(), 1100U);
  const auto& kinds = plan.diagnostics_dropped.kinds();
  ASSERT_TRUE(kinds.contains(ErrorCode::kLiteralRange));
  EXPECT_EQ(kinds.at(ErrorCode::kLiteralRange).first.program, 45);
  EXPECT_EQ(kinds.at(ErrorCode::kLiteralRange).last.program, 45);
}

// OPT-8.35: nor is anything lost of what CONVERT says of a program in inches.
TEST_F(Project, FindingsOfTheConversionThatHaveNoRoomAreCounted) {
  std::string text = "DECLARE X = 10.5\n";
  for (int n = 0; n < 1100; ++n) text += "VR[0] = X\n";
  bundle_.programs.push_back({45, {"45.SI", text}, true});
  const machine::TransferPlan plan = Plan();
  EXPECT_TRUE(plan.ok);
  const auto& kinds = plan.diagnostics_dropped.kinds();
  ASSERT_TRUE(kinds.contains(ErrorCode::kConvertConstant));
  const GatheredFindings& more = kinds.at(ErrorCode::kConvertConstant);
  EXPECT_EQ(more.count, 100U);
  EXPECT_EQ(more.first.program, 45);
  EXPECT_EQ(more.last.program, 45);
  EXPECT_EQ(more.last.file, "45.SI");
  EXPECT_EQ(more.last.where.line, 1101);
}

}  // namespace
}  // namespace rmlcell::optimo
