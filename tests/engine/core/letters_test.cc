#include "engine/core/letters.h"

#include <gtest/gtest.h>

namespace rmlcell {
namespace {

TEST(Letters, OnlyThoseOfAsciiChange) {
  EXPECT_EQ(LowerCase("@AMZ[`amz{09\xC4"), "@amz[`amz{09\xC4");
  EXPECT_EQ(UpperCase("@AMZ[`amz{09\xE4"), "@AMZ[`AMZ{09\xE4");
  for (int byte = 0; byte < 256; ++byte) {
    const char c = static_cast<char>(byte);
    const bool capital = byte >= 65 && byte <= 90;
    const bool small = byte >= 97 && byte <= 122;
    EXPECT_EQ(LowerCase(c), capital ? static_cast<char>(byte + 32) : c) << byte;
    EXPECT_EQ(UpperCase(c), small ? static_cast<char>(byte - 32) : c) << byte;
  }
}

TEST(Letters, AreComparedWithoutTheirCase) {
  EXPECT_TRUE(EqualIgnoringCase("Content-Length", "content-LENGTH"));
  EXPECT_TRUE(EqualIgnoringCase("", ""));
  EXPECT_FALSE(EqualIgnoringCase("abc", "abcd"));
  EXPECT_FALSE(EqualIgnoringCase("abcd", "abc"));
  EXPECT_FALSE(EqualIgnoringCase("[", "{"));
  EXPECT_FALSE(EqualIgnoringCase("@", "`"));
}

TEST(Letters, BlanksAtBothEndsGo) {
  EXPECT_EQ(Trimmed(" \t a b\r\r"), "a b");
  EXPECT_EQ(Trimmed("a"), "a");
  EXPECT_EQ(Trimmed(" \t\r"), "");
  EXPECT_EQ(Trimmed(""), "");
  EXPECT_EQ(Trimmed("\na\n"), "\na\n");
  EXPECT_EQ(Trimmed("\ta\r", " \t"), "a\r");
}

}  // namespace
}  // namespace rmlcell
