// Verdicts of streams by the rules for mills that need more than a line: steps, speeds, plunges,
// clamps; and that a fault never makes a verdict better. docs/verdict.md lists the rules.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/run/drive.h"
#include "engine/simulation/run/simulate.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

using machine::Verdict;

machine::Judgement CheckOf(const std::string& stream, const std::string& profile = "t1",
                           const std::map<std::string, std::string>& changed = {}) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  const auto parameters = machine::MakeParameters(mill, profile, changed);
  EXPECT_TRUE(parameters);
  return JudgeFigures(
      mill, mill.Translate({.name = "part.rml", .bytes = stream}, *parameters, {}).figures);
}

std::string TextOfRun(const std::string& stream) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  machine::RunSetup setup(*machine::MakeParameters(mill, "t1", {}));
  setup.main_program = 1;
  setup.programs[1].object = machine::Bytes::Of(stream);
  const auto result = Simulate(mill, std::move(setup), {});
  EXPECT_TRUE(result);
  return result ? TextOf(result->report.judgement) : std::string();
}

std::string TextOfCheck(const std::string& stream, const std::string& profile = "t1") {
  return TextOf(CheckOf(stream, profile));
}

// A stroke from the origin to X, 100 units deep; lifts are 200 units.
std::string StrokeTo(const std::string& x) {
  return "VS10;!VZ10;!PZ-100,200;!MC1;PU0,0;PD" + x + ",0;PU0,0;!MC0;";
}

// The MDX-15 has 40 units in a mm and 152.4 mm, 6096 units, in X. Written for 100 units, work is
// 2.5 times as long here: up to 15240 units it would fit. RML1-1.08
TEST(MillRules, WorkThatWouldFitWithTheOtherStep) {
  EXPECT_EQ(TextOfCheck(StrokeTo("6096"), "mdx-15"), "GOOD");
  EXPECT_EQ(TextOfCheck(StrokeTo("6097"), "mdx-15"),
            "BAD; RML1-E8002 the work is 0.025 mm longer in X than the travel: wherever its origin "
            "is, it does not fit; RML1-E8002 0.025 mm of the work lie beyond the travel and are "
            "not cut @6; RML1-E8016 it may be written for 100 units per mm: the work would be "
            "60.97 x 0 x 1 mm there, and would fit");
  const auto guesses = [](const std::string& x, const std::string& profile) {
    return TextOfCheck(StrokeTo(x), profile).find("RML1-E8016") != std::string::npos;
  };
  EXPECT_TRUE(guesses("15240", "mdx-15"));
  EXPECT_FALSE(guesses("15241", "mdx-15"));
  // Where it is already 100, or where only the origin is wrong, there is nothing to guess.
  EXPECT_FALSE(guesses("20400", "t1"));
  EXPECT_FALSE(guesses("-400", "mdx-15"));
}

// 40 units are a lift of 0.4 mm, or of 1 mm on a machine with 40 units; 50 are an ordinary 0.5 mm.
TEST(MillRules, LiftsAsLowAsWithTheOtherStep) {
  const auto lift = [](const std::string& units, const std::string& profile = "t1") {
    return TextOfCheck("VS10;!VZ10;!PZ-100," + units + ";!MC1;PU100,100;PD200,100;PU0,0;!MC0;",
                       profile);
  };
  EXPECT_EQ(lift("19"), "GOOD");
  EXPECT_EQ(lift("20"),
            "DOUBTFUL; RML1-E8016 it may be written for 40 units per mm: the tool rises 0.200 mm "
            "above the work, which would be 0.5 mm there");
  EXPECT_EQ(lift("40"),
            "DOUBTFUL; RML1-E8016 it may be written for 40 units per mm: the tool rises 0.400 mm "
            "above the work, which would be 1 mm there");
  EXPECT_EQ(lift("41"), "GOOD");
  EXPECT_EQ(lift("50"), "GOOD");
  // 88 and 100 units are 2.2 and 2.5 mm with 40: twentieths of a millimetre, as people think of
  // them. With 100, 0.88 mm is none. 80 and 100 units are round with both, 102 too high to tell.
  EXPECT_EQ(lift("88"),
            "DOUBTFUL; RML1-E8016 it may be written for 40 units per mm: the tool rises 0.880 mm "
            "above the work, which would be 2.2 mm there");
  EXPECT_EQ(lift("98").substr(0, 20), "DOUBTFUL; RML1-E8016");
  EXPECT_EQ(lift("80"), "GOOD");
  EXPECT_EQ(lift("99"), "GOOD");
  EXPECT_EQ(lift("102"), "GOOD");
  // One height that is round with neither: nothing to guess.
  EXPECT_EQ(TextOfCheck("VS10;!VZ10;!PZ-100,88;!MC1;PU100,100;PD200,100;Z200,100,-101;PU0,0;!MC0;"),
            "GOOD");
  EXPECT_EQ(lift("40", "mdx-15"), "GOOD");
}

