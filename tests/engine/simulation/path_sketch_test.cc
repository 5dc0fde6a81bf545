#include "engine/simulation/picture/path_sketch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/path/part_shape.h"
#include "engine/simulation/path/polyline.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachineVector;
using motion::PathPiece;

void AddLine(PathSketch& sketch, const motion::MachinePoint& from, const motion::MachinePoint& to,
             MotionUse use = MotionUse::kCut) {
  motion::PlannedMotion planned;
  planned.path = LineFrom(from, to);
  sketch.Add({.use = use, .motion = &planned, .travelled = planned.path.length()});
}

// Up to the limit the sketch is exact; one more and it is coarser, but bounded. Both sides.
TEST(PathSketch, IsExactUpToItsLimit) {
  constexpr std::size_t kLimit = 100;
  PathSketch sketch({}, kLimit);
  const auto corner = [](std::size_t k) {
    return MachineVector{static_cast<double>(k), k % 2 == 0 ? 0.0 : 1.0, 0};
  };
  for (std::size_t k = 0; k < kLimit; ++k) AddLine(sketch, corner(k), corner(k + 1));
  EXPECT_EQ(sketch.elements().size(), kLimit);
  EXPECT_EQ(sketch.tolerance_mm(), 0.0);
  AddLine(sketch, corner(kLimit), corner(kLimit + 1));
  EXPECT_LE(sketch.elements().size(), kLimit / 2 + 1);
  EXPECT_GT(sketch.tolerance_mm(), 0.0);
}

// A million moves of a relief keep its box to the last digit and its look to a share of it.
TEST(PathSketch, LongPathsStayInBounds) {
  constexpr std::size_t kLimit = 20'000;
  PathSketch sketch({}, kLimit);
  motion::MachinePoint at{0, 0, 0};
  for (int row = 0; row < 1000; ++row) {
    for (int k = 1; k <= 1000; ++k) {
      const double x = row % 2 == 0 ? 0.1 * k : 100.0 - 0.1 * k;
      const motion::MachinePoint next{x, 0.1 * row, -std::abs(std::sin(0.05 * x))};
      AddLine(sketch, at, next);
      at = next;
    }
  }
  EXPECT_LE(sketch.elements().size(), kLimit);
  EXPECT_NEAR(sketch.cut_box().max.x(), 100.0, 1e-9);
  EXPECT_NEAR(sketch.cut_box().max.y(), 99.9, 1e-9);
  machine::Box kept;
  for (const SketchElement& element : sketch.elements()) {
    kept.Add(element.from);
    kept.Add(element.to);
  }
  EXPECT_NEAR(kept.max.x(), 100.0, 3 * sketch.tolerance_mm());
  EXPECT_NEAR(kept.max.y(), 99.9, 3 * sketch.tolerance_mm());
  EXPECT_LT(sketch.tolerance_mm(), 2.0);
}

// Coarsening begins with 5e-5 of the size, doubles it until at most half of the room is taken, and
// stays there.
TEST(PathSketch, ToleranceDoublesUntilHalfIsFree) {
  constexpr double kFirst = 5e-5;
  // Straight on with gaps of 5 first tolerances: 8 of them close the gaps.
  PathSketch gaps({}, 100);
  const double gap = 100.0 * 5.0 * kFirst;
  for (int k = 0; k <= 100; ++k) {
    AddLine(gaps, {0.99 * k, 0, 0}, {k == 100 ? 100.0 : 0.99 * (k + 1) - gap, 0, 0});
  }
  EXPECT_NEAR(gaps.tolerance_mm(), 8.0 * kFirst * 100.0, 1e-12);
  EXPECT_EQ(gaps.elements().size(), 1u);
  // Two straight stretches of a room of four are half of it.
  PathSketch half({}, 4);
  for (int k = 0; k < 3; ++k) AddLine(half, {1.0 * k, 0, 0}, {k + 1.0, 0, 0});
  for (int k = 0; k < 2; ++k) AddLine(half, {3, 2.0 * k, 0}, {3, 2.0 * k + 2, 0});
  EXPECT_EQ(half.elements().size(), 2u);
  EXPECT_NEAR(half.tolerance_mm(), kFirst * 5.0, 1e-15);  // of a diagonal of 5 mm
  // Once it is coarse it does not get finer.
  AddLine(half, {3, 4, 0}, {0, 4, 0});
  AddLine(half, {0, 4, 0}, {0, 1, 0});
  EXPECT_EQ(half.elements().size(), 4u);
  EXPECT_NEAR(half.tolerance_mm(), kFirst * 5.0, 1e-15);
}

