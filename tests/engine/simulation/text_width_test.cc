// Widths worked out by hand from the metrics of Helvetica: i is 0.222 of the size wide, W 0.944,
// the ellipsis (in no table) 1. All times 1.12 for the widest font, and 1.1 where it is bold.
#include "engine/simulation/picture/text_width.h"

#include <gtest/gtest.h>

namespace rmlcell::simulation {
namespace {

const TextStyle kPlain{.size = 100.0};

TEST(TextWidth, OfNarrowAndWideLetters) {
  EXPECT_DOUBLE_EQ(TextWidth("", kPlain), 0.0);
  EXPECT_NEAR(TextWidth("iiii", kPlain), 4 * 22.2 * 1.12, 1e-9);
  EXPECT_NEAR(TextWidth("WW", kPlain), 2 * 94.4 * 1.12, 1e-9);
  EXPECT_NEAR(TextWidth("W", {.size = 10.0, .bold = true}), 9.44 * 1.12 * 1.1, 1e-9);
  EXPECT_NEAR(TextWidth("~ @", kPlain), (58.4 + 27.8 + 101.5) * 1.12, 1e-9);
  EXPECT_NEAR(TextWidth("ü", kPlain), 112.0, 1e-9);  // two bytes, one character
}

TEST(TextWidth, TextsAreShortenedWhereTheyDoNotFit) {
  // Ten i are 248.64 px; with an ellipsis of 112 px, 5 of 24.864 px fit into 240 px.
  const std::string ten(10, 'i');
  EXPECT_EQ(Fitted(ten, 248.65, kPlain), ten);
  EXPECT_EQ(Fitted(ten, 240.0, kPlain), "iiiii…");
  EXPECT_EQ(Fitted(ten, 236.33, kPlain), "iiiii…");  // 5 * 24.864 + 112 = 236.32
  EXPECT_EQ(Fitted(ten, 236.31, kPlain), "iiii…");
  EXPECT_EQ(Fitted(ten, 10.0, kPlain), "…");
  EXPECT_EQ(Fitted("", 0.0, kPlain), "");
  // ü ü ü: 336 px; one of them and the ellipsis are 224 px.
  EXPECT_EQ(Fitted("üüü", 335.0, kPlain), "ü…");
  EXPECT_EQ(Fitted("üüü", 223.0, kPlain), "…");
}

}  // namespace
}  // namespace rmlcell::simulation
