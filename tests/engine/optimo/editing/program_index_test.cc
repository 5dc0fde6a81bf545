#include "engine/optimo/editing/program_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/optimo/language/checker.h"

namespace rmlcell::optimo::editing {
namespace {

// "jump 900 900" for each use that is no word, in order: kind, number or text.
std::string Dump(std::string_view text) {
  const ProgramIndex index(text);
  std::string out;
  for (const Use& use : index.uses()) {
    switch (use.kind) {
      case UseKind::kWord:
        continue;
      case UseKind::kName:
        out += use.declares ? "declare " : "name ";
        break;
      case UseKind::kLabel:
        out += "label ";
        break;
      case UseKind::kJump:
        out += "jump ";
        break;
      case UseKind::kProgram:
        out += "program ";
        break;
      case UseKind::kVariable:
        out += "variable ";
        break;
    }
    out += std::string(index.TextOf(use)) + "; ";
  }
  return out;
}

// OPT-1.23, OPT-7.15, OPT-7.17, OPT-7.20, OPT-7.23
TEST(ProgramIndex, JumpsAreTheNumbersBehindWordsThatJump) {
  EXPECT_EQ(Dump("10 GOTO 20"), "label 10; jump 20; ");
  EXPECT_EQ(Dump("GOSUB 0100"), "jump 0100; ");
  EXPECT_EQ(Dump("ERR 900"), "jump 900; ");
  EXPECT_EQ(Dump("IF VR[1] > 5 THEN 50 ELSE 60"), "variable VR[1]; jump 50; jump 60; ");
  EXPECT_EQ(Dump("GOTO VI [ 2 ] (20,30, 40)"), "variable VI [ 2 ]; jump 20; jump 30; jump 40; ");
  EXPECT_EQ(Dump("MOVE (1,2,3,0,0)/TIME (2.5+(1), 900)/FLY"), "jump 900; ");
  EXPECT_EQ(Dump("TIMER (5., 900) /AUTO"), "jump 900; ");
  EXPECT_EQ(Dump("DELAY 20"), "");
  EXPECT_EQ(Dump("WORKDEF 1,0 (6,80,1,95)"), "");
}

// OPT-7.01, OPT-7.07, OPT-9.01, OPT-6.11
TEST(ProgramIndex, ProgramsAreWhatIsGoneToAndCalled) {
  EXPECT_EQ(Dump("CALL 02 (5, 6)"), "program 02; ");
  EXPECT_EQ(Dump("GO 46/C"), "program 46; ");
  EXPECT_EQ(Dump("FUNCTION 44 (DATO)"), "program 44; name DATO; ");
  EXPECT_EQ(Dump("BREAK 7, 45"), "program 45; ");
  EXPECT_EQ(Dump("CALL VI[1]"), "variable VI[1]; ");
}

// OPT-7.41, OPT-7.46, OPT-7.60
TEST(ProgramIndex, NamesAreWhatIsNotReserved) {
  EXPECT_EQ(Dump("DECLARE YHOME = 45.0"), "declare YHOME; ");
  EXPECT_EQ(Dump("declare caxis = OL [11]"), "declare caxis; variable OL [11]; ");
  EXPECT_EQ(Dump("VR[N] = XP + 1"), "name N; name XP; ");
  const ProgramIndex index("DECLARE POSITION1 = VR[1]\nPOSITION = 5.");
  ASSERT_EQ(index.uses().size(), 4U);
  EXPECT_EQ(index.uses()[1].key, index.uses()[3].key);  // eight characters count
}

// OPT-6.01, OPT-1.27: DECLARE, comments and lone numbers are no steps.
TEST(ProgramIndex, StepsAreCountedAsTheCheckerCountsThem) {
  constexpr std::string_view kText =
      "; a comment\nDECLARE X = VR[0]\n10 SPEED 5\n20\n30 ; alone\nMOVE (1,2,\n 3,0,0)/\nFLY\n"
      "CONT 3 /\nSPEED 7 ; last\n40\n";
  const ProgramIndex index(kText);
  Findings findings;
  ParsedProgram program = Parse(kText, findings);
  Check(program, findings);
  EXPECT_EQ(index.step_count(), program.module.step_count);
  EXPECT_EQ(index.step_count(), 4U);
  EXPECT_EQ(index.StepOfLabel(*index.FindLabel(20)), 2U);
  EXPECT_EQ(index.StepOfLabel(*index.FindLabel(30)), 2U);
  EXPECT_EQ(index.StepOfLabel(*index.FindLabel(40)), 5U);  // the end
}

TEST(ProgramIndex, AHalfWrittenLineLosesNothingBehindIt) {
  EXPECT_EQ(Dump("MOVE (XP, \n10 GOTO 20\n"), "name XP; label 10; jump 20; ");
  EXPECT_EQ(Dump("SPEED @@ XP\n10 GOTO 20\n"), "name XP; label 10; jump 20; ");
  EXPECT_EQ(Dump("GOTO\n10 GOSUB\n"), "label 10; ");
}

TEST(ProgramIndex, FindsWhatStandsAtAPlaceAndWhatEndsThere) {
  constexpr std::string_view kText = "10 X=VR[5]+Y ; GOTO 10";
  const ProgramIndex index(kText);
  const auto at = [&](std::size_t offset) {
    const Use* use = index.At(offset);
    return use == nullptr ? std::string() : std::string(index.TextOf(*use));
  };
  EXPECT_EQ(at(0), "10");
  EXPECT_EQ(at(2), "10");  // behind it
  EXPECT_EQ(at(3), "X");
  EXPECT_EQ(at(4), "X");
  EXPECT_EQ(at(5), "VR[5]");
  EXPECT_EQ(at(9), "VR[5]");
  EXPECT_EQ(at(10), "VR[5]");
  EXPECT_EQ(at(11), "Y");
  EXPECT_EQ(at(13), "");
  EXPECT_EQ(index.CommentAt(13), nullptr);
  EXPECT_NE(index.CommentAt(14), nullptr);
}

// OPT-3.01, OPT-3.13
TEST(ProgramIndex, ProcessesAreWorkdefsAndTheirWorks) {
  const ProgramIndex index(
      "WORKDEF 1,05 (8.,75.,1.,50.)\nWORK 1,5/ON\nWORK 1,5 /OFF\nWORK 3,0/ON\n");
  ASSERT_EQ(index.processes().size(), 3U);
  EXPECT_TRUE(index.processes()[0].defines);
  EXPECT_EQ(index.processes()[0].process, 5);
  EXPECT_TRUE(index.processes()[1].on);
  EXPECT_TRUE(index.processes()[2].off);
  EXPECT_EQ(ProcessOf(index, index.statements()[2])->off, true);
  EXPECT_EQ(ProcessOf(index, index.statements()[3]), nullptr);
}

// OPT-1.03: the text ends at 1Ah.
TEST(ProgramIndex, NothingBehindTheEndOfTextCounts) {
  EXPECT_EQ(Dump("GOTO 10\n\x1AGOTO 20\n"), "jump 10; ");
}

}  // namespace
}  // namespace rmlcell::optimo::editing
