#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "clients/lsp/document.h"

namespace rmlcell::lsp {
namespace document_places {
namespace {

Document Opened(std::string text) {
  return {"file:///a.S", "optimo-rml", 1, std::move(text), Encoding::kUtf16};
}

TEST(DocumentPlaces, OnlyBytesBelow128AreCharactersByThemselves) {
  EXPECT_TRUE(Opened("").ascii());
  EXPECT_TRUE(Opened("a\x7F").ascii());
  EXPECT_FALSE(Opened("a\x80").ascii());
  EXPECT_FALSE(Opened("\xC3\xA4z").ascii());
}

TEST(DocumentPlaces, AnotherTextIsCountedAnew) {
  Document document = Opened("abc\nd");
  document.ReplaceAll("\xC3\xA4\xC3\xA4z\nde\nf");
  EXPECT_EQ(document.text(), "\xC3\xA4\xC3\xA4z\nde\nf");
  EXPECT_EQ(document.lines().count(), 3U);
  EXPECT_FALSE(document.ascii());
  EXPECT_EQ(document.PositionOf(4), (Position{0, 2}));
  EXPECT_EQ(document.OffsetOf({0, 2}), 4U);
  EXPECT_EQ(document.OffsetOf({2, 0}), 9U);
  document.ReplaceAll("xyz");
  EXPECT_TRUE(document.ascii());
  EXPECT_EQ(document.lines().count(), 1U);
  EXPECT_EQ(document.PositionOf(2), (Position{0, 2}));
}

TEST(DocumentPlaces, AWideCharacterThatIsTypedCountsFromThenOn) {
  Document document = Opened("ab\ncd");
  document.Replace({{0, 1}, {0, 1}}, "e");
  EXPECT_TRUE(document.ascii());
  document.Replace({{0, 1}, {0, 2}}, "\xC3\xA4");
  EXPECT_FALSE(document.ascii());
  EXPECT_EQ(document.PositionOf(3), (Position{0, 2}));
  document.Replace({{1, 0}, {1, 1}}, "xy");
  EXPECT_FALSE(document.ascii());
  EXPECT_EQ(document.text(),
            "a\xC3\xA4"
            "b\nxyd");
  EXPECT_EQ(document.OffsetOf({0, 3}), 4U);
  EXPECT_EQ(document.PositionOf(7), (Position{1, 2}));
}

// The table of lines follows each edit: as if the text had been opened as it is now.
TEST(DocumentPlaces, LinesFollowWhatIsCutAndPasted) {
  struct Row {
    Range range;
    const char* text;
    const char* whole;
  };
  const Row rows[] = {{{{1, 1}, {3, 2}}, "x", "a\nbxcd\nhi\njk\nlm"},
                      {{{0, 1}, {1, 3}}, "1\n2\n3\n4\n5", "a1\n2\n3\n4\n5d\nhi\njk\nlm"},
                      {{{2, 0}, {4, 0}}, "", "a1\n2\n5d\nhi\njk\nlm"},
                      {{{5, 2}, {5, 2}}, "\n\nno\n", "a1\n2\n5d\nhi\njk\nlm\n\nno\n"},
                      {{{0, 0}, {7, 1}}, "\np", "\npo\n"}};
  Document document = Opened("a\nbb\ncc\ndccd\nhi\njk\nlm");
  for (const Row& row : rows) {
    document.Replace(row.range, row.text);
    ASSERT_EQ(document.text(), row.whole);
    EXPECT_EQ(document.lines(), LineTable(row.whole)) << row.whole;
  }
}

// One finder from line to line, on and back, says what a new one says.
TEST(DocumentPlaces, EachPlaceIsFoundWhateverWasAskedBefore) {
  const Document document = Opened(
      "\xC3\xA4"
      "b\xC3\xA4"
      "d\n\xE2\x82\xAC"
      "fg\nh\xC3\xA4k");
  struct Row {
    std::size_t offset;
    Position place;
  };
  const Row rows[] = {{3, {0, 2}},  {6, {0, 4}},  {10, {1, 1}}, {12, {1, 3}}, {12, {1, 3}},
                      {11, {1, 2}}, {14, {2, 1}}, {16, {2, 2}}, {17, {2, 3}}, {99, {2, 3}},
                      {5, {0, 3}},  {13, {2, 0}}, {2, {0, 1}}};
  PositionFinder finder(document);
  for (const Row& row : rows) EXPECT_EQ(finder.At(row.offset), row.place) << row.offset;
}

TEST(DocumentPlaces, ASpanEndsNotBeforeItsBeginning) {
  const Document document = Opened("abcd\nefg");
  PositionFinder finder(document);
  const Range across = finder.Span(2, 7);
  EXPECT_EQ(across.start, (Position{0, 2}));
  EXPECT_EQ(across.end, (Position{1, 2}));
  const Range empty = finder.Span(6, 1);
  EXPECT_EQ(empty.start, (Position{1, 1}));
  EXPECT_EQ(empty.end, (Position{1, 1}));
}

}  // namespace
}  // namespace document_places
}  // namespace rmlcell::lsp
