#include "engine/optimo/language/fixes.h"

#include <gtest/gtest.h>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

std::string Fixed(const std::string& text) {
  return ApplyFixes(text, Compile(text, "", {}).diagnostics);
}

// OPT-7.91: the proposed word is put in place of the mistyped one.
TEST(Fixes, MistypedWordsAreCorrected) {
  EXPECT_EQ(Fixed("SPEDE 20 ; slow\nSPEED 5\n"), "SPEED 20 ; slow\nSPEED 5\n");
  EXPECT_EQ(Fixed("DECLARE XHOME = VR[1]\nXHOM = 5.\n"), "DECLARE XHOME = VR[1]\nXHOME = 5.\n");
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

}  // namespace
}  // namespace rmlcell::optimo
