#include "engine/optimo/offline/semantic_diff.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

using Kind = StepChange::Kind;
using Texts = std::vector<std::string>;

ProgramDiff DiffOf(const std::string& a, const std::string& b) {
  return Diff(MustCompile(a).module, MustCompile(b).module);
}

constexpr const char* kContour =
    "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nMOVE (10,0,0,0,0)/FLY\n"
    "MOVE (10,10,0,0,0)\nWORK 0,0/OFF\n";

// OPT-1.04, OPT-1.29, OPT-7.41, OPT-7.91: how it is written does not count.
TEST(SemanticDiff, WritingDoesNotCount) {
  EXPECT_TRUE(DiffOf(kContour, kContour).equal());
  EXPECT_TRUE(DiffOf(kContour,
                     "; other text\ndeclare EDGE = 10.0\ncoord absol\nPath Lin\nspeed 10.\n"
                     "5 move(0.,0.,0.,0.,0.)\nwork 0,00 /on\nmove (EDGE,0,0,0,0) /fly\n"
                     "MOVE (EDGE,\n EDGE,0,-0.0,0)\nwork 0,0/off ; end\n")
                  .equal());
  EXPECT_TRUE(
      DiffOf("VR[0] = VR[1] + 5\nOL[1] = 1\n", "LET VR[00] = VR[1] + 5.0\nOL[1] = ON\n").equal());
  EXPECT_FALSE(DiffOf("VR[0] = VR[1] + 5\n", "VR[0] = VR[1] - 5\n").equal());
  EXPECT_FALSE(DiffOf("CALL 2 (ON)\n", "CALL 2 (1)\n").equal());  // where no logical value stands
}

// OPT-3.46: ENDTASK at the end is assumed there; before the end it ends the program.
TEST(SemanticDiff, EndtaskAtTheEndDoesNotCount) {
  EXPECT_TRUE(DiffOf("SPEED 5\n", "SPEED 5\nENDTASK\n").equal());
  EXPECT_TRUE(DiffOf("", "").equal());
  EXPECT_TRUE(DiffOf("DECLARE X = 5.\nENDTASK\n", "").equal());
  EXPECT_TRUE(DiffOf("VI[1]=1\nENDTASK ; over\n", "VI[1]=1\n").equal());
  // A jump to it is a jump to the end.
  EXPECT_TRUE(
      DiffOf("IF VL[0] THEN 9\nVI[1]=1\n9\n", "IF VL[0] THEN 9\nVI[1]=1\n9 ENDTASK\n").equal());
  EXPECT_FALSE(DiffOf("VI[1]=1\nENDTASK\nVI[2]=1\n", "VI[1]=1\nVI[2]=1\n").equal());
}

// OPT-7.43, OPT-7.44: the same words with names that stand for something else.
TEST(SemanticDiff, NamesCountByWhatTheyStandFor) {
  EXPECT_TRUE(DiffOf("DECLARE P = VR[1]\nP = 2.\n", "DECLARE Q = VR[1]\nQ = 2.\n").equal());
  const ProgramDiff constant = DiffOf("DECLARE T = 1.5\nDELAY T\n", "DECLARE T = 2.5\nDELAY T\n");
  ASSERT_EQ(constant.steps.size(), 1U);
  EXPECT_EQ(constant.steps[0].what, (Texts{"1.5 -> 2.5"}));
  const ProgramDiff last =
      DiffOf("DECLARE T = 1.5\nCALL 45 (1.,2.,T)\n", "DECLARE T = 2.5\nCALL 45 (1.,2.,T)\n");
  ASSERT_EQ(last.steps.size(), 1U);
  EXPECT_EQ(last.steps[0].what, (Texts{"1.5 -> 2.5"}));
  // The step behind it has its own values.
  const ProgramDiff both =
      DiffOf("DECLARE T = 1.5\nDELAY T\nDELAY 3.\n", "DECLARE T = 2.5\nDELAY T\nDELAY 4.\n");
  ASSERT_EQ(both.steps.size(), 2U);
  EXPECT_EQ(both.steps[0].what, (Texts{"1.5 -> 2.5"}));
  EXPECT_EQ(both.steps[1].what, (Texts{"DELAY 3.0 -> DELAY 4.0"}));
  const ProgramDiff source = DiffOf("DECLARE XP = VR[1]\nMOVE (XP+1,0,0,0,0)\n",
                                    "DECLARE XP = VR[2]\nMOVE (XP+1,0,0,0,0)\n");
  ASSERT_EQ(source.steps.size(), 1U);
  EXPECT_EQ(source.steps[0].what, (Texts{"X VR[1] + 1 -> VR[2] + 1"}));
}

