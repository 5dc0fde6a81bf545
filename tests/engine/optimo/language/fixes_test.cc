#include "engine/optimo/language/fixes.h"

#include <gtest/gtest.h>

#include "engine/core/text_fixes.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

std::string Fixed(const std::string& text) {
  return ApplyFixes(text, Compile(text, "", {}).diagnostics);
}

// OPT-7.91: the proposed word is put in place of the mistyped one.
TEST(Fixes, MistypedWordsAreCorrected) {
  EXPECT_EQ(Fixed("SPEDE 20 ; slow\nSPEED 5\n"), "SPEED 20 ; slow\nSPEED 5\n");
  EXPECT_EQ(Fixed("DECLARE XHOME = VR[1]\nXHOEM = 5.\n"), "DECLARE XHOME = VR[1]\nXHOME = 5.\n");
}

// OPT-7.91, OPT-7.60: of a variable with an index by name only the name is put right.
TEST(Fixes, MistypedIndexesAreCorrected) {
  EXPECT_EQ(Fixed("DECLARE VALVE = 16\nOL[VAVLE] = ON\nVR [ vavle ] = 5.*VR[VAVLE]\n"),
            "DECLARE VALVE = 16\nOL[VALVE] = ON\nVR [ VALVE ] = 5.*VR[VALVE]\n");
  EXPECT_EQ(Fixed("DECLARE FIVE = 5\nVR[30] = SQRT(VR ; c\n [\n FIEV ])\n"),
            "DECLARE FIVE = 5\nVR[30] = SQRT(VR ; c\n [\n FIVE ])\n");
  const std::vector<Diagnostic> found =
      Compile("DECLARE VALVE=16\nOL[VAVLE] = ON\n", "", {}).diagnostics;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].where, (SourceSpan{.line = 2, .column = 4, .length = 5, .byte_offset = 20}));
}

// OPT-7.50: a program that would stay valid with another variable is left to the programmer.
TEST(Fixes, NoNameIsMadeAnotherThatMayNotBeMeant) {
  const std::string text =
      "DECLARE POS1 = VR[1]\nDECLARE POS2 = VR[2]\nDECLARE ZONE1 = VL[1]\n"
      "DECLARE XPOS = VR[3]\nPOS3 = 7\nZONE3 = ON\nYPOS = 7\nXPO = 7\n";
  EXPECT_EQ(Fixed(text), text);
  const std::vector<Diagnostic> found = Compile(text, "", {}).diagnostics;
  ASSERT_EQ(found.size(), 4U);
  EXPECT_NE(found[0].detail.find("did you mean POS1 or POS2?"), std::string::npos);
  EXPECT_NE(found[2].detail.find("did you mean XPOS?"), std::string::npos);
}

// OPT-1.32: some editors put it there unasked.
TEST(Fixes, AByteOrderMarkIsTakenOut) {
  EXPECT_EQ(FindingsOf("\xEF\xBB\xBFSPEED 5\n"), (std::vector<int>{7001}));
  EXPECT_EQ(Fixed("\xEF\xBB\xBFSPEED 5\n"), "SPEED 5\n");
  EXPECT_EQ(Fixed("SPEED 5\n\xEF\xBB\xBFSPEED 6\n"), "SPEED 5\n\xEF\xBB\xBFSPEED 6\n");
}

// OPT-7.91, OPT-1.29: digits behind the word of an instruction are its operand, never waste.
TEST(Fixes, OperandsAreParted) {
  EXPECT_EQ(
      Fixed("GOTO10\nGOSUB10\n10 SPEED20\nTASK1\nSPEED33.\nGO46/C\nWORK0,0/ON\nFUNCTION44\n"),
      "GOTO 10\nGOSUB 10\n10 SPEED 20\nTASK 1\nSPEED 33.\nGO 46/C\nWORK 0,0/ON\nFUNCTION 44\n");
  EXPECT_EQ(
      Compile("SPEED20\n", "", {}).diagnostics.at(0).detail,
      "'SPEED20' is no instruction and no declared name; a blank is missing before its digits");
}

// OPT-7.91: no repair where none makes the statement right, several do, or it would do nothing.
TEST(Fixes, WhatIsNotSureIsOnlyProposed) {
  for (const char* text :
       {"SYSDEF86\n", "STOP1\n", "REAL1\n", "GOT 10\n", "WORKD 1,0 (8,75,0,50)\n", "SPEDE 20 20\n",
        "CON 5\n", "DECLARE XHOME = VR[1]\nXHOEM 5.\n"}) {
    EXPECT_EQ(Fixed(text), text);
  }
}

// A statement is repaired as long as it stays below 2000 bytes.
TEST(Fixes, LongStatementsAreLeftToTheProgrammer) {
  std::string ones;
  for (int n = 0; n < 996; ++n) ones += "+1";
  EXPECT_EQ(Fixed("SPEDE 1" + ones + "\n"), "SPEED 1" + ones + "\n");  // 7 + 2 * 996 = 1999
  EXPECT_EQ(Fixed("SPEDE  1" + ones + "\n"), "SPEDE  1" + ones + "\n");
}

