#include "clients/lsp/document.h"

#include <gtest/gtest.h>

#include <random>

namespace rmlcell::lsp {
namespace {

Document Make(std::string text, Encoding encoding = Encoding::kUtf16) {
  return {"file:///a.S", "optimo-rml", 1, std::move(text), encoding};
}

TEST(Document, LinesEndAtLfCrLfAndCr) {
  const Document document = Make("a\nbc\r\nd\re\n");
  ASSERT_EQ(document.lines().count(), 5U);
  EXPECT_EQ(document.PositionOf(0), (Position{0, 0}));
  EXPECT_EQ(document.PositionOf(3), (Position{1, 1}));
  EXPECT_EQ(document.PositionOf(6), (Position{2, 0}));
  EXPECT_EQ(document.PositionOf(8), (Position{3, 0}));
  EXPECT_EQ(document.PositionOf(10), (Position{4, 0}));
  // Between CR and LF is the end of the line.
  EXPECT_EQ(document.PositionOf(5), (Position{1, 2}));
}

// "a", two-byte, three-byte and four-byte characters, "z".
constexpr const char* kWide = "a\xC3\xA4\xE2\x82\xAC\xF0\x9D\x84\x9Ez";

TEST(Document, CharactersCountAsTheEncodingSays) {
  struct Row {
    std::size_t offset;
    std::uint32_t utf8, utf16, utf32;
  };
  const Row rows[] = {{0, 0, 0, 0}, {1, 1, 1, 1},   {3, 3, 2, 2},
                      {6, 6, 3, 3}, {10, 10, 5, 4}, {11, 11, 6, 5}};
  for (const Row& row : rows) {
    EXPECT_EQ(Make(kWide, Encoding::kUtf8).PositionOf(row.offset).character, row.utf8);
    EXPECT_EQ(Make(kWide, Encoding::kUtf16).PositionOf(row.offset).character, row.utf16);
    EXPECT_EQ(Make(kWide, Encoding::kUtf32).PositionOf(row.offset).character, row.utf32);
    EXPECT_EQ(Make(kWide, Encoding::kUtf8).OffsetOf({0, row.utf8}), row.offset);
    EXPECT_EQ(Make(kWide, Encoding::kUtf16).OffsetOf({0, row.utf16}), row.offset);
    EXPECT_EQ(Make(kWide, Encoding::kUtf32).OffsetOf({0, row.utf32}), row.offset);
  }
}

TEST(Document, APlaceInsideACharacterIsTheOneBeforeIt) {
  EXPECT_EQ(Make(kWide).OffsetOf({0, 4}), 6U);                   // between two surrogates
  EXPECT_EQ(Make(kWide, Encoding::kUtf8).OffsetOf({0, 2}), 1U);  // inside two bytes
}

TEST(Document, PlacesBehindTheEndAreTheEnd) {
  const Document document = Make("ab\r\ncd\n");
  EXPECT_EQ(document.OffsetOf({0, 99}), 2U);
  EXPECT_EQ(document.OffsetOf({1, 99}), 6U);
  EXPECT_EQ(document.OffsetOf({2, 5}), 7U);
  EXPECT_EQ(document.OffsetOf({3, 0}), 7U);
  EXPECT_EQ(document.OffsetOf({99, 0}), 7U);
  EXPECT_EQ(document.PositionOf(7), (Position{2, 0}));
}

TEST(Document, BytesThatAreNoUtf8CountAsOne) {
  const Document document = Make("\xFF\xC3(\xE2\x82 \xED\xA0");
  for (std::size_t offset = 0; offset <= document.text().size(); ++offset)
    EXPECT_EQ(document.OffsetOf(document.PositionOf(offset)) <= offset, true);
  EXPECT_EQ(document.PositionOf(2).character, 2U);
}

TEST(Document, AnEditReplacesTheRangeInUtf16) {
  Document document = Make("10 MOVE ; \xF0\x9D\x84\x9E here\nSPEED 5\n");
  document.Replace({{0, 13}, {0, 17}}, "there");  // behind two surrogates and a blank
  EXPECT_EQ(document.text(), "10 MOVE ; \xF0\x9D\x84\x9E there\nSPEED 5\n");
  document.Replace({{1, 6}, {1, 7}}, "7");
  EXPECT_EQ(document.text(), "10 MOVE ; \xF0\x9D\x84\x9E there\nSPEED 7\n");
  document.Replace({{0, 0}, {1, 0}}, "");
  EXPECT_EQ(document.text(), "SPEED 7\n");
  document.Replace({{0, 5}, {0, 2}}, "X");  // an end before the start is the start
  EXPECT_EQ(document.text(), "SPEEDX 7\n");
}

// Whatever is cut and pasted, the table of lines is that of the text.
TEST(Document, LinesStayRightUnderAnyEdit) {
  std::mt19937 random(20261121);
  constexpr std::string_view kPieces[] = {"",    "\n",   "\r",     "\r\n",    "a",
                                          "b\n", "\n\r", "x\r\ny", "\r\r\n\n"};
  std::string text;
  LineTable table(text);
  for (int round = 0; round < 20'000; ++round) {
    const std::size_t begin = random() % (text.size() + 1);
    const std::size_t end = begin + random() % std::min<std::size_t>(text.size() - begin + 1, 6);
    const std::string_view piece = kPieces[random() % std::size(kPieces)];
    text.replace(begin, end - begin, piece);
    table.Replace(text, begin, end, piece.size());
    ASSERT_EQ(table, LineTable(text)) << "round " << round;
    if (text.size() > 60) {
      text.clear();
      table.Rebuild(text);
    }
  }
}

TEST(Document, AscendingPlacesOfOneLongLineAreFoundInOnePass) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) text += "\xC3\xA4,";
  const Document document = Make(text);
  PositionFinder finder(document);
  for (std::size_t i = 0; i < 200'000; ++i)
    ASSERT_EQ(finder.At(3 * i), (Position{0, static_cast<std::uint32_t>(2 * i)}));
  EXPECT_EQ(finder.At(3), (Position{0, 2}));  // and back
}

}  // namespace
}  // namespace rmlcell::lsp
