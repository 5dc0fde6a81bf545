#include "engine/simulation/path/polyline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

// motion.md 9: ceil(sweep / (2 acos(1 - tolerance / radius))) chords. A tolerance of
// 1 - cos(30 degrees) of the radius gives chords of 60 degrees.
TEST(Polyline, ChordsOfAnArc) {
  const double sixty = 10.0 * (1.0 - std::cos(kPi / 6.0));
  EXPECT_EQ(ChordCount(10.0, kTurn, sixty), 6);
  EXPECT_EQ(ChordCount(10.0, kTurn + 0.01, sixty), 7);
  EXPECT_EQ(ChordCount(10.0, kTurn - 0.01, sixty), 6);
  EXPECT_EQ(ChordCount(10.0, kPi / 3.0, sixty), 1);
  EXPECT_EQ(ChordCount(10.0, kPi / 3.0 + 0.01, sixty), 2);
  EXPECT_EQ(ChordCount(20.0, kTurn, 2.0 * sixty), 6);
}

// At least one, however short; a chord is half a turn at most, however coarse; never past the
// limit.
TEST(Polyline, ChordsHaveLimits) {
  EXPECT_EQ(ChordCount(10.0, 0.0, 0.01), 1);
  EXPECT_EQ(ChordCount(10.0, kTurn, 10.0), 2);
  EXPECT_EQ(ChordCount(10.0, kTurn, 1000.0), 2);
  EXPECT_EQ(ChordCount(1e9, 1e6, 1e-3), kChordsMax);
}

// COORD ROBOT: B swings a tip 300 mm below its column, so the way is an arc of R 300. Every place
// of it is within the tolerance of the polyline, chords of half the tolerance are none, and what is
// asked of a part of the way does not depend on where the part lies.
TEST(Polyline, ASwingIsCutAsTheToleranceAllows) {
  const motion::Head head = motion::GantryHead{.length_mm = 300.0};
  const motion::PathPiece path =
      motion::PathPiece::Joint({{0, 0, 300}, 0.0, 0.0}, {{0, 0, 300}, 0.0, 4.0});
  for (const double tolerance : {0.01, 0.5, 20.0}) {
    std::size_t counts[2] = {};
    for (const int half : {0, 1}) {
      const PathPart part{path, head, 0.5 * half * path.length(), 0.5 * (half + 1) * path.length()};
      double before = part.from;
      motion::MachinePoint from = TipAt(path, head, before);
      double worst = 0.0;
      PartShape shape(part);
      ForEachVertex(shape, tolerance, [&](double s, const motion::MachinePoint& tip) {
        EXPECT_GT(s, before);
        EXPECT_NEAR((tip - TipAt(path, head, s)).norm(), 0.0, 1e-9);
        const motion::MachinePoint middle = TipAt(path, head, 0.5 * (before + s));
        worst = std::max(worst, (middle - ((from + tip) * 0.5)).norm());
        before = s;
        from = tip;
        ++counts[half];
      });
      EXPECT_EQ(before, part.to);
      EXPECT_LE(worst, tolerance);
      EXPECT_GT(
          worst,
          tolerance / 6.0);  // halved once too often at most, with a quarter for what lies between
    }
    EXPECT_EQ(counts[0], counts[1]) << tolerance;
  }
}

// A way that runs past the end of its chord and back is not as near as the line through it: the tip
// of a whole turn ends where it began.
TEST(Polyline, AWholeTurnIsNoPoint) {
  const motion::Head head = motion::GantryHead{.length_mm = 300.0};
  const motion::PathPiece path =
      motion::PathPiece::Joint({{0, 0, 300}, 0.0, 0.0}, {{0, 0, 300}, 0.0, kTurn});
  double way = 0.0;
  motion::MachinePoint from = TipAt(path, head, 0.0);
  PartShape shape({path, head, 0.0, path.length()});
  ForEachVertex(shape, 1.0, [&](double, const motion::MachinePoint& tip) {
    way += (from - tip).norm();
    from = tip;
  });
  EXPECT_NEAR(way, 300.0 * kTurn, 10.0);
}

}  // namespace
}  // namespace rmlcell::simulation
