#include "engine/rml1/number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

NumberReader Read(std::string_view text) {
  NumberReader reader;
  reader.Begin(static_cast<unsigned char>(text[0]));
  for (const char c : text.substr(1)) EXPECT_TRUE(reader.Take(static_cast<unsigned char>(c)));
  return reader;
}
Number ValueOf(std::string_view text) { return Read(text).value(); }

// RML1-2.25: sign, digits and period in every permitted place.
TEST(NumberReader, ReadsEveryForm) {
  EXPECT_EQ(ValueOf("100").single, 100.0);
  EXPECT_EQ(ValueOf("+.5").single, 0.5);
  EXPECT_EQ(ValueOf("200.").single, 200.0);
  EXPECT_EQ(ValueOf("-12.25").single, -12.25);
  EXPECT_EQ(ValueOf("-0").single, 0.0);
  EXPECT_FALSE(std::signbit(ValueOf("-0").single));
}

// RML1-2.28, RML1-2.31: what has no digit.
TEST(NumberReader, TellsALonePeriodFromALoneSign) {
  EXPECT_FALSE(Read("-").has_digit());
  EXPECT_FALSE(Read("-").has_period());
  EXPECT_FALSE(Read("+.").has_digit());
  EXPECT_TRUE(Read("+.").has_period());
  EXPECT_EQ(ValueOf("+.").single, 0.0);
}

// RML1-2.26, RML1-2.30: a letter, a sign and a second period do not belong to a number.
TEST(NumberReader, EndsAtForeignBytes) {
  NumberReader reader = Read("1.5");
  for (const char foreign : {'.', '-', '+', 'E', ' ', ',', '\0', '\x7F', '\xB0'}) {
    EXPECT_FALSE(reader.Take(static_cast<unsigned char>(foreign)));
  }
  EXPECT_EQ(reader.value().single, 1.5);
}

// RML1-2.63, RML1-9.13: cut towards zero.
TEST(NumberReader, CutsFractionsTowardsZero) {
  EXPECT_EQ(ValueOf("10.9").truncated(), 10);
  EXPECT_EQ(ValueOf("-10.9").truncated(), -10);
  EXPECT_EQ(ValueOf("-.9").truncated(), 0);
}

// RML1-9.50: the range holds for the decimal value as it is written.
TEST(NumberReader, ComparesTheWrittenValue) {
  EXPECT_TRUE(ValueOf("8388607").Within(kFloatMin, kFloatMax));
  EXPECT_TRUE(ValueOf("8388607.000").Within(kFloatMin, kFloatMax));
  EXPECT_FALSE(ValueOf("8388607.0001").Within(kFloatMin, kFloatMax));
  EXPECT_TRUE(ValueOf("-8388608").Within(kFloatMin, kFloatMax));
  EXPECT_FALSE(ValueOf("-8388608." + std::string(500, '0') + "1").Within(kFloatMin, kFloatMax));
  EXPECT_FALSE(ValueOf("8388608").Within(kFloatMin, kFloatMax));
  EXPECT_FALSE(ValueOf("-0.5").Within(0, 10));
  EXPECT_TRUE(ValueOf("-0.0").Within(0, 10));
  EXPECT_FALSE(ValueOf("0.5").Within(1, 10));
}

// The value of a decimal whose significant digits from the sixteenth on are 0.
double FirstDigits(std::string text) {
  int significant = 0;
  for (char& c : text) {
    if (c < '0' || c > '9') continue;
    if (c != '0' || significant > 0) ++significant;
    if (significant > 15) c = '0';
  }
  return std::strtod(text.c_str(), nullptr);
}

// RML1-3A.47, RML1-3B.29: a speed below a step stays below it, however many nines are written.
TEST(NumberReader, KeepsSpeedsBelowTheirStep) {
  EXPECT_LT(ValueOf("0.9999999999").decimal, 1.0);
  EXPECT_LT(ValueOf("0." + std::string(16, '9')).decimal, 1.0);
  EXPECT_LT(ValueOf("0." + std::string(200, '9')).decimal, 1.0);
  EXPECT_LT(ValueOf("0.6" + std::string(40, '9')).decimal, 0.7);
  EXPECT_EQ(ValueOf("0.7").decimal, 0.7);
  EXPECT_EQ(ValueOf("0.7" + std::string(40, '0')).decimal, 0.7);
  EXPECT_EQ(ValueOf("00007." + std::string(40, '0') + "1").decimal, 7.0);
}

