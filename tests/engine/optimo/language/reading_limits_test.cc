// How far a parser looks for what was meant, how much of it a finding shows, and where it goes on
// when it went too far: one side of each number, and the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::reading_limits {
namespace {

// The only finding of a text.
Diagnostic OnlyFinding(std::string_view text) {
  const Compilation compiled = Compile(text, "", {.advice = false});
  EXPECT_EQ(compiled.diagnostics.size(), 1U) << text.substr(0, 80);
  return compiled.diagnostics.empty() ? Diagnostic{} : compiled.diagnostics[0];
}

// OPT-1.32: forty characters of what cannot stand there, those that nobody sees by their numbers.
TEST(ReadingLimits, FortyCharactersAreShown) {
  const std::string forty(40, '~');
  EXPECT_EQ(OnlyFinding(forty + "\n").detail, "'" + forty + "' cannot stand here");
  EXPECT_EQ(OnlyFinding(forty + "~\n").detail, "'" + forty + "...' cannot stand here");
  EXPECT_EQ(OnlyFinding("\x1F\x7F\n").detail, "'\\x1F\\x7F' cannot stand here");
}

// OPT-7.91: a repair is tried on a statement of up to 1999 bytes. SPEED is one letter more than
// SPED, and 20 are two.
TEST(ReadingLimits, LongStatementsAreNotRepaired) {
  const auto fixes = [](std::size_t blanks) {
    return OnlyFinding("SPED" + std::string(blanks, ' ') + "20\n").fixes;
  };
  EXPECT_EQ(fixes(1), (std::vector<Fix>{{0, 4, "SPEED"}}));
  EXPECT_EQ(fixes(1999 - 7), (std::vector<Fix>{{0, 4, "SPEED"}}));
  EXPECT_TRUE(fixes(2000 - 7).empty());
}

// OPT-7.91: the first five hundred names are compared with a mistyped one.
TEST(ReadingLimits, FiveHundredNamesAreCompared) {
  const auto said = [](int before) {
    std::string text;
    for (int n = 0; n < before; ++n) text += "DECLARE N" + std::to_string(n) + " = VR[1]\n";
    return std::string(OnlyFinding(text + "DECLARE XHOME = VR[2]\nXHOEM 5.\n").detail);
  };
  const std::string unknown = "'XHOEM' is no instruction and no declared name";
  EXPECT_EQ(said(499), unknown + "; did you mean XHOME?");
  EXPECT_EQ(said(500), unknown);
}

// Behind an error an assignment is a statement of its own where its '=' is one of the first forty
// characters of the line.
TEST(ReadingLimits, AnAssignmentIsSeenWithinFortyCharacters) {
  const auto statements = [](std::size_t blanks) {
    Findings findings;
    const std::string next = "X1" + std::string(blanks, ' ') + "= 5\n";
    return Parse("VR[2] = (1 #\n+ 2\n" + next, findings, Places::kStatements).statements.size();
  };
  EXPECT_EQ(statements(1), 2U);
  EXPECT_EQ(statements(37), 2U);
  EXPECT_EQ(statements(38), 1U);
}

// OPT-1.25, OPT-E.7023: what is left of a line without effect, and a line that was read as part of
// the statement before it, are read again; lines are counted and comments kept once.
TEST(ReadingLimits, WhatIsReadAgainCountsOnce) {
  const auto first_line_of_10 = [](const std::string& before) {
    const std::string text = before + "10 SPEED 5\n10 SPEED 6\n";
    for (const Diagnostic& d : Compile(text, "", {.advice = false}).diagnostics) {
      if (d.code == ErrorCode::kLabelDuplicate) return std::string(d.detail);
    }
    return std::string();
  };
  const auto told = [](int line) {
    return "sequence number 10 stands on line " + std::to_string(line) + " already";
  };
  EXPECT_EQ(first_line_of_10(""), told(1));
  EXPECT_EQ(first_line_of_10("CONT (\n"), told(2));
  EXPECT_EQ(first_line_of_10("CONT (,\n; a\n\n"), told(4));
  EXPECT_EQ(first_line_of_10("MOVE (1, 2\nVR[5] = 1.\n"), told(3));
  const auto comments = [](std::string_view text) {
    Findings findings;
    return Parse(text, findings, Places::kStatements).comments.size();
  };
  EXPECT_EQ(comments("CONT;a\nSTOP\n"), 1U);
  EXPECT_EQ(comments("CONT ( ;a\n;b\nSTOP ;c\n"), 3U);
  EXPECT_EQ(comments("MOVE (1, 2 ;a\nVR[5] = 1. ;b\nSTOP ;c\n"), 3U);
}

// OPT-1.03, OPT-1.18: a comment has no line end, and what lies behind a text is none of it.
TEST(ReadingLimits, ACommentEndsWithItsLine) {
  const auto ends = [](std::string_view text) {
    Findings findings;
    const ParsedProgram program = Parse(text, findings, Places::kStatements);
    std::vector<std::uint32_t> all;
    for (const Comment& comment : program.comments) all.push_back(comment.end);
    return all;
  };
  using Ends = std::vector<std::uint32_t>;
  EXPECT_EQ(ends("STOP ; a\r\r\n; b\r\n;\r\n; c"), (Ends{8, 14, 17, 22}));
  constexpr std::string_view kLonger = "STOP ; a b\nSTOP\nSTOP\n";
  EXPECT_EQ(ends(kLonger), Ends{10});
  EXPECT_EQ(ends(kLonger.substr(0, 8)), Ends{8});
}

// lexer.h: the first word too many is told, and nothing behind it.
TEST(ReadingLimits, TheFirstWordTooManyIsTold) {
  std::string text = "VR[1]=1";  // six words, and two for each sum
  for (int n = 0; n < 49'997; ++n) text += "+1";
  const auto end = static_cast<int>(text.size());
  const Diagnostic told = OnlyFinding(text + "+1+1\n");
  EXPECT_EQ(told.code, ErrorCode::kSyntax);
  EXPECT_EQ(told.detail, "the statement is too long");
  EXPECT_EQ(told.where, (SourceSpan{1, end + 1, 1, end}));
}

}  // namespace
}  // namespace rmlcell::optimo::reading_limits
