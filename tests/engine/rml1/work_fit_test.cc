#include "engine/rml1/work_fit.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "engine/rml1/rml1_family.h"
#include "engine/rml1/step_guess.h"

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
  const WorkFit fit = FitOf(work, {}, {0, 0, -2000, 0}, kTravel, 0.0, kUnits);
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
  const WorkFit fit = FitOf(work, lost, {1000, 0, -2000, 0}, kTravel, 0.0, kUnits);
  EXPECT_EQ(fit.x.high, 6.0);
}

TEST(WorkFit, LargerThanTheTravelFitsNowhere) {
  const WorkExtent work{From(-100, 20400), From(0, 15000), From(-6001, 0)};
  const WorkFit fit = FitOf(work, {}, {0, 0, 0, 0}, kTravel, 0.0, kUnits);
  EXPECT_EQ(fit.x.over, 5.0);
  EXPECT_EQ(fit.y.over, 0.0);
  EXPECT_EQ(fit.z.over, 0.01);
}

// X from 1 to 204 mm in a travel of 203.2: the origin would have to be from -1 to -0.8, where no
// panel sets it, so the program must move by 0.8 mm to less X. Y from -150.01 to -2 mm in a travel
// of 150: from 150.01 to 152, so it must move by 0.01 mm to greater Y.
TEST(WorkFit, AnOriginOutsideTheTravelIsNone) {
  const CuttingRange travel{{0.0, 20320.0}, {0.0, 15000.0}, {-6000.0, 0.0}};
  const auto fit = [&](const Extent& x, const Extent& y) {
    return FitOf({x, y, From(-100, 0)}, {}, {}, travel, 0.0, kUnits);
  };
  const WorkFit none = fit(From(100, 20400), From(-15001, -200));
  EXPECT_NEAR(none.x.move, -0.8, 1e-9);
  EXPECT_FALSE(none.x.fits());
  EXPECT_EQ(none.x.over, 0.0);
  EXPECT_NEAR(none.y.move, 0.01, 1e-9);
  const WorkFit just = fit(From(0, 20320), From(-15000, -200));
  EXPECT_TRUE(just.x.fits());
  EXPECT_EQ(just.x.low, 0.0);
  EXPECT_EQ(just.x.high, 0.0);
  EXPECT_EQ(just.y.move, 0.0);
  EXPECT_EQ(just.y.low, 150.0);
  EXPECT_EQ(just.y.high, 150.0);
}

// 15 mm deep in 60 mm of travel: with lifts of 2 mm Z0 may be from -45 to -2 mm. 59 mm deep there
// is room for 1 mm of lift, and at full depth for none.
TEST(WorkFit, TheLowestLiftStaysAboveTheSurface) {
  const auto z = [](double depth, double lift) {
    return FitOf({From(0, 1), From(0, 1), From(-depth, 0)}, {}, {}, kTravel, lift, kUnits).z;
  };
  EXPECT_EQ(z(1500, 200).low, -45.0);
  EXPECT_EQ(z(1500, 200).high, -2.0);
  EXPECT_EQ(z(5900, 200).low, -1.0);
  EXPECT_EQ(z(5900, 200).high, -1.0);
  EXPECT_EQ(z(6000, 200).high, 0.0);
  EXPECT_EQ(z(6001, 200).over, 0.01);
}

// The lowest way across counts: 0.5 mm of the Z commands, not 2 mm of Z2, nor what goes straight
// up.
TEST(WorkFit, TheLowestLiftIsThatOfTheProgram) {
  const machine::MachineFamily& mill = Rml1Family();
  const auto parameters = *machine::MakeParameters(mill, "t1", {});
  const auto zmax = [&](const std::string& stream) {
    const auto made = mill.Translate({.name = "a.rml", .bytes = stream}, parameters, {});
    for (const machine::Figure& figure : made.figures) {
      if (figure.name == "origin.zmax") return figure.value;
    }
    return 1.0;
  };
  const std::string cut = "!MC1;V10;!PZ-200,200;PU0,0;PD4000,0;PU4000,3000;";
  EXPECT_NEAR(zmax(cut + "!MC0;"), -2.0, 1e-9);
  EXPECT_NEAR(zmax(cut + "Z4000,3000,30;Z4000,3000,50;Z0,0,50;!MC0;"), -0.5, 1e-9);
}