// What takes an attribute out: with its '/' and the blanks before it, and no value of its name.
TEST(Fixes, AttributesAreFoundBehindTheirSlash) {
  struct Row {
    std::string text;
    Word word;
    std::string without;
  };
  for (const Row& row : {Row{"TIMER /DIS\n", Word::kDis, "TIMER\n"},
                         Row{"SPEED 5\nTIMER\t /DIS ; x\n", Word::kDis, "SPEED 5\nTIMER ; x\n"},
                         Row{"WORK 0,0/START (ON)/ON\n", Word::kOn, "WORK 0,0/START (ON)\n"},
                         Row{"10 UPDATE IL / ON\n", Word::kOn, "10 UPDATE IL\n"}}) {
    Findings none;
    const ParsedProgram program = Parse(row.text, none);
    const auto fix = AttributeRemoval(program, program.module.instructions.back(), row.word);
    ASSERT_TRUE(fix) << row.text;
    std::string text = row.text;
    text.replace(static_cast<std::size_t>(fix->byte_offset), static_cast<std::size_t>(fix->length),
                 fix->text);
    EXPECT_EQ(text, row.without);
    EXPECT_FALSE(AttributeRemoval(program, program.module.instructions.back(), Word::kFly));
  }
}

// OPT-2.61, OPT-2.47, OPT-9.24, OPT-7.37
TEST(Fixes, WhatHasNoEffectIsTakenOut) {
  EXPECT_EQ(Fixed("MOVE (1.,2.,3.,0.,0.) / INF ; x\n"), "MOVE (1.,2.,3.,0.,0.) ; x\n");
  EXPECT_EQ(Fixed("MOVE (1.,2.,3.,0.,0.)/FLY\n"), "MOVE (1.,2.,3.,0.,0.)\n");
  EXPECT_EQ(Fixed("DEFINE PAR = INT\n"), "DEFINE PAR[0] = INT\n");
  EXPECT_EQ(Fixed("SYSDEF (0,0,0,0,0,0) ; off\n"), "SYSDEF ; off\n");
}

// OPT-7.37, OPT-1.30: what would take a comment away is told, but not repaired.
TEST(Fixes, NoFixTakesACommentAway) {
  const std::string text = "SYSDEF (0,0,0, ; place\n0,0,0)\n";
  EXPECT_EQ(Compile(text, "", {}).diagnostics.front().code, ErrorCode::kSysdefAllZero);
  EXPECT_EQ(Fixed(text), text);
}

// OPT-1.30, OPT-2.61: an attribute on the next line, with comments on the way.
TEST(Fixes, CommentsWithinAStatementStay) {
  EXPECT_EQ(Fixed("MOVE (1.,2.,3.,0.,0.) / ; one\n; two\n  INF ; three\n"),
            "MOVE (1.,2.,3.,0.,0.) ; one\n; two\n   ; three\n");
  EXPECT_EQ(Fixed("MOVE (1.,2.,3.,0.,0.)\n  /INF ; three\n"), "MOVE (1.,2.,3.,0.,0.)\n ; three\n");
}

// A text without fixes stays as it is; of findings whose fixes overlap the first is repaired, and
// the other one not in parts.
TEST(Fixes, FirstOfOverlappingFixesWins) {
  EXPECT_EQ(Fixed("SPEED 101\n"), "SPEED 101\n");
  const Diagnostic one{.code = ErrorCode::kSyntax,
                       .severity = Severity::kCompile,
                       .detail = {},
                       .rule = {},
                       .file = {},
                       .where = {},
                       .fixes = {{0, 3, "A"}}};
  Diagnostic two = one;
  two.fixes = {{2, 3, "B"}, {5, 1, "C"}};
  EXPECT_EQ(ApplyFixes("012345678", std::vector<Diagnostic>{one, two}), "A345678");
  EXPECT_EQ(ApplyFixes("012345678", std::vector<Diagnostic>{two, one}), "01BC678");
  two.fixes = {{3, 2, "B"}, {8, 1, "C"}};
  EXPECT_EQ(ApplyFixes("012345678", std::vector<Diagnostic>{two, one}), "AB567C");
  two.fixes = {{100, 3, "B"}};
  EXPECT_EQ(ApplyFixes("012345678", std::vector<Diagnostic>{one, two}), "A345678");
}

// OPT-7.91, OPT-E.7023: what a word without effect lacks is nothing.
TEST(Fixes, NoBlankIsPutBehindAWordWithoutEffect) {
  for (const std::string text : {"CONT5\n", "WEAV1\n"}) {
    EXPECT_EQ(Fixed(text), text);
    const std::string detail = Compile(text, "", {}).diagnostics.at(0).detail;
    EXPECT_EQ(detail.find("blank"), detail.npos) << detail;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