// T1 has 0.5 to 60 mm/s. 60.6 is 1 % of 60.6 too fast at most; the plunge of 1 mm goes by !VZ, the
// stroke of 1 mm by VS.
TEST(MillRules, FeedRatesThatTheMachineDoesNotHave) {
  const auto feeds = [](const std::string& setting) {
    return TextOfCheck(setting + "!PZ-100,200;!MC1;PU100,100;PD200,100;PU0,0;!MC0;");
  };
  const std::string said =
      "DOUBTFUL; RML1-E8003 1.000 mm in the work with feed rates that the machine does not have: ";
  EXPECT_EQ(feeds("VS60.6;!VZ10;"), "GOOD");
  EXPECT_EQ(feeds("VS61;!VZ10;"), said + "60 mm/s in place of 61 @6");
  EXPECT_EQ(feeds("VS0;!VZ10;"), said + "0.5 mm/s in place of 0 @6");
  EXPECT_EQ(feeds("VS-5;!VZ10;"), said + "0.5 mm/s in place of -5 @6");
  EXPECT_EQ(feeds("VS10;!VZ0.1;"), said + "0.5 mm/s in place of 0.1 @6");
  // The worst one is told: 0.1 is four fifths less than 0.5, 61 a sixtieth more than 60.
  EXPECT_EQ(feeds("VS61;!VZ0.1;"),
            "DOUBTFUL; RML1-E8003 2.000 mm in the work with feed rates that the machine does not "
            "have: 0.5 mm/s in place of 0.1 @6");
  // What is set anew before the cut, or only lifts, costs nothing; nor does rounding to a step.
  EXPECT_EQ(feeds("VS61;VS10;!VZ10;"), "GOOD");
  EXPECT_EQ(feeds("VS10;!VZ0.1;!VZ10;"), "GOOD");
  EXPECT_EQ(feeds("VS10;!VZ85;").find("RML1-E8003"), std::string::npos);  // a slower plunge
  EXPECT_EQ(feeds("VS10;V85;Z0,0,500;V10;"), "GOOD");
  EXPECT_EQ(feeds("VS10.9;!VZ10.9;"), "GOOD");
  EXPECT_EQ(feeds("VS61;!VZ0.1;DF;VS10;!VZ10;"), "GOOD");
}

// T1 has 4500 to 15000 rpm; RML1-3C.15 to 3C.20. Plunge and stroke are 2 mm.
TEST(MillRules, SpindleSpeedsThatTheMachineDoesNotHave) {
  const auto speed = [](const std::string& rc, const std::string& profile) {
    return TextOfCheck("!RC" + rc + ";VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD200,100;PU0,0;!MC0;",
                       profile);
  };
  const std::string said =
      "DOUBTFUL; RML1-E8003 2.000 mm in the work with spindle speeds that the machine does not "
      "have: ";
  EXPECT_EQ(speed("15000", "t1"), "GOOD");
  EXPECT_EQ(speed("20000", "t1"), said + "15000 rpm in place of 20000 @7");
  EXPECT_EQ(speed("4000", "t1"), said + "4500 rpm in place of 4000 @7");
  EXPECT_EQ(speed("4460", "t1"), "GOOD");                                     // 0.9 % below 4500
  EXPECT_EQ(speed("15", "t1"), "GOOD");                                       // a stage
  EXPECT_EQ(speed("12000", "t1s"), said + "15000 rpm in place of 12000 @7");  // the last stage
  // RML1-3C.20: by hand T1F has 4500 to 15000 rpm, and the MDX-20 nothing but 6500.
  EXPECT_EQ(speed("15000", "t1f"), "GOOD");
  EXPECT_EQ(speed("20000", "t1f"), said + "15000 rpm in place of 20000 @7");
  EXPECT_EQ(speed("15", "t1f"), "GOOD");
  EXPECT_EQ(speed("-1", "t1f"), "GOOD");
  const auto on_mdx_20 = [](const std::string& rc) {
    return TextOfCheck(rc + "VS5;!VZ2;!PZ-40,80;!MC1;PU40,40;PD80,40;PU0,0;!MC0;", "mdx-20");
  };
  EXPECT_EQ(on_mdx_20("!RC6500;"), "GOOD");
  EXPECT_EQ(on_mdx_20("!RC20000;"), said + "6500 rpm in place of 20000 @7");
  EXPECT_EQ(on_mdx_20("!RC20000;!RC6500;"), "GOOD");
  EXPECT_EQ(speed("12000", "t1f"), "GOOD");  // set on the machine, not by command
  EXPECT_EQ(speed("20000;!RC8000", "t1"), "GOOD");
}