// OPT-2.10, OPT-2.34: modal values count where a MOVE uses them.
TEST(SemanticDiff, ModalValuesCountWhereTheyAreUsed) {
  EXPECT_TRUE(DiffOf("SPEED 70\nMOVE (1,2,3,0,0)\n", "MOVE (1,2,3,0,0)\nSPEED 5\n").equal());
  const ProgramDiff faster = DiffOf("SPEED 10\nMOVE (1,2,3,0,0)\nMOVE (2,2,3,0,0)\n",
                                    "SPEED 10\nMOVE (1,2,3,0,0)\nSPEED 12\nMOVE (2,2,3,0,0)\n");
  ASSERT_EQ(faster.steps.size(), 1U);
  EXPECT_EQ(faster.steps[0].kind, Kind::kChanged);
  EXPECT_EQ(faster.steps[0].step_a, 3);
  EXPECT_EQ(faster.steps[0].step_b, 4);
  EXPECT_EQ(faster.steps[0].what, (Texts{"SPEED 10.0 -> 12.0"}));
  EXPECT_EQ(AspectText(faster.aspects), "time");
  // With a jump it is not known which MOVE uses it: the instruction itself has changed.
  const ProgramDiff jumping = DiffOf("10 SPEED 10\nMOVE (1,2,3,0,0)\nIF VL[0] THEN 10\n",
                                     "10 SPEED 12\nMOVE (1,2,3,0,0)\nIF VL[0] THEN 10\n");
  ASSERT_EQ(jumping.steps.size(), 1U);
  EXPECT_EQ(jumping.steps[0].what, (Texts{"SPEED 10 -> SPEED 12"}));
}

// A target that moved by (3, 4, 0): 5 mm; an attribute; the path type.
TEST(SemanticDiff, MovesTellWhatChanged) {
  const ProgramDiff moved =
      DiffOf("PATH LIN\nMOVE (1,2,3,0,0)/FLY\n", "PATH CIR\nMOVE (4,6,3,0,0)\n");
  ASSERT_EQ(moved.steps.size(), 1U);
  EXPECT_EQ(moved.steps[0].what,
            (Texts{"PATH LIN -> PATH CIR", "/FLY removed", "X 1.0 -> 4.0", "Y 2.0 -> 6.0"}));
  EXPECT_DOUBLE_EQ(moved.steps[0].target_moved_mm, 5.0);
  EXPECT_EQ(AspectText(moved.aspects), "path, time");
  // X, Y and Z count, the head does not; nor is known how far a variable goes.
  EXPECT_DOUBLE_EQ(DiffOf("MOVE (1,2,3,0,0)\n", "MOVE (4,6,15,1,2)\n").steps.at(0).target_moved_mm,
                   13.0);
  EXPECT_DOUBLE_EQ(
      DiffOf("MOVE (1,2,3,0,0)\n", "MOVE (4,6,VR[1],0,0)\n").steps.at(0).target_moved_mm, 0.0);
}

