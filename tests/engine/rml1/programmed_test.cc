#include "engine/rml1/programmed.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <utility>

#include "tests/engine/rml1/run_support.h"

// The conventions are those of shared/corpus/rml1/SOURCES.md; corpus_test.cc compares whole
// programs.
namespace rmlcell::rml1 {
namespace {

Figures FiguresOf(const std::string& stream, const char* machine = "t1") {
  TestRun run(ParametersOf(machine), stream);
  run.AdvanceToEnd();
  return run.figures();
}

// Tool heights first, then X and Y: 3 up, 4 across; then 3 down to Z1 = 0, 4 cut back; the tool
// motion from 3 to 0 ends not below 0, so it is travel.
TEST(Programmed, GoesToTheToolHeightFirst) {
  const Figures figures = FiguresOf("@0,3;PU4,0;PD0,0;");
  EXPECT_DOUBLE_EQ(figures.at("programmed.travel_length"), 3 + 4 + 3);
  EXPECT_DOUBLE_EQ(figures.at("programmed.cut_length"), 4);
  EXPECT_EQ(figures.at("programmed.zmin"), 0);
  EXPECT_EQ(figures.at("programmed.zmax"), 3);
}

// RML1-3A.02, RML1-3A.04: 0 is a height of both; of what lies on the wrong side of it, and of a
// second number that is not there, nothing changes. DF sets both to 0.
TEST(Programmed, TakesTheHeightsThatTheMachineTakes) {
  const auto lowest_and_highest = [](const std::string& heights) {
    const Figures figures = FiguresOf(heights + "PD1,0;PU2,0;");
    const auto value = [&](const char* name) {
      return figures.contains(name) ? figures.at(name) : 0.0;
    };
    return std::pair(value("programmed.zmin"), value("programmed.zmax"));
  };
  EXPECT_EQ(lowest_and_highest("@-5,3;@0,0;"), std::pair(0.0, 0.0));
  EXPECT_EQ(lowest_and_highest("@-5,3;@1,-1;"), std::pair(-5.0, 3.0));
  EXPECT_EQ(lowest_and_highest("@-5,3;@-4;"), std::pair(-4.0, 3.0));
  EXPECT_EQ(lowest_and_highest("@-5,3;DF;@-4;"), std::pair(-4.0, 0.0));
  EXPECT_EQ(lowest_and_highest("@-5,3;@;"), std::pair(0.0, 0.0));
}

// A segment with an end below Z 0 is cut length, the whole of it.
TEST(Programmed, CountsWhatEndsBelowZeroAsCut) {
  const Figures figures = FiguresOf("Z0,0,10,3,4,10,3,4,-2,3,4,10,0,0,10;");
  EXPECT_DOUBLE_EQ(figures.at("programmed.cut_length"), 12 + 12);
  EXPECT_DOUBLE_EQ(figures.at("programmed.travel_length"), 10 + 5 + 5);
}

// The ways of H, IN and !ZM do not count, and H leaves Z where it is.
TEST(Programmed, LeavesOutTheWaysHome) {
  const Figures figures = FiguresOf("Z30,40,0;H;!ZM-100;IN;Z3,4,0;");
  EXPECT_DOUBLE_EQ(figures.at("programmed.travel_length"), 50 + 5);
}

// A machine that is too small, or counts other units, changes nothing of what a program asks for.
TEST(Programmed, KnowsNoMachine) {
  const std::string stream = "@-7000,9000;PU-5,90000;PD8000000,1;PR;Z1,1,1;!RC9;!ZE X1A90;F1000;";
  Figures small = FiguresOf(stream, "mdx-15");
  Figures large = FiguresOf(stream, "mdx-540");
  std::erase_if(small, [](const auto& f) { return !f.first.starts_with("programmed."); });
  std::erase_if(large, [](const auto& f) { return !f.first.starts_with("programmed."); });
  EXPECT_EQ(small, large);
  EXPECT_EQ(small.at("programmed.zmin"), -7000);
  EXPECT_EQ(small.at("programmed.zmax"), 9000);
  EXPECT_EQ(small.at("programmed.ymax"), 90000);
}

// A statement that is no command counts as such, and nothing in it as a command: M runs in the
// first one (RML1-2.11), R in the second, yet neither was meant.
TEST(Programmed, CountsSpoiltStatementsAsOther) {
  const Figures figures = FiguresOf("Z9,9,9;MC0;\n..R;Z9,9,9;");
  EXPECT_EQ(figures.at("programmed.other"), 2);
  EXPECT_EQ(figures.at("programmed.commands"), 2);
  EXPECT_FALSE(figures.contains("programmed.count.M"));
  EXPECT_FALSE(figures.contains("programmed.count.R"));
}

// Surplus behind good parameters leaves the command.
TEST(Programmed, KeepsCommandsWithSurplus) {
  const Figures figures = FiguresOf("VS5,6;@-1,2,3;^PA;");
  EXPECT_EQ(figures.at("programmed.other"), 0);
  EXPECT_EQ(figures.at("programmed.commands"), 3);
  EXPECT_EQ(figures.at("programmed.count.^"), 1);
}

// A command that nothing ends is not executed (RML1-7.04), and not counted.
TEST(Programmed, CountsWhatRan) {
  EXPECT_EQ(FiguresOf("PU1,1;PU2,2").at("programmed.commands"), 1);
  EXPECT_EQ(FiguresOf("PU1,1;PU2,2,").at("programmed.commands"), 2);
}

// Heights are multiples of what they have in common where they are whole numbers; one that is not,
// or that no machine is as high as, leaves 1.
TEST(Programmed, HeightsHaveAGrain) {
  const auto grain = [](std::initializer_list<double> heights) {
    Programmed programmed;
    for (const double z : heights) programmed.OnSetXYZ(0.0, 0.0, z);
    return programmed.z_grain();
  };
  EXPECT_EQ(grain({}), 0U);
  EXPECT_EQ(grain({10.0}), 10U);
  EXPECT_EQ(grain({10.0, -4.0}), 2U);
  EXPECT_EQ(grain({10.0, 2.5}), 1U);
  EXPECT_EQ(grain({10.0, 1e9}), 1U);
}

// A spoilt statement takes back nothing of the statements before it: heights, what DF set, and the
// places of groups.
TEST(Programmed, SpoiltStatementsLeaveWhatStoodBefore) {
  const auto value = [](const Figures& figures, const char* name) {
    return figures.contains(name) ? figures.at(name) : 0.0;
  };
  const Figures heights = FiguresOf("@-5,3;\nQQ;\nPD1,0;PU2,0;");
  EXPECT_EQ(value(heights, "programmed.zmin"), -5.0);
  EXPECT_EQ(value(heights, "programmed.zmax"), 3.0);
  const Figures defaults = FiguresOf("@-5,3;\nDF;\nQQ;\nPD1,0;PU2,0;");
  EXPECT_EQ(value(defaults, "programmed.zmin"), 0.0);
  EXPECT_EQ(value(defaults, "programmed.zmax"), 0.0);
  const Figures groups = FiguresOf("!ZE X9000;\nQQ;\n!ZE Y700;\nQQ;\n");
  EXPECT_EQ(value(groups, "programmed.xmax"), 9000.0);
  EXPECT_EQ(value(groups, "programmed.ymax"), 700.0);
  EXPECT_EQ(groups.at("programmed.other"), 2.0);
}

// programmed.h: a group of axes is no cut in X and Y with the tool down: above Z 0 it is travel.
TEST(Programmed, GroupsAboveZeroAreTravel) {
  const Figures figures = FiguresOf("!ZE X300Y400;");
  EXPECT_DOUBLE_EQ(figures.at("programmed.travel_length"), 500.0);
  EXPECT_EQ(figures.at("programmed.cut_length"), 0.0);
}

// RML1-3B.08: PA and PR without numbers move nothing: they go to no height.
TEST(Programmed, ModesAskForNoHeight) {
  for (const std::string mode : {"PA;", "PR;"})
    EXPECT_FALSE(FiguresOf("@-5,3;" + mode).contains("programmed.zmax")) << mode;
  EXPECT_EQ(FiguresOf("@-5,3;PU;").at("programmed.zmax"), 3.0);
}

}  // namespace
}  // namespace rmlcell::rml1