// Z of T1 goes 60 mm/s at most; the plunge from 2 mm above has 1 mm below the surface.
TEST(MillRules, PlungesAsFastAsZTravels) {
  const auto down = [](const std::string& commands) {
    return TextOfCheck("VS10;" + commands + "PU0,0;!MC0;");
  };
  const std::string said = " mm down to where the tool cuts, nearly as fast as Z travels @";
  EXPECT_EQ(down("!VZ60;!PZ-100,200;!MC1;PU100,100;PD200,100;"),
            "DOUBTFUL; RML1-E8017 1.000" + said + "6");
  EXPECT_EQ(down("!VZ48;!PZ-100,200;!MC1;PU100,100;PD200,100;"),  // 0.8 of 60
            "DOUBTFUL; RML1-E8017 1.000" + said + "6");
  EXPECT_EQ(down("!VZ47;!PZ-100,200;!MC1;PU100,100;PD200,100;"), "GOOD");
  EXPECT_EQ(down("!VZ60;Z100,100,0;!VZ10;Z100,100,-100;!VZ60;Z100,100,100;"), "GOOD");
  // Steps down on the way of a cut are part of it, as reliefs have them.
  EXPECT_EQ(down("VS40;V10;!PZ-100,200;!MC1;PU100,100;PD200,100;V60;Z200,100,-150,300,100,-150;"),
            "GOOD");
  // A hole: 3 mm at once are too fast; 2 mm and the last one slowly are not.
  EXPECT_EQ(down("!VZ60;Z100,100,10;Z100,100,-300;Z100,100,100;"),
            "DOUBTFUL; RML1-E8017 3.000" + said + "4");
  EXPECT_EQ(down("!VZ60;Z100,100,10;Z100,100,-200;!VZ10;Z100,100,-300;Z100,100,100;"), "GOOD");
}

// From 1 mm above the surface to 1 mm below, and as much across, in units of 0.01 mm.
TEST(MillRules, SteepWaysDownArePlunges) {
  const auto ramp = [](const std::string& speed, const std::string& x) {
    return TextOfCheck("!MC1;V" + speed + ";Z1000,0,100,1" + x +
                       ",0,-100;V10;Z2000,0,-100;V60;Z2000,0,200;!MC0;");
  };
  const std::string said = " mm down to where the tool cuts, nearly as fast as Z travels @3";
  EXPECT_EQ(ramp("60", "001"), "DOUBTFUL; RML1-E8017 1.000" + said);
  EXPECT_EQ(ramp("48", "001"), "DOUBTFUL; RML1-E8017 1.000" + said);
  EXPECT_EQ(ramp("47", "001"), "GOOD");
  EXPECT_EQ(ramp("60", "199"), "DOUBTFUL; RML1-E8017 1.411" + said);  // sqrt(2^2 + 1.99^2) / 2
  // At 45 degrees it is a way across.
  EXPECT_EQ(ramp("60", "200"),
            "DOUBTFUL; RML1-E8019 1.414 mm across in the work, nearly as fast as Z travels, "
            "where other cuts take half of that or less @3");
  // Down the walls of a relief, behind its first cut.
  EXPECT_EQ(TextOfCheck("!MC1;V10;Z0,0,200,0,0,-10;V60;Z500,0,-10,501,0,-300,900,0,-300;"
                        "Z900,0,200;!MC0;"),
            "GOOD");
}

