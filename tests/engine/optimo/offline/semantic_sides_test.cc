#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/offline/semantic_diff.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// "kind step_a step_b before -> after" of each change.
std::vector<std::string> ChangesOf(const std::string& a, const std::string& b) {
  std::vector<std::string> lines;
  for (const StepChange& change : Diff(MustCompile(a).module, MustCompile(b).module).steps) {
    const char kind = change.kind == StepChange::Kind::kAdded     ? '+'
                      : change.kind == StepChange::Kind::kRemoved ? '-'
                                                                  : '*';
    lines.push_back(std::string(1, kind) + " " + std::to_string(change.step_a) + " " +
                    std::to_string(change.step_b) + " " + change.before + " -> " + change.after);
  }
  return lines;
}
using Lines = std::vector<std::string>;

// semantic_diff.h: between two equal stretches each step is made from one of its kind, in order.
TEST(SemanticSides, StepsInARowAreChangedOneByOne) {
  EXPECT_EQ(
      ChangesOf("VI[9]=1\nDELAY 1.\nVI[1]=5\nOL[2]=ON\n", "VI[9]=1\nDELAY 3.\nVI[1]=6\nOL[2]=ON\n"),
      (Lines{"* 2 2 DELAY 1.0 -> DELAY 3.0", "* 3 3 LET VI[1] = 5 -> LET VI[1] = 6"}));
}

// What an instruction is counts, also where nothing stands behind its word.
TEST(SemanticSides, OfTwoWordsOneComesAndOneGoes) {
  EXPECT_EQ(ChangesOf("NOERR\n", "RETURN\n"), (Lines{"+ 0 1  -> RETURN", "- 1 0 NOERR -> "}));
}

TEST(SemanticSides, AChangeBehindAnAdditionIsOneOfItsOwnStep) {
  EXPECT_EQ(ChangesOf("VI[9]=1\nDELAY 1.\nOL[2]=ON\n", "VI[9]=1\nVI[1]=5\nDELAY 3.\nOL[2]=ON\n"),
            (Lines{"+ 0 2  -> LET VI[1] = 5", "* 2 3 DELAY 1.0 -> DELAY 3.0"}));
}

TEST(SemanticSides, StepsInARowGo) {
  EXPECT_EQ(
      ChangesOf("VI[9]=1\nDELAY 1.\nVI[1]=5\nVI[2]=6\nOL[2]=ON\nDELAY 4.\n", "VI[9]=1\nOL[2]=ON\n"),
      (Lines{"- 2 0 DELAY 1.0 -> ", "- 3 0 LET VI[1] = 5 -> ", "- 4 0 LET VI[2] = 6 -> ",
             "- 6 0 DELAY 4.0 -> "}));
  EXPECT_EQ(ChangesOf("DELAY 1.\nVI[1]=5\n", ""),
            (Lines{"- 1 0 DELAY 1.0 -> ", "- 2 0 LET VI[1] = 5 -> "}));
}

// OPT-3.46: ENDTASK at the end and declarations are no steps, alone and in any order.
TEST(SemanticSides, WhatStandsAtTheEndIsNoStep) {
  for (const std::string text : {"ENDTASK\n", "DECLARE X = 1\n", "ENDTASK\nDECLARE X = 1\n",
                                 "DECLARE X = 1\nENDTASK\nDECLARE Y = 1\n"}) {
    EXPECT_EQ(ChangesOf(text, ""), Lines{}) << text;
    EXPECT_EQ(ChangesOf("", text), Lines{}) << text;
    EXPECT_EQ(ChangesOf("DELAY 1.\n" + text, "DELAY 1.\n"), Lines{}) << text;
  }
}

// How far a target moved is known only where all three coordinates are numbers, before and behind.
TEST(SemanticSides, OnlyPlainTargetsMoveByALength) {
  const auto moved = [](const std::string& a, const std::string& b) {
    const ProgramDiff diff = Diff(MustCompile("MOVE (" + a + ",0,0)\n").module,
                                  MustCompile("MOVE (" + b + ",0,0)\n").module);
    return diff.steps.size() == 1 ? diff.steps[0].target_moved_mm : -1.0;
  };
  EXPECT_EQ(moved("1,2,3", "4,6,15"), 13.0);
  EXPECT_EQ(moved("1,2,3", "1,2,-4"), 7.0);
  EXPECT_EQ(moved("VR[1],2,3", "4,6,15"), 0.0);
  EXPECT_EQ(moved("1,2,3", "VR[1],6,15"), 0.0);
  EXPECT_EQ(moved("1,VR[1],3", "4,6,15"), 0.0);
  EXPECT_EQ(moved("1,2,3", "4,6,VR[1]"), 0.0);
  EXPECT_EQ(moved("1,2,VR[1]", "4,6,VR[1]"), 0.0);
}