TEST(SemanticDiff, StepsThatComeAndGo) {
  const ProgramDiff diff =
      DiffOf("OL[11]=ON\nVR[1]=2.\nDELAY 1\n", "VR[1]=2.\nWORKDEF 2,0 (11)\nDELAY 2\n");
  ASSERT_EQ(diff.steps.size(), 3U);
  EXPECT_EQ(diff.steps[0].kind, Kind::kRemoved);
  EXPECT_EQ(diff.steps[0].step_a, 1);
  EXPECT_EQ(diff.steps[0].before, "LET OL[11] = ON");
  EXPECT_EQ(diff.steps[0].aspects, unsigned{kAspectOutputs});
  EXPECT_EQ(diff.steps[1].kind, Kind::kAdded);
  EXPECT_EQ(diff.steps[1].step_b, 2);
  EXPECT_EQ(diff.steps[1].after, "WORKDEF 2,0 (11)");
  EXPECT_EQ(diff.steps[1].aspects, unsigned{kAspectPower});
  EXPECT_EQ(diff.steps[2].what, (Texts{"DELAY 1 -> DELAY 2"}));
  EXPECT_EQ(AspectText(diff.aspects), "time, power, outputs");
}

// Only of a step with the same instruction, variable, process and switch another may be made.
TEST(SemanticDiff, StepsOfOneKindAreChanged) {
  const struct {
    const char *a, *b;
    bool changed;
  } kRows[] = {
      {"VR[1] = 2.", "VR[1] = 3.", true},
      {"VR[1] = 0.", "VR[1] = 1.", true},
      {"VR[1] = 2.", "VR[2] = 2.", false},
      {"VI[1] = 2", "VR[1] = 2.", false},
      {"ASSIGN OL[1] = 5 /4", "ASSIGN OL[1] = 6 /4", true},
      {"ASSIGN OL[1] = 5 /4", "ASSIGN OL[2] = 5 /4", false},
      {"WORK 0,0/ON", "WORK 0,0/ON/END (IL[1])", true},
      {"WORK 0,0/ON", "WORK 0,0/OFF", false},
      {"WORK 0,0/ON", "WORK 0,1/ON", false},
      {"WORK 0,0/ON", "WORK 1,0/ON", false},
      {"WORKDEF 2,0 (11)", "WORKDEF 2,0 (12)", true},
      {"WORKDEF 2,0 (11)", "WORKDEF 2,1 (11)", false},
      {"DELAY 1", "DELAY 2", true},
      {"DELAY 1", "WAIT IL[1]", false},
      {"WORK 1,1/OFF", "CALL 2", false},
      {"WORKDEF 1,1 (8.,75.,1.,50.)", "GO 2", false},
  };
  for (const auto& row : kRows) {
    std::vector<Kind> kinds;
    for (const StepChange& step :
         DiffOf(std::string(row.a) + "\n", std::string(row.b) + "\n").steps)
      kinds.push_back(step.kind);
    std::ranges::sort(kinds);
    std::vector<Kind> expected = {Kind::kChanged};
    if (!row.changed) expected = {Kind::kAdded, Kind::kRemoved};
    std::ranges::sort(expected);
    EXPECT_EQ(kinds, expected) << row.a << " | " << row.b;
  }
}

// OPT-1.25, OPT-7.15: jumps are compared by where they come to.
TEST(SemanticDiff, JumpsAreComparedByTheirTarget) {
  const std::string program = "GOTO 20\n10 VI[2]=1\n20 VI[3]=1\n";
  EXPECT_TRUE(DiffOf(program, "GOTO 7\n1 VI[2]=1\n7 VI[3]=1\n").equal());
  const ProgramDiff other = DiffOf(program, "GOTO 10\n10 VI[2]=1\n20 VI[3]=1\n");
  ASSERT_EQ(other.steps.size(), 1U);
  EXPECT_EQ(other.steps[0].what, (Texts{"goes to step 3 -> step 2"}));
  EXPECT_EQ(other.aspects, unsigned{kAspectFlow});
  EXPECT_TRUE(DiffOf("GOTO 99\n", "GOTO 99\n").equal());
  EXPECT_FALSE(DiffOf("GOTO 99\n", "GOTO 98\n").equal());
  // A step that is new before the target is the only change.
  EXPECT_EQ(DiffOf(program, "GOTO 20\n10 VI[2]=1\nVI[5]=1\n20 VI[3]=1\n").steps.size(), 1U);
}