// V of lifts across the work: 10 mm to the cut, at 5 mm/s, and sqrt(20^2 + 10^2) mm behind it.
// V of T1 is 60 at most; from 0.8 of that on it is fast, and half of the speed and less is slow.
TEST(MillRules, WaysAcrossAtTheSpeedOfLifts) {
  const auto across = [](const std::string& cut, const std::string& fast) {
    return TextOfCheck("V60;!MC1;Z1000,0,200;V" + cut + ";Z1000,0,-50;Z2000,0,-50;V" + fast +
                       ";Z4000,1000,-50;Z4000,1000,200;!MC0;");
  };
  const std::string said =
      " mm across in the work, nearly as fast as Z travels, where other cuts take half of "
      "that or less @";
  EXPECT_EQ(across("5", "60"), "DOUBTFUL; RML1-E8019 22.361" + said + "8");
  EXPECT_EQ(across("30", "60"), "DOUBTFUL; RML1-E8019 22.361" + said + "8");
  EXPECT_EQ(across("31", "60"), "GOOD");
  EXPECT_EQ(across("5", "48"), "DOUBTFUL; RML1-E8019 22.361" + said + "8");
  EXPECT_EQ(across("5", "47"), "GOOD");
  // The plunge leads to a cut as fast, and is told with it.
  EXPECT_EQ(across("60", "5"), "DOUBTFUL; RML1-E8019 10.000" + said + "6");
  // A lift that ends in the work is none; at the surface it is one.
  const auto lift = [](const std::string& z) {
    return TextOfCheck("V5;!MC1;Z0,0,200;Z0,0,-50;Z1000,0,-50;V60;Z1000,0," + z + ";Z3000,0," + z +
                       ";Z3000,0,200;!MC0;");
  };
  EXPECT_EQ(lift("1"), "GOOD");
  EXPECT_EQ(lift("0"),
            "DOUBTFUL; RML1-E8010 20.000 mm across at travel speed, not above the surface of the "
            "work @8");
  EXPECT_EQ(lift("-1"), "DOUBTFUL; RML1-E8019 20.000" + said + "8");
  // The way out on a slope from 0.5 mm below to 0.5 mm above: half of 10.05 mm lies below.
  EXPECT_EQ(TextOfCheck("V5;!MC1;Z0,0,200;Z0,0,-50;Z1000,0,-50;V60;Z2000,0,50;Z2000,0,200;!MC0;"),
            "DOUBTFUL; RML1-E8019 5.025" + said + "7");
}

// A Z command along the surface, as fast as lifts, between cuts at half of that or less: 10 mm
// across from a hole or a groove, or to the first one. Reliefs are as fast there as beside it.
TEST(MillRules, WaysAlongTheSurfaceAtTheSpeedOfLifts) {
  const auto along = [](const std::string& before, const std::string& behind,
                        const std::string& fast = "60", const std::string& z = "0") {
    return TextOfCheck("!MC1;V60;Z0,0,200;V" + before + ";Z0,0,-50;Z500,0,-50;V" + fast +
                       ";Z500,0," + z + ";Z1500,0," + z + ";V" + behind +
                       ";Z1500,0,-50;Z2000,0,-50;V60;Z2000,0,200;!MC0;");
  };
  const std::string said =
      "DOUBTFUL; RML1-E8010 10.000 mm across at travel speed, not above the surface of the work @";
  EXPECT_EQ(along("5", "5"), said + "9");
  EXPECT_EQ(along("30", "30"), said + "9");
  EXPECT_EQ(along("31", "30"), "GOOD");
  EXPECT_EQ(along("30", "31"), "GOOD");
  EXPECT_EQ(along("5", "5", "48"), said + "9");
  EXPECT_EQ(along("5", "5", "47"), "GOOD");
  EXPECT_EQ(along("5", "5", "60", "1"), "GOOD");
  // To the first hole, and home from the last one.
  EXPECT_EQ(
      TextOfCheck("PA;!MC1;V60;Z0,0,200;Z0,0,0;Z1000,0,0;V5;Z1000,0,-50;V60;Z1000,0,200;!MC0;"),
      said + "6");
  EXPECT_EQ(TextOfCheck("PA;!MC1;V60;Z1000,0,200;V5;Z1000,0,-50;V60;Z1000,0,0;Z0,0,0;!MC0;"),
            said + "9");
}

