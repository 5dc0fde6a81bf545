// Curves of any kind against a dense search of their own, and what lies at the edge of a table or
// of a tolerance. motion.md 3.2, 4.2, 4.3
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/motion/corner/corner.h"
#include "engine/motion/geometry/corner_nodes.h"
#include "engine/motion/geometry/corner_table.h"
#include "engine/motion/geometry/path.h"
#include "engine/motion/kinematics/axes.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// A corner that bends as arcs do and turns the head far: more than the sines of its middle are
// drawn on for.
CornerCurve AnyCurve(Dice& dice, double cut, double turns_rad) {
  const double turn = dice.Uniform(0.05, 2.6);
  const MachineVector in{1, 0, 0}, out{std::cos(turn), std::sin(turn), 0};
  const MachineVector left{0, 1, 0}, left_out{-out.y(), out.x(), 0};
  const auto rate = [&] { return turns_rad * dice.Uniform(-1.0, 1.0) / cut; };
  const CurveEnd from{.pose = {in * -cut, dice.Uniform(-2, 2), dice.Uniform(-1.5, 1.5)},
                      .tangent = in,
                      .curvature = left * (dice.Uniform(-0.8, 0.8) / cut),
                      .a_rate = rate(),
                      .b_rate = rate()};
  const CurveEnd to{.pose = {out * cut, from.pose.a_rad + turns_rad * dice.Uniform(-1, 1),
                             from.pose.b_rad + turns_rad * dice.Uniform(-1, 1)},
                    .tangent = out,
                    .curvature = left_out * (dice.Uniform(-0.8, 0.8) / cut),
                    .a_rate = rate(),
                    .b_rate = rate()};
  return CornerCurve(from, to, cut);
}

// The least that all limits leave at 6,001 places, and again about the lowest of them.
double LeastOfDense(const CornerCurve& curve, const Head& head, const MachineLimits& machine) {
  const auto allowed = [&](double u) {
    const PathDerivatives second = curve.SecondByLength(u);
    const AxisDerivatives q = ThroughHead(head, curve.At(u), curve.FirstByLength(u), second);
    double least = std::min(std::sqrt(machine.normal_acceleration() / second.point.norm()),
                            std::cbrt(machine.normal_jerk() / curve.JerkPerCube(u)));
    for (std::size_t i = 0; i < kAxisCount; ++i) {
      least = std::min({least, machine.axes.speed[i] / std::abs(q.first[i]),
                        std::sqrt(machine.axes.acceleration[i] / std::abs(q.second[i]))});
    }
    return least;
  };
  double where = 0.5, least = HUGE_VAL;
  for (const double step : {1.0 / 6000.0, 1.0 / (6000.0 * 2500.0)}) {
    const double middle = step < 1e-5 ? where : 0.5;
    for (int k = -3000; k <= 3000; ++k) {
      const double u = std::clamp(middle + step * k, 0.0, 1.0);
      if (const double here = allowed(u); here < least) {
        least = here;
        where = u;
      }
    }
  }
  return least;
}

TEST(SpeedOnCurve, OfAnyCurveIsTheLeastOfAllPlaces) {
  Dice dice(77);
  const MachineLimits machine = StandardMachine();
  for (int round = 0; round < 120; ++round) {
    const CornerCurve curve =
        AnyCurve(dice, dice.Magnitude(0.3, 30.0), dice.Chance(0.5) ? 2.0 : 0.08);
    const Head head = GantryHead{.length_mm = dice.Magnitude(1.0, 300.0),
                                 .tool = {dice.Uniform(-20, 20), dice.Uniform(-20, 20), 30.0}};
    const double least = LeastOfDense(curve, head, machine);
    ASSERT_NEAR(SpeedOnCurve(curve, head, machine), least, 1e-6 * least) << round;
  }
}

// Where nothing of the tip moves the head turns the way that was asked for.
TEST(ArcThrough, WithoutAWayTheHeadStillTurns) {
  const TipPose from{{5, 6, 7}, 0.1, -0.2}, to{{5, 6, 7}, 0.4, 0.3};
  const auto arc = PathPiece::ArcThrough(from, {5, 6, 7}, to);
  ASSERT_TRUE(arc);
  EXPECT_EQ(arc->kind, PathPiece::ArcCase::kNoTipMotion);
  EXPECT_EQ(arc->path.kind(), PathPiece::Kind::kRotary);
  EXPECT_EQ(arc->path.tip_from().a_rad, 0.1);
  EXPECT_EQ(arc->path.tip_to().b_rad, 0.3);
  EXPECT_DOUBLE_EQ(arc->path.a_rate(), 0.3);
  EXPECT_DOUBLE_EQ(arc->path.b_rate(), 0.5);
}

// A via point at an end or on the chord: the line goes from the start to the target all the same.
TEST(ArcThrough, AWarnedLineGoesToItsTarget) {
  const TipPose from{{0, 0, 0}, 0.1, 0.0}, to{{10, 0, 0}, 0.4, -0.2};
  for (const MachinePoint& via :
       {MachinePoint{0, 0, 0}, MachinePoint{10, 0, 0}, MachinePoint{4, 0, 0}}) {
    const auto arc = PathPiece::ArcThrough(from, via, to);
    ASSERT_TRUE(arc);
    EXPECT_EQ(arc->kind, PathPiece::ArcCase::kLineWarned);
    EXPECT_EQ(arc->path.tip_from().a_rad, 0.1);
    EXPECT_EQ(arc->path.tip_to().b_rad, -0.2);
    EXPECT_EQ(arc->path.Tangent(3.0).x(), 1.0);
  }
}

// The table of measures goes up to its last figure, and not beyond.
TEST(PlainMeasure, KnowsTheLastOfItsTable) {
  const auto known = [](double turn) {
    return PlainMeasure({.at = {}, .tangent_in = {}, .tangent_out = {turn, 0, 0}, .cut_mm = 1.0})
        .known();
  };
  double last = 2.0 * std::sqrt(MeasureNodes::kSquareMax) * (1.0 - 1e-14);
  while (0.25 * std::nextafter(last, 2.0) * std::nextafter(last, 2.0) <= MeasureNodes::kSquareMax)
    last = std::nextafter(last, 2.0);
  ASSERT_EQ(0.25 * last * last, MeasureNodes::kSquareMax);
  EXPECT_TRUE(known(last));
  EXPECT_FALSE(known(std::nextafter(last, 2.0)));
}

}  // namespace
}  // namespace rmlcell::motion
