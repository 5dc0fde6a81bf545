// Curves so small that they are passed at less than 1 mm/s, and heads that are nearly upright,
// where sines are drawn on from one place of the curve. motion.md 4.3
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/motion/corner/corner.h"
#include "engine/motion/kinematics/axes.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

double AllowedAt(const CornerCurve& curve, const Head& head, const MachineLimits& machine,
                 double u) {
  const PathDerivatives second = curve.SecondByLength(u);
  const AxisDerivatives q = ThroughHead(head, curve.At(u), curve.FirstByLength(u), second);
  double least = std::min(std::sqrt(machine.normal_acceleration() / second.point.norm()),
                          std::cbrt(machine.normal_jerk() / curve.JerkPerCube(u)));
  for (const std::size_t i : kAxes) {
    least = std::min({least, machine.axes.speed[i] / std::abs(q.first[i]),
                      std::sqrt(machine.axes.acceleration[i] / std::abs(q.second[i]))});
  }
  return least;
}

// At 1,601 places, and closer about the lowest of them.
double LeastAllowed(const CornerCurve& curve, const Head& head, const MachineLimits& machine) {
  double where = 0.5, least = HUGE_VAL;
  for (const double step : {1.0 / 1600.0, 1.0 / 640e3, 1.0 / 256e6}) {
    const double middle = where;
    for (int k = -800; k <= 800; ++k) {
      const double u = std::clamp(middle + step * k, 0.0, 1.0);
      if (const double here = AllowedAt(curve, head, machine, u); here < least) {
        least = here;
        where = u;
      }
    }
  }
  return least;
}

CornerCurve SmallCurve(Dice& dice, double cut, double tilt_rad) {
  const double turn = dice.Uniform(0.05, 2.4);
  const MachineVector in{1, 0, 0}, out{std::cos(turn), std::sin(turn), 0};
  const auto angle = [&] { return tilt_rad * dice.Uniform(-1.0, 1.0); };
  const auto rate = [&] { return angle() / cut; };
  const double bend = dice.Chance(0.5) ? 0.6 / cut : 0.0;
  const CurveEnd from{.pose = {in * -cut, angle(), angle()},
                      .tangent = in,
                      .curvature = MachineVector{0, 1, 0} * (bend * dice.Uniform(-1, 1)),
                      .a_rate = rate(),
                      .b_rate = rate()};
  const CurveEnd to{.pose = {out * cut, angle(), angle()},
                    .tangent = out,
                    .curvature = MachineVector{-out.y(), out.x(), 0} * (bend * dice.Uniform(-1, 1)),
                    .a_rate = rate(),
                    .b_rate = rate()};
  return CornerCurve(from, to, cut);
}

// Weak where the column is swung out: what the angles are decides.
TEST(SpeedOnCurve, OfHeadsNearlyUprightIsTheLeastOfAllPlaces) {
  Dice dice(1187);
  for (int round = 0; round < 40; ++round) {
    MachineLimits machine = StandardMachine();
    machine.tip_acceleration_mm_s2 = machine.tip_jerk_mm_s3 = 1e9;
    machine.axes.speed[3] = machine.axes.speed[4] = 1e6;
    machine.axes.acceleration[3] = machine.axes.acceleration[4] = 1e9;
    machine.axes.acceleration[static_cast<int>(dice.Uniform(0.0, 2.99))] = 30.0;
    const CornerCurve curve = SmallCurve(dice, dice.Magnitude(1.0, 30.0), 0.045);
    const Head head = GantryHead{.length_mm = 300.0, .tool = {40.0, -25.0, 0.0}};
    const double least = LeastAllowed(curve, head, machine);
    ASSERT_NEAR(SpeedOnCurve(curve, head, machine), least, 1e-6 * least) << round;
  }
}

TEST(SpeedOnCurve, OfTinyCurvesIsTheLeastOfAllPlaces) {
  Dice dice(1193);
  int slow = 0;
  for (int round = 0; round < 60; ++round) {
    const CornerCurve curve = SmallCurve(dice, dice.Magnitude(1e-4, 1e-2), 1e-9);
    const double least = LeastAllowed(curve, MillHead{}, StandardMachine());
    slow += least < 0.5 ? 1 : 0;
    ASSERT_NEAR(SpeedOnCurve(curve, MillHead{}, StandardMachine()), least, 1e-6 * least) << round;
  }
  EXPECT_GT(slow, 20);
}

}  // namespace
}  // namespace rmlcell::motion