// A pass of its own may be as fast as the machine goes, where it goes down slowly: to finish, or
// behind a slow ramp. One that goes down at V of the lift before it was given no speed.
TEST(MillRules, FastPassesBesideSlowOnes) {
  const auto second = [](const std::string& down, const std::string& fast) {
    return TextOfCheck("V5;!MC1;Z0,0,200;Z0,0,-50;Z1000,0,-50;V60;Z1000,0,200;Z0,1000,200;V" +
                       down + ";Z0,1000,-50;V" + fast + ";Z1000,1000,-50;Z1000,1000,200;!MC0;");
  };
  EXPECT_EQ(second("10", "60"), "GOOD");
  EXPECT_EQ(second("60", "60"),
            "DOUBTFUL; RML1-E8019 10.000 mm across in the work, nearly as fast as Z travels, "
            "where other cuts take half of that or less @12");
  EXPECT_EQ(second("47", "47"), "GOOD");
  // VS is no speed of lifts: back in its groove a tool may be as fast as it likes.
  EXPECT_EQ(TextOfCheck("VS10;!VZ10;!PZ-50,200;!MC1;PU0,0;PD1000,0;VS60;PD0,0;PU0,0;!MC0;"),
            "GOOD");
  // No cut of the program is slower.
  EXPECT_EQ(TextOfCheck("V60;!MC1;Z0,0,200;Z0,0,-50;Z1000,0,-50;Z1000,0,200;!MC0;"), "GOOD");
  EXPECT_EQ(TextOfCheck("!MC1;V10;Z0,0,200;Z0,0,0;Z1000,0,-50;V60;Z0,0,-50;Z0,0,200;!MC0;"),
            "GOOD");
}

// Where the tool cuts as fast as it plunges, the way down is as usual: on the MDX-15, with 15 mm/s
// in all axes, many a program has no other speed. 40 units are 1 mm there.
TEST(MillRules, PlungesAtTheSpeedOfTheCut) {
  const auto slow = [](const std::string& speeds) {
    return TextOfCheck(speeds + "!PZ-40,80;!MC1;PU400,400;PD800,400;PU0,0;!MC0;", "mdx-15");
  };
  const std::string said =
      "DOUBTFUL; RML1-E8017 1.000 mm down to where the tool cuts, nearly as fast as Z travels @6";
  EXPECT_EQ(slow("VS15;!VZ15;"), "GOOD");
  EXPECT_EQ(slow("VS14;!VZ15;"), said);
  EXPECT_EQ(slow("VS14;!VZ14;"), "GOOD");
  // Ways down that turn back are judged by the fastest cut of the program, before or behind them.
  const std::string hole = "!VZ15;!PZ-40,80;!MC1;PU100,100;PD;PU;";
  const std::string stroke = "PU400,400;PD800,400;PU0,0;";
  EXPECT_EQ(TextOfCheck("VS15;" + hole + stroke + "!MC0;", "mdx-15"), "GOOD");
  EXPECT_EQ(TextOfCheck("VS15;" + hole + stroke + "VS5;" + "!VZ5;" + stroke + "!MC0;", "mdx-15"),
            "GOOD");
  EXPECT_EQ(TextOfCheck("VS14;" + hole + "!VZ5;" + stroke + "!MC0;", "mdx-15"), said);
  EXPECT_EQ(TextOfCheck("VS15;" + hole + "PU0,0;!MC0;", "mdx-15"), said);
}

// As fast down as across is the feed of the tool; a little faster, it dives.
TEST(MillRules, OfABlockPlungesAsFastAsTheCut) {
  RunReport report;
  report.milling = MillingFigures{.removed_mm3 = 1.0,
                                  .fast_plunge_mm = 2.0,
                                  .fast_plunge_mm_s = 10.0,
                                  .fast_plunge_place = {.step = 5},
                                  .pass_mm_s = 10.0};
  EXPECT_EQ(TextOf(Judge(report)), "GOOD");
  report.milling->pass_mm_s = 9.999;
  EXPECT_EQ(TextOf(Judge(report)),
            "DOUBTFUL; CELL-E9620 the tool goes 2.000 mm down into material nearly as fast as Z "
            "travels, faster than it cuts @5");
}

// RML1-3C.08: a run waits at !NR, and so a check says, which looks behind it all the same.
TEST(MillRules, WaitsForTheResumeKey) {
  EXPECT_EQ(TextOfCheck("VS10;!VZ10;!PZ-100,200;!MC1;PU0,0;PD400,0;PU0,0;!NR;!NR;!MC0;"),
            "DOUBTFUL; CELL-E9308 halts that wait for a key to go on: 2 @8");
}