// Arcs that are left keep their circles, whatever was dropped before them.
TEST(PathSketch, ArcsKeepTheirCircles) {
  PathSketch sketch({}, 6);
  const auto add_circle = [&](const motion::MachinePoint& centre, double radius) {
    motion::PlannedMotion planned;
    planned.path = PathPiece::Circle({centre + MachineVector{radius, 0, 0}}, centre, {0, 0, 1},
                                     kTurn, 0.0, 0.0);
    sketch.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = planned.path.length()});
  };
  for (int k = 0; k < 5; ++k) add_circle({0, 0, 0}, 5.0);
  add_circle({50, 0, 0}, 7.0);
  AddLine(sketch, {57, 0, 0}, {99, 0, 0});  // one too many: the copies are dropped
  std::vector<double> radii;
  for (const SketchElement& element : sketch.elements()) {
    if (element.arc >= 0) radii.push_back(sketch.circle(element.arc).radius_mm);
  }
  EXPECT_EQ(radii, (std::vector{5.0, 7.0}));
  EXPECT_EQ(sketch.circles().size(), 2u);
}

// Plunges have 20 000 dots; more run together in any picture.
TEST(PathSketch, DotsAreBounded) {
  PathSketch sketch({}, 10);
  for (int k = 0; k <= 20'000; ++k) sketch.AddPierce();
  EXPECT_EQ(sketch.dots().size(), 20'000u);
}

// Of directions every one is kept up to 4096, then every second, then every fourth.
TEST(PathSketch, EverySecondDirectionGoes) {
  machine::MachineShape shape;
  shape.five_axis = true;
  shape.laser_watts = 1500.0;
  PathSketch sketch(shape, 100);
  int cuts = 0;
  const auto cut_until = [&](int count) {
    for (; cuts < count; ++cuts) {
      motion::PlannedMotion planned;
      planned.path = LineFrom({1.0 * cuts, 9, 0}, {1.0 * cuts, 0, 0});
      sketch.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = 9.0, .beam_on = true});
    }
  };
  cut_until(4095);
  ASSERT_EQ(sketch.tools().size(), 4095u);
  EXPECT_EQ(sketch.tools()[4094].tip, (MachineVector{4094, 0, 0}));  // where the cut ends
  cut_until(4096);
  ASSERT_EQ(sketch.tools().size(), 2048u);
  for (std::size_t i = 0; i < 2048; ++i)
    ASSERT_EQ(sketch.tools()[i].tip.x(), 2.0 * static_cast<double>(i));
  cut_until(8191);
  ASSERT_EQ(sketch.tools().size(), 2048u + 2048u - 2048u);
  for (std::size_t i = 0; i < 2048; ++i)
    ASSERT_EQ(sketch.tools()[i].tip.x(), 4.0 * static_cast<double>(i));
}

// Repeated passes lie on top of each other: coarsening drops the copies first.
TEST(PathSketch, CopiesAreDropped) {
  PathSketch sketch({}, 100);
  for (int pass = 0; pass < 100; ++pass) {
    for (int k = 0; k < 40; ++k) {
      const double a = kTurn * k / 40;
      const double b = kTurn * (k + 1) / 40;
      AddLine(sketch, {50 * std::cos(a), 50 * std::sin(a), 0},
              {50 * std::cos(b), 50 * std::sin(b), 0});
    }
  }
  EXPECT_LE(sketch.elements().size(), 100u);
  EXPECT_LT(sketch.tolerance_mm(), 0.1);
}

TEST(PathSketch, KeepsArcsPlungesAndPierces) {
  PathSketch sketch({}, 1000);
  motion::PlannedMotion planned;
  planned.path = PathPiece::Circle({{12, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0);
  sketch.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = planned.path.length()});
  AddLine(sketch, {12, 0, 0}, {12, 0, -3}, MotionUse::kPlunge);
  sketch.AddPierce();
  ASSERT_EQ(sketch.elements().size(), 2u);
  ASSERT_EQ(sketch.elements()[0].arc, 0);
  EXPECT_EQ(sketch.circle(0).radius_mm, 12.0);
  EXPECT_NEAR(sketch.elements()[0].middle.x(), -12.0, 1e-12);
  EXPECT_NEAR(sketch.box().min.x(), -12.0, 1e-12);
  ASSERT_EQ(sketch.dots().size(), 2u);
  EXPECT_FALSE(sketch.dots()[0].pierce);
  EXPECT_TRUE(sketch.dots()[1].pierce);
  EXPECT_EQ(sketch.dots()[1].at, (MachineVector{12, 0, -3}));
}

