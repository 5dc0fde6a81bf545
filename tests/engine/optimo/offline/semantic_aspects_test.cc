#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/offline/semantic_diff.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

struct Comparison {
  std::string before, after;
  std::vector<std::string> what;
  std::string aspects;
};

// One changed step.
void ExpectChange(const Comparison& row) {
  const ProgramDiff diff = Diff(MustCompile(row.before).module, MustCompile(row.after).module);
  ASSERT_EQ(diff.steps.size(), 1U) << row.before << row.after;
  EXPECT_EQ(diff.steps[0].kind, StepChange::Kind::kChanged) << row.before << row.after;
  EXPECT_EQ(diff.steps[0].what, row.what) << row.before << row.after;
  EXPECT_EQ(AspectText(diff.steps[0].aspects), row.aspects) << row.before << row.after;
  EXPECT_EQ(diff.aspects, diff.steps[0].aspects);
}

// OPT-2.10, OPT-2.20, OPT-2.43, OPT-2.54: what of a MOVE may change.
TEST(SemanticAspects, OfMoves) {
  const std::vector<Comparison> rows = {
      {"MOVE (1,2,3,4,5)\n", "MOVE (1,2,4,4,5)\n", {"Z 3.0 -> 4.0"}, "path"},
      {"MOVE (1,2,3,4,5)\n", "MOVE (1,2,3,0.5,5)\n", {"A 4.0 -> 0.5"}, "path"},
      {"MOVE (1,2,3,4,5)\n", "MOVE (1,2,3,4,-5)\n", {"B 5.0 -> -5.0"}, "path"},
      {"MOVE (1,2,3,4,5)\n", "MOVE (1,2,VR[1]*2,4,5)\n", {"Z 3.0 -> VR[1] * 2"}, "path"},
      {"ACCEL 50\nMOVE (1,2,3,4,5)\n",
       "ACCEL 60\nMOVE (1,2,3,4,5)\n",
       {"ACCEL 50.0 -> 60.0"},
       "time"},
      {"OVERSH 50\nMOVE (1,2,3,4,5)\n",
       "OVERSH 60\nMOVE (1,2,3,4,5)\n",
       {"OVERSH 50.0 -> 60.0"},
       "path, time"},
      {"PATH HOLE (5.)\nMOVE (1,2,3,4,5)\n",
       "PATH HOLE (6.)\nMOVE (1,2,3,4,5)\n",
       {"PATH HOLE (5.0) -> PATH HOLE (6.0)"},
       "path"},
      {"MOVE (1,2,3,4,5)/VIA (1,2,3,4,5)\n",
       "MOVE (1,2,3,4,5)/VIA (1,2,3,4,6)\n",
       {"via B 5.0 -> 6.0"},
       "path"},
      {"MOVE (1,2,3,4,5)/VIA (1,2,3,4,5)\n",
       "MOVE (1,2,3,4,5)/VIA (7,2,3,4,5)\n",
       {"via X 1.0 -> 7.0"},
       "path"},
      {"MOVE (1,2,3,4,5)\n", "MOVE (1,2,3,4,5)/VIA (7,2,3,4,5)\n", {"/VIA added"}, "path"},
      {"MOVE (1,2,3,4,5)/VIA (7,2,3,4,5)\n", "MOVE (1,2,3,4,5)\n", {"/VIA removed"}, "path"},
      {"MOVE (1,2,3,4,5)\n", "MOVE (1,2,3,4,5)/FLY\n", {"/FLY added"}, "path, time"},
      {"MOVE (1,2,3,4,5)\n", "MOVE (1,2,3,4,5)/START (IL[20])\n", {"/START added"}, "time"},
      {"MOVE (1,2,3,4,5)\n", "MOVE (1,2,3,4,5)/END (IL[20])\n", {"/END added"}, "path, time"},
      {"MOVE (1,2,3,4,5)/START (IL[20])\n",
       "MOVE (1,2,3,4,5)/START (IL[21])\n",
       {"/START IL[20] -> IL[21]"},
       "time"},
      {"MOVE (1,2,3,4,5)/START (ON)\n",
       "MOVE (1,2,3,4,5)/START (OFF)\n",
       {"/START ON -> OFF"},
       "time"},
      {"MOVE (1,2,3,4,5)/END (IL[20])\n",
       "MOVE (1,2,3,4,5)/END (IL[21])\n",
       {"/END IL[20] -> IL[21]"},
       "path, time"},
      {"MOVE (1,2,3,4,5)/TIME (1.,9)\n9\n",
       "MOVE (1,2,3,4,5)/TIME (2.,9)\n9\n",
       {"/TIME 1.0 -> 2.0"},
       "path, time"},
  };
  for (const Comparison& row : rows) ExpectChange(row);
}

