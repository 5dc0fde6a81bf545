#include "engine/simulation/polyline.h"

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

}  // namespace
}  // namespace rmlcell::simulation
