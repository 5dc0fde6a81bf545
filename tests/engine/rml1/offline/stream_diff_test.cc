#include "engine/rml1/offline/stream_diff.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::StepChange;

machine::ProgramDiff Diff(std::string_view a, std::string_view b, std::string_view profile = "t1") {
  const auto made = CompareStreams({.object = a}, {.object = b}, ParametersOf(profile));
  EXPECT_TRUE(made) << (made ? "" : made.error().detail);
  return *made;
}

TEST(CompareStreams, HowItIsWrittenDoesNotCount) {
  EXPECT_TRUE(Diff("PU100,0,100,50;PD0,0;", " M 100 , 0;M100,50\r\n;D0,0;").equal());
  EXPECT_TRUE(Diff("V3;Z1,2,3,4,5,6;", "!VZ3.0;!ZZ1,2,3;PR;Z3,3,3;").equal());
  EXPECT_TRUE(Diff("PU5,5;", "VS9;VS2;PU5,5;").equal());  // a setting without effect
}

TEST(CompareStreams, WhatChangesIsSaidInMillimetres) {
  const auto diff = Diff("!MC0;Z0,0,100;Z50,0,-20;", "!MC0;Z0,0,100;V3;Z70,0,-35;");
  ASSERT_EQ(diff.steps.size(), 1U);
  const StepChange& change = diff.steps[0];
  EXPECT_EQ(change.kind, StepChange::Kind::kChanged);
  EXPECT_EQ(change.step_a, 3);
  EXPECT_EQ(change.step_b, 4);
  EXPECT_EQ(change.before, "cut to X 0.5 Z -0.2 at 2 mm/s");
  EXPECT_EQ(change.after, "cut to X 0.7 Z -0.35 at 3 mm/s");
  EXPECT_EQ(change.what,
            (std::vector<std::string>{"X 0.5 -> 0.7", "Z -0.2 -> -0.35", "mm/s 2 -> 3"}));
  EXPECT_EQ(change.aspects, unsigned{machine::kAspectPath | machine::kAspectTime});
  EXPECT_NEAR(change.target_moved_mm, 0.25, 1e-9);  // 0.2 in X, 0.15 in Z
  EXPECT_EQ(diff.aspects, change.aspects);
}

TEST(CompareStreams, AddedRemovedSpindleWaitsAndPauses) {
  const auto diff = Diff("PU1,1;PU2,2;PU3,3;", "!RC15;PU1,1;PU3,3;!NR;!DW5;PD;");
  ASSERT_EQ(diff.steps.size(), 5U);
  EXPECT_EQ(diff.steps[0].what, (std::vector<std::string>{"spindle speed 4500 -> 15000"}));
  EXPECT_EQ(diff.steps[0].aspects, unsigned{machine::kAspectPower});
  EXPECT_EQ(diff.steps[1].kind, StepChange::Kind::kRemoved);
  EXPECT_EQ(diff.steps[1].before, "go to X 0.02 Y 0.02 at 60 mm/s");
  EXPECT_EQ(diff.steps[2].kind, StepChange::Kind::kAdded);
  EXPECT_EQ(diff.steps[2].aspects, unsigned{machine::kAspectFlow});
  EXPECT_EQ(diff.steps[3].aspects, unsigned{machine::kAspectTime});
  EXPECT_EQ(diff.steps[4].after, "down into the work to Z 0 at 2 mm/s");
}

// Each motion leads on from where the one before it ended.
TEST(CompareStreams, MotionsOfOneCommand) {
  const auto diff = Diff("!MC0;", "!MC0;PU100,200;");
  ASSERT_EQ(diff.steps.size(), 2U);
  EXPECT_EQ(diff.steps[0].after, "go to Z 5 at 2 mm/s");
  EXPECT_EQ(diff.steps[1].after, "go to X 1 Y 2 at 60 mm/s");
}

TEST(CompareStreams, FiguresOfRunsButNotOfTheText) {
  const std::vector<machine::Figure> a = {{"cut_length", "mm", 1.0}, {"programmed.xmax", "", 1.0}};
  const std::vector<machine::Figure> b = {{"cut_length", "mm", 2.0}, {"programmed.xmax", "", 9.0}};
  const auto diff = CompareStreams({.object = "PU;", .figures = a}, {.object = "PU;", .figures = b},
                                   ParametersOf("t1"));
  ASSERT_TRUE(diff);
  ASSERT_EQ(diff->figures.size(), 1U);
  EXPECT_EQ(diff->figures[0].name, "cut_length");
  EXPECT_EQ(diff->figures[0].after, 2.0);
}

// A figure of one run alone counts from 0 or to 0; equal ones, and the number of commands, are no
// change, but a difference of a ten millionth is.
TEST(CompareStreams, WhichFiguresChange) {
  const std::vector<machine::Figure> a = {{"commands", "", 7.0},
                                          {"cut_length", "mm", 1.0},
                                          {"errors", "", 0.0},
                                          {"time", "s", 5.0},
                                          {"travel", "mm", 4.0}};
  const std::vector<machine::Figure> b = {{"commands", "", 9.0},
                                          {"cut_length", "mm", 1.0 + 1e-7},
                                          {"errors", "", 0.0},
                                          {"plunges", "times", 3.0},
                                          {"time", "s", 5.0 + 1e-12}};
  const auto diff = CompareStreams({.object = "PU;", .figures = a}, {.object = "PU;", .figures = b},
                                   ParametersOf("t1"));
  ASSERT_TRUE(diff);
  ASSERT_EQ(diff->figures.size(), 3U);
  EXPECT_EQ(diff->figures[0].name, "cut_length");
  EXPECT_EQ(diff->figures[0].before, 1.0);
  EXPECT_EQ(diff->figures[1].name, "plunges");
  EXPECT_EQ(diff->figures[1].unit, "times");
  EXPECT_EQ(diff->figures[1].before, 0.0);
  EXPECT_EQ(diff->figures[1].after, 3.0);
  EXPECT_EQ(diff->figures[2].name, "travel");
  EXPECT_EQ(diff->figures[2].unit, "mm");
  EXPECT_EQ(diff->figures[2].before, 4.0);
  EXPECT_EQ(diff->figures[2].after, 0.0);
}