// RML1-9.21: the nearest 4-byte value, as the C library finds it, for any decimal.
TEST(NumberReader, RoundsToTheNearestSingle) {
  std::mt19937 random(20260101);
  for (int i = 0; i < 20000; ++i) {
    std::string text = i % 2 == 0 ? "-" : "";
    const int whole = static_cast<int>(random() % 8);
    const int fraction = static_cast<int>(random() % 45);
    for (int d = 0; d < whole; ++d) text += static_cast<char>('0' + random() % 10);
    text += '.';
    for (int d = 0; d <= fraction; ++d) text += static_cast<char>('0' + random() % 10);
    const Number number = ValueOf(text);
    EXPECT_EQ(number.single, static_cast<double>(std::strtof(text.c_str(), nullptr))) << text;
    EXPECT_EQ(number.decimal, FirstDigits(text)) << text;
  }
}

// RML1-9.21: few digits behind many noughts: a tenth's powers are exact up to 22, and further on
// too.
TEST(NumberReader, SmallDecimals) {
  for (int noughts = 15; noughts < 40; ++noughts) {
    for (const char* digits : {"1", "123", "987654321012345"}) {
      const std::string text = "0." + std::string(static_cast<std::size_t>(noughts), '0') + digits;
      EXPECT_EQ(ValueOf(text).decimal, std::strtod(text.c_str(), nullptr)) << text;
      EXPECT_EQ(ValueOf(text).single, static_cast<double>(std::strtof(text.c_str(), nullptr)));
    }
  }
}

// RML1-9.21: decimals exactly halfway between two values, and a hair beside them. 16777217 lies
// halfway above 2^24; 8388607.75 is halfway between two values half a unit apart.
TEST(NumberReader, RoundsHalfwayCasesRight) {
  EXPECT_EQ(ValueOf("8388607.25").single, 8388607.0);
  EXPECT_EQ(ValueOf("8388607.75").single, 8388608.0);
  EXPECT_EQ(ValueOf("8388607.2500000000000000000000000001").single, 8388607.5);
  EXPECT_EQ(ValueOf("8388606.75").single, 8388607.0);
  EXPECT_EQ(ValueOf("8388606.7499999999999999999999999").single, 8388606.5);
  // Halfway between 1 and the next value, 1 + 2^-24, then the same with a digit very far behind.
  const std::string halfway = "1.000000059604644775390625";
  EXPECT_EQ(ValueOf(halfway).single, 1.0);
  const double next = std::nextafterf(1.0F, 2.0F);
  EXPECT_EQ(ValueOf(halfway + std::string(300, '0') + "1").single, next);
  EXPECT_EQ(ValueOf(halfway + std::string(300, '0')).single, 1.0);
}

// RML1-9.21: of fifteen digits, so near to the middle between two values that their double is that
// middle: above it, above it, below it, below it, by less than 2^-54 of it.
TEST(NumberReader, RoundsWhatADoubleCannotTellFromTheMiddle) {
  EXPECT_EQ(ValueOf("6.84661602973938").single, static_cast<double>(6.84661627F));
  EXPECT_EQ(ValueOf("2.90292227268219").single, static_cast<double>(2.90292239F));
  EXPECT_EQ(ValueOf("0.0918300561606884").single, static_cast<double>(0.0918300524F));
  EXPECT_EQ(ValueOf("0.0308123966678977").single, static_cast<double>(0.0308123957F));
}

// RML1-7.07: a number of any length in the same room.
TEST(NumberReader, ReadsAMillionDigits) {
  EXPECT_EQ(ValueOf(std::string(1'000'000, '0') + "100").single, 100.0);
  EXPECT_EQ(ValueOf("." + std::string(1'500'000, '0') + "1").single, 0.0);
  EXPECT_EQ(ValueOf("." + std::string(1'500'000, '0') + "1").decimal, 0.0);
  EXPECT_TRUE(ValueOf("." + std::string(1'500'000, '0') + "1").fraction);
  const Number huge = ValueOf(std::string(1'000'000, '9'));
  EXPECT_EQ(huge.magnitude, Number::kMagnitudeMax);
  EXPECT_FALSE(huge.Within(kFloatMin, kFloatMax));
  EXPECT_EQ(ValueOf("-" + std::string(1'000'000, '9')).decimal, -1e9);
}

}  // namespace
}  // namespace rmlcell::rml1
