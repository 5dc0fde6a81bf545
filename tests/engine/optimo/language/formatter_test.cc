#include "engine/optimo/language/formatter.h"

#include <gtest/gtest.h>

namespace rmlcell::optimo {
namespace {

// OPT-B.40
TEST(Formatter, KeepsCommentsAndBlankLines) {
  const Formatting formatted =
      Format("; head\n\n  ; indented\nspeed 20   ; slow\n\n\n10 path lin\n\n");
  EXPECT_EQ(formatted.text,
            "; head\n\n     ; indented\n     SPEED 20  ; slow\n\n\n10   PATH LIN\n");
  EXPECT_TRUE(formatted.changed);
  EXPECT_FALSE(Format(formatted.text).changed);
}

// OPT-1.30, OPT-1.27
TEST(Formatter, JoinsContinuedStatements) {
  EXPECT_EQ(
      Format(
          "MOVE (1.,2.,3., ; xyz\n0.,0.)/\nFLY ; end\n15 ;$cleft\n16\n MOVE (1.,2.,3.,0.,0.)\n17\n")
          .text,
      "     ; xyz\n     MOVE (1.0, 2.0, 3.0, 0.0, 0.0) /FLY  ; end\n15  ;$cleft\n16\n"
      "     MOVE (1.0, 2.0, 3.0, 0.0, 0.0)\n17\n");
}

TEST(Formatter, KeepsDosLineEnds) {
  EXPECT_EQ(Format("speed 5\r\n; x\r\n").text, "     SPEED 5\r\n; x\r\n");
  EXPECT_EQ(Format("\r\nspeed 5\r\n").text, "\r\n     SPEED 5\r\n");
  EXPECT_EQ(Format("\nspeed 5\r\n").text, "\n     SPEED 5\n");  // the first line decides
}

// OPT-1.18: a comment stays with its statement, however near it stands; blanks behind it go.
TEST(Formatter, CommentsStayWithTheirStatements) {
  EXPECT_EQ(Format("speed 5;slow\n;  next \t\npath lin;straight  \n").text,
            "     SPEED 5  ;slow\n;  next\n     PATH LIN  ;straight\n");
  EXPECT_EQ(Format("cont a;once\ncont;twice\n").text, "     CONT A  ;once\n     CONT  ;twice\n");
}

// OPT-1.03: what stands behind the end of the text is not looked at, and not lost.
TEST(Formatter, KeepsWhatStandsBehindTheEndOfTheText) {
  const std::string text = "speed 5\r\n\x1A garbage\n";
  EXPECT_EQ(Format(text).text, "     SPEED 5\r\n\x1A garbage\n");
  EXPECT_FALSE(Format(Format(text).text).changed);
  EXPECT_EQ(Format("speed 5 ; slow\x1A").text, "     SPEED 5  ; slow\n\x1A");
}

TEST(Formatter, LeavesTextWithSyntaxErrorsAlone) {
  const std::string text = "speed 5\n10000 path lin\n(((\n";
  const Formatting formatted = Format(text);
  EXPECT_EQ(formatted.text, text);
  EXPECT_FALSE(formatted.changed);
}

}  // namespace
}  // namespace rmlcell::optimo
