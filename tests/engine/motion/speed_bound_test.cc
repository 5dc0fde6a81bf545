#include "engine/motion/kinematics/speed_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

// motion.md 1 and 5.1, case L01: column x' = 1 + 3 cos A.
TEST(SpeedBound, NamesTheAxisThatIsAskedForMost) {
  const PathPiece line = PathPiece::Line({{0, 0, 0}, 0.0, kPi / 2}, {{100, 0, 0}, 1.0, kPi / 2});
  const SpeedBound bound = TightestBound(line, Head{}, StandardMachine(), 150.0);
  EXPECT_EQ(bound.cause, SpeedBound::Cause::kAxis);
  EXPECT_EQ(bound.axis, 0);
  EXPECT_NEAR(bound.speed, 125.0, 1e-6);
  EXPECT_EQ(TightestBound(line, Head{}, StandardMachine(), 100.0).cause, SpeedBound::Cause::kNone);
  const SpeedBound same = TightestBound(line, Head{}, StandardMachine(), bound.speed);
  EXPECT_EQ(same.cause, SpeedBound::Cause::kNone);
  EXPECT_EQ(same.axis, -1);
  EXPECT_EQ(same.speed, bound.speed);
}

// motion.md 5.1: half of the 2000 mm/s2 of an axis for the bend: sqrt(0.5 * 2000 * 2) = 44.721,
// against sqrt(0.8 * 2000 * 2) = 56.569 and cbrt(0.8 * 40000 * 4) = 50.397 of the tip. All by the
// radius.
TEST(SpeedBound, KnowsTheRadius) {
  const auto arc = PathPiece::ArcThrough({{2, 0, 0}, 0, 0}, {0, 2, 0}, {{-2, 0, 0}, 0, 0});
  ASSERT_TRUE(arc);
  const SpeedBound bound = TightestBound(arc->path, Head{}, StandardMachine(), 500.0);
  EXPECT_EQ(bound.cause, SpeedBound::Cause::kRadius);
  EXPECT_EQ(bound.axis, -1);
  EXPECT_NEAR(bound.speed, std::sqrt(0.5 * 2000.0 * 2.0), 1e-9);
}

// The same where the head stands upright at one third of the way, in a turn of 0.88 rad, half way,
// in one of 0.6 or of 60, or at an end: those places are looked at. x' = 1 + 3 (turn / 1 rad) cos
// A.
TEST(SpeedBound, LooksAtEqualSteps) {
  for (const auto& [turn, share] : {std::pair{0.88, 1.0 / 3.0},
                                    {0.6, 0.5},
                                    {60.0, 0.5},
                                    {0.01, 0.5},
                                    {0.88, 0.0},
                                    {0.88, 1.0}}) {
    const PathPiece line = PathPiece::Line({{0, 0, 0}, -turn * share, kPi / 2},
                                           {{100, 0, 0}, turn * (1.0 - share), kPi / 2});
    const SpeedBound bound = TightestBound(line, Head{}, StandardMachine(), 1000.0);
    EXPECT_EQ(bound.axis, 0);
    EXPECT_NEAR(bound.speed, 500.0 / (1.0 + 3.0 * turn), 1e-9);
  }
}

// motion.md 2.6: what an axis lacks is told axis by axis, with the place on the path.
TEST(Travel, ExcessOfEachAxisAndWhere) {
  const AxisLimits limits = StandardMachine().axes;
  const PathPiece line = PathPiece::Joint({{3500, 0, 0}, 0, 0}, {{3700, 0, 0}, -13.0, 0.0});
  const auto worst = ExcessOfEach(line, Head{}, limits);
  EXPECT_NEAR(worst[0].excess, 100.0, 1e-9);
  EXPECT_EQ(worst[0].s, line.length());
  EXPECT_EQ(worst[1].excess, 0.0);
  EXPECT_EQ(worst[1].s, 0.0);
  EXPECT_NEAR(worst[3].excess, 0.4, 1e-9);
  EXPECT_NEAR(ExcessOfAxis(3, {{}, 12.7, 0.0}, limits), 0.1, 1e-12);
  // As far outside all along: the first such place.
  const PathPiece beside = PathPiece::Joint({{3700, 0, 0}, 0, 0}, {{3700, 50, 0}, 0.0, 0.0});
  EXPECT_NEAR(ExcessOfEach(beside, Head{}, limits)[0].excess, 100.0, 1e-9);
  EXPECT_EQ(ExcessOfEach(beside, Head{}, limits)[0].s, 0.0);
}

}  // namespace
}  // namespace rmlcell::motion
