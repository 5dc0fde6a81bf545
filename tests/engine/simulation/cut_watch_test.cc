// Where the rules for the speeds of a mill end: one way more, or one unit, and they say something
// else. T1 goes 60 mm/s at most; from 0.8 of that on it is fast, and half of a speed and less is
// slow. docs/verdict.md lists the rules.
#include <gtest/gtest.h>

#include <string>

#include "engine/families/families.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

std::string Judged(const std::string& stream, const std::string& profile = "t1") {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  const auto parameters = machine::MakeParameters(mill, profile, {});
  EXPECT_TRUE(parameters);
  return TextOf(JudgeFigures(
      mill, mill.Translate({.name = "part.rml", .bytes = stream}, *parameters, {}).figures));
}

std::string Across(const std::string& mm, const std::string& command) {
  return "DOUBTFUL; RML1-E8019 " + mm +
         " mm across in the work, nearly as fast as Z travels, where other cuts take half of that "
         "or less @" +
         command;
}

// Up within the work by V of lifts, from 2.5 to 1.5 mm below the surface: steeper than 45 degrees
// it is a lift, at 45 degrees a way across, of sqrt(2) mm.
TEST(CutWatch, LiftsAreSteeperThanWaysAcross) {
  const auto rise = [](const std::string& x) {
    return Judged("V5;!MC1;Z0,0,200;Z0,0,-250;Z1000,0,-250;V60;Z" + x + ",0,-150;Z" + x +
                  ",0,200;!MC0;");
  };
  EXPECT_EQ(rise("1099"), "GOOD");
  EXPECT_EQ(rise("1100"), Across("1.414", "7"));
}

// Slow ways above the work are no slow cuts: all that is cut is as fast as it goes down.
TEST(CutWatch, WaysAboveTheWorkAreNoCuts) {
  EXPECT_EQ(Judged("V60;!MC1;Z0,0,200;Z0,0,-50;Z1000,0,-50;Z1000,0,200;V5;Z0,0,200;!MC0;"), "GOOD");
}

// A visit to the work as fast as lifts, beside one that takes half of that: 30 of 60 mm/s are half,
// 31 are not.
TEST(CutWatch, VisitsBesideOthersAtHalfOfTheSpeed) {
  const auto beside = [](const std::string& slow) {
    return Judged("V" + slow +
                  ";!MC1;Z0,0,200;Z0,0,-50;Z1000,0,-50;V60;Z1000,0,200;Z0,1000,200;"
                  "Z0,1000,-50;Z1000,1000,-50;Z1000,1000,200;!MC0;");
  };
  EXPECT_EQ(beside("30"), Across("10.000", "10"));
  EXPECT_EQ(beside("31"), "GOOD");
}

// The speed of a way along the surface is its own, not that of a slower way above it: cuts at 28
// mm/s are half of 60, and not of the 48 on the way there.
TEST(CutWatch, WaysAboveTheSurfaceAreNotAlongIt) {
  const auto along = [](const std::string& above) {
    return Judged("!MC1;V60;Z0,0,200;V28;Z0,0,-50;Z500,0,-50;V48;Z500,0,100;Z800,0," + above +
                  ";V60;Z800,0,0;Z1800,0,0;V28;Z1800,0,-50;Z2300,0,-50;V60;Z2300,0,200;!MC0;");
  };
  EXPECT_EQ(along("100"),
            "DOUBTFUL; RML1-E8010 10.000 mm across at travel speed, not above the surface of the "
            "work @12");
}

// A way along the surface in a program that cuts nothing may be what it cuts.
TEST(CutWatch, WithoutACutNothingTellsAWayAlongTheSurfaceFromOne) {
  EXPECT_EQ(Judged("PA;!MC1;V60;Z0,0,200;Z0,0,0;Z1000,0,0;Z1000,0,200;!MC0;").find("RML1-E8010"),
            std::string::npos);
}

// RML1-3A.46, RML1-3A.51: a speed without a number is that of the machine again, which the program
// did not give.
TEST(CutWatch, SpeedsThatAreTakenBack) {
  const auto feeds = [](const std::string& settings) {
    return Judged(settings + "!PZ-100,200;!MC1;PU100,100;PD200,100;PU0,0;!MC0;");
  };
  const std::string said =
      "DOUBTFUL; RML1-E8013 1.000 mm in the work at a speed that the program did not set @7";
  EXPECT_EQ(feeds("VS10;!VZ10;VS;"), said);
  EXPECT_EQ(feeds("VS10;!VZ10;!VZ;"), said);
  EXPECT_EQ(feeds("VS;!VZ;VS10;!VZ10;"), "GOOD");
}

// RML1-1.08: on the MDX-15, with 40 units in a mm, the travel is 4064 units in Y and 2420 in Z.
// Written for 100 units, work is 2.5 times as long here: up to 10160 and 6050 units it would fit.
TEST(CutWatch, WorkThatWouldFitWithTheOtherStepInEachAxis) {
  const auto guesses = [](const std::string& strokes) {
    return Judged("VS10;!VZ10;!PZ-100,200;!MC1;PU0,0;" + strokes + "PU0,0;!MC0;", "mdx-15")
               .find("RML1-E8016") != std::string::npos;
  };
  EXPECT_FALSE(guesses("PD0,4064;"));
  EXPECT_TRUE(guesses("PD0,4065;"));
  EXPECT_TRUE(guesses("PD0,10160;"));
  EXPECT_FALSE(guesses("PD0,10161;"));
  EXPECT_FALSE(guesses("Z0,0,100,0,0,-1000;"));
  EXPECT_TRUE(guesses("Z0,0,100,0,0,-2421;"));
  EXPECT_TRUE(guesses("Z0,0,100,0,0,-6050;"));
  EXPECT_FALSE(guesses("Z0,0,100,0,0,-6051;"));
  // One axis that fits with neither is enough.
  EXPECT_FALSE(guesses("PD0,4065,15241,4065;"));
  EXPECT_TRUE(guesses("PD0,4065,15240,4065;"));
}

// Two visits as fast as lifts: of both together, from the first on, where a third one is slow.
TEST(CutWatch, VisitsAreAddedUp) {
  const std::string fast = "V60;Z0,0,200;Z0,1000,200;Z0,1000,-50;Z1000,1000,-50;Z1000,1000,200;";
  EXPECT_EQ(Judged("!MC1;" + fast + fast + "V5;Z0,0,200;Z0,0,-50;Z1000,0,-50;V60;Z1000,0,200;!MC0;")
                .find(Across("20.000", "6")),
            0U);
}

}  // namespace
}  // namespace rmlcell::simulation
