#include "engine/core/number_text.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <string>

namespace rmlcell {
namespace {

constexpr double kLargest = std::numeric_limits<double>::max();
constexpr double kSmallest = std::numeric_limits<double>::denorm_min();

TEST(NumberText, FixedDecimalsAreRoundedFromTheExactValue) {
  EXPECT_EQ(FixedText(12.5, 3), "12.500");
  EXPECT_EQ(FixedText(0.0005, 3), "0.001");  // the double is above 0.0005
  EXPECT_EQ(FixedText(2.5, 0), "2");         // a tie goes to the even digit
  EXPECT_EQ(FixedText(3.5, 0), "4");
  EXPECT_EQ(FixedText(-1.25, 1), "-1.2");
  EXPECT_EQ(FixedText(999.9999, 3), "1000.000");
  EXPECT_EQ(FixedText(1e15, 2), "1000000000000000.00");
}

// Whichever way it is written: as the C library has it, which looks at the exact value. Near the
// middle between two texts, at powers of ten, small and large.
TEST(NumberText, FixedDecimalsOfManyNumbers) {
  std::mt19937_64 dice(7);
  std::uniform_real_distribution<double> exponent(-9.0, 14.0);
  std::uniform_int_distribution<std::int64_t> whole(0, 2'000'000'000);
  for (int k = 0; k < 200'000; ++k) {
    const int decimals = 1 + k % 7;
    const double scale = std::pow(10.0, decimals);
    const auto step = static_cast<double>(whole(dice));
    double value = std::pow(10.0, exponent(dice));
    if (k % 3 == 1) value = (step + 0.5) / scale;
    if (k % 3 == 2) value = std::nextafter((step + 0.5) / scale, k % 2 == 0 ? 0.0 : 1e300);
    if (k % 5 == 0) value = step / scale;
    if (k % 2 == 0) value = -value;
    char expected[64];
    std::snprintf(expected, sizeof expected, "%.*f", decimals, value);
    const std::string text = expected;
    const bool nothing = text.find_first_not_of("-0.") == std::string::npos;
    ASSERT_EQ(FixedText(value, decimals), nothing && text[0] == '-' ? text.substr(1) : text) << k;
  }
}

TEST(NumberText, AppendedBehindWhatStandsThere) {
  std::string text = "-0.";
  AppendFixed(text, -1e-9, 3);
  AppendTrimmed(text, 2.50, 3);
  AppendFixed(text, 1e13, 1);
  AppendTrimmed(text, 100.0, 0);
  EXPECT_EQ(text, "-0.0.0002.510000000000000.0100");
}

TEST(NumberText, ThereIsNoNegativeZero) {
  EXPECT_EQ(FixedText(-0.0, 3), "0.000");
  EXPECT_EQ(FixedText(-0.0004, 3), "0.000");
  EXPECT_EQ(FixedText(-0.0006, 3), "-0.001");
  EXPECT_EQ(FixedText(-0.4, 0), "0");
  EXPECT_EQ(TrimmedText(-1e-9, 3), "0.0");
}

TEST(NumberText, TrimmedKeepsOneDecimal) {
  EXPECT_EQ(TrimmedText(12.7, 3), "12.7");
  EXPECT_EQ(TrimmedText(12.0, 3), "12.0");
  EXPECT_EQ(TrimmedText(100.0, 1), "100.0");
  EXPECT_EQ(TrimmedText(0.1 + 0.2, 6), "0.3");
  EXPECT_EQ(TrimmedText(1.2345, 3), "1.234");  // the double is below 1.2345
}

TEST(NumberText, TheLargestNumbersFit) {
  const std::string large = FixedText(-kLargest, 50);
  EXPECT_EQ(large.size(), 1U + 309U + 1U + 50U);
  EXPECT_EQ(ParseDouble(large), -kLargest);
  EXPECT_EQ(FixedText(-kLargest, 100).size(), 1U + 309U + 1U + 100U);
  EXPECT_EQ(FixedText(1.0, 1'000'000).size(), 102U);  // at most 100 decimals
  EXPECT_EQ(FixedText(1.6, -1), "2");
  EXPECT_EQ(FixedText(kSmallest, 3), "0.000");
}

TEST(NumberText, ShortestReadsBackToTheSameValue) {
  EXPECT_EQ(ShortestText(0.1), "0.1");
  EXPECT_EQ(ShortestText(12.0), "12");
  EXPECT_EQ(ShortestText(1e-7), "1e-07");
  EXPECT_EQ(ShortestText(-25.4), "-25.4");
  for (const double value :
       {0.0, -0.0, kLargest, -kLargest, kSmallest, std::numeric_limits<double>::min(), 1.0 / 3.0}) {
    const auto read = ParseDouble(ShortestText(value));
    ASSERT_TRUE(read) << value;
    EXPECT_EQ(*read, value);
    EXPECT_EQ(std::signbit(*read), std::signbit(value));
  }
  std::mt19937_64 random(20240531);
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t bits = random();
    double value = 0.0;
    static_assert(sizeof value == sizeof bits);
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(ParseDouble(ShortestText(value)), value) << std::hexfloat << value;
  }
}

// Whatever the locale of the process: a comma must never become a point, nor a point a comma.
TEST(NumberText, KnowsNoLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr) (void)std::setlocale(LC_ALL, "C.UTF-8");
  EXPECT_EQ(FixedText(1234.5, 1), "1234.5");
  EXPECT_EQ(ShortestText(1234.5), "1234.5");
  EXPECT_EQ(ParseDouble("1234.5"), 1234.5);
  EXPECT_EQ(ParseDouble("1234,5"), std::nullopt);
  std::setlocale(LC_ALL, before.c_str());
}

TEST(NumberText, TheWholeTextMustBeANumber) {
  EXPECT_EQ(ParseDouble("12"), 12.0);
  EXPECT_EQ(ParseDouble("-.5"), -0.5);
  EXPECT_EQ(ParseDouble("5."), 5.0);
  EXPECT_EQ(ParseDouble("1e3"), 1000.0);
  for (const std::string_view text :
       {"",  " 1", "1 ",    "+1",  "1a",   "a",        "1e",  "0x10", "1,0",  "--1",
        ".", "-",  "1e400", "inf", "-inf", "infinity", "nan", "NaN",  "-nan", "nan(1)"}) {
    EXPECT_EQ(ParseDouble(text), std::nullopt) << text;
  }
  EXPECT_EQ(ParseDouble(std::string_view("1\0", 2)), std::nullopt);
}

TEST(NumberText, WholeNumbersHaveSixtyFourBits) {
  EXPECT_EQ(ParseInteger("0"), 0);
  EXPECT_EQ(ParseInteger("-9223372036854775808"), std::numeric_limits<long long>::min());
  EXPECT_EQ(ParseInteger("9223372036854775807"), std::numeric_limits<long long>::max());
  for (const std::string_view text : {"", " 1", "1 ", "+1", "1.0", "1e3", "0x10", "a", "-",
                                      "9223372036854775808", "-9223372036854775809"}) {
    EXPECT_EQ(ParseInteger(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace rmlcell