TEST(WorkFit, NothingInTheWorkSaysNothing) {
  EXPECT_FALSE(FitOf({}, {}, {}, kTravel, 0.0, kUnits).x.known);
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

// RML1-1.08: what is larger than the travel by the 0.01 mm of rounding is no reason to guess
// another step; more than that is, along any axis.
TEST(StepGuess, RoundingBeyondTheTravelIsNoReason) {
  const CuttingRange travel{{0.0, 8000.0}, {0.0, 6000.0}, {-2400.0, 0.0}};
  for (WorkFit::Axis WorkFit::*axis : {&WorkFit::x, &WorkFit::y, &WorkFit::z}) {
    WorkFit fit;
    (fit.*axis).over = 0.01;
    EXPECT_EQ(GuessStep(fit, travel, {}, 40.0).fits_at, 0.0);
    (fit.*axis).over = 0.0125;
    EXPECT_EQ(GuessStep(fit, travel, {}, 40.0).fits_at, 100.0);
  }
}

// With 100 units in a millimetre the work would be two fifths as long, and must fit the travel of
// 200 by 150 by 60 mm then, its ends included.
TEST(StepGuess, TheWorkFitsWithTheOtherStep) {
  const CuttingRange travel{{0.0, 8000.0}, {0.0, 6000.0}, {-2400.0, 0.0}};
  WorkFit fit;
  fit.x = {.known = true, .over = 300.0, .length = 500.0};
  fit.y.length = 375.0;
  fit.z.length = 150.0;
  const StepGuess guess = GuessStep(fit, travel, {}, 40.0);
  EXPECT_EQ(guess.fits_at, 100.0);
  EXPECT_EQ(guess.work.x.length, 200.0);
  EXPECT_EQ(guess.work.y.length, 150.0);
  EXPECT_EQ(guess.work.z.length, 60.0);
  for (WorkFit::Axis WorkFit::*axis : {&WorkFit::x, &WorkFit::y, &WorkFit::z}) {
    WorkFit larger = fit;
    (larger.*axis).length += 0.1;
    EXPECT_EQ(GuessStep(larger, travel, {}, 40.0).fits_at, 0.0);
  }
  EXPECT_EQ(GuessStep(fit, travel, {}, 100.0).fits_at, 0.0);
}

// A lift of 0.2 to 0.4 mm, or of less than 1 mm with heights that are whole twentieths of a
// millimetre for 40 units (2 of them) and not for 100 (5).
TEST(StepGuess, LiftsThatAreLow) {
  const CuttingRange travel{{0.0, 20000.0}, {0.0, 15000.0}, {-6000.0, 0.0}};
  WorkFit fit;
  fit.x.known = true;
  const auto lift = [&](double high, std::uint32_t grain) {
    const ProgrammedHeights heights{{.low = -100.0, .high = high, .known = true}, grain};
    const StepGuess guess = GuessStep(fit, travel, heights, 100.0);
    EXPECT_DOUBLE_EQ(guess.lift_there_mm, guess.lift_mm * 2.5);
    return guess.lift_mm;
  };
  EXPECT_EQ(lift(19.0, 1), 0.0);
  EXPECT_EQ(lift(20.0, 1), 0.2);
  EXPECT_EQ(lift(40.0, 5), 0.4);
  EXPECT_EQ(lift(41.0, 1), 0.0);
  EXPECT_EQ(lift(50.0, 10), 0.0);  // both
  EXPECT_EQ(lift(88.0, 2), 0.88);
  EXPECT_EQ(lift(99.0, 2), 0.99);
  EXPECT_EQ(lift(100.0, 2), 0.0);
  EXPECT_EQ(lift(88.0, 3), 0.0);
  const ProgrammedHeights low{{.low = -100.0, .high = 20.0, .known = true}, 1};
  EXPECT_EQ(GuessStep(fit, travel, low, 40.0).lift_mm, 0.0);
  EXPECT_EQ(GuessStep({}, travel, low, 100.0).lift_mm, 0.0);  // nothing was cut
}

// Work that goes no deeper than the surface has no depth.
TEST(WorkFit, WithoutDepthItIsNone) {
  const WorkExtent flat{From(0, 100), From(0, 100), From(0, 0)};
  EXPECT_EQ(FitOf(flat, {}, {}, kTravel, 0.0, kUnits).z.length, 0.0);
}

// How large the work is: X and Y from end to end, Z as deep as it goes, whatever it lifts.
TEST(WorkFit, HasTheLengthOfTheWork) {
  const WorkExtent work{From(1000, 5000), From(-2000, 3000), From(-1500, 200)};
  const WorkFit fit = FitOf(work, {}, {}, kTravel, 200.0, kUnits);
  EXPECT_EQ(fit.x.length, 40.0);
  EXPECT_EQ(fit.y.length, 50.0);
  EXPECT_EQ(fit.z.length, 15.0);
}

}  // namespace
}  // namespace rmlcell::rml1