// OPT-2.54 to OPT-2.58: each attribute by its own value.
TEST(SemanticSides, AttributesChangeByTheirOwnValue) {
  const auto what = [](const std::string& a, const std::string& b) {
    const ProgramDiff diff = Diff(MustCompile("MOVE (1,2,3,0,0)" + a + "\n").module,
                                  MustCompile("MOVE (1,2,3,0,0)" + b + "\n").module);
    return diff.steps.size() == 1 ? diff.steps[0].what : Lines{"?"};
  };
  EXPECT_EQ(what("/START (VL[1])", "/START (VL[2])"), (Lines{"/START VL[1] -> VL[2]"}));
  EXPECT_EQ(what("/END (VL[1])", "/END (VL[2])"), (Lines{"/END VL[1] -> VL[2]"}));
  EXPECT_EQ(what("/START (VL[1])/END (VL[3])", "/START (VL[2])/END (VL[4])"),
            (Lines{"/START VL[1] -> VL[2]", "/END VL[3] -> VL[4]"}));
}

// OPT-2.34: SPEED counts where a MOVE runs with it, and nowhere else; variables in the MOVE are no
// reason to look at it where it stands.
TEST(SemanticSides, SpeedCountsWhereItIsUsed) {
  EXPECT_EQ(ChangesOf("SPEED 5\nDELAY 1.\n", "SPEED 6\nDELAY 1.\n"), Lines{});
  EXPECT_EQ(ChangesOf("SPEED 5\nMOVE (VR[1],2,3,0,0)\n", "SPEED 6\nMOVE (VR[1],2,3,0,0)\n"),
            (Lines{"* 2 2 MOVE (VR[1], 2, 3, 0, 0) -> MOVE (VR[1], 2, 3, 0, 0)"}));
}

// Of several PATHs a MOVE has the last one, and that alone.
TEST(SemanticSides, OfSeveralPathsTheLastCounts) {
  const std::string move = "MOVE (1,2,3,0,0)\n", next = "MOVE (4,2,3,0,0)\n";
  EXPECT_EQ(ChangesOf("PATH LIN\nPATH CIR\n" + move, "PATH CIR\n" + move), Lines{});
  const ProgramDiff diff = Diff(MustCompile("PATH LIN\n" + move + "PATH CIR\n" + next).module,
                                MustCompile("PATH LIN\n" + move + "PATH PTP\n" + next).module);
  ASSERT_EQ(diff.steps.size(), 1U);
  EXPECT_EQ(diff.steps[0].what, (Lines{"PATH CIR -> PATH PTP"}));
}

// semantic_diff.h: a jump comes to the first step from there on that both programs have: one that
// only one of them has before it is the only change.
TEST(SemanticSides, AJumpToAStepThatOneProgramLacks) {
  const std::string with = "VI[9]=1\nGOTO 10\n10 VI[5]=1\nVI[2]=1\n",
                    without = "VI[9]=1\nGOTO 10\n10 VI[2]=1\n";
  EXPECT_EQ(ChangesOf(with, without), (Lines{"- 3 0 LET VI[5] = 1 -> "}));
  EXPECT_EQ(ChangesOf(without, with), (Lines{"+ 0 3  -> LET VI[5] = 1"}));
}

// A zero is written as one, with either sign.
TEST(SemanticSides, ZerosAreToldAsZeros) {
  const auto what = [](const std::string& x) {
    return Diff(MustCompile("MOVE (" + x + ",2,3,0,0)\n").module,
                MustCompile("MOVE (5,2,3,0,0)\n").module)
        .steps.at(0)
        .what;
  };
  EXPECT_EQ(what("0"), (Lines{"X 0.0 -> 5.0"}));
  EXPECT_EQ(what("-0.0"), (Lines{"X 0.0 -> 5.0"}));
}

// OPT-3.46, OPT-E.7023: instructions without effect are no steps, wherever they stand; what stands
// behind one of them, or behind an ENDTASK, is one.
TEST(SemanticSides, WhatStandsBehindNothingIsAStep) {
  for (const std::string text : {"CONT 3\n", "ENDTASK\n", "DECLARE X = 1\nCONT 3\nENDTASK\n"}) {
    EXPECT_EQ(ChangesOf(text, ""), Lines{}) << text;
    EXPECT_EQ(ChangesOf("DELAY 1.\n" + text, "DELAY 1.\n"), Lines{}) << text;
  }
  for (const std::string text : {"CONT 3\n", "ENDTASK\n"}) {
    EXPECT_EQ(ChangesOf(text + "DELAY 1.\n", text + "DELAY 2.\n"),
              (Lines{"* 2 2 DELAY 1.0 -> DELAY 2.0"}))
        << text;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