// Places that differ by less than half of a ten thousandth of a unit are one.
TEST(CompareStreams, NoiseOfDecimalsIsNoChange) {
  EXPECT_TRUE(Diff("Z100,0,0;", "Z100.00004,0,0;").equal());
  EXPECT_FALSE(Diff("Z100,0,0;", "Z100.00006,0,0;").equal());
}

// Places are told from the work origin, wherever that is on the table.
TEST(CompareStreams, PlacesAreFromTheWorkOrigin) {
  machine::Parameters moved = ParametersOf("t1");
  ASSERT_TRUE(moved.Set("ORIGIN_X", std::string_view("50")));
  ASSERT_TRUE(moved.Set("ORIGIN_Y", std::string_view("20")));
  const auto diff =
      CompareStreams({.object = "!MC0;Z50,30,0;"}, {.object = "!MC0;Z70,10,5;"}, moved);
  ASSERT_TRUE(diff);
  ASSERT_EQ(diff->steps.size(), 1U);
  EXPECT_EQ(diff->steps[0].what,
            (std::vector<std::string>{"X 0.5 -> 0.7", "Y 0.3 -> 0.1", "Z 0 -> 0.05"}));
}

// Degrees and waits are compared as what they are; a pause is one like any other.
TEST(CompareStreams, DegreesAndWaits) {
  const auto turned = Diff("!ZE A90;", "!ZE A80.5;", "t1a");
  ASSERT_EQ(turned.steps.size(), 1U);
  EXPECT_EQ(turned.steps[0].what, (std::vector<std::string>{"A 90 -> 80.5"}));
  EXPECT_EQ(turned.steps[0].aspects, unsigned{machine::kAspectPath});
  const auto waits = Diff("!MC0;!DW5;Z1,1,1;", "!MC0;!DW7;Z1,1,1;");
  ASSERT_EQ(waits.steps.size(), 1U);
  EXPECT_EQ(waits.steps[0].kind, StepChange::Kind::kChanged);
  EXPECT_EQ(waits.steps[0].what, (std::vector<std::string>{"wait in ms 5 -> 7"}));
  EXPECT_EQ(waits.steps[0].aspects, unsigned{machine::kAspectTime});
  EXPECT_EQ(waits.steps[0].target_moved_mm, 0.0);
}

// More differences than an exact alignment takes, and more than are told.
TEST(CompareStreams, LongStreams) {
  std::string a, b;
  for (int i = 0; i < 30'000; ++i) {
    a += "PU" + std::to_string(i % 9000) + ",1;";
    b += "PU" + std::to_string(i % 9000) + ",2;";
  }
  const auto diff = Diff(a, b);
  EXPECT_EQ(diff.steps.size(), 30'000U);
  EXPECT_FALSE(diff.steps[kToldChangesMax - 1].before.empty());
  EXPECT_TRUE(diff.steps[kToldChangesMax].before.empty());
  EXPECT_FALSE(diff.steps[kToldChangesMax - 1].what.empty());
  EXPECT_TRUE(diff.steps[kToldChangesMax].what.empty());
}

TEST(CompareStreams, Refuses) {
  std::string many;
  for (std::size_t i = 0; i < kComparedMax + 1; ++i) many += i % 2 == 0 ? "Z1,1,1;" : "Z2,2,2;";
  const auto refused = CompareStreams({.object = many}, {.object = "PU;"}, ParametersOf("t1"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kRml1TooManyMotions);
  const std::string prose(300, '$');
  const auto none = CompareStreams({.object = "PU;"}, {.object = prose}, ParametersOf("t1"));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kRml1NoProgram);
}

// Values have five decimals at most: 100.0064 units are 1.000064 mm.
TEST(CompareStreams, ValuesHaveFiveDecimals) {
  const auto diff = Diff("!MC0;Z100,0,0;", "!MC0;Z100.0064,0,0;");
  ASSERT_EQ(diff.steps.size(), 1U);
  EXPECT_EQ(diff.steps[0].what, (std::vector<std::string>{"X 1 -> 1.00006"}));
  const auto back = Diff("!MC0;Z100.0064,0,0;", "!MC0;Z100,0,0;");
  ASSERT_EQ(back.steps.size(), 1U);
  EXPECT_EQ(back.steps[0].what, (std::vector<std::string>{"X 1.00006 -> 1"}));
}

// The same numbers of other axes are another place, and so is one that is as far in both.
TEST(CompareStreams, TheSameNumbersInOtherAxes) {
  EXPECT_FALSE(Diff("!MC0;Z100,200,0;", "!MC0;Z200,100,0;").equal());
  EXPECT_FALSE(Diff("!MC0;PU100,100;", "!MC0;PU200,200;").equal());
}

}  // namespace
}  // namespace rmlcell::rml1
