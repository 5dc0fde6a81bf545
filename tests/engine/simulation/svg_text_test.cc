#include "engine/simulation/picture/svg_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "tests/engine/simulation/xml_check.h"

namespace rmlcell::simulation {
namespace {

const std::string kUnknown = "\xEF\xBF\xBD";  // U+FFFD

TEST(XmlText, EscapesMarkup) {
  EXPECT_EQ(XmlText("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST(XmlText, KeepsUtf8AndReplacesWhatXmlCannotHold) {
  EXPECT_EQ(XmlText("Bögen → 5"), "Bögen → 5");
  EXPECT_EQ(XmlText("a\x01\x1B"
                    "b"),
            "a" + kUnknown + kUnknown + "b");
  EXPECT_EQ(XmlText("a\tb\n"), "a b ");
  EXPECT_EQ(XmlText("\xC3"), kUnknown);                                // cut off
  EXPECT_EQ(XmlText("\xC0\xAF"), kUnknown + kUnknown);                 // overlong
  EXPECT_EQ(XmlText("\xED\xA0\x80"), kUnknown + kUnknown + kUnknown);  // surrogate
  EXPECT_EQ(XmlText("\xEF\xBF\xBE"), kUnknown + kUnknown + kUnknown);  // U+FFFE
  EXPECT_EQ(XmlText("\xF5\x80\x80\x80").size(), 4 * kUnknown.size());
}

// RFC 3629: the first and last of each length are kept; one short of each is overlong, one more is
// beyond Unicode or a surrogate; XML 1.0 leaves U+FFFE and U+FFFF out.
TEST(XmlText, BoundsOfUtf8) {
  for (const char* good :
       {"\x7E", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEE\x80\x80",
        "\xEF\xBF\xBD", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(XmlText(good), good);
    EXPECT_EQ(XmlText(std::string(good) + "z"), std::string(good) + "z");
  }
  for (const std::string bad :
       {"\xC1\xBF", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xED\xBF\xBF", "\xEF\xBF\xBE", "\xEF\xBF\xBF",
        "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xC2", "\xE2\x82",
        "\xF0\x9F\x98", "\xE2\x28\xA1", "\xE2\x82\xC0"}) {
    std::string expected;
    for (const char c : bad) expected += c == '(' ? "(" : kUnknown;
    EXPECT_EQ(XmlText(bad), expected);
  }
  // No lead has more than three followers, and none that are not there.
  for (const char* lead : {"\xF8", "\xFF"})
    EXPECT_EQ(XmlText(std::string(lead) + "\xBF\xBF\xBF"),
              kUnknown + kUnknown + kUnknown + kUnknown);
  EXPECT_EQ(XmlText(std::string_view("\xC3\xBC").substr(0, 1)), kUnknown);
  EXPECT_EQ(XmlText("\x1F \x7F\r"), kUnknown + " " + kUnknown + " ");
  EXPECT_EQ(XmlText(std::string_view("\0", 1)), kUnknown);
}

// At most so many bytes, and the ellipsis; a text that fits stays.
TEST(Shortened, CutsBetweenCharacters) {
  EXPECT_EQ(Shortened("abcd", 4), "abcd");
  EXPECT_EQ(Shortened("abcde", 4), "abcd…");
  EXPECT_EQ(Shortened("abcö", 4), "abc…");
  EXPECT_EQ(Shortened("aböd", 4), "abö…");
  EXPECT_EQ(Shortened("a€€", 3), "a…");
  EXPECT_EQ(Shortened("\x80\x80\x80", 2), "…");
  EXPECT_EQ(Shortened("ab", 0), "…");
}

// Lines of as many words as fit, up to the last byte; three at most.
TEST(Wrapped, CutsAtBlanks) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(Wrapped("", 7), Lines{});
  EXPECT_EQ(Wrapped("one two", 7), Lines{"one two"});
  EXPECT_EQ(Wrapped("one two", 6), (Lines{"one", "two"}));
  EXPECT_EQ(Wrapped("one two", 3), (Lines{"one", "two"}));
  EXPECT_EQ(Wrapped("a bc def", 4), (Lines{"a bc", "def"}));
  EXPECT_EQ(Wrapped(" abcdef g", 3), (Lines{" ab…", "g"}));
  EXPECT_EQ(Wrapped("a b c", 1), (Lines{"a", "b", "c"}));
  EXPECT_EQ(Wrapped("a b c d", 1), (Lines{"a", "b", "c…"}));
  EXPECT_EQ(Wrapped("a b cd", 1), (Lines{"a", "b", "c…"}));
}

TEST(Wrapped, ShortensAWordThatIsTooLong) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(Wrapped("lengthy", 4), Lines{"leng…"});
  EXPECT_EQ(Wrapped("lengthy ab", 4), (Lines{"leng…", "ab"}));
  EXPECT_EQ(Wrapped("ab lengthy cd", 4), (Lines{"ab", "leng…", "cd"}));
}

TEST(XmlText, AnyBytesGiveWellFormedText) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string bytes{static_cast<char>(first), static_cast<char>(second), 'x'};
      const std::string fault =
          XmlFault("<a b=\"" + XmlText(bytes) + "\">" + XmlText(bytes) + "</a>");
      ASSERT_EQ(fault, "") << first << ' ' << second;
    }
  }
}

