#include "engine/rml1/work_fit.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "engine/rml1/rml1_family.h"

namespace rmlcell::rml1 {
namespace {

// 200 x 150 x 60 mm in steps of 0.01 mm.
constexpr CuttingRange kTravel{{0.0, 20000.0}, {0.0, 15000.0}, {-6000.0, 0.0}};
constexpr double kUnits = 100.0;

Extent From(double low, double high) { return {.low = low, .high = high, .known = true}; }

// RML1-5A.01: X from 10 to 50 mm fits while the origin is from 0 (it cannot be further down on the
// panel) to 150; Y from -20 to 30 while it is from 20 to 120; 15 mm deep while Z0 is -45 or higher.
TEST(WorkFit, TheOriginMayBeWhereNothingLeavesTheTravel) {
  const WorkExtent work{From(1000, 5000), From(-2000, 3000), From(-1500, 200)};
  const WorkFit fit = FitOf(work, {}, {0, 0, -2000, 0}, kTravel, kUnits);
  EXPECT_EQ(fit.x.low, 0.0);
  EXPECT_EQ(fit.x.high, 150.0);
  EXPECT_EQ(fit.y.low, 20.0);
  EXPECT_EQ(fit.y.high, 120.0);
  EXPECT_EQ(fit.z.low, -45.0);
  EXPECT_EQ(fit.z.high, 0.0);
  EXPECT_EQ(fit.x.over, 0.0);
}

// What was lost beyond the end, at 201 to 204 mm of the machine with the origin at 10, counts: 194
// mm from the origin, which may be at 6 at most.
TEST(WorkFit, WhatWasLostIsPartOfTheWork) {
  LostCut lost;
  lost.x = From(20100, 20400);
  const WorkExtent work{From(1000, 19000), From(0, 100), From(-100, 0)};
  const WorkFit fit = FitOf(work, lost, {1000, 0, -2000, 0}, kTravel, kUnits);
  EXPECT_EQ(fit.x.high, 6.0);
}

TEST(WorkFit, LargerThanTheTravelFitsNowhere) {
  const WorkExtent work{From(-100, 20400), From(0, 15000), From(-6001, 0)};
  const WorkFit fit = FitOf(work, {}, {0, 0, 0, 0}, kTravel, kUnits);
  EXPECT_EQ(fit.x.over, 5.0);
  EXPECT_EQ(fit.y.over, 0.0);
  EXPECT_EQ(fit.z.over, 0.01);
}

TEST(WorkFit, NothingInTheWorkSaysNothing) {
  EXPECT_FALSE(FitOf({}, {}, {}, kTravel, kUnits).x.known);
}

// The profile T1 has 200 x 150 x 60 mm (rml1.md 0.2). A frame of 40 x 30 mm, 2 mm deep: wherever
// the origin is, and however much is lost there, the answer is the same.
TEST(WorkFit, TheAnswerDoesNotHangOnTheOrigin) {
  const machine::MachineFamily& mill = Rml1Family();
  const std::string stream = "!MC1;V10;!PZ-200,200;PU0,0;PD4000,0,4000,3000,0,3000,0,0;PU;!MC0;";
  for (const auto& [x, y, z] : {std::array{"0", "0", "-20"},
                                {"190", "140", "-20"},
                                {"10", "10", "-57"},
                                {"-30", "300", "-1"}}) {
    const auto parameters =
        machine::MakeParameters(mill, "t1", {{"ORIGIN_X", x}, {"ORIGIN_Y", y}, {"Z0", z}});
    ASSERT_TRUE(bool(parameters));
    const auto made = mill.Translate({.name = "frame.rml", .bytes = stream}, *parameters, {});
    std::map<std::string, double> figures;
    for (const machine::Figure& figure : made.figures) figures[figure.name] = figure.value;
    EXPECT_EQ(figures.at("origin.xmin"), 0.0) << x;
    EXPECT_NEAR(figures.at("origin.xmax"), 160.0, 1e-9) << x;
    EXPECT_EQ(figures.at("origin.ymin"), 0.0) << x;
    EXPECT_NEAR(figures.at("origin.ymax"), 120.0, 1e-9) << x;
    EXPECT_NEAR(figures.at("origin.zmin"), -58.0, 1e-9) << x;
    EXPECT_EQ(figures.at("oversize_x"), 0.0) << x;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
