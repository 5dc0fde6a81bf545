// Texts that go on behind what is looked at, numbers with more digits than usual, and what a check
// that fails does.
#include <gtest/gtest.h>

#include <csignal>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/check.h"
#include "engine/core/line_table.h"
#include "engine/core/number_text.h"

namespace rmlcell {
namespace {

// Bytes behind a text are not of it: a line end there begins no line.
TEST(LineTable, NothingBehindTheTextCounts) {
  constexpr std::string_view kAll = "ab\ncd\nef";
  for (const std::size_t size : {0U, 1U, 2U, 3U, 5U, 6U}) {
    const std::string copy(kAll.substr(0, size));
    EXPECT_TRUE(LineTable(kAll.substr(0, size)) == LineTable(copy)) << size;
  }
  EXPECT_EQ(LineTable(kAll.substr(0, 2)).count(), 1U);
  EXPECT_EQ(LineTable(kAll.substr(0, 5)).count(), 2U);
}

// A CR that the text ends with is a line end of its own, whatever comes behind it.
TEST(LineTable, ACrAtTheEndStandsAlone) {
  constexpr std::string_view kAll = "ab\r\ncd";
  EXPECT_EQ(LineTable(kAll.substr(0, 3)).count(), 2U);
  EXPECT_EQ(LineTable(kAll.substr(0, 3)).Begin(1), 3U);
  EXPECT_EQ(LineTable(kAll.substr(0, 4)).count(), 2U);
  EXPECT_EQ(LineTable(kAll.substr(0, 4)).Begin(1), 4U);
}

// Of a change as well, where the text ends before its buffer does.
TEST(LineTable, NothingBehindAChangedTextCounts) {
  constexpr std::string_view kAfter = "ab\ncdX\nef";
  LineTable lines(std::string_view("ab\ncd"));
  lines.Replace(kAfter.substr(0, 6), 5, 5, 1);
  EXPECT_EQ(lines.count(), 2U);
  EXPECT_TRUE(lines == LineTable(std::string_view("ab\ncdX")));
}

// Every number of decimals, beyond those that are written in a quick way too.
TEST(FixedText, HasAsManyDecimalsAsAskedFor) {
  EXPECT_EQ(FixedText(1.23456789, 0), "1");
  EXPECT_EQ(FixedText(1.23456789, 1), "1.2");
  EXPECT_EQ(FixedText(1.23456789, 5), "1.23457");
  EXPECT_EQ(FixedText(1.23456789, 6), "1.234568");
  EXPECT_EQ(FixedText(1.23456789, 7), "1.2345679");
  EXPECT_EQ(FixedText(-1.23456789, 8), "-1.23456789");
}

// Where a number lies just between two texts its last bits decide: of eighths there are none, and
// the even digit is taken; 1.005 and 0.145 are below theirs.
TEST(FixedText, HalvesAreRoundedByTheirLastBits) {
  EXPECT_EQ(FixedText(0.125, 2), "0.12");
  EXPECT_EQ(FixedText(0.375, 2), "0.38");
  EXPECT_EQ(FixedText(0.625, 2), "0.62");
  EXPECT_EQ(FixedText(-0.125, 2), "-0.12");
  EXPECT_EQ(FixedText(1.005, 2), "1.00");
  EXPECT_EQ(FixedText(0.145, 2), "0.14");
  EXPECT_EQ(FixedText(0.25, 1), "0.2");
  EXPECT_EQ(FixedText(0.75, 1), "0.8");
}

// The greatest numbers with the most decimals.
TEST(FixedText, HasRoomForTheLongestNumber) {
  const std::string text = FixedText(-1e308, 100);
  EXPECT_EQ(text.size(), 1U + 309U + 1U + 100U);
  EXPECT_EQ(text.substr(0, 3), "-10");
  EXPECT_EQ(text.substr(text.size() - 101), "." + std::string(100, '0'));
  EXPECT_EQ(FixedText(-1e308, 1000), text);
}

// Digits behind a text are not of its number.
TEST(ParseNumbers, EndWithTheirText) {
  constexpr std::string_view kDigits = "12.75";
  EXPECT_EQ(ParseInteger(kDigits.substr(0, 1)), 1);
  EXPECT_EQ(ParseInteger(kDigits.substr(0, 2)), 12);
  EXPECT_EQ(ParseDouble(kDigits.substr(0, 2)), 12.0);
  EXPECT_EQ(ParseDouble(kDigits.substr(0, 4)), 12.7);
  EXPECT_EQ(ParseInteger(kDigits.substr(0, 3)), std::nullopt);
}

// A check that fails ends the process at once, with the place and the condition.
TEST(CheckDeathTest, AbortsWithItsPlace) {
  EXPECT_EXIT(CheckFailed("a == b", "some/file.cc", 12), testing::KilledBySignal(SIGABRT),
              "some/file.cc:12: check failed: a == b");
}

}  // namespace
}  // namespace rmlcell
