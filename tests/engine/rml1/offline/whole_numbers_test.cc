// Numbers that need not change stay as they are written, and what begins a part.
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

std::string ShiftedBy(std::string_view stream, double x_mm, double y_mm, double z_mm) {
  const auto made = MoveStream(stream, ParametersOf("t1"), {x_mm, y_mm, z_mm});
  return made ? made->stream : "refused: " + made.error().detail;
}

// Along X and Y alone heights are not touched; by a single unit, they are.
TEST(WholeNumbers, HeightsAreWrittenAnewOnlyWhereTheyChange) {
  EXPECT_EQ(ShiftedBy("!PZ-050,+200;PU1,1;PD2,2;", 1, 1, 0), "!PZ-050,+200;PU101,101;PD102,102;");
  EXPECT_EQ(ShiftedBy("!PZ-050,+200;PU1,1;PD2,2;", 0, 0, 0.01), "!PZ-49,201;PU1,1;PD2,2;");
  EXPECT_EQ(ShiftedBy("!PZ-050,+200;PU1,1;PD2,2;", 0, 0, -0.01), "!PZ-51,199;PU1,1;PD2,2;");
}

// A motion in space leads from the height where the tool stands, so the way in Z is put in before
// it; one in the plane goes to the height of its tool state by itself.
TEST(WholeNumbers, MotionsInSpaceGetTheWayInZ) {
  EXPECT_EQ(ShiftedBy("PR;Z100,0,0;", 0, 0, -0.5), "PR;!ZZ0,0,-50;Z100,0,0;");
  EXPECT_EQ(ShiftedBy("PR;Z0,100,0;", 0, 0, -0.5), "PR;!ZZ0,0,-50;Z0,100,0;");
  EXPECT_EQ(ShiftedBy("!PZ-50,200;PR;PU100,0;", 0, 0, -0.5), "!PZ-100,150;PR;PU100,0;");
  EXPECT_EQ(ShiftedBy("!PZ-50,200;PR;PU0,100;PU5,5;", 0, 0, -0.5), "!PZ-100,150;PR;PU0,100;PU5,5;");
}

// Where a relative part begins with its very first command, the copy begins there, too: at the work
// origin, 10 and 5 mm from that of the machine. The part is 1 by 0.5 mm and ends 2 and 0.5 mm on;
// with 1 mm between the copies the next one begins 0.5 mm below where the tool came to.
TEST(WholeNumbers, APartMayBeginWithItsFirstCommand) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", 10.0));
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", 5.0));
  const auto made =
      TileStream("PR100,0;PD;PR100,50;PU;PA;PU0,0;", parameters, {.columns = 2, .gap_mm = 1.0});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->stream,
            "PR100,0;PD;PR100,50;PU;\nPA;\nPR;!ZZ0,-50,0;PA;PR100,0;PD;PR100,50;PU;\n;PA;PU0,0;");
}

// RML1-3C.32, RML1-3C.33: !ZM and !ZO count from where the tool stands in relative coordinates:
// before a copy they are absolute. Z0 is lowered by 1 mm, so a height of 1 mm is no lift, and one
// of 3 mm is.
TEST(WholeNumbers, HeightsBetweenCopiesAreAbsolute) {
  const auto between = [](const std::string& z2) {
    const auto made = TileStream("!PZ-50," + z2 +
                                     ";PU100,100;PD300,100;PU;!ZO-2100;PR;PD0,50;PU;"
                                     "PA;PU0,0;",
                                 ParametersOf("t1"), {.columns = 2, .gap_mm = 1.0});
    EXPECT_TRUE(made) << made.error().detail;
    const std::string end = "PR;PD0,50;PU;\n";
    const std::size_t begin = made->stream.find(end) + end.size();
    return made->stream.substr(begin, made->stream.find("PU400,100;") - begin);
  };
  EXPECT_EQ(between("100"), "PA;\n!ZM0;\n!ZO-2000;\n");
  EXPECT_EQ(between("300"), "PA;\n!ZO-2000;\n");
}

// rewrite.h: every byte that is not a number that changes is as it was: along X alone those of Y
// and Z are not written anew, and by a single unit those of X are.
TEST(WholeNumbers, NumbersOfOtherAxesStayAsTheyAreWritten) {
  EXPECT_EQ(ShiftedBy("PU007,+8;PD1.50,-.5;Z03,+4,+09;", 1, 0, 0),
            "PU107,+8;PD101.5,-.5;Z103,+4,+09;");
  EXPECT_EQ(ShiftedBy("PU007,+8;PD1.50,-.5;Z03,+4,+09;", 0.01, 0, 0),
            "PU8,+8;PD2.5,-.5;Z4,+4,+09;");
}

}  // namespace
}  // namespace rmlcell::rml1