TEST(PathSketch, NonsensePositionsAreLeftOut) {
  PathSketch sketch({}, 100);
  AddLine(sketch, {0, 0, 0}, {std::nan(""), 0, 0});
  AddLine(sketch, {0, 0, 0}, {HUGE_VAL, 0, 0});
  EXPECT_TRUE(sketch.elements().empty());
  EXPECT_TRUE(sketch.box().empty() || sketch.box().max == MachineVector{});
}

// What is neither line nor arc is drawn as chords within a hundredth of a millimetre, which no
// picture shows: with longer ones the curve of a corner would have visible edges.
TEST(PathSketch, CurvesAreChordsWithinAHundredth) {
  PathSketch sketch({}, 10'000);
  std::size_t chords = 0;
  for (const double up : {10.0, 40.0, 70.0, 100.0, 160.0}) {
    for (const motion::PlannedMotion& planned :
         PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{150, up, 0}})) {
      const double length = planned.path.length();
      sketch.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = length});
      PartShape shape({planned.path, planned.head, 0.0, length});
      motion::MachinePoint at = shape.tip_from();
      ForEachVertex(shape, 0.01, [&](double /*s*/, const motion::MachinePoint& tip) {
        if (at != tip) ++chords;
        at = tip;
      });
    }
  }
  EXPECT_EQ(sketch.elements().size(), chords);
}

// The head's direction is kept for some of the cuts, however many there are.
TEST(PathSketch, ToolDirectionsAreBounded) {
  machine::MachineShape shape;
  shape.five_axis = true;
  shape.laser_watts = 1500.0;
  PathSketch sketch(shape, 1000);
  motion::PlannedMotion planned;
  planned.path = PathPiece::Line({{0, 0, 0}, 0.0, kPi / 2}, {{1, 0, 0}, 0.0, kPi / 2});
  for (int k = 0; k < 50'000; ++k) {
    sketch.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = 1.0, .beam_on = true});
  }
  EXPECT_LE(sketch.tools().size(), 4096u);
  EXPECT_GE(sketch.tools().size(), 2000u);
  EXPECT_NEAR(sketch.tools()[0].towards_head.y(), -1.0, 1e-12);  // u at A = 0, B = pi/2
}

// Only a head has a direction, and only where it cuts.
TEST(PathSketch, DirectionsAreOfCutsWithAHead) {
  for (const bool five_axis : {true, false}) {
    for (const bool beam_on : {true, false}) {
      machine::MachineShape shape;
      shape.five_axis = five_axis;
      shape.laser_watts = 1500.0;
      PathSketch sketch(shape, 1000);
      motion::PlannedMotion planned;
      planned.path = LineFrom({0, 0, 0}, {1, 0, 0});
      sketch.Add(
          {.use = MotionUse::kCut, .motion = &planned, .travelled = 1.0, .beam_on = beam_on});
      EXPECT_EQ(sketch.tools().size(), five_axis && beam_on ? 1u : 0u);
      EXPECT_EQ(sketch.elements()[0].cuts, beam_on);
    }
  }
}

// A mill cuts with its tool in the material, not on its way out of it.
TEST(PathSketch, WhatAMillCuts) {
  PathSketch sketch({}, 1000);
  AddLine(sketch, {0, 0, 0}, {1, 0, 0}, MotionUse::kTravel);
  AddLine(sketch, {1, 0, 0}, {1, 0, -1}, MotionUse::kPlunge);
  AddLine(sketch, {1, 0, -1}, {1, 0, -2}, MotionUse::kPlunge);  // the same plunge: one dot
  AddLine(sketch, {1, 0, -2}, {3, 0, -2}, MotionUse::kCut);
  AddLine(sketch, {3, 0, -2}, {3, 0, 5}, MotionUse::kRetract);
  AddLine(sketch, {3, 0, 5}, {3, 0, -1}, MotionUse::kPlunge);
  std::vector<bool> cuts;
  for (const SketchElement& element : sketch.elements()) cuts.push_back(element.cuts);
  EXPECT_EQ(cuts, (std::vector<bool>{false, true, true, true, false, true}));
  EXPECT_EQ(sketch.dots().size(), 2u);
  EXPECT_EQ(sketch.start(), (MachineVector{0, 0, 0}));
  EXPECT_EQ(sketch.end(), (MachineVector{3, 0, -1}));
  EXPECT_EQ(sketch.cut_box().min, (MachineVector{1, 0, -2}));
  EXPECT_EQ(sketch.cut_box().max, (MachineVector{3, 0, 5}));
  EXPECT_EQ(sketch.box().min, (MachineVector{0, 0, -2}));
}