// OPT-2.43, OPT-3.13: attributes of other instructions touch what the instruction does.
TEST(SemanticAspects, OfAttributes) {
  const std::vector<Comparison> rows = {
      {"GO 46 /C\n", "GO 46 /R\n", {"/C removed", "/R added", "GO 46 /C -> GO 46 /R"}, "flow"},
      {"WORK 0,0/ON\n",
       "WORK 0,0/ON/START (IL[20])\n",
       {"/START added", "WORK 0,0 /ON -> WORK 0,0 /ON /START (IL[20])"},
       "time, power"},
  };
  for (const Comparison& row : rows) ExpectChange(row);
}

struct Added {
  std::string text;
  std::string aspects;
};

// What each instruction touches where it comes or goes, by what its own rule says that it does.
TEST(SemanticAspects, OfEachInstruction) {
  const std::vector<Added> rows = {
      {"MOVE (1,2,3,4,5)\n", "path, time"},
      {"ZERO\n", "path, time"},
      {"COORD ABSOL\n", "path"},
      {"SYSDEF\n", "path"},
      {"TCP (0,0,0/0,0,-5)\n", "path"},
      {"DELAY 1\n", "time"},
      {"WAIT IL[20]\n", "time"},
      {"WORK 0,0/ON\n", "power"},
      {"WORK 1,0/ON\n", "time, power"},
      {"WORKDEF 0,1\n", "power"},
      {"WORKDEF 1,0 (8.,75.,1.,50.)\n", "time, power"},
      {"WORKDEF 2,0 (5)\n", "power"},
      {"VR[1] = 2.\n", "data"},
      {"VL[1] = ON\n", "data"},
      {"OL[8] = ON\n", "outputs"},
      {"OA[1] = 2.\n", "outputs"},
      {"ASSIGN OL[8] = 1 /2\n", "outputs"},
      {"ASSIGN VL[8] = 1 /2\n", "data"},
      {"UPDATE OL /ON\n", "outputs"},
      {"IMAGE OL\n", "outputs"},
      {"REAL\n", "outputs"},
      {"DEFINE PAR[0] = INT\n", "data"},
      {"PAUSE\n", "time, flow"},
      {"CALL 2\n", "flow"},
      {"GO 2\n", "flow"},
      {"SETERR 5\n", "flow"},
      {"NOERR\n", "flow"},
      {"RETURN\n", "flow"},
      {"TASK 1\n", "flow"},
  };
  const Module nothing = MustCompile("STOP\n").module;
  ASSERT_EQ(AspectText(Diff(MustCompile("SPEED 5\n").module, nothing).aspects), "time, flow");
  for (const Added& row : rows) {
    const Module one = MustCompile(row.text + "STOP\n").module;
    const ProgramDiff added = Diff(nothing, one), removed = Diff(one, nothing);
    for (const ProgramDiff* diff : {&added, &removed}) {
      ASSERT_EQ(diff->steps.size(), 1U) << row.text;
      EXPECT_EQ(AspectText(diff->steps[0].aspects), row.aspects) << row.text;
    }
    EXPECT_EQ(added.steps[0].step_a, 0) << row.text;
    EXPECT_EQ(added.steps[0].step_b, 1) << row.text;
    EXPECT_EQ(removed.steps[0].step_a, 1) << row.text;
    EXPECT_EQ(removed.steps[0].step_b, 0) << row.text;
    EXPECT_TRUE(added.steps[0].before.empty() && removed.steps[0].after.empty()) << row.text;
    EXPECT_EQ(added.steps[0].after, removed.steps[0].before) << row.text;
  }
}

// OPT-2.34, OPT-2.36: in programs with jumps modal instructions are steps like others.
TEST(SemanticAspects, OfModalInstructionsInProgramsWithJumps) {
  for (const Added& row : std::vector<Added>{{"SPEED 5\n", "time"},
                                             {"ACCEL 5\n", "time"},
                                             {"OVERSH 5\n", "path, time"},
                                             {"PATH LIN\n", "path"}}) {
    const ProgramDiff diff =
        Diff(MustCompile("9 MOVE (1,2,3,4,5)\nGOTO 9\n").module,
             MustCompile("9 " + row.text + "MOVE (1,2,3,4,5)\nGOTO 9\n").module);
    ASSERT_EQ(diff.steps.size(), 1U) << row.text;
    EXPECT_EQ(AspectText(diff.steps[0].aspects), row.aspects) << row.text;
  }
  // Neither a FUNCTION nor a computed value leaves it known which MOVE has which speed.
  for (const std::string rest : {"FUNCTION 3\n", "ACCEL VR[64]\n"}) {
    EXPECT_EQ(Diff(MustCompile("SPEED 5\n" + rest).module, MustCompile("SPEED 6\n" + rest).module)
                  .steps.size(),
              1U)
        << rest;
    EXPECT_TRUE(
        Diff(MustCompile("SPEED 5\n" + rest).module, MustCompile("SPEED 5.0\n" + rest).module)
            .equal());
  }
}