// RML1-3A.03, RML1-9.23: Z2 below the surface is refused; at the surface travel has no clearance.
TEST(MillRules, ToolUpHeightsThatAreNotAboveTheSurface) {
  const auto up = [](const std::string& z2) {
    return TextOfCheck("VS10;!VZ10;!PZ-100," + z2 + ";!MC1;PU100,100;PD200,100;PU0,0;!MC0;");
  };
  EXPECT_EQ(up("0"),
            "DOUBTFUL; RML1-E8010 3.650 mm across at travel speed, not above the surface of the "
            "work @5");
  EXPECT_EQ(up("-1"),
            "BAD; RML1-E8008 coordinates or heights that were refused: 1 @3; RML1-E8014 places "
            "that are no command, or have wrong parameters: 1");
}

// sqrt(2) mm to the work and sqrt(5) mm from it at 2 mm; between two cuts nobody stands a clamp.
TEST(MillRules, WaysLowerThanTheClamps) {
  const auto with_clamps = [](const std::string& mm, const std::string& stream) {
    return TextOf(CheckOf(stream, "t1", {{"CLAMP_HEIGHT", mm}}));
  };
  const std::string low =
      "VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD200,100;PU500,500;PD;PU200,100;PD;PU0,0;!MC0;";
  EXPECT_EQ(with_clamps("0", low), "GOOD");
  EXPECT_EQ(with_clamps("2", low), "GOOD");
  EXPECT_EQ(with_clamps("2.01", low),
            "DOUBTFUL; RML1-E8018 3.650 mm across to the work or from it, lower than the clamps "
            "stand @5");
  const std::string high =
      "VS10;!VZ10;!PZ-100,200;!MC1;Z100,100,2000;PD200,100;PU;Z200,100,2000,0,0,2000;!MC0;";
  EXPECT_EQ(with_clamps("20", high), "GOOD");
  // High on the way there and low, sqrt(5) mm, on the way back: that is the place.
  const std::string back = "VS10;!VZ10;!PZ-100,200;!MC1;Z100,100,2000;PD200,100;PU;PU0,0;!MC0;";
  EXPECT_EQ(with_clamps("20", back),
            "DOUBTFUL; RML1-E8018 2.236 mm across to the work or from it, lower than the clamps "
            "stand @8");
  // Sloping from 10 mm down to the surface over 10 mm: half of it lies below 5 mm.
  const std::string slope = "VS10;!VZ10;!PZ-100,200;!MC1;Z0,0,1000;Z1000,0,0;PD1100,0;PU;!MC0;";
  EXPECT_EQ(with_clamps("5", slope),
            "DOUBTFUL; RML1-E8018 7.071 mm across to the work or from it, lower than the clamps "
            "stand @6");
}

// An orderly program of random strokes on T1: what stands in each list is one command.
std::vector<std::string> RandomProgram(std::mt19937& random) {
  const auto number = [&](int low, int high) {
    return std::to_string(low + static_cast<int>(random() % static_cast<unsigned>(high - low)));
  };
  const auto place = [&] { return number(0, 20000) + "," + number(0, 15000); };
  // Lifts of less than 1 mm may be taken for those of another step size. Up to 47 mm/s: from 48 on,
  // 0.8 of those of T1, speeds are judged as those of travel.
  std::vector<std::string> program = {"VS" + number(1, 48), "!VZ" + number(1, 48),
                                      "!PZ-" + number(10, 2000) + "," + number(100, 1500), "!MC1"};
  const int parts = 2 + static_cast<int>(random() % 5U);
  for (int part = 0; part < parts; ++part) {
    const std::string start = place();
    program.push_back("PU" + start);
    if (random() % 2U == 0) {
      program.push_back("PD" + place());
      program.push_back("PA" + place());  // at the height of the tool
    } else {
      program.push_back("Z" + start + ",-" + number(1, 4000));
      program.push_back("Z" + place() + ",-" + number(1, 4000));
      program.push_back("PU");
    }
  }
  // One of each way of cutting at least, so that every setting matters.
  for (const std::string command : {"PU0,0", "PD5000,5000", "PU500,0", "Z500,0,-50", "PU0,0"})
    program.push_back(command);
  program.push_back("!MC0");
  return program;
}

std::string Joined(const std::vector<std::string>& program) {
  std::string stream;
  for (const std::string& command : program) stream += command + ";";
  return stream;
}

void Replace(std::vector<std::string>& program, std::string_view begins, const std::string& by) {
  for (std::string& command : program) {
    if (command.starts_with(begins)) command = by;
  }
}

std::vector<std::string>::iterator PlaceOf(std::vector<std::string>& program,
                                           std::string_view begins) {
  return std::ranges::find_if(
      program, [&](const std::string& command) { return command.starts_with(begins); });
}

