// What two paths share where arcs begin elsewhere, ways lie on each other, or dots just touch, and
// what the pieces look like that are left.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/picture/path_difference.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachinePoint;

class SharedWay {
 public:
  SharedWay& Straight(const MachinePoint& from, const MachinePoint& to,
                      MotionUse use = MotionUse::kCut) {
    return Take(LineFrom(from, to), use);
  }
  SharedWay& Round(const MachinePoint& centre, double radius, double begin, double sweep) {
    const MachinePoint spoke{radius * std::cos(begin), radius * std::sin(begin), 0};
    return Take(motion::PathPiece::Circle({centre + spoke}, centre, {0, 0, sweep < 0 ? -1.0 : 1.0},
                                          std::abs(sweep), 0.0, 0.0),
                MotionUse::kCut);
  }
  const PathSketch& sketch() const { return sketch_; }

 private:
  SharedWay& Take(const motion::PathPiece& piece, MotionUse use) {
    motion::PlannedMotion planned;
    planned.path = piece;
    sketch_.Add({.use = use, .motion = &planned, .travelled = piece.length()});
    return *this;
  }
  PathSketch sketch_{{}, 10'000};
};

// The same circle from wherever it begins, and whichever way round.
TEST(SharedWays, ACircleIsTheSameFromWhereverItBegins) {
  for (const double first : {0.0, 1.0, 3.0, -2.0}) {
    for (const double later : {0.25, 0.5, 0.9, 1.5, 3.0, 6.0, -0.5}) {
      for (const double turn : {kTurn, -kTurn}) {
        SharedWay before, after;
        before.Round({5, 6, 7}, 10.0, first, kTurn);
        after.Round({5, 6, 7}, 10.0, first + later, turn);
        const PathDifference difference = Compare(before.sketch(), after.sketch());
        EXPECT_NEAR(difference.common.cut_mm, 10.0 * kTurn, 1e-6) << first << ' ' << later;
        EXPECT_NEAR(difference.removed.cut_mm, 0.0, 1e-6) << first << ' ' << later;
        EXPECT_NEAR(difference.added.cut_mm, 0.0, 1e-6) << first << ' ' << later;
      }
    }
  }
}

// A piece of an arc has its ends and its middle on its own circle, and sweeps as far as it is long.
void ExpectPiece(const PathShare& share, std::size_t index, double radius, double begin,
                 double sweep) {
  ASSERT_LT(index, share.elements.size());
  const SketchElement& piece = share.elements[index];
  ASSERT_GE(piece.arc, 0);
  ASSERT_LT(static_cast<std::size_t>(piece.arc), share.circles.size());
  const SketchCircle& circle = share.circles[static_cast<std::size_t>(piece.arc)];
  EXPECT_NEAR(circle.radius_mm, radius, 1e-9);
  EXPECT_NEAR(circle.sweep_rad, sweep, 1e-9);
  const auto at = [&](double angle) {
    return MachinePoint{radius * std::cos(angle), radius * std::sin(angle), 0};
  };
  EXPECT_NEAR((piece.from - at(begin)).norm(), 0.0, 1e-6) << index;
  EXPECT_NEAR((piece.middle - at(begin + 0.5 * sweep)).norm(), 0.0, 1e-6) << index;
  EXPECT_NEAR((piece.to - at(begin + sweep)).norm(), 0.0, 1e-6) << index;
}

TEST(SharedWays, PiecesOfArcsLieOnTheirCircles) {
  SharedWay before, after;
  before.Round({}, 10.0, 0.0, 4.0).Round({}, 20.0, 0.5, 3.0);
  after.Round({}, 10.0, 1.0, 1.5).Round({}, 20.0, 2.0, 1.0);
  const PathDifference difference = Compare(before.sketch(), after.sketch());
  ASSERT_EQ(difference.removed.elements.size(), 4U);
  ExpectPiece(difference.removed, 0, 10.0, 0.0, 1.0);
  ExpectPiece(difference.removed, 1, 10.0, 2.5, 1.5);
  ExpectPiece(difference.removed, 2, 20.0, 0.5, 1.5);
  ExpectPiece(difference.removed, 3, 20.0, 3.0, 0.5);
  ASSERT_EQ(difference.common.elements.size(), 2U);
  ExpectPiece(difference.common, 0, 10.0, 1.0, 1.5);
  ExpectPiece(difference.common, 1, 20.0, 2.0, 1.0);
  EXPECT_TRUE(difference.added.elements.empty());
  EXPECT_NEAR(difference.removed.cut_mm, 25.0 + 40.0, 1e-9);
}

// A cut lies where travel went along before it: each is compared with its own kind.
TEST(SharedWays, CutsLieOnTravel) {
  SharedWay path, travel;
  path.Straight({0, 0, 0}, {10, 0, 0}, MotionUse::kTravel).Straight({10, 0, 0}, {0, 0, 0});
  path.Round({20, 0, 0}, 5.0, 0.0, 2.0).Straight({25, 0, 0}, {20, 0, 0}, MotionUse::kTravel);
  const PathDifference same = Compare(path.sketch(), path.sketch());
  EXPECT_NEAR(same.common.cut_mm, 20.0, 1e-9);
  EXPECT_NEAR(same.common.travel_mm, 15.0, 1e-9);
  EXPECT_TRUE(same.removed.elements.empty());
  EXPECT_TRUE(same.added.elements.empty());
  travel.Straight({0, 0, 0}, {10, 0, 0}, MotionUse::kTravel);
  const PathDifference cut = Compare(path.sketch(), travel.sketch());
  EXPECT_NEAR(cut.removed.cut_mm, 20.0, 1e-9);
  EXPECT_NEAR(cut.removed.travel_mm, 5.0, 1e-9);
}

// Of ways that lie on each other one is enough to look at: as many pairs as ways do.
TEST(SharedWays, OneThatCoversItAllIsEnough) {
  SharedWay path;
  for (int k = 0; k < 40; ++k) {
    const double x = k % 2 == 0 ? 0.0 : 10.0;
    path.Straight({x, 0, 0}, {10.0 - x, 0, 0});
  }
  const PathDifference difference = Compare(path.sketch(), path.sketch(), 40);
  EXPECT_TRUE(difference.exact);
  EXPECT_NEAR(difference.common.cut_mm, 400.0, 1e-9);
  EXPECT_FALSE(Compare(path.sketch(), path.sketch(), 39).exact);
}

// Two ways that meet cover one that goes on, which stays one piece.
TEST(SharedWays, WhatMeetsIsOnePiece) {
  SharedWay before, after;
  before.Straight({0, 0, 0}, {4, 0, 0}).Straight({4, 5, 0}, {4, 0, 0});
  before.Straight({10, 0, 0}, {4, 0, 0});
  after.Straight({0, 0, 0}, {12, 0, 0});
  const PathDifference difference = Compare(before.sketch(), after.sketch());
  ASSERT_EQ(difference.common.elements.size(), 1U);
  EXPECT_NEAR(difference.common.elements[0].to.x(), 10.0, 1e-9);
  ASSERT_EQ(difference.added.elements.size(), 1U);
  EXPECT_NEAR(difference.added.elements[0].from.x(), 10.0, 1e-9);
  EXPECT_NEAR(difference.removed.cut_mm, 5.0, 1e-9);
}

// Dots just as far from each other as places that are one are the same; farther ones are not, nor
// those that are of another kind.
TEST(SharedWays, DotsThatJustTouchAreOne) {
  const auto sketch_with = [](double x, double y) {
    PathSketch sketch(Laser(), 100);
    motion::PlannedMotion planned;
    planned.path = LineFrom({x, y, 9}, {x, y, 0});
    sketch.Add({.motion = &planned, .travelled = 9.0});
    sketch.AddPierce();
    return sketch;
  };
  const auto shared = [&](double x, double y) {
    const PathDifference difference = Compare(sketch_with(0, 0), sketch_with(x, y));
    EXPECT_EQ(difference.removed.dots.size(), difference.added.dots.size());
    return difference.common.dots.size();
  };
  EXPECT_EQ(shared(kSamePlace_mm, 0), 1U);
  EXPECT_EQ(shared(-kSamePlace_mm, 0), 1U);
  EXPECT_EQ(shared(0, kSamePlace_mm), 1U);
  EXPECT_EQ(shared(1.001 * kSamePlace_mm, 0), 0U);
  EXPECT_EQ(shared(-1.001 * kSamePlace_mm, 0), 0U);
  EXPECT_EQ(shared(0, -1.001 * kSamePlace_mm), 0U);
  EXPECT_EQ(shared(0.8 * kSamePlace_mm, 0.8 * kSamePlace_mm), 0U);
}

}  // namespace
}  // namespace rmlcell::simulation
