#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/rml1/offline/explain.h"
#include "engine/rml1/offline/gcode_arc.h"
#include "engine/rml1/offline/stream_diff.h"
#include "engine/rml1/offline/work_check.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// The tools for streams on what lies beside the plain case: another origin, the first command, a
// wait of a millisecond, what was read before. T1: 100 units in a mm, X to 200 mm and Y to 150 mm.
namespace rmlcell::rml1 {
namespace {

// RML1-3A.02: a relative set of which one number alone leads somewhere.
TEST(StreamSides, AWayInOneAxisIsOwedInBoth) {
  const auto moved = [](const std::string& stream, double x_mm, double y_mm, double z_mm) {
    return MoveStream(stream, ParametersOf("t1"), {x_mm, y_mm, z_mm}).value().stream;
  };
  EXPECT_EQ(moved("PR;PU0,5;", 1, 2, 0), "PR;!ZZ100,200,0;PU0,5;");
  EXPECT_EQ(moved("PR;PU5,0;", 1, 2, 0), "PR;!ZZ100,200,0;PU5,0;");
  EXPECT_EQ(moved("PR;PU0,0;", 1, 2, 0), "PR;PU0,0;");
  EXPECT_EQ(moved("!PZ-100,200;PR;Z0,0,-3000;", 0, 0, -0.5),
            "!PZ-150,150;PR;!ZZ0,0,-50;Z0,0,-3000;");
  // The third number of a command before is none of this one.
  EXPECT_EQ(moved("!PZ-100,200;PA;Z1,1,5;H;PR;PU0,0;", 0, 0, -0.5),
            "!PZ-150,150;PA;Z1,1,-45;H;PR;PU0,0;");
}

// 3 units of 40 in a mm are 7.5 of 100. What rounding took of Z1 stays owed over a whole !ZO and
// !ZM; IN leads to X and Y of the machine, of which nothing is owed.
TEST(StreamSides, WhatRoundingTookStaysOwed) {
  const auto scaled = [](const std::string& stream) {
    return ScaleStream(stream, ParametersOf("t1"), 40, 100).value().stream;
  };
  EXPECT_EQ(scaled("!PZ-3,3;!ZO-8;PD;^PR;Z0,0,-3;"), "!PZ-8,8;!ZO-20;PD;^PR;Z0,0,-7;");
  EXPECT_EQ(scaled("!PZ-3,3;!ZM-8;PD;^PR;Z0,0,-3;"), "!PZ-8,8;!ZM-20;PD;^PR;Z0,0,-7;");
  EXPECT_EQ(scaled("PR;Z3,3,0;IN;PR;Z3,3,0;"), "PR;Z8,8,0;IN;PR;Z8,8,0;");
  EXPECT_EQ(scaled("PR;Z3,3,0;H;PR;Z3,3,0;"), "PR;Z8,8,0;H;PR;Z8,8,0;");
}

// A wait of one millisecond is one, and is over behind the motion that it comes before.
TEST(StreamSides, AWaitOfAMillisecond) {
  const auto body = [](const std::string& text, std::string_view profile) {
    return FromGcode(text, ParametersOf(profile), {}).value().stream;
  };
  const std::string slow = body("G4 P0.001\nG1 Z-1 F120\nG1 X5\n", "t1");
  EXPECT_NE(slow.find("!DW1;\nZ0,0,-100;\n!DW0;\nZ500,0,-100;\n"), std::string::npos) << slow;
  const std::string level = body("G1 Z-1 F600\nG4 P0.001\nG1 X5 F2400\nG1 X6\n", "mdx-40a");
  EXPECT_NE(level.find("!DW1;\nPD500,0;\n!DW0;\nPD600,0;\n"), std::string::npos) << level;
}

// The lesser of two arcs has a radius above 0, however small: clockwise to the right its centre is
// below the way, counterclockwise above it.
TEST(StreamSides, ARadiusBelowOneMillimetre) {
  const auto centre = [](bool clockwise, double r) {
    return ArcOf({.from = {1, 2}, .to = {1.8, 2}, .clockwise = clockwise, .r = r}).value().centre;
  };
  for (const double r : {0.5, -0.5}) {
    const double up = r > 0 ? 0.3 : -0.3;
    EXPECT_NEAR(centre(true, r).x(), 1.4, 1e-9);
    EXPECT_NEAR(centre(true, r).y(), 2 - up, 1e-9) << r;
    EXPECT_NEAR(centre(false, r).x(), 1.4, 1e-9);
    EXPECT_NEAR(centre(false, r).y(), 2 + up, 1e-9) << r;
  }
}

// Where a line cannot be read: the character, and no more than that.
TEST(StreamSides, PlacesOfCharactersInALine) {
  const auto where = [](const std::string& text) {
    return FromGcode(text, ParametersOf("t1"), {}).value().findings.at(0).where;
  };
  EXPECT_EQ(where("G0 X1\nG0  #\n"), (SourceSpan{2, 5, 1, 10}));
  EXPECT_EQ(where("G0 X1\n  % G0\n"), (SourceSpan{2, 5, 1, 10}));
  EXPECT_EQ(where("G0 X1\n   (no end\n"), (SourceSpan{2, 4, 1, 9}));
  EXPECT_EQ(where("G0 X1\n   /G0 X2\n"), (SourceSpan{2, 4, 1, 9}));
}

// The place of a note is where its phrase begins.
TEST(StreamSides, PlacesOfNotesAndRefusals) {
  const auto made = ToGcode("!MC0;!PZ-50,200;\nPU0,0;\n  PD500,0;PU0,0;", ParametersOf("t1"));
  ASSERT_TRUE(made);
  ASSERT_EQ(made->findings.size(), 1U);
  EXPECT_EQ(made->findings[0].code, ErrorCode::kRml1FeedNotGiven);
  EXPECT_EQ(made->findings[0].where, (SourceSpan{3, 3, 1, 26}));
  const auto turned = ToGcode("PU0,0;\n !ZEA9;", ParametersOf("t1a"));
  ASSERT_FALSE(turned);
  EXPECT_EQ(turned.error().code, ErrorCode::kRml1RotaryMotion);
  EXPECT_EQ(turned.error().where, (SourceSpan{2, 2, 1, 8}));
}

// A spindle goes on turning over a wait, a pause and another speed; told only where it still turns
// at the end.
TEST(StreamSides, ASpindleTurnsOnUntilItIsStopped) {
  const auto left_on = [](const std::string& stream) {
    const auto made = ToGcode(stream, ParametersOf("t1"));
    int count = 0;
    for (const Diagnostic& finding : made->findings)
      count += finding.code == ErrorCode::kRml1SpindleLeftOn;
    return count;
  };
  EXPECT_EQ(left_on("V2;!VZ2;!MC1;PU1,1;"), 1);
  EXPECT_EQ(left_on("V2;!VZ2;!MC1;PU1,1;!RC15;PU2,2;"), 1);
  EXPECT_EQ(left_on("V2;!VZ2;!MC1;PU1,1;!DW5;PU2,2;"), 1);
  EXPECT_EQ(left_on("V2;!VZ2;!MC1;PU1,1;!RC15;PU2,2;!MC0;"), 0);
  EXPECT_EQ(left_on("V2;!VZ2;!MC0;PU1,1;!RC15;!DW5;PU2,2;"), 0);
}

// What nobody reads as a command keeps its place, also where it is but a comma; a call that
// the data end in begins with its mark.
TEST(StreamSides, PlacesOfPhrases) {
  const auto explained = [](const std::string& stream) {
    std::vector<ExplainedPhrase> phrases;
    EXPECT_TRUE(Explain(stream, ParametersOf("t1"), [&](const ExplainedPhrase& phrase) {
      phrases.push_back(phrase);
      return true;
    }));
    return phrases;
  };
  const auto comma = explained("PU;,");
  ASSERT_EQ(comma.size(), 2U);
  EXPECT_EQ(comma[1].offset, 3);
  EXPECT_EQ(comma[1].text, ",");
  const auto call = explained("^ P");
  ASSERT_EQ(call.size(), 1U);
  EXPECT_EQ(call[0].offset, 0);
  EXPECT_EQ(call[0].text, "^ P");
}

// What the second stream does not do any more at its end is told, one change each.
TEST(StreamSides, MotionsThatAreGoneAtTheEnd) {
  const auto diff = *CompareStreams({.object = "!MC0;PU1,1;PU2,2;PU3,3;"},
                                    {.object = "!MC0;PU1,1;"}, ParametersOf("t1"));
  ASSERT_EQ(diff.steps.size(), 2U);
  EXPECT_EQ(diff.steps[0].kind, machine::StepChange::Kind::kRemoved);
  EXPECT_EQ(diff.steps[0].before, "go to X 0.02 Y 0.02 at 60 mm/s");
  EXPECT_EQ(diff.steps[1].kind, machine::StepChange::Kind::kRemoved);
  EXPECT_EQ(diff.steps[1].before, "go to X 0.03 Y 0.03 at 60 mm/s");
}

// A motion that comes between two that stay is new, and no other one is another.
TEST(StreamSides, AMotionBetweenTwoThatStay) {
  const auto diff = *CompareStreams({.object = "!MC0;PU1,1;PU2,2;"},
                                    {.object = "!MC0;PU1,1;PU3,3;PU2,2;"}, ParametersOf("t1"));
  ASSERT_EQ(diff.steps.size(), 1U);
  EXPECT_EQ(diff.steps[0].kind, machine::StepChange::Kind::kAdded);
  EXPECT_EQ(diff.steps[0].after, "go to X 0.03 Y 0.03 at 60 mm/s");
}

// RML1-E8007 says how much, with one decimal.
TEST(StreamSides, TheShareOfForeignBytes) {
  const auto made = MoveStream(std::string(300, '$'), ParametersOf("t1"), {1, 0, 0});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().detail, "100.0 % of the bytes belong to no command");
  EXPECT_EQ(ArgumentsText(made.error().detail), "share=100 %");
}

// Of an origin 50 mm in, X leads to 150 mm. And of a way in from outside, the place where the tool
// stood before is no part of the work: it begins at Y 30 mm.
TEST(StreamSides, FacesOfTheTravel) {
  machine::Parameters moved = ParametersOf("t1");
  ASSERT_TRUE(moved.Set("ORIGIN_X", std::string_view("50")));
  const auto right = CheckWork(machine::Bytes::Borrowed("PU0,0;PD16000,0;PU;"), moved).value();
  ASSERT_TRUE(right);
  EXPECT_EQ(right->detail,
            "10 mm of the work would not be cut: 10 mm beyond the greatest X (150 mm); in X it "
            "fits moved by -50 to -10 mm");
  const auto in = CheckWork(machine::Bytes::Borrowed("PU-1000,3000;PD1000,3000,1000,15100;PU;"),
                            ParametersOf("t1"))
                      .value();
  ASSERT_TRUE(in);
  EXPECT_EQ(in->detail,
            "11 mm of the work would not be cut: 10 mm beyond the least X (0 mm), 1 mm beyond the "
            "greatest Y (150 mm); in X it fits moved by 10 to 190 mm; in Y it fits moved by -30 to "
            "-1 mm");
}

}  // namespace
}  // namespace rmlcell::rml1
