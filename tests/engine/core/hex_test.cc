#include "engine/core/hex.h"

#include <gtest/gtest.h>

namespace rmlcell {
namespace {

TEST(Hex, TwoDigitsAByte) {
  EXPECT_EQ(HexOf(std::string_view("\x00\x0F\xA9\xFF", 4)), "000fa9ff");
  EXPECT_EQ(HexOf(""), "");
  EXPECT_EQ(HexByte('\x0A'), "0A");
  EXPECT_EQ(HexByte('\xFE'), "FE");
  EXPECT_EQ(HexDigit(0), '0');
  EXPECT_EQ(HexDigit(10), 'a');
  EXPECT_EQ(HexDigit(0x1F), 'f');  // the least four bits
}

TEST(Hex, NumbersHaveNoLeadingZeros) {
  EXPECT_EQ(HexNumber(0), "0");
  EXPECT_EQ(HexNumber(0x1a0), "1a0");
  EXPECT_EQ(HexNumber(UINT64_MAX), "ffffffffffffffff");
}

TEST(Hex, DigitsOfEitherCase) {
  for (unsigned value = 0; value < 16; ++value) {
    EXPECT_EQ(HexValue("0123456789abcdef"[value]), value);
    EXPECT_EQ(HexValue("0123456789ABCDEF"[value]), value);
  }
  for (const char none : {'/', ':', '@', 'G', '`', 'g', '\0'}) EXPECT_FALSE(HexValue(none));
}

TEST(Hex, AndBackAgain) {
  EXPECT_EQ(BytesOfHex("000fa9ff"), std::string("\x00\x0F\xA9\xFF", 4));
  EXPECT_EQ(BytesOfHex(""), "");
  for (const char* bad : {"0", "0g", "g0", "0A", " 0", "00 "})
    EXPECT_EQ(BytesOfHex(bad), std::nullopt) << bad;
}

}  // namespace
}  // namespace rmlcell