TEST(Pixels, HundredthsWithoutTrailingZeros) {
  EXPECT_EQ(Pixels(12.5), "12.5");
  EXPECT_EQ(Pixels(-0.074), "-.07");
  EXPECT_EQ(Pixels(3.0), "3");
  EXPECT_EQ(Pixels(-0.001), "0");
  EXPECT_EQ(Pixels(0.05), ".05");
  EXPECT_EQ(Pixels(std::nan("")), "0");
  EXPECT_EQ(Pixels(1e300), "10000000");
  EXPECT_EQ(Pixels(-1e300), "-10000000");
  EXPECT_EQ(Pixels(9999999.5), "9999999.5");
  EXPECT_EQ(Pixels(0.99), ".99");
  EXPECT_EQ(Pixels(1.004), "1");
  EXPECT_EQ(Pixels(1.006), "1.01");
  EXPECT_EQ(Pixels(-10.1), "-10.1");
}

// Steps are relative to the rounded point before, so that thousand thirds end where they should.
TEST(PathData, RoundingDoesNotAddUp) {
  PathData data;
  data.MoveTo({0, 0});
  for (int k = 1; k <= 1000; ++k) data.LineTo({k / 3.0, 0});
  EXPECT_TRUE(data.StandsAt({1000 / 3.0, 0}));
  EXPECT_EQ(data.segments(), 1000u);
}

TEST(PathData, CommandsAreShort) {
  PathData data;
  data.MoveTo({10, 20});
  data.LineTo({11, 19.5});
  data.LineTo({10.5, 19.5});
  data.ArcTo({.rx = 5, .ry = 2.5, .rotation_deg = 30, .large = false, .clockwise = true}, {0, 0});
  data.LineTo({1, 1});
  data.MoveTo({2, 2});
  EXPECT_EQ(data.text(), "M10 20l1-.5-.5 0a5 2.5 30 0 1 -10.5-19.5l1 1m1 1");
}

// After a step to the left no blank separates, after one to the right or none at all it does; a
// pair of an arc or a move is no pair of a line.
TEST(PathData, NumbersAreSeparated) {
  PathData data;
  EXPECT_FALSE(data.StandsAt({0, 0}));
  data.MoveTo({5, 5});
  data.LineTo({5, 6});
  data.LineTo({5, 6});
  data.LineTo({4, 6});
  data.LineTo({6, 5});
  EXPECT_EQ(data.text(), "M5 5l0 1 0 0-1 0 2-1");
  EXPECT_EQ(data.segments(), 4u);
  EXPECT_TRUE(data.StandsAt({6.001, 5}));
  EXPECT_FALSE(data.StandsAt({6.01, 5}));
  EXPECT_FALSE(data.StandsAt({6, 5.01}));
  data.ArcTo({.rx = 1, .ry = 1, .rotation_deg = -30, .large = true, .clockwise = false}, {7, 7});
  data.MoveTo({8, 8});
  EXPECT_EQ(data.text(), "M5 5l0 1 0 0-1 0 2-1a1 1 -30 1 0 1 2m1 1");
  EXPECT_EQ(data.segments(), 5u);
  data.Clear();
  EXPECT_EQ(data.text(), "");
  EXPECT_EQ(data.segments(), 0u);
  EXPECT_FALSE(data.StandsAt({0, 0}));
}

// The checker that the tests rely on refuses what it should.
TEST(XmlFault, RefusesWhatIsNotWellFormed) {
  EXPECT_EQ(XmlFault("<a b=\"1\"><c/>x</a>\n"), "");
  for (const char* bad :
       {"<a>", "<a></b>", "<a/><b/>", "<a b=1/>", "<a b=\"1\" b=\"2\"/>", "<a>&x;</a>",
        "<a>\x02</a>", "x<a/>", "<a b=\"<\"/>", "<a>\xFF</a>", ""}) {
    EXPECT_NE(XmlFault(bad), "") << bad;
  }
}

}  // namespace
}  // namespace rmlcell::simulation
