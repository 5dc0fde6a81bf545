#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/language/linker.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/optimo/language/compile_text.h"

// What findings in a text know besides the text.
namespace rmlcell::optimo {
namespace {

struct ArgumentsRow {
  std::string program;
  int number;
  std::string detail;
  std::string arguments;
};

void ExpectArguments(const std::vector<ArgumentsRow>& rows, bool advice = false) {
  for (const ArgumentsRow& row : rows) {
    bool found = false;
    for (const Diagnostic& d : Compile(row.program, "", {.advice = advice}).diagnostics) {
      if (found || Lookup(d.code).number != row.number) continue;
      found = true;
      EXPECT_EQ(d.detail, row.detail);
      EXPECT_EQ(ArgumentsText(d.detail), row.arguments) << row.program;
    }
    EXPECT_TRUE(found) << row.program;
  }
}

TEST(FindingArguments, CountsOfValues) {
  ExpectArguments({
      {"MOVE (1, 2)\n", 7019, "MOVE has 2 values, needs 5", "instruction='MOVE' values=2 needed=5"},
      {"SYSDEF (1)\n", 7019, "SYSDEF has 1 value, needs 6 or none",
       "instruction='SYSDEF' values=1 needed='6 or none'"},
      {"TCP (1,2,3)\n", 7019, "TCP has 3 values, needs 6", "instruction='TCP' values=3 needed=6"},
      {"TCP\n", 7019, "TCP has 0 values, needs 6", "instruction='TCP' values=0 needed=6"},
      {"WORKDEF 2,1,(1,2)\n", 7019, "WORKDEF 2 has 2 values, needs 1: the laser schedule",
       "instruction='WORKDEF' kind=2 values=2 needed='1: the laser schedule'"},
      {"MOVE (1,2,3,4,5)/VIA (1)\n", 7019, "/VIA has 1 value, needs 5",
       "attribute='/VIA' values=1 needed=5"},
  });
}

TEST(FindingArguments, WordsOfTheText) {
  ExpectArguments({
      {"WORK 0,0/ON/ON\n", 7021, "'ON' stands twice", "attribute='ON'"},
      {"SPEED = \n", 7003, "expected a number, a variable, a name or '(', found '='",
       "expected='a number, a variable, a name or '('' found='='"},
      {"VR[100] = 1\n", 7017, "index 100 is outside 0..99", "index=100 most=99"},
      {"PAR[008] = 1\n", 7017, "index 008 is outside 0..7", "index=8 most=7"},
      {"10 DELAY 1\n10 DELAY 1\n", 7007, "sequence number 10 stands on line 1 already",
       "label=10 line=1"},
      {"GOTO 60\n", 7008, "no sequence number 60", "label=60"},
      {"DECLARE SPEED = 1\n", 7009, "'SPEED' is reserved", "name='SPEED'"},
      {"IL[3] = 1\n", 7016, "IL[3] can only be read", "variable='IL[3]'"},
      {"CONT 3\n", 7023, "CONT has no effect", "word='CONT'"},
      {"VR[0] = 1 E 100\n", 7005, "'1 E 100' is no number", "word='1 E 100'"},
      {"DECLARE TEN = 10\nDELAY TENN\n", 7011, "TENN is not declared; did you mean TEN?",
       "name='TENN' near='TEN'"},
  });
}

TEST(FindingArguments, AdviceOnMoves) {
  const std::string cut =
      "COORD ABSOL\nPATH LIN\nWORKDEF 1,1,(10,50,1,50)\nMOVE (0,0,0,0,0)\nOL[11]=ON\nWORK "
      "1,1/ON\nSPEED 20.5\nMOVE (9,0,0,0,0)\nWORK 1,1/OFF\n";
  ExpectArguments(
      {{cut, 7033, "SPEED 20.5 with the beam on; cutting takes 5 to 15 %", "speed=20.5 %"}}, true);
}

TEST(FindingArguments, WhatTheLinkerMisses) {
  const std::string object = MustCompile("FUNCTION 7\n").object;
  const auto linked = Link(
      3,
      [&](int slot) { return slot == 3 ? std::optional<std::string_view>(object) : std::nullopt; },
      {});
  ASSERT_FALSE(linked);
  EXPECT_EQ(linked.error().detail, "no object for FUNCTION 7 in program 3, step 1");
  EXPECT_EQ(ArgumentsText(linked.error().detail), "function=7 program=3 step=1");
}

TEST(FindingArguments, SizesAreInBytes) {
  const Compilation compiled = Compile("SPEED 5\n", "", {.object_limit = 10, .advice = false});
  ASSERT_FALSE(compiled.ok);
  const std::vector<Argument>& arguments = compiled.diagnostics[0].detail.arguments();
  ASSERT_EQ(arguments.size(), 2U);
  EXPECT_EQ(arguments[0].name, "bytes");
  EXPECT_EQ(arguments[0].unit, "bytes");
  EXPECT_EQ(arguments[1], (Argument{"limit", 10.0, "bytes"}));
}

// Bytes of the text that no screen shows are told as they are shown.
TEST(FindingArguments, WhatIsQuotedIsToldAsItIsShown) {
  const Compilation compiled = Compile("DELAY \x01\n", "", {.advice = false});
  ASSERT_FALSE(compiled.diagnostics.empty());
  const Detail& detail = compiled.diagnostics[0].detail;
  EXPECT_EQ(detail, "'\\x01' cannot stand here");
  EXPECT_EQ(ArgumentsText(detail), "word='\\x01'");
  EXPECT_EQ(Compile("DELAY \x7F\n", "", {.advice = false}).diagnostics.at(0).detail,
            "'\\x7F' cannot stand here");
}

// Of long words the first forty characters are told.
TEST(FindingArguments, WhatIsQuotedIsShort) {
  const auto told = [](std::size_t length) {
    const std::string text = "SPEED 5 " + std::string(length, 'A') + "\n";
    return std::string(Compile(text, "", {.advice = false}).diagnostics.at(0).detail);
  };
  const std::string most(40, 'A');
  EXPECT_TRUE(told(40).ends_with("found '" + most + "'")) << told(40);
  EXPECT_TRUE(told(41).ends_with("found '" + most + "...'")) << told(41);
}

}  // namespace
}  // namespace rmlcell::optimo