// Each fault with the least verdict that it has, on a program that was GOOD.
struct Fault {
  const char* name;
  Verdict least;
  void (*put)(std::vector<std::string>&);
};
constexpr Fault kFaults[] = {
    {"no feed in X and Y", Verdict::kDoubtful, [](auto& p) { Replace(p, "VS", ""); }},
    {"no feed in Z", Verdict::kDoubtful, [](auto& p) { Replace(p, "!VZ", ""); }},
    {"lifts to the surface", Verdict::kDoubtful, [](auto& p) { Replace(p, "!PZ", "!PZ-100,0"); }},
    {"no spindle", Verdict::kBad, [](auto& p) { Replace(p, "!MC1", "!MC0"); }},
    {"beyond the travel", Verdict::kBad, [](auto& p) { Replace(p, "PD5000", "PD5000,30000"); }},
    {"a feed that there is not", Verdict::kDoubtful,
     [](auto& p) { p.insert(p.begin() + 2, "VS90"); }},
    {"no tail", Verdict::kDoubtful, [](auto& p) { p.resize(p.size() - 2); }},
    {"spindle off on the way", Verdict::kBad,
     [](auto& p) { p.insert(PlaceOf(p, "PD5000"), "!MC0"); }},
    {"a plunge as fast as lifts", Verdict::kDoubtful, [](auto& p) { Replace(p, "!VZ", "!VZ60"); }},
    {"a rapid at depth", Verdict::kDoubtful,
     [](auto& p) {
       const auto at = PlaceOf(p, "Z500,0,") + 1;
       p.insert(at, {"V10", "Z900,0,-50", "V60", "Z900,700,-50"});
     }},
    {"a rapid along the surface", Verdict::kDoubtful,
     [](auto& p) {
       const auto at = PlaceOf(p, "PU500");
       p.insert(at, {"V10", "Z5000,5000,-60", "Z5100,5000,-60", "V60", "Z5100,5000,0", "Z400,0,0",
                     "V10", "Z400,0,-60"});
     }},
    {"deeper than the travel", Verdict::kBad,
     [](auto& p) { Replace(p, "Z500,0,", "Z500,0,-4100"); }},
    {"Z0 out of place", Verdict::kDoubtful, [](auto& p) { p.insert(p.begin() + 3, "!ZO-2100"); }},
    {"a number that is missing", Verdict::kBad, [](auto& p) { Replace(p, "PU500,0", "PU500"); }},
    {"a place from before", Verdict::kDoubtful,
     [](auto& p) {
       p.insert(p.begin() + 4, {"PR", "PD10,10", "PU", "PA"});
     }},
};

constexpr int kRounds = 60;

TEST(MillRules, AFaultNeverMakesAVerdictBetter) {
  std::mt19937 random(20);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<std::string> orderly = RandomProgram(random);
    ASSERT_EQ(TextOfCheck(Joined(orderly)), "GOOD") << Joined(orderly);
    std::vector<Fault> faults(std::begin(kFaults), std::end(kFaults));
    std::shuffle(faults.begin(), faults.end(), random);
    std::vector<std::string> faulty = orderly;
    Verdict before = Verdict::kGood;
    for (const Fault& fault : faults) {
      std::vector<std::string> alone = orderly;
      fault.put(alone);
      EXPECT_GE(CheckOf(Joined(alone)).verdict, fault.least) << fault.name << Joined(alone);
      EXPECT_EQ(TextOfRun(Joined(alone)), TextOfCheck(Joined(alone))) << fault.name;
      fault.put(faulty);
      const Verdict now = CheckOf(Joined(faulty)).verdict;
      EXPECT_GE(now, before) << fault.name << Joined(faulty);
      before = now;
    }
    EXPECT_EQ(before, Verdict::kBad);
    EXPECT_EQ(TextOfRun(Joined(faulty)), TextOfCheck(Joined(faulty))) << Joined(faulty);
  }
}

