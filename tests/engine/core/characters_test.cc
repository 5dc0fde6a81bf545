// Bytes and characters of a line: Unicode 15, table 3-7 (well-formed UTF-8). A byte that begins no
// character counts as one, in every encoding.
#include "engine/core/characters.h"

#include <gtest/gtest.h>

#include <string>

namespace rmlcell {
namespace {

struct Line {
  const char* what;
  std::string text;
  std::uint32_t utf8, utf16, utf32;
};

TEST(Characters, CountsInEveryEncoding) {
  const Line rows[] = {
      {"nothing", "", 0, 0, 0},
      {"ASCII and a byte alone", "a\x80", 2, 2, 2},
      {"the last byte that begins nothing", "\xC1\x80", 2, 2, 2},
      {"the first that begins two", "\xC2\x80", 2, 1, 1},
      {"the last that begins two", "\xDF\xBF", 2, 1, 1},
      {"the first that begins three", "\xE0\xA0\x80", 3, 1, 1},
      {"the last that begins three", "\xEF\xBF\xBF", 3, 1, 1},
      {"the first that begins four", "\xF0\x90\x80\x80", 4, 2, 1},
      {"the last that begins four", "\xF4\x8F\xBF\xBF", 4, 2, 1},
      {"beyond the last", "\xF5\x80\x80\x80", 4, 4, 4},
      {"two that are cut", "\xC3", 1, 1, 1},
      {"three that are cut", "\xE2\x82", 2, 2, 2},
      {"four that are cut", "\xF0\x9D\x84", 3, 3, 3},
      {"three with another byte in them", "\xE2\x82z", 3, 3, 3},
      {"four with another byte in them", "\xF0z\x84\x9E", 4, 4, 4},
  };
  for (const Line& row : rows) {
    EXPECT_EQ(CharactersIn(row.text, Encoding::kUtf8), row.utf8) << row.what;
    EXPECT_EQ(CharactersIn(row.text, Encoding::kUtf16), row.utf16) << row.what;
    EXPECT_EQ(CharactersIn(row.text, Encoding::kUtf32), row.utf32) << row.what;
    for (const auto& [encoding, count] : {std::pair(Encoding::kUtf8, row.utf8),
                                          {Encoding::kUtf16, row.utf16},
                                          {Encoding::kUtf32, row.utf32}}) {
      EXPECT_EQ(BytesOfCharacters(row.text, count, encoding), row.text.size()) << row.what;
      EXPECT_EQ(BytesOfCharacters(row.text, count + 1, encoding), row.text.size()) << row.what;
      EXPECT_EQ(BytesOfCharacters(row.text, 0, encoding), 0U) << row.what;
    }
  }
}

TEST(Characters, APlaceInsideACharacterIsBeforeIt) {
  const std::string clef = "a\xF0\x9D\x84\x9Ez";
  EXPECT_EQ(BytesOfCharacters(clef, 2, Encoding::kUtf16), 1U);  // between the surrogates
  EXPECT_EQ(BytesOfCharacters(clef, 3, Encoding::kUtf16), 5U);
  EXPECT_EQ(BytesOfCharacters(clef, 4, Encoding::kUtf8), 1U);
  EXPECT_EQ(BytesOfCharacters(clef, 5, Encoding::kUtf8), 5U);
  EXPECT_EQ(BytesOfCharacters(clef, 2, Encoding::kUtf32), 5U);
}

}  // namespace
}  // namespace rmlcell