// OPT-7.16: a number that one of the programs lacks leads elsewhere than in the other.
TEST(SemanticDiff, AMissingNumberIsAnotherTarget) {
  const std::string there = "GOTO 10\n10 VI[2]=1\n", missing = "GOTO 10\nVI[2]=1\n";
  const auto what = [](const std::string& a, const std::string& b) {
    const ProgramDiff diff = DiffOf(a, b);
    EXPECT_EQ(diff.steps.size(), 1U);
    return diff.steps.empty() ? Texts() : diff.steps[0].what;
  };
  EXPECT_EQ(what(there, missing), (Texts{"goes to step 2 -> missing 10"}));
  EXPECT_EQ(what(missing, there), (Texts{"goes to missing 10 -> step 2"}));
  EXPECT_EQ(what(missing, "GOTO 11\nVI[2]=1\n"), (Texts{"goes to missing 10 -> missing 11"}));
  // The first step as well as any other.
  const std::string first = "10 VI[2]=1\nGOTO 10\n", none = "VI[2]=1\nGOTO 10\n";
  EXPECT_EQ(what(first, none), (Texts{"goes to step 1 -> missing 10"}));
  EXPECT_EQ(what(none, first), (Texts{"goes to missing 10 -> step 1"}));
}

TEST(SemanticDiff, FiguresOfRunsAreCompared) {
  const Module module = MustCompile("SPEED 5\n").module;
  const ProgramDiff diff =
      Diff(module, module, {{"time", "s", 10.0}, {"cut", "mm", 5.0}, {"pierces", "", 1.0}},
           {{"time", "s", 12.5}, {"cut", "mm", 5.0 * (1 + 1e-12)}});
  ASSERT_EQ(diff.figures.size(), 2U);
  EXPECT_EQ(diff.figures[0].name, "pierces");
  EXPECT_EQ(diff.figures[0].after, 0.0);
  EXPECT_EQ(diff.figures[1].name, "time");
  EXPECT_EQ(diff.figures[1].before, 10.0);
  EXPECT_EQ(diff.figures[1].after, 12.5);
  EXPECT_FALSE(diff.equal());
}

// OPT-7.41: of two plain values each has one spelling, whatever value stands behind them.
TEST(SemanticDiff, PlainValuesHaveOneSpelling) {
  const auto what = [](const std::string& a, const std::string& b) {
    const ProgramDiff diff = DiffOf(a, b);
    EXPECT_EQ(diff.steps.size(), 1U);
    return diff.steps.empty() ? Texts() : diff.steps[0].what;
  };
  EXPECT_EQ(what("MOVE (0,0,0,0,1)\nWAIT ON\n", "MOVE (0,0,0,0,2.250)\nWAIT ON\n"),
            (Texts{"B 1.0 -> 2.25"}));
  EXPECT_EQ(what("DECLARE FLAG = ON\nVL[1] = FLAG\n", "DECLARE FLAG = OFF\nVL[1] = FLAG\n"),
            (Texts{"ON -> OFF"}));
}

// OPT-7.17: of tables of different lengths the labels that both have are compared, and those of no
// other instruction.
TEST(SemanticDiff, TablesOfDifferentLengthsCompareWhatBothHave) {
  const std::string body = "GOTO 4\n1 VI[2]=1\n2 VI[3]=1\n3 VI[4]=1\n4\n";
  const auto what = [&](const std::string& a, const std::string& b) {
    const ProgramDiff diff = DiffOf(a + body, b + body);
    EXPECT_EQ(diff.steps.size(), 1U);
    Texts goes = diff.steps.empty() ? Texts() : diff.steps[0].what;
    std::erase_if(goes, [](const std::string& text) { return !text.starts_with("goes to"); });
    return goes;
  };
  const std::string two = "GOTO VI[1] (1, 2)\n";
  const std::string three = "GOTO VI[1] (1, 2, 3)\n";
  EXPECT_EQ(what(two, three), Texts());
  EXPECT_EQ(what(three, two), Texts());
  EXPECT_EQ(what(three, "GOTO VI[1] (1, 3)\n"), (Texts{"goes to step 4 -> step 5"}));
}

}  // namespace
}  // namespace rmlcell::optimo
