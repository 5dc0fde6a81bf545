#include "engine/optimo/offline/literal_text.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rmlcell::optimo {
namespace {

// OPT-7.62: signs, blanks, exponents.
TEST(LiteralText, LiteralsHaveTheirValue) {
  const std::vector<std::pair<std::string, double>> rows = {
      {"5", 5.0},
      {"-5.25", -5.25},
      {"+5.", 5.0},
      {"--5", 5.0},
      {"-+5", -5.0},
      {"- + -5", 5.0},
      {".256 E -3", 0.000256},
      {"1E+2", 100.0},
      {"- 1.5\tE 2", -150.0},
      {"1\n2", 12.0},
      {"0", 0.0},
      {" 7 ", 7.0},
      {"-\r\n3", -3.0},
  };
  for (const auto& [text, value] : rows) {
    const auto found = LiteralValue(text);
    ASSERT_TRUE(found) << text;
    EXPECT_DOUBLE_EQ(*found, value) << text;
  }
  for (const std::string text : {"", "x", "5x", "-", "1.2.3", "5-3", "5+3", "5+", "1E2+3", "1E++2"})
    EXPECT_FALSE(LiteralValue(text)) << text;
}

struct NumberRow {
  std::string before, number, after;  // of the statement's text
  bool negated = false;
  double value = 0.0;
};

// What is replaced to give a number another value, in parentheses and over lines.
TEST(LiteralText, NumbersStandWhereTheyAreReplaced) {
  const std::vector<NumberRow> rows = {
      {"DELAY ", "4.5", "\n", false, 4.5},
      {"DELAY +", "4.5", " ; 9\n", false, 4.5},
      {"DELAY -(", "4.", ")\n", true, -4.0},
      {"DELAY -(-(", "4.", "))\n", false, 4.0},
      {"DELAY (", "4.25", " )\n", false, 4.25},
      {"DELAY -(", "0.5", ")\n", true, -0.5},
      {"DELAY -(", "9.5", ")\n", true, -9.5},
      {"DELAY ((", ".5", "))\n", false, 0.5},
      {"SYSDEF (", "1.5", ", 2, 3, 4, 5, 6)\n", false, 1.5},
      {"SYSDEF (-( ; (-1)\n", "1.5", " ; 7)\n), 2, 3, 4, 5, 6)\n", true, -1.5},
  };
  for (const NumberRow& row : rows) {
    const std::string text = row.before + row.number + row.after;
    Findings findings;
    const ParsedProgram program = Parse(text, findings);
    ASSERT_EQ(program.module.instructions.size(), 1U) << text;
    const std::uint32_t first = program.module.instructions[0].first_expression;
    const NumberPlace place = PlaceOfNumber(program, program.module.FirstNode(first));
    EXPECT_EQ(text.substr(place.offset, place.length), row.number) << text;
    EXPECT_EQ(place.offset, row.before.size()) << text;
    EXPECT_EQ(place.negated, row.negated) << text;
    EXPECT_EQ(PlainNumber(program, first), row.value) << text;
    EXPECT_EQ(place.Written(row.value), row.negated ? -row.value : row.value) << text;
  }
}

// OPT-7.62: a number of 401 digits is told when it is read; no double holds it, so it has no value.
TEST(LiteralText, WhatNoDoubleHoldsHasNoValue) {
  Findings findings;
  const std::string text = "DELAY 1" + std::string(400, '0') + "\n";
  const ParsedProgram program = Parse(text, findings);
  ASSERT_EQ(program.module.instructions.size(), 1U);
  EXPECT_FALSE(PlainNumber(program, program.module.instructions[0].first_expression));
}

// Names, variables and sums are no plain numbers.
TEST(LiteralText, OtherExpressionsAreNoPlainNumbers) {
  for (const std::string value : {"VR[1]", "1. + 2.", "PI", "K", "SIN(1.)", "-VR[1]"}) {
    Findings findings;
    const std::string text = "DELAY " + value + "\n";
    const ParsedProgram program = Parse(text, findings);
    ASSERT_EQ(program.module.instructions.size(), 1U) << text;
    EXPECT_FALSE(PlainNumber(program, program.module.instructions[0].first_expression)) << text;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
