#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>

#include "engine/rml1/offline/gcode_reader.h"
#include "engine/rml1/offline/work_check.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// What a stream is rewritten to where the tool stands low, and words beside others. docs/gcode.md
namespace rmlcell::rml1 {
namespace {

std::string ShiftedTo(std::string_view stream, const std::array<double, 3>& by_mm) {
  const auto made = MoveStream(stream, ParametersOf("t1"), by_mm);
  return made ? made->stream : "refused: " + made.error().detail;
}

// T1: Z 0 is 2000 units below the top, where the tool stands first. Across only above the work:
// moved down by 50 it stands in it and goes up 2050 before, moved up it stands above it.
TEST(MovedSides, WhereTheToolStandsInTheMovedWork) {
  EXPECT_EQ(ShiftedTo("PR;!ZM-2000;Z100,0,0;", {1, 2, -0.5}),
            "PR;!ZZ0,0,-50;!ZM-2000;!ZZ0,0,2050,100,200,0,0,0,-2050;Z100,0,0;");
  EXPECT_EQ(ShiftedTo("PR;!ZM-2000;Z100,0,0;", {1, 2, 0.5}),
            "PR;!ZZ0,0,50;!ZM-2000;!ZZ100,200,0;Z100,0,0;");
}

// A motion in space leads from a height, whatever it does to it: up before, down behind.
TEST(MovedSides, AMotionInSpaceCountsFromItsHeight) {
  EXPECT_EQ(ShiftedTo("PR;Z100,0,0;", {1, 2, 0.5}), "PR;!ZZ0,0,50,100,200,0;Z100,0,0;");
  EXPECT_EQ(ShiftedTo("PR;Z100,0,0;", {1, 2, -0.5}), "PR;!ZZ100,200,0,0,0,-50;Z100,0,0;");
}

// One unit beyond a face is too little for a word of the face, and it has a remedy.
TEST(CheckWorkSides, OneUnitBeyondTheLeastX) {
  const auto found =
      CheckWork(machine::Bytes::Borrowed("PU-1,100;PD-1,500;PU;"), ParametersOf("t1")).value();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->detail,
            "4 mm of the work would not be cut; in X it fits moved by 0.01 to 200.01 mm");
}

// A word that says what holds already, or what comes later, leaves the motion beside it.
TEST(GcodeSides, AMotionBesideAnyOtherWord) {
  for (const char* word : {"G17", "G18", "G19", "G21", "G90", "G94", "G40", "G54", "M3", "M5", "M8",
                           "M0", "T1", "N7"}) {
    const auto made = FromGcode(std::string(word) + " G0 X5 Z0\n", ParametersOf("t1"));
    ASSERT_TRUE(made && made->ok) << word;
    EXPECT_NE(made->stream.find("500,0,0;"), std::string::npos) << word << ": " << made->stream;
  }
  // And back from another plane to that of X and Y.
  const auto arc = FromGcode("G18\nG17 G2 X9 I3 F60\n", ParametersOf("t1"));
  ASSERT_TRUE(arc);
  EXPECT_EQ(arc->findings.front().detail, "the start is 3 mm from the centre, the end 6 mm");
}

// By one unit heights change, and by two a height of -1 comes above Z0.
TEST(MovedSides, HeightsThatComeAboveTheSurface) {
  EXPECT_EQ(ShiftedTo("!PZ-1,200;PU1,1;PD2,2;", {0, 0, 0.01}), "!PZ0,201;PU1,1;PD2,2;");
  EXPECT_EQ(ShiftedTo("!PZ-1,200;PU1,1;PD2,2;", {0, 0, 0.02}),
            "refused: the tool-down height would come above Z0: move Z0 on the panel");
}

// What is found is a place of one byte: that of the command.
TEST(CheckWorkSides, ThePlaceIsThatOfTheCommand) {
  const auto found =
      CheckWork(machine::Bytes::Borrowed("PU1000,100;\nPD20100,100;PU;"), ParametersOf("t1"))
          .value();
  ASSERT_TRUE(found && found->where);
  EXPECT_EQ(found->where->line, 2);
  EXPECT_EQ(found->where->column, 1);
  EXPECT_EQ(found->where->length, 1);
}

// RML1-9.31: where the highest speed is 1 rpm above the lowest, it is the last of 15 stages.
TEST(GcodeSides, TheHighestSpeedIsTheLastStage) {
  machine::Parameters narrow = ParametersOf("t1s");
  ASSERT_TRUE(narrow.Set("SPINDLE_MIN", 14999.0));
  const auto made = FromGcode("S15000\n", narrow);
  ASSERT_TRUE(made && made->ok);
  EXPECT_NE(made->stream.find("!RC15;"), std::string::npos) << made->stream;
}

// CR LF at the end of a text ends its last line, and begins no other one; a word may stand right
// behind a comment.
TEST(GcodeSides, EndsOfLinesAndOfComments) {
  GcodeReader reader("G0 X1\r\n");
  ASSERT_TRUE(reader.Next());
  EXPECT_FALSE(reader.Next());
  const auto made = FromGcode("(a)G0(b)X5(c)Z0\nG0 X1 X2\n", ParametersOf("t1"));
  ASSERT_TRUE(made);
  ASSERT_EQ(made->findings.size(), 1U);
  EXPECT_EQ(made->findings[0].detail, "X twice in one line");
}

}  // namespace
}  // namespace rmlcell::rml1
