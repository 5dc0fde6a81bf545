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

// OPT-2.54: a jump is the second value of /TIME ( and of TIMER (, at their own level alone.
TEST(ProgramIndex, TimesJumpWithTheirSecondValueOnly) {
  EXPECT_EQ(Dump("MOVE (1,2,3,0,0)/VIA (4,5,6)"), "");
  EXPECT_EQ(Dump("MOVE (1,2,3,0,0) TIME (2., 900)"), "");  // no attribute without its slash
  EXPECT_EQ(Dump("TIME (2., 900)"), "");
  EXPECT_EQ(Dump("SPEED TIMER (2., 900)"), "");
  EXPECT_EQ(Dump("10 TIMER (2., 900)"), "label 10; jump 900; ");
  EXPECT_EQ(Dump("MOVE (1,2,3,0,0)/TIME (SIN (2, 800), 900)/VIA (1, 700)"), "jump 900; ");
  EXPECT_EQ(Dump("GOTO VI[2] (20, (30, 40), 50)"), "variable VI[2]; jump 20; jump 50; ");
  EXPECT_EQ(Dump("GOTO VI[2] (20, 10000)"), "variable VI[2]; jump 20; ");
  EXPECT_EQ(Dump("GOTO VI[2] (1 + 20)"), "variable VI[2]; jump 1; ");
  EXPECT_EQ(Dump("GOTO 9999"), "jump 9999; ");
  EXPECT_EQ(Dump("GOTO 10000"), "");
  EXPECT_EQ(Dump("GOTO 5."), "");
}

// OPT-1.23: a sequence number goes up to 9999.
TEST(ProgramIndex, ALabelIsANumberThatASequenceNumberCanBe) {
  EXPECT_EQ(Dump("9999 STOP"), "label 9999; ");
  EXPECT_EQ(Dump("10000 STOP"), "");
}

// OPT-7.60: an index that a variable can have; what is none stands there as words.
TEST(ProgramIndex, AVariableHasItsIndexFrom0To99) {
  EXPECT_EQ(Dump("VR[99] = 1"), "variable VR[99]; ");
  EXPECT_EQ(Dump("VR[100] = 1"), "");
  EXPECT_EQ(Dump("VR[5"), "");
  EXPECT_EQ(Dump("VR[5.] = 1"), "");
}

// OPT-7.44: what a name stands for, and whether it is one whole number.
TEST(ProgramIndex, DeclarationsHaveTheirValue) {
  const ProgramIndex index(
      "DECLARE A1 = 44\nDECLARE B1 = VR[3]\nDECLARE C1 = 44 + 1\nDECLARE D1 = 4.5\nDECLARE E1 "
      "=\nDECLARE F1 5\nDECLARE SPEED = 5\n");
  ASSERT_EQ(index.declarations().size(), 4U);
  const auto& declared = index.declarations();
  const auto value = [&](std::size_t i) {
    return std::string(index.text().substr(declared[i].value_begin,
                                           declared[i].value_end - declared[i].value_begin));
  };
  EXPECT_EQ(value(0), "44");
  EXPECT_EQ(declared[0].whole, 44U);
  EXPECT_FALSE(declared[0].variable);
  EXPECT_EQ(value(1), "VR[3]");
  EXPECT_EQ(declared[1].variable, (Variable{VariableGroup::kVr, 3}));
  EXPECT_FALSE(declared[1].whole);
  EXPECT_EQ(value(2), "44 + 1");
  EXPECT_FALSE(declared[2].whole);
  EXPECT_EQ(value(3), "4.5");
  EXPECT_FALSE(declared[3].whole);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(index.TextOf(index.uses()[declared[i].use]).back(), '1') << i;
}

// OPT-7.01, OPT-7.07, OPT-9.01, OPT-6.11
TEST(ProgramIndex, ProgramsAreWhatIsGoneToAndCalled) {
  EXPECT_EQ(Dump("CALL 02 (5, 6)"), "program 02; ");
  EXPECT_EQ(Dump("GO 46/C"), "program 46; ");
  EXPECT_EQ(Dump("FUNCTION 44 (DATO)"), "program 44; name DATO; ");
  EXPECT_EQ(Dump("BREAK 7, 45"), "program 45; ");
  EXPECT_EQ(Dump("CALL VI[1]"), "variable VI[1]; ");
  EXPECT_EQ(Dump("SIMUL 7, 45"), "program 45; ");
  EXPECT_EQ(Dump("BREAK 7 45"), "");
  EXPECT_EQ(Dump("BREAK 7, 45, 46"), "program 45; ");
  EXPECT_EQ(Dump("TASK 7, 45"), "");
  EXPECT_EQ(Dump("10 CALL 44"), "label 10; program 44; ");
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

// OPT-E.7023: an instruction without effect is a word that can be asked for; what stands behind it
// on its line are its parameters, whatever they are.
TEST(ProgramIndex, AnInstructionWithoutEffectIsAWordAlone) {
  const ProgramIndex index("10 CONT XP VR[5]\nSPEED 5\n");
  ASSERT_EQ(index.uses().size(), 3U);  // with the label, and SPEED
  const Use* use = index.At(3);
  ASSERT_NE(use, nullptr);
  EXPECT_EQ(use->kind, UseKind::kWord);
  EXPECT_EQ(use->word, Word::kCont);
  EXPECT_EQ(index.TextOf(*use), "CONT");
  EXPECT_EQ(index.At(8), nullptr);
  EXPECT_EQ(index.TextOf(index.statements()[0]), "CONT XP VR[5]");
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
  const ProgramIndex bounds(
      "WORK 2,9/ON\nWORK 3,0/ON\nWORK 0,10/ON\nWORK 1 0/ON\nWORK XP,0/ON\nWORK 0,0\n");
  ASSERT_EQ(bounds.processes().size(), 2U);
  EXPECT_EQ(bounds.processes()[0].kind, 2);
  EXPECT_EQ(bounds.processes()[0].process, 9);
  EXPECT_FALSE(bounds.processes()[0].off);
  EXPECT_EQ(bounds.processes()[1].statement, 5U);
  EXPECT_FALSE(bounds.processes()[1].on || bounds.processes()[1].off);
}

// OPT-1.03: the text ends at 1Ah.
TEST(ProgramIndex, NothingBehindTheEndOfTextCounts) {
  EXPECT_EQ(Dump("GOTO 10\n\x1AGOTO 20\n"), "jump 10; ");
}

// A parenthesis too many, as while something is written, opens and closes nothing: behind it the
// list is that of the jump.
TEST(ProgramIndex, AParenthesisTooManyLosesNothingBehindIt) {
  EXPECT_EQ(Dump("GOTO VI[2]) (20, 30)"), "variable VI[2]; jump 20; jump 30; ");
  EXPECT_EQ(Dump("MOVE (1,2,3,0,0))/TIME (2., 900)"), "jump 900; ");
}

}  // namespace
}  // namespace rmlcell::optimo::editing
