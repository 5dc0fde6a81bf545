// How near a bend comes to a point is the least of all its places, wherever on
// it that is. motion.md 4.2, 8.2
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/motion/geometry/corner_curve.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::curve_foot {
namespace {

double LeastOfPlaces(const CornerCurve& curve, const MachinePoint& point) {
  constexpr int kPlaces = 4000;
  double least = kNoLimit;
  for (int k = 0; k <= kPlaces; ++k)
    least = std::min(least, (curve.At(static_cast<double>(k) / kPlaces).point - point).norm());
  return least;
}

TEST(CurveFoot, OfAnyPointIsTheNearestPlace) {
  Dice dice(81);
  for (int round = 0; round < 60; ++round) {
    const MachineVector back = dice.Direction(), on = dice.Direction();
    if (std::abs(back.dot(on)) > 0.9) continue;
    const PathPiece in = PathPiece::Line({MachinePoint{} + back * 20.0}, {});
    const PathPiece out = PathPiece::Line({}, {MachinePoint{} + on * 20.0});
    const double cut = dice.Uniform(1.0, 10.0);
    const CornerCurve curve(EndAt(in, 20.0 - cut), EndAt(out, cut), cut);
    // On the outer side one place alone is the nearest.
    const MachinePoint near = MachinePoint{} + dice.Direction() * (0.03 * cut);
    EXPECT_NEAR(curve.DistanceFrom(near), LeastOfPlaces(curve, near), 1e-6 * cut) << round;
    EXPECT_NEAR(curve.DistanceFrom({}), LeastOfPlaces(curve, {}), 1e-6 * cut) << round;
  }
}

}  // namespace
}  // namespace rmlcell::motion::curve_foot
