// What a tool for streams tells of one thing when others stand beside it, and
// what it leaves as it is.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "engine/machine/program_file.h"
#include "engine/rml1/offline/explain.h"
#include "engine/rml1/offline/stream_copy.h"
#include "engine/rml1/offline/work_check.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, X to 200 mm and Y to 150 mm, Z0 20 mm below the top.
namespace rmlcell::rml1 {
namespace {

std::string ShiftedOrWhy(std::string_view stream, double x_mm, double y_mm, double z_mm,
                         std::string_view profile = "t1") {
  const auto made = MoveStream(stream, ParametersOf(profile), {x_mm, y_mm, z_mm});
  return made ? made->stream : "refused: " + made.error().detail;
}

std::optional<Error> WorkOf(std::string_view stream) {
  return CheckWork(machine::Bytes::Borrowed(stream), ParametersOf("t1")).value();
}

// Of two turns the first one is what G-code of three axes cannot say.
TEST(ToldSides, TheFirstTurnIsTold) {
  const auto turned = ToGcode("!ZE A9;\n!ZE A20;", ParametersOf("t1a"));
  ASSERT_FALSE(turned);
  EXPECT_EQ(turned.error().detail, "A goes to 9 degrees");
  EXPECT_EQ(turned.error().where, (SourceSpan{1, 1, 1, 0}));
}

// to_gcode.h: a cut says its F, the first one too, however slow it is: 1 mm/s
// are 60 mm/min.
TEST(ToldSides, TheFirstCutSaysItsFeedRate) {
  const auto made = ToGcode("!MC0;V1;Z100,0,0;Z200,0,0;", ParametersOf("t1"));
  ASSERT_TRUE(made);
  EXPECT_NE(made->text.find(" F60\nG1 X2\n"), std::string::npos) << made->text;
}

// work_check.h: half a unit beyond the travel is told with its remedy, half a
// unit within needs none.
TEST(ToldSides, HalfAUnitBesideAFace) {
  EXPECT_EQ(WorkOf("PU-0.5,100;PD-0.5,500;PU;")->detail,
            "4 mm of the work would not be cut; in X it fits moved by 0.005 to "
            "200.005 mm");
  EXPECT_EQ(WorkOf("PU20000.5,100;PD20000.5,500;PU;")->detail,
            "4 mm of the work would not be cut; in X it fits moved by -200.005 "
            "to -0.005 mm");
  EXPECT_EQ(WorkOf("PU19999.5,100;PD19999.5,15100;PU;")->detail,
            "1 mm of the work would not be cut: 1 mm beyond the greatest Y "
            "(150 mm); in Y it fits "
            "moved by -1 to -1 mm");
  EXPECT_EQ(WorkOf("PU0.5,100;PD0.5,15100;PU;")->detail,
            "1 mm of the work would not be cut: 1 mm beyond the greatest Y "
            "(150 mm); in Y it fits "
            "moved by -1 to -1 mm");
}

// Its place is the first byte of its command. A wait moves nothing, and of a
// plunge from above the surface, 20 mm below the top, only what lies below is
// work.
TEST(ToldSides, WorkIsWhatTheToolDoesBelowTheSurface) {
  const auto waits = WorkOf("!DW5;PU1000,1000;\nPD20100,1000;PU;");
  ASSERT_TRUE(waits);
  EXPECT_EQ(waits->detail,
            "1 mm of the work would not be cut: 1 mm beyond the "
            "greatest X (200 mm); in X it fits "
            "moved by -10 to -1 mm");
  EXPECT_EQ(waits->where, (SourceSpan{2, 1, 1, 18}));
  EXPECT_EQ(WorkOf("!MC1;Z100,100,1000;Z100,100,-5000;")->detail,
            "10 mm of the work would not be cut: 10 mm below the lowest Z (-40 "
            "mm); in Z it fits "
            "moved by 10 to 20 mm");
}

// A stream of some portions comes out as it went in.
TEST(ToldSides, ALongStreamWithOneCopy) {
  const std::string stream = std::string(machine::kReleaseEvery + 12'345, ';') +
                             "!PZ0,200;\nPU100,100;PD300,100,300,200;PU0,0;" +
                             std::string(machine::kReleaseEvery + 54'321, '\n');
  const auto made = TileStream(stream, ParametersOf("t1"), {});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_TRUE(made->stream == stream) << made->stream.size() << ' ' << stream.size();
}

// stream_copy.h: the first error is kept, and nothing more is copied, however
// many numbers follow.
TEST(ToldSides, BehindAnErrorNoNumberIsCopied) {
  const machine::Bytes bytes = machine::Bytes::Borrowed("1;2;");
  std::size_t copied = 0;
  const ByteSink sink = [&](std::string_view part) { copied += part.size(); };
  StreamCopy copy(bytes, 0, sink);
  copy.Refuse("the first", 0);
  Phrase::Value number;
  number.begin = 2;
  number.end = 3;
  for (int k = 0; k < 20'000; ++k) copy.Replace(number, 123456.0);
  EXPECT_FALSE(copy.Finish(4));
  EXPECT_EQ(copied, 0U);
}

// rewrite.h: a set with an error is refused with that error.
TEST(ToldSides, WhySetsAreRefused) {
  EXPECT_EQ(ShiftedOrWhy("PU1,1;PD1;", 1, 0, 0), "refused: PD lacks a number of its last set");
  EXPECT_EQ(ShiftedOrWhy("!ZE X1 X2;", 1, 0, 0, "t1a"), "refused: axis 'X' twice in one group");
  // Also where foreign bytes before it would make it no stream at all.
  const auto last = MoveStream(std::string(300, '$') + "PD1;", ParametersOf("t1"), {1, 0, 0});
  ASSERT_FALSE(last);
  EXPECT_EQ(last.error().code, ErrorCode::kRml1NotRewritten);
  const auto scaled = ScaleStream(std::string(300, '$') + "PD1;", ParametersOf("t1"), 40, 100);
  ASSERT_FALSE(scaled);
  EXPECT_EQ(scaled.error().code, ErrorCode::kRml1NotRewritten);
}

// RML1-3C.25: a relative !ZM leads from where the tool stands, so the way there
// comes before it; a setting leads nowhere.
TEST(ToldSides, WhatLeadsFromWhereTheToolStands) {
  EXPECT_EQ(ShiftedOrWhy("PR;!ZM-500;", 0, 0, -0.5), "PR;!ZZ0,0,-50;!ZM-500;");
  EXPECT_EQ(ShiftedOrWhy("PR;!ZM;", 0, 0, -0.5), "PR;!ZM;");
  EXPECT_EQ(ShiftedOrWhy("!ZM-500;", 0, 0, -0.5), "!ZM-500;");
  EXPECT_EQ(ShiftedOrWhy("PR;VS5;!DW7;PU5,5;", 1, 2, 0), "PR;VS5;!DW7;!ZZ100,200,0;PU5,5;");
  EXPECT_EQ(ShiftedOrWhy("PR;VS5;!DW7;Z5,5,0;", 0, 0, -0.5), "PR;VS5;!DW7;!ZZ0,0,-50;Z5,5,0;");
  EXPECT_EQ(ShiftedOrWhy("!PZ-100,200;PU;PR;Z0,0,-10;", 0, 0, -0.5), "!PZ-150,150;PU;PR;Z0,0,-10;");
}

// phrase_words.h: a change of mode is told where it changes, and not again.
TEST(ToldSides, AModeIsToldWhereItChanges) {
  std::vector<std::string> told;
  EXPECT_TRUE(Explain("!MC0;PU1,1;PR5,0;PR6,0;PA7,7;", ParametersOf("t1"),
                      [&](const ExplainedPhrase& phrase) {
                        told.push_back(phrase.words);
                        return true;
                      }));
  ASSERT_EQ(told.size(), 5U);
  EXPECT_EQ(told[2], "relative coordinates; go to X 0.06 at 60 mm/s");
  EXPECT_EQ(told[3], "go to X 0.12 at 60 mm/s");
  EXPECT_EQ(told[4], "absolute coordinates; go to X 0.07 Y 0.07 at 60 mm/s");
}

// to_gcode.h: words of axes that stay where they are are left out, but for the
// first word of X or Y; a cut is one whether it plunges or leads down on its
// way.
TEST(ToldSides, WordsOfAxesAndCuts) {
  const auto made = ToGcode("!MC0;PU0,100;PU0,200;PU50,200;", ParametersOf("t1"));
  ASSERT_TRUE(made);
  EXPECT_NE(made->text.find("G0 X0 Y1\nG0 Y2\nG0 X0.5\nM30\n"), std::string::npos) << made->text;
  const auto across = ToGcode("!MC0;Z100,100,-2100;", ParametersOf("t1"));
  ASSERT_TRUE(across);
  ASSERT_EQ(across->findings.size(), 1U);
  EXPECT_EQ(across->findings[0].code, ErrorCode::kRml1FeedNotGiven);
}

// RML1-3A.03: !PZ without numbers brings back the heights of the machine, which
// nothing rounds: 3 units of 40 in a mm are 7.5 of 100.
TEST(ToldSides, HeightsOfTheMachineAreExact) {
  const auto scaled = [](const std::string& stream) {
    return ScaleStream(stream, ParametersOf("t1"), 40, 100).value().stream;
  };
  EXPECT_EQ(scaled("!PZ-3,3;!PZ;PU;^PR;Z0,0,3;"), "!PZ-8,8;!PZ;PU;^PR;Z0,0,8;");
  EXPECT_EQ(scaled("!PZ-3,3;!PZ;PD;^PR;Z0,0,3;"), "!PZ-8,8;!PZ;PD;^PR;Z0,0,8;");
  EXPECT_EQ(scaled("!PZ-3,3;PU;^PR;Z0,0,3;"), "!PZ-8,8;PU;^PR;Z0,0,7;");
}

}  // namespace
}  // namespace rmlcell::rml1
