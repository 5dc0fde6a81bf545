// The speed on a curve to its last digits, against a search that closes in on every peak of every
// limit: curves of all sizes, also such as nearly come to a point, and each limit alone.
// motion.md 4.3
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/motion/corner/corner.h"
#include "engine/motion/kinematics/axes.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr std::size_t kDigitLimits = 2 + 2 * kAxisCount;

// What a curve is passed by.
struct Passing {
  CornerCurve curve;
  Head head;
  MachineLimits machine;

  // The highest speed by one limit at a place: of the tip, then of each axis.
  double At(std::size_t limit, double u) const {
    const PathDerivatives second = curve.SecondByLength(u);
    if (limit == 0) return std::sqrt(machine.normal_acceleration() / second.point.norm());
    if (limit == 1) return std::cbrt(machine.normal_jerk() / curve.JerkPerCube(u));
    const AxisDerivatives q = ThroughHead(head, curve.At(u), curve.FirstByLength(u), second);
    const std::size_t axis = (limit - 2) / 2;
    return limit % 2 == 0 ? machine.axes.speed[axis] / std::abs(q.first[axis])
                          : std::sqrt(machine.axes.acceleration[axis] / std::abs(q.second[axis]));
  }

  // The lowest of one limit: golden sections about each valley of `places`, closer about `sharp`.
  double Least(std::size_t limit, double sharp) const {
    constexpr int kPlaces = 160;
    std::array<double, 2 * kPlaces + 1> places;
    for (int k = 0; k <= kPlaces; ++k) {
      const double x = 2.0 * k / kPlaces - 1.0;  // cubed: many about the middle of it
      places[static_cast<std::size_t>(k)] = static_cast<double>(k) / kPlaces;
      if (k < kPlaces)
        places[static_cast<std::size_t>(kPlaces + 1 + k)] =
            std::clamp(sharp + 0.5 * x * x * x, 0.0, 1.0);
    }
    std::ranges::sort(places);
    std::array<double, 2 * kPlaces + 1> here;
    for (std::size_t k = 0; k < places.size(); ++k) here[k] = At(limit, places[k]);
    double least = *std::ranges::min_element(here);
    const double worth = 1.5 * least;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const std::size_t low = k > 0 ? k - 1 : k, high = std::min(k + 1, places.size() - 1);
      if (here[k] > worth || here[low] < here[k] || here[high] < here[k]) continue;
      least = std::min(least, Valley(limit, places[low], places[high]));
    }
    return least;
  }

 private:
  double Valley(std::size_t limit, double low, double high) const {
    constexpr double kGolden = 0.6180339887498949;
    double least = HUGE_VAL;
    for (int section = 0; section < 40; ++section) {
      const double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
      const double at_left = At(limit, left), at_right = At(limit, right);
      least = std::min({least, at_left, at_right});
      (at_left < at_right ? high : low) = at_left < at_right ? right : left;
    }
    return least;
  }
};

void ExpectLeastOfAll(const Passing& passing, bool of_lines = false) {
  const double sharp = passing.curve.SlowestPlace();
  double least = HUGE_VAL;
  for (std::size_t limit = of_lines ? 2 : 0; limit < kDigitLimits; ++limit)
    least = std::min(least, passing.Least(limit, sharp));
  const auto speed = [&](double enough) {
    return SpeedOnCurve(passing.curve, passing.head, passing.machine, enough, of_lines);
  };
  EXPECT_NEAR(speed(HUGE_VAL), least, 3e-9 * least);
  EXPECT_NEAR(speed(1.001 * least), least, 3e-9 * least);
  EXPECT_GE(speed(0.9 * least), 0.9 * least);
}

MachineLimits AllStrong() {
  MachineLimits machine;
  machine.tip_acceleration_mm_s2 = machine.tip_jerk_mm_s3 = 1e15;
  machine.axes.speed.fill(1e9);
  machine.axes.acceleration.fill(1e15);
  return machine;
}

// The standard machine, or one that has but one limit.
MachineLimits OneLimit(Dice& dice) {
  if (dice.Chance(0.3)) return StandardMachine();
  MachineLimits machine = AllStrong();
  const auto limit = static_cast<std::size_t>(dice.Uniform(0.0, kDigitLimits - 0.001));
  const std::size_t axis = (std::max<std::size_t>(limit, 2) - 2) / 2;
  if (limit == 0) machine.tip_acceleration_mm_s2 = 2000.0;
  if (limit == 1) machine.tip_jerk_mm_s3 = 40000.0;
  if (limit >= 2 && limit % 2 == 0) machine.axes.speed[axis] = 20.0;
  if (limit >= 2 && limit % 2 == 1) machine.axes.acceleration[axis] = 90.0;
  return machine;
}

// Turns its head by up to `turns`, and bends at its ends by up to `bends` over its cut.
CornerCurve CurveOf(Dice& dice, double cut, double turns, double bends) {
  const double turn = dice.Uniform(0.05, 2.8);
  const MachineVector in{1, 0, 0}, out{std::cos(turn), std::sin(turn), 0};
  const auto any = [&](double most) { return most * dice.Uniform(-1.0, 1.0); };
  const CurveEnd from{.pose = {in * -cut, dice.Uniform(-2, 2), dice.Uniform(-1.5, 1.5)},
                      .tangent = in,
                      .curvature = MachineVector{0, 0.8, 0.6} * any(bends / cut),
                      .a_rate = any(turns / cut),
                      .b_rate = any(turns / cut)};
  const CurveEnd to{.pose = {out * cut, from.pose.a_rad + any(turns), from.pose.b_rad + any(turns)},
                    .tangent = out,
                    .curvature = MachineVector{-out.y(), out.x(), 0} * any(bends / cut),
                    .a_rate = any(turns / cut),
                    .b_rate = any(turns / cut)};
  return CornerCurve(from, to, cut);
}