// Which steps are one step changed: of the same instruction, of the same target or process.
TEST(SemanticAspects, StepsArePairedByWhatTheySwitch) {
  const auto kinds = [](const std::string& a, const std::string& b) {
    std::string text;
    for (const StepChange& step : Diff(MustCompile(a).module, MustCompile(b).module).steps)
      text += step.kind == StepChange::Kind::kAdded     ? '+'
              : step.kind == StepChange::Kind::kRemoved ? '-'
                                                        : '*';
    return text;
  };
  EXPECT_EQ(kinds("VR[1] = 2.\n", "VR[1] = 3.\n"), "*");
  EXPECT_EQ(kinds("VR[1] = 2.\n", "VR[2] = 2.\n").size(), 2U);
  EXPECT_EQ(kinds("VR[1] = 2.\n", "VI[1] = 2\n").size(), 2U);
  EXPECT_EQ(kinds("ASSIGN OL[8] = 1 /2\n", "ASSIGN OL[8] = 2 /2\n"), "*");
  EXPECT_EQ(kinds("WORK 0,0/ON\n", "WORK 0,1/ON\n").size(), 2U);
  EXPECT_EQ(kinds("WORK 0,0/ON\n", "WORK 0,0/OFF\n").size(), 2U);
  EXPECT_EQ(kinds("WORKDEF 2,0 (5)\n", "WORKDEF 2,0 (6)\n"), "*");
  EXPECT_EQ(kinds("WORKDEF 2,0 (5)\n", "WORKDEF 2,1 (5)\n").size(), 2U);
  EXPECT_EQ(kinds("DELAY 1\n", "WAIT IL[20]\n").size(), 2U);
  EXPECT_EQ(kinds("COORD ABSOL\n", "COORD ROBOT\n"), "*");
  EXPECT_EQ(kinds("GOSUB 5\n5 RETURN\n", "GOSUB 5\n5 RETURN\n"), "");
}

// OPT-7.15, OPT-7.17, OPT-7.23: where jumps come to, of tables and both ways of an IF.
TEST(SemanticAspects, OfTargets) {
  const std::string body = "1 VI[2]=1\n2 VI[3]=1\n3 VI[4]=1\n4\n";
  const auto what = [&](const std::string& a, const std::string& b) {
    const ProgramDiff diff =
        Diff(MustCompile(a + "\n" + body).module, MustCompile(b + "\n" + body).module);
    EXPECT_EQ(diff.steps.size(), 1U) << a << b;
    return diff.steps.empty() ? std::vector<std::string>() : diff.steps[0].what;
  };
  using Whats = std::vector<std::string>;
  EXPECT_EQ(what("GOTO 1", "GOTO 4"), (Whats{"goes to step 2 -> the end"}));
  EXPECT_EQ(what("GOTO 4", "GOTO 3"), (Whats{"goes to the end -> step 4"}));
  EXPECT_EQ(what("IF VL[1] THEN 1 ELSE 2", "IF VL[1] THEN 1 ELSE 3").back(),
            "goes to step 3 -> step 4");
  EXPECT_EQ(what("GOTO VI[1] (1, 2)", "GOTO VI[1] (3, 2)").back(), "goes to step 2 -> step 4");
}

// A figure counts beyond 1e-9 of its size, on both sides of that; names are in order.
TEST(SemanticAspects, OfFigures) {
  const Module module = MustCompile("SPEED 5\n").module;
  const auto changed = [&](double before, double after) {
    return !Diff(module, module, {{"time", "s", before}}, {{"time", "s", after}}).figures.empty();
  };
  EXPECT_FALSE(changed(0.0, 0.0));
  EXPECT_TRUE(changed(0.0, 1e-12));
  EXPECT_TRUE(changed(-5.0, 5.0));
  EXPECT_FALSE(changed(1000.0, 1000.0 + 0.9e-6));
  EXPECT_TRUE(changed(1000.0, 1000.0 + 1.1e-6));
  EXPECT_TRUE(changed(1000.0 + 1.1e-6, 1000.0));
  EXPECT_FALSE(changed(-1000.0, -1000.0 - 0.9e-6));
  const ProgramDiff only = Diff(module, module, {}, {{"cut", "mm", 5.0}});
  ASSERT_EQ(only.figures.size(), 1U);
  EXPECT_EQ(only.figures[0].name, "cut");
  EXPECT_EQ(only.figures[0].unit, "mm");
  EXPECT_EQ(only.figures[0].before, 0.0);
  EXPECT_EQ(only.figures[0].after, 5.0);
  EXPECT_EQ(AspectText(0), "");
  EXPECT_EQ(AspectText(63), "path, time, power, outputs, data, flow");
}

}  // namespace
}  // namespace rmlcell::optimo
