#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/offline/project.h"

namespace rmlcell::optimo {
namespace {

class ProjectSides : public testing::Test {
 protected:
  void Put(int slot, std::string_view text) {
    bundle_.programs.push_back({slot, {std::to_string(slot) + ".S", text}, false});
  }
  void Define(int kind, int process, std::vector<double> values) {
    bundle_.processes.push_back({kind, process, std::move(values), ""});
  }
  machine::TransferPlan Plan(bool insert = false) {
    return PlanTransfer(bundle_, {.insert_missing_definitions = insert});
  }
  std::size_t CountOf(ErrorCode code) {
    std::size_t count = 0;
    for (const Diagnostic& d : Plan().diagnostics) {
      // What the compiler says of a program alone is a warning.
      if (code == ErrorCode::kWorkdefMissing && !IsError(d.severity)) continue;
      if (code == ErrorCode::kPracticeAdvice && d.rule != "OPT-7.39") continue;
      if (d.code == code) ++count;
    }
    return count;
  }
  machine::ProjectBundle bundle_;
};

constexpr const char* kDefinesIt = "WORKDEF 1,0 (6.5, 80., 1.5, 95)\n";
constexpr const char* kUsesIt = "WORK 1,0/ON\nWORK 1,0/OFF\n";

// OPT-3.12, OPT-9.16: the FUNCTION of a FUNCTION shares the definitions, in whatever order the
// programs stand, and whether the definition is with the callers or the called.
TEST_F(ProjectSides, FarRelativesShareDefinitions) {
  for (const bool reversed : {false, true}) {
    bundle_ = {};
    std::vector<std::pair<int, std::string>> programs = {
        {32, std::string("FUNCTION 33\n") + kUsesIt},
        {33, "FUNCTION 34\n"},
        {34, "FUNCTION 35\n"},
        {35, kDefinesIt}};
    if (reversed) std::swap(programs[0], programs[3]);
    if (reversed) std::swap(programs[1], programs[2]);
    for (const auto& [slot, text] : programs) Put(slot, text);
    EXPECT_EQ(CountOf(ErrorCode::kWorkdefMissing), 0U) << reversed;
  }
  for (const bool reversed : {false, true}) {
    bundle_ = {};
    std::vector<std::pair<int, std::string>> programs = {
        {32, std::string("FUNCTION 33\n") + kDefinesIt},
        {33, "FUNCTION 34\n"},
        {34, "FUNCTION 35\n"},
        {35, kUsesIt}};
    if (reversed) std::swap(programs[0], programs[3]);
    if (reversed) std::swap(programs[1], programs[2]);
    for (const auto& [slot, text] : programs) Put(slot, text);
    EXPECT_EQ(CountOf(ErrorCode::kWorkdefMissing), 0U) << reversed;
  }
}

// OPT-3.09, OPT-9.16: a FUNCTION is no definition, whatever its number.
TEST_F(ProjectSides, AFunctionDefinesNoProcess) {
  Put(45, "FUNCTION 1\nWORK 1,0/ON\nWORK 1,0/OFF\n");
  EXPECT_EQ(CountOf(ErrorCode::kWorkdefMissing), 1U);
  bundle_ = {};
  Put(45, "FUNCTION 2\nWORK 2,0/ON\nWORK 2,0/OFF\n");
  EXPECT_EQ(CountOf(ErrorCode::kWorkdefMissing), 1U);
}

// OPT-3.11: each value counts, the first and the last.
TEST_F(ProjectSides, EachValueOfADefinitionCounts) {
  for (std::size_t other = 0; other <= 4; ++other) {
    bundle_ = {};
    std::vector<double> values = {6.5, 80, 1.5, 95};
    if (other < values.size()) values[other] += 1.0;
    Define(1, 0, values);
    Put(45, kDefinesIt);
    EXPECT_EQ(CountOf(ErrorCode::kProjectProcess), other < 4 ? 1U : 0U) << other;
  }
}

// OPT-3.09: inserted in the order in which they are used, behind the declarations, also where only
// one statement follows those.
TEST_F(ProjectSides, InsertedDefinitionsStandInTheOrderOfTheirUse) {
  Define(1, 0, {8, 75, 1, 50});
  Define(2, 0, {11});
  bundle_.schedules.push_back({.number = 11, .name = {}});
  Put(45, "DECLARE V = 5\nWORK 2,0/ON\nWORK 1,0/ON\n");
  Put(46, "DECLARE V = 5\nWORK 1,0/ON\n");
  const machine::TransferPlan plan = Plan(true);
  ASSERT_TRUE(plan.ok);
  ASSERT_EQ(plan.programs.size(), 2U);
  EXPECT_EQ(plan.programs[0].source,
            "DECLARE V = 5\n     WORKDEF 2,0 (11)\n     WORKDEF 1,0 (8.0, 75.0, 1.0, 50.0)\n"
            "WORK 2,0/ON\nWORK 1,0/ON\n");
  EXPECT_EQ(plan.programs[1].source,
            "DECLARE V = 5\n     WORKDEF 1,0 (8.0, 75.0, 1.0, 50.0)\nWORK 1,0/ON\n");
}

// OPT-9.12: the first TASK 1 is the beginning; they stand behind all that only declares, DEFINE and
// TASK as well as DECLARE.
TEST_F(ProjectSides, InsertedDefinitionsStandAtTheBeginning) {
  Define(1, 0, {8, 75, 1, 50});
  const std::string says = "TASK 1\nDEFINE PAR[0] = INT\nTASK 2\nDECLARE V = 5\n", work = kUsesIt,
                    inserted = "     WORKDEF 1,0 (8.0, 75.0, 1.0, 50.0)\n", one = says + work,
                    other = "VI[2]=1\nTASK 1\n" + work + "TASK 1\nVI[3]=1\n";
  Put(45, one);
  Put(46, other);
  const machine::TransferPlan plan = Plan(true);
  ASSERT_EQ(plan.programs.size(), 2U);
  EXPECT_EQ(plan.programs[0].source, says + inserted + work);
  EXPECT_EQ(plan.programs[1].source, "VI[2]=1\nTASK 1\n" + inserted + work + "TASK 1\nVI[3]=1\n");
}

// OPT-7.39: it takes a MOVE, in ABSOL, and another program with a SYSDEF.
TEST_F(ProjectSides, WhatNeedsASysdef) {
  const std::string sysdef = "SYSDEF (1,2,3,0,0,0)\n", move = "MOVE (1,2,3,0,0)\n";
  const auto said = [&](const std::string& one, const std::string& other) {
    bundle_ = {};
    Put(45, one);
    Put(46, other);
    return CountOf(ErrorCode::kPracticeAdvice);
  };
  EXPECT_EQ(said("COORD ABSOL\n" + move, sysdef), 1U);
  EXPECT_EQ(said("COORD ABSOL\n", sysdef), 0U);
  EXPECT_EQ(said("COORD ROBOT\n" + move, sysdef), 0U);
  EXPECT_EQ(said("COORD ABSOL\n" + move, "COORD ABSOL\n" + move), 0U);
}

// OPT-3.02, OPT-3.03, OPT-3.04, OPT-3.06, OPT-3.08: what is wrong with a definition, by which rule.
TEST_F(ProjectSides, DefinitionsAreRefusedByTheirRule) {
  const auto said = [](int kind, int process, std::vector<double> values) {
    std::vector<std::string> lines;
    for (const Diagnostic& d : CheckProcess({kind, process, std::move(values), ""}))
      lines.push_back(d.rule + " " + std::string(d.detail));
    return lines;
  };
  using Refusals = std::vector<std::string>;
  EXPECT_EQ(said(0, 4, {5}), (Refusals{"OPT-3.03 process definition 0,4: 1 values do not fit this "
                                       "kind"}));
  EXPECT_EQ(said(1, 5, {5, 6}),
            (Refusals{"OPT-3.04 process definition 1,5: 2 values do not fit this "
                      "kind"}));
  EXPECT_EQ(said(2, 6, {}), (Refusals{"OPT-3.06 process definition 2,6: 0 values do not fit this "
                                      "kind"}));
  EXPECT_EQ(said(3, 7, {}), (Refusals{"OPT-3.02 process definition 3,7: the kind is 0, 1 or 2, the "
                                      "process number 0 to 9"}));
  EXPECT_EQ(said(1, 2, {0, 101, -1, 95}),
            (Refusals{"OPT-3.08 process definition 1,2: the speed must be above 0",
                      "OPT-3.08 process definition 1,2: the power is out of range",
                      "OPT-3.08 process definition 1,2: the delay is out of range"}));
  EXPECT_EQ(said(1, 2, {101, 5, 1, 101}),
            (Refusals{"OPT-3.08 process definition 1,2: the speed is out of range",
                      "OPT-3.08 process definition 1,2: the peak is out of range"}));
  EXPECT_EQ(said(2, 8, {64}),
            (Refusals{"OPT-3.06 process definition 2,8: laser schedules go from 1 to 63"}));
}

// OPT-3.11, OPT-7.50: by a name the number counts that it stands for; of a name that nobody
// declared there is none to compare.
TEST_F(ProjectSides, NamesInDefinitionsCountByTheirNumbers) {
  Define(1, 0, {6.5, 80, 1.5, 95});
  Put(45, "WORKDEF 1,0 (6.5,NOPE,1.5,95.)\n");
  EXPECT_EQ(CountOf(ErrorCode::kProjectProcess), 0U);
  EXPECT_FALSE(Plan().ok);
  bundle_.programs.clear();
  Put(45, "DECLARE P = 81.\nWORKDEF 1,0 (6.5,P,1.5,95.)\n");
  EXPECT_EQ(CountOf(ErrorCode::kProjectProcess), 1U);
  bundle_.programs.clear();
  Put(45, "DECLARE P = 80.\nWORKDEF 1,0 (6.5,P,1.5,95.)\n");
  EXPECT_EQ(CountOf(ErrorCode::kProjectProcess), 0U);
}

// OPT-8.53, OPT-8.71: of a program in inches what is no RML is the compiler's alone, also where
// there is no room for it.
TEST_F(ProjectSides, LinesThatAreNoneAreCountedByTheCompiler) {
  std::string text;
  for (int n = 0; n < 1100; ++n) text += "12345 VR[0] = 1.\n";
  bundle_.programs.push_back({45, {"45.SI", text}, true});
  const machine::TransferPlan plan = Plan();
  EXPECT_FALSE(plan.ok);
  EXPECT_FALSE(plan.diagnostics_dropped.empty());
  EXPECT_FALSE(plan.diagnostics_dropped.kinds().contains(ErrorCode::kConvertNotRml));
}

// OPT-8.68, OPT-10.17: what is wrong with a program as a whole, of which one, by which rule.
TEST_F(ProjectSides, FindingsOfAProgramAreOfItsFile) {
  Put(45, "");
  Put(5, "SPEED 5\n");
  std::vector<std::string> said;
  for (const Diagnostic& d : Plan().diagnostics) {
    if (d.code != ErrorCode::kProjectSource && d.code != ErrorCode::kReservedVariable) continue;
    said.push_back(std::to_string(d.program) + " " + d.file + " " + d.rule + " " + d.detail);
  }
  EXPECT_EQ(said,
            (std::vector<std::string>{"45 45.S OPT-8.68 program 45 has no text",
                                      "5 5.S OPT-10.17 programs 1 to 7 are reserved for Amada"}));
}

}  // namespace
}  // namespace rmlcell::optimo
