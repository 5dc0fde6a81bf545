// Edges of the planner's stages: how many moves wait, where a bend ends to the last digit, and what
// the ends of a bend's halves are.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/core/units.h"
#include "engine/motion/geometry/blend_curve.h"
#include "engine/motion/planner/planner.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// Steps of 0.1 mm at 90 mm/s, from which 10 mm/s2 take 405 mm to rest: nothing is known before
// then. As many moves wait as the window holds; the last of them decides half of it too early.
// motion.md 5.5
TEST(PlannerWindow, IsFullWithAsManyMovesAsItHolds) {
  MachineLimits machine = StandardMachine();
  machine.tip_acceleration_mm_s2 = 10.0;
  machine.tip_jerk_mm_s3 = 1000.0;
  for (const std::size_t window : {40, 64, 100}) {
    Planner planner(machine, window);
    planner.BeginMoving(90.0);
    for (std::size_t k = 0; k < window; ++k) {
      const double x = 0.1 * static_cast<double>(k);
      MoveCommand move;
      move.path = PathPiece::Line({{x, 0, 0}}, {{x + 0.1, 0, 0}});
      move.speed_fraction = k % 2 == 0 ? 0.18 : 0.2;  // else they would be one leg
      move.fly = true;
      EXPECT_EQ(planner.lookahead_starved(), 0U) << k;
      ASSERT_TRUE(planner.Append(move));
    }
    EXPECT_GT(planner.lookahead_starved(), 0U) << window;
  }
}

// A bend that takes half of the run behind it ends at a point in its middle: 1e-10 mm beside it is
// the same place, and nothing is left of the move that ends there.
TEST(BendEnds, APointAtItsEndIsItsEnd) {
  constexpr double kBeside_mm = 1e-10;
  const double middle = 1.0 + kBeside_mm;
  std::vector<MoveCommand> chain(3);
  chain[0].path = PathPiece::Line({{-300, 0, 0}}, {{0, 0, 0}});
  chain[1].path = PathPiece::Line({{0, 0, 0}}, {{0, 1, 0}});
  chain[2].path = PathPiece::Line({{0, 1, 0}}, {{0, 2.0 * middle, 0}});
  for (std::size_t k = 0; k < chain.size(); ++k) {
    chain[k].fly = k < 2;
    chain[k].tag = k;
  }
  ASSERT_EQ(0.5 * (chain[1].path.length() + chain[2].path.length()), 1.0 + kBeside_mm);
  int ends = 0;
  for (const PlannedMotion& motion : Plan(chain)) {
    EXPECT_GT(motion.path.length(), 1e-6) << motion.tag;
    if (motion.tag != 1 || !motion.ends_move) continue;
    ++ends;
    EXPECT_EQ(motion.path.kind(), PathPiece::Kind::kBlend);
  }
  EXPECT_EQ(ends, 1);
}

// The ends of a piece are those that it was made with, to the last bit, whatever its curve says.
TEST(BendEnds, AreThoseThatItWasMadeWith) {
  const PlainCorner corner{.at = {{7, -2, 3}, 0.4, -0.3},
                           .tangent_in = {1, 0, 0},
                           .tangent_out = {0, 1, 0},
                           .cut_mm = 2.0};
  const CornerCurve curve(corner);
  const double half = 0.5 * CornerLength(curve).total();
  PathPose middle = curve.At(0.5);
  middle.point.x() += 1e-7;
  PathPiece first, second;
  first.AssignCorner(corner, 0.0, half, corner.Start(), middle);
  second.AssignCorner(corner, half, half, middle, corner.Finish());
  EXPECT_EQ(first.At(half), middle);
  EXPECT_EQ(first.At(half + 1.0), middle);
  EXPECT_EQ(second.At(0.0), middle);
  EXPECT_EQ(second.At(-1.0), middle);
  EXPECT_EQ(second.At(std::nan("")), middle);
}

// Where bends are passed on ramps, each in one stretch, the speed that is told of one is that in
// its middle, where its first half ends, and not that of its end. Corners of 20 degrees, each
// faster than the last.
TEST(BendEnds, TheSpeedToldIsThatOfTheMiddle) {
  std::vector<MoveCommand> chain;
  MachinePoint at{1000, 900, -200};
  for (int k = 0; k < 8; ++k) {
    const double heading = 20.0 * kRadPerDegree * (k % 2);
    const MachinePoint to = at + MachineVector{std::cos(heading), std::sin(heading), 0.0} * 3.0;
    MoveCommand move;
    move.path = PathPiece::Line({at}, {to});
    move.speed_fraction = 0.8;
    move.fly = k < 7;
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
    at = to;
  }
  int slopes = 0;
  const std::vector<PlannedMotion> motions = Plan(chain);
  for (std::size_t k = 0; k + 1 < motions.size(); ++k) {
    const PlannedMotion& motion = motions[k];
    if (!motion.ends_move || !IsBlend(motion.corner.passage)) continue;
    EXPECT_NEAR(motion.corner.speed, motion.speed.end().speed, 1e-6) << motion.tag;
    if (std::abs(motions[k + 1].speed.end().speed - motion.corner.speed) > 1.0) ++slopes;
  }
  EXPECT_GT(slopes, 1);
}

}  // namespace
}  // namespace rmlcell::motion