Head HeadOf(Dice& dice) {
  return GantryHead{.length_mm = dice.Magnitude(1.0, 300.0),
                    .tool = {dice.Uniform(-20, 20), dice.Uniform(-20, 20), 0.5}};
}

TEST(CurveSpeedDigits, OfCurvesThatTurnTheHead) {
  Dice dice(2101);
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    const double turns = dice.Chance(0.5) ? 1.5 : 0.07;
    const CornerCurve curve = CurveOf(dice, dice.Magnitude(0.1, 30.0), turns, 0.8);
    ExpectLeastOfAll({curve, HeadOf(dice), OneLimit(dice)});
  }
}

// Passed at less than a tenth of a millimetre in a second.
TEST(CurveSpeedDigits, OfTheSmallestCurves) {
  Dice dice(2111);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    const CornerCurve curve = CurveOf(dice, dice.Magnitude(1e-5, 1e-3), 1e-9, 0.7);
    ExpectLeastOfAll({curve, MillHead{}, StandardMachine()});
  }
}

// Between lines: what the axes allow is all that is asked for.
TEST(CurveSpeedDigits, OfAxesBetweenLines) {
  Dice dice(2113);
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    MachineLimits machine = StandardMachine();
    if (dice.Chance(0.7)) {
      machine = AllStrong();
      const auto axis = static_cast<std::size_t>(dice.Uniform(0.0, 4.999));
      (dice.Chance(0.5) ? machine.axes.speed : machine.axes.acceleration)[axis] = 60.0;
    }
    const CornerCurve curve = CurveOf(dice, dice.Magnitude(0.1, 30.0), 0.9, 0.0);
    ExpectLeastOfAll({curve, HeadOf(dice), machine}, true);
  }
}

// Two limits nearly alike: the lower one counts, though the other one may be the lower at all
// places that are looked at first.
TEST(CurveSpeedDigits, OfTwoLimitsNearlyAlike) {
  Dice dice(2129);
  int pairs = 0;
  for (int round = 0; round < 80; ++round) {
    SCOPED_TRACE(round);
    Passing passing{CurveOf(dice, dice.Magnitude(1.0, 30.0), 0.6, 0.5), HeadOf(dice), AllStrong()};
    const auto one = static_cast<std::size_t>(dice.Uniform(2.0, kDigitLimits - 0.001));
    const auto other = static_cast<std::size_t>(dice.Uniform(2.0, kDigitLimits - 0.001));
    const double more = 1.0 + dice.Magnitude(1e-5, 3e-3);
    if (one == other) continue;
    for (const std::size_t limit : {one, other}) {
      const double wanted = limit == one ? 20.0 : 20.0 * more;
      const double share = wanted / passing.Least(limit, passing.curve.SlowestPlace());
      const std::size_t axis = (limit - 2) / 2;
      if (limit % 2 == 0) {
        passing.machine.axes.speed[axis] *= share;
      } else {
        passing.machine.axes.acceleration[axis] *= share * share;
      }
    }
    ExpectLeastOfAll(passing);
    ++pairs;
  }
  EXPECT_GT(pairs, 50);
}

// Between two arcs of these curvatures that meet at this turn, cut 1 mm from where they do.
CornerCurve BetweenArcs(double turn, double bend_in, double bend_out) {
  const auto turned = [](const MachineVector& v, double angle) {
    return MachineVector{v.x() * std::cos(angle) - v.y() * std::sin(angle),
                         v.x() * std::sin(angle) + v.y() * std::cos(angle), 0};
  };
  const auto left = [](const MachineVector& v) { return MachineVector{-v.y(), v.x(), 0}; };
  // A millimetre along an arc that leaves the origin along X.
  const auto along = [](double bend) {
    return MachineVector{std::sin(bend) / bend, (1.0 - std::cos(bend)) / bend, 0};
  };
  const MachineVector back = along(-bend_in), on = turned(along(bend_out), turn);
  const MachineVector in = turned({1, 0, 0}, -bend_in), out = turned({1, 0, 0}, turn + bend_out);
  return CornerCurve(
      {.pose = {{-back.x(), -back.y(), 0}, 0, 0}, .tangent = in, .curvature = left(in) * bend_in},
      {.pose = {on, 0, 0}, .tangent = out, .curvature = left(out) * bend_out}, 1.0);
}

// Two arcs that meet nearly back to back: the curve all but comes to a point, between two of the
// places that are looked at first.
TEST(CurveSpeedDigits, OfCurvesThatNearlyComeToAPoint) {
  for (const auto& [turn, in, out] : {std::array{2.908305, 0.022643, 0.422142},
                                      {2.985370, -0.183730, 0.445394},
                                      {2.909708, 0.490130, -0.052406},
                                      {2.938832, 0.469661, -0.114364}}) {
    const CornerCurve curve = BetweenArcs(turn, in, out);
    const double sharp = 48.0 * curve.SlowestPlace();
    EXPECT_NEAR(sharp - std::floor(sharp), 0.5, 0.3);
    EXPECT_GT(curve.SecondByLength(curve.SlowestPlace()).point.norm(), 150.0);
    EXPECT_FALSE(curve.HasCusp(1.0));
    ExpectLeastOfAll({curve, MillHead{}, StandardMachine()});
    MachineLimits one = AllStrong();
    one.axes.acceleration[0] = 100.0;
    ExpectLeastOfAll({curve, MillHead{}, one});
    one = AllStrong();
    one.tip_acceleration_mm_s2 = 2000.0;
    ExpectLeastOfAll({curve, MillHead{}, one});
  }
}

}  // namespace
}  // namespace rmlcell::motion