// The same with what only a machine, or a block, makes wrong. A program that reaches into the far
// corner does not fit when its origin is moved, nor on a machine with fewer units in a millimetre.
TEST(MillRules, TheWrongMachineNeverMakesAVerdictBetter) {
  std::mt19937 random(22);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::string> program = RandomProgram(random);
    program.insert(program.begin() + 4, {"PU0,0", "PD20000,15000"});
    const std::string stream = Joined(program);
    ASSERT_EQ(TextOfCheck(stream), "GOOD") << stream;
    for (const char* axis : {"ORIGIN_X", "ORIGIN_Y"})
      EXPECT_EQ(CheckOf(stream, "t1", {{axis, "1"}}).verdict, Verdict::kBad) << axis << stream;
    const std::string there = TextOfCheck(stream, "mdx-20");
    EXPECT_EQ(there.substr(0, 3), "BAD");
    EXPECT_NE(there.find("RML1-E8002"), std::string::npos) << there;
    EXPECT_NE(there.find("RML1-E8016"), std::string::npos) << there;
  }
}

// The deepest cut of each reaches 40 mm, all of them 20 mm and more into X; a tool of 60 mm is as
// wide as any pass is deep.
TEST(MillRules, TheWrongBlockNeverMakesAVerdictBetter) {
  std::mt19937 random(23);
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  for (int round = 0; round < kRounds / 3; ++round) {
    std::vector<std::string> program = RandomProgram(random);
    program.insert(program.begin() + 4,
                   {"PU10000,7000", "Z10000,7000,-4000", "Z10500,7000,-4000", "PU10500,7000"});
    const auto judged = [&](const std::string& stock, const std::string& tool) {
      machine::RunSetup setup(*machine::MakeParameters(mill, "t1", {}));
      setup.main_program = 1;
      setup.programs[1].object = machine::Bytes::Of(Joined(program));
      SimulationRequest request;
      request.products.milling = Milling{.stock = *ParseStock(stock), .tool = *ParseTool(tool)};
      request.products.milling->stock.cell = 1.0;
      return Simulate(mill, std::move(setup), std::move(request))->report.judgement;
    };
    ASSERT_EQ(TextOf(judged("200x150x40", "flat:60")), "GOOD") << Joined(program);
    EXPECT_EQ(judged("200x150x38.5", "flat:60").verdict, Verdict::kBad);       // the table
    EXPECT_EQ(judged("200x150x39.5", "flat:60").verdict, Verdict::kDoubtful);  // into it
    EXPECT_EQ(judged("200x150x60@0,0,16", "flat:60").verdict, Verdict::kBad);  // travel through it
    EXPECT_GE(judged("200x150x40", "flat:20").verdict, Verdict::kDoubtful);    // a pass of 40 mm
    EXPECT_EQ(judged("200x150x40", "flat:60:flute=30").verdict, Verdict::kBad);
    EXPECT_GE(judged("200x150x40@300,0,0", "flat:60").verdict, Verdict::kDoubtful);
  }
}

// Travel speed never leads down: RML1-9.28, RML1-9.44, RML1-9.53. So a plunge into the work at the
// travel speed of the machine is none that a stream can ask for; only by its own speed of Z.
class FastWaysDown final : public machine::RunObserver {
 public:
  void OnMotion(const machine::MotionDone& done) override {
    if (done.programmed_mm_s > 0.0) return;
    ++rapid;
    const motion::PathPiece& path = done.motion->path;
    if (path.At(done.travelled).point.z() < path.At(done.from).point.z() - 1e-9) ++down;
  }
  int rapid = 0;
  int down = 0;
};

TEST(MillRules, TravelSpeedNeverLeadsDown) {
  std::mt19937 random(21);
  FastWaysDown ways;
  for (int round = 0; round < 40; ++round) {
    std::vector<std::string> program = RandomProgram(random);
    for (const char* command :
         {"PU30000,100", "PD", "PA100,100", "H", "Z-500,90,-900,400,90,-900", "!ZO-500", "PU50,50",
          "!ZM-3000", "IN", "@-50,0", "M-40,-40,90,90"}) {
      const auto at = static_cast<std::ptrdiff_t>(random() % program.size());
      program.insert(program.begin() + at, command);
    }
    machine::RunSetup setup(*machine::MakeParameters(*families::FindFamily("rml1"), "t1", {}));
    setup.main_program = 1;
    setup.programs[1].object = machine::Bytes::Of(Joined(program));
    setup.forecast = true;
    auto run = families::FindFamily("rml1")->NewRun(std::move(setup), ways);
    ASSERT_TRUE(run);
    Drive drive(**run, {});
    while (drive.Step(std::chrono::hours(1)) == machine::RunPhase::kRunning) {
    }
    EXPECT_TRUE(drive.finished());
  }
  EXPECT_GT(ways.rapid, 100);
  EXPECT_EQ(ways.down, 0);
}

}  // namespace
}  // namespace rmlcell::simulation