// Neighbours that go straight on are one; no vertex is farther off than twice the tolerance.
TEST(MergeStraight, MergesWithinTheTolerance) {
  std::vector<SketchElement> elements;
  for (int k = 0; k < 100; ++k) {
    elements.push_back(
        {.from = {1.0 * k, 0.001 * (k % 2), 0}, .to = {1.0 * (k + 1), 0.001 * ((k + 1) % 2), 0}});
  }
  elements.push_back({.from = {100, 0, 0}, .to = {100, 10, 0}});
  elements.push_back({.from = {100, 10, 0}, .to = {100, 5, 0}});  // back: not straight on
  MergeStraight(elements, 0.2);
  ASSERT_EQ(elements.size(), 3u);
  EXPECT_EQ(elements[0].to, (MachineVector{100, 0, 0}));
}

// Both sides of the tolerance, a quarter of a millimetre: in the gap, beside the way, and in the
// length that gives a direction. An arc is never part of a line.
TEST(MergeStraight, LimitsOfTheTolerance) {
  const auto merged = [](const motion::MachinePoint& end, const motion::MachinePoint& from,
                         const motion::MachinePoint& to) {
    std::vector<SketchElement> elements = {{.from = {0, 0, 0}, .to = end},
                                           {.from = from, .to = to}};
    MergeStraight(elements, 0.25);
    return elements.size() == 1;
  };
  EXPECT_TRUE(merged({10, 0, 0}, {10.25, 0, 0}, {12, 0, 0}));
  EXPECT_FALSE(merged({10, 0, 0}, {10.375, 0, 0}, {12, 0, 0}));
  EXPECT_TRUE(merged({10, 0, 0}, {10, 0, 0}, {12, 0.25, 0}));
  EXPECT_FALSE(merged({10, 0, 0}, {10, 0, 0}, {12, 0.375, 0}));
  EXPECT_TRUE(merged({10, 0, 0}, {10, 0, 0}, {10, 0.125, 0}));  // no further, and no less far
  EXPECT_FALSE(merged({10, 0, 0}, {10, 0, 0}, {9.875, 0, 0}));
  EXPECT_TRUE(merged({0.125, 0, 0}, {0.125, 0, 0}, {0.25, 0, 0}));  // too short for a direction
  EXPECT_FALSE(merged({0.25, 0, 0}, {0.25, 0, 0}, {0.5, 0, 0}));
  EXPECT_TRUE(merged({0.5, 0, 0}, {0.5, 0, 0}, {0.75, 0, 0}));
  for (const std::size_t arc : {0u, 1u}) {
    std::vector<SketchElement> elements = {{.from = {0, 0, 0}, .to = {10, 0, 0}},
                                           {.from = {10, 0, 0}, .to = {20, 0, 0}}};
    elements[arc].middle = elements[arc].from + MachineVector{5, 5, 0};
    elements[arc].arc = 0;
    MergeStraight(elements, 0.25);
    EXPECT_EQ(elements.size(), 2u) << arc;
  }
}

TEST(DropAlike, DropsCopiesFromEitherEnd) {
  std::vector<SketchElement> elements = {
      {.from = {0, 0, 0}, .to = {10, 0, 0}},
      {.from = {10.001, 0, 0}, .to = {0, 0.001, 0}},        // the way back
      {.from = {0, 0, 0}, .to = {10, 0, 0}, .cuts = true},  // looks different
      {.from = {0, 0, 0}, .to = {10, 0, 0}, .middle = {5, 3, 0}, .arc = 0},
      {.from = {0, 0, 0}, .to = {10, 0, 0}, .middle = {5, -3, 0}, .arc = 1}};
  DropAlike(elements, 0.1);
  EXPECT_EQ(elements.size(), 4u);
}

// An arc whose middle is as near to where it begins as the tolerance is drawn as a line, wherever
// it lies; one that reaches further stays an arc.
TEST(MergeStraight, TakesArcsWithinTheToleranceForLines) {
  const auto arc_left = [](const motion::MachinePoint& from, const motion::MachinePoint& middle) {
    std::vector<SketchElement> elements(1);
    elements[0] = {.from = from, .to = from, .middle = middle, .arc = 0};
    MergeStraight(elements, 0.5);
    return elements.at(0).arc == 0;
  };
  EXPECT_FALSE(arc_left({1000, 0, 0}, {1000, 0.5, 0}));
  EXPECT_TRUE(arc_left({1000, 0, 0}, {1000, 0.75, 0}));
  EXPECT_TRUE(arc_left({-5, 0, 0}, {5, 0, 0}));
}

}  // namespace
}  // namespace rmlcell::simulation
