#include "engine/simulation/svg_text.h"

#include <gtest/gtest.h>

#include <cmath>

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
