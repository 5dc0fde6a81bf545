// What the axes leave of a move while the head turns, against a search of its
// own that closes in on every peak of what an axis is asked for. motion.md 5.1
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr PathLimits kAsked{.speed = 900.0, .acceleration = 1e6, .jerk = 1e9};
constexpr int kLookedAt = 240;

// The most of `asked` along a piece: golden sections about every peak of the
// places looked at.
template <class Asked>
double MostAlong(double length, Asked asked) {
  const double step = length / kLookedAt;
  std::array<double, kLookedAt + 1> seen;
  for (int k = 0; k <= kLookedAt; ++k) seen[static_cast<std::size_t>(k)] = asked(step * k);
  double most = 0.0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    most = std::max(most, seen[k]);
    const bool rises = k == 0 || seen[k] >= seen[k - 1];
    const bool falls = k + 1 == seen.size() || seen[k] >= seen[k + 1];
    if (!rises || !falls) continue;
    constexpr double kGolden = 0.6180339887498949;
    double low = std::max(step * (static_cast<double>(k) - 1.0), 0.0);
    double high = std::min(step * (static_cast<double>(k) + 1.0), length);
    for (int section = 0; section < 44; ++section) {
      const double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
      const double at_left = asked(left), at_right = asked(right);
      most = std::max({most, at_left, at_right});
      (at_left > at_right ? high : low) = at_left > at_right ? right : left;
    }
  }
  return most;
}

// Else what is left for changes of speed has corners, beside which it may be least between two of
// the places that a search looks at.
bool BendsOneWay(const PathPiece& path, const Head& head, std::size_t axis) {
  double low = 0.0, high = 0.0;
  for (int k = 0; k <= kLookedAt; ++k) {
    const double second =
        DerivativesAt(path, head, path.length() * k / kLookedAt).second[static_cast<int>(axis)];
    low = std::min(low, second);
    high = std::max(high, second);
  }
  return low == 0.0 || high == 0.0;
}

AxisLimits StrongAxes() {
  AxisLimits axes;
  axes.speed.fill(1e9);
  axes.acceleration.fill(1e15);
  axes.jerk.fill(1e18);
  return axes;
}

// One axis has no more than these.
struct WeakAxis {
  std::size_t axis;
  double speed, acceleration, jerk;
  AxisShares shares{};
};

// No more than there is, by 1e-9, and no less by more than `room`.
void ExpectLimits(const PathPiece& path, const Head& head, const WeakAxis& weak, double room) {
  AxisLimits axes = StrongAxes();
  axes.speed[weak.axis] = weak.speed;
  axes.acceleration[weak.axis] = weak.acceleration;
  axes.jerk[weak.axis] = weak.jerk;
  const PathLimits limits = WithinAxes(path, head, axes, weak.shares, kAsked);
  const double speed_of_axis = weak.shares.speed * weak.speed;
  const double acceleration = weak.shares.acceleration * weak.acceleration;
  const double jerk = weak.shares.acceleration * weak.jerk;
  const auto first = [&](double s) {
    return std::abs(DerivativesAt(path, head, s).first[weak.axis]);
  };
  const auto second = [&](double s) {
    return std::abs(DerivativesAt(path, head, s).second[weak.axis]);
  };
  const double most_first = MostAlong(path.length(), first);
  const double speed = std::min({kAsked.speed, speed_of_axis / most_first,
                                 std::sqrt(0.5 * acceleration / MostAlong(path.length(), second))});
  // At the speed that was found, whatever it is.
  const double square = limits.speed * limits.speed;
  const double per_acceleration = MostAlong(path.length(), [&](double s) {
    const AxisDerivatives q = DerivativesAt(path, head, s);
    return std::abs(q.first[weak.axis]) / (acceleration - std::abs(q.second[weak.axis]) * square);
  });
  const auto near = [&](const char* what, double got, double exact, double above) {
    EXPECT_LE(got, exact * (1.0 + above)) << what << " of axis " << weak.axis;
    EXPECT_GE(got, exact * (1.0 - room)) << what << " of axis " << weak.axis;
  };
  near("speed", limits.speed, speed, 3e-9);
  near("acceleration", limits.acceleration, std::min(kAsked.acceleration, 1.0 / per_acceleration),
       BendsOneWay(path, head, weak.axis) ? 3e-9 : 1e-3);
  near("jerk", limits.jerk, std::min(kAsked.jerk, jerk / most_first), 3e-9);
}

WeakAxis AnyWeakAxis(Dice& dice) {
  WeakAxis weak{.axis = static_cast<std::size_t>(dice.Uniform(0.0, 4.999)),
                .speed = dice.Chance(0.5) ? 1e9 : dice.Magnitude(0.5, 500.0),
                .acceleration = dice.Magnitude(0.05, 5000.0),
                .jerk = dice.Magnitude(10.0, 40000.0)};
  if (dice.Chance(0.5)) weak.shares = {dice.Uniform(0.1, 1.0), dice.Uniform(0.1, 1.0)};
  return weak;
}

Head AnyHead(Dice& dice) {
  return GantryHead{.length_mm = dice.Magnitude(1.0, 300.0),
                    .tool = {dice.Uniform(-30.0, 30.0), dice.Uniform(-30.0, 30.0), 0.4}};
}

// Turns of more than 0.064 rad are searched, or known from their ends, to 1e-9.
// Shorter ones need be no better than 1 %.
TEST(AxisExtremes, OfAnyLineAreMetToTheLastDigits) {
  Dice dice(1107);
  for (int round = 0; round < 240; ++round) {
    SCOPED_TRACE(round);
    const bool far = dice.Chance(0.8);
    const double turn = far ? dice.Magnitude(0.15, 4.0) : dice.Magnitude(1e-4, 0.06);
    const double share = dice.Uniform(0.0, 1.0);
    const TipPose from{{0, 0, 0}, dice.Uniform(-3.2, 3.2), dice.Uniform(-2.0, 2.0)};
    const TipPose to{dice.Direction() * dice.Magnitude(0.5, 300.0),
                     from.a_rad + (dice.Chance(0.5) ? 1.0 : -1.0) * share * turn,
                     from.b_rad + (dice.Chance(0.5) ? 1.0 : -1.0) * (1.0 - share) * turn};
    ExpectLimits(PathPiece::Line(from, to), AnyHead(dice), AnyWeakAxis(dice), far ? 3e-9 : 0.01);
  }
}

// One angle turns through the place where the column is thrown fastest, or just
// not to it: the peak lies anywhere, also right beside an end.
TEST(AxisExtremes, PeaksBesideAnEndAreMet) {
  Dice dice(1109);
  for (int round = 0; round < 240; ++round) {
    SCOPED_TRACE(round);
    const double turn = dice.Magnitude(0.08, 2.5) * (dice.Chance(0.5) ? 1.0 : -1.0);
    const double beside = dice.Magnitude(1e-4, 0.6) * (dice.Chance(0.5) ? 1.0 : -1.0);
    const double share = dice.Chance(0.5) ? beside : 1.0 - beside;
    const double quarters = std::floor(dice.Uniform(-2.0, 3.0)) * 0.5 * kPi;
    const double begin = quarters - share * turn;
    const double still = dice.Uniform(-1.5, 1.5);
    const bool a = dice.Chance(0.5);
    const TipPose from{{0, 0, 0}, a ? begin : still, a ? still : begin};
    const TipPose to{dice.Direction() * dice.Magnitude(1.0, 300.0), a ? begin + turn : still,
                     a ? still : begin + turn};
    const Head head = GantryHead{.length_mm = dice.Magnitude(1.0, 300.0)};
    ExpectLimits(PathPiece::Line(from, to), head, AnyWeakAxis(dice), 3e-9);
  }
}

// The same about a tip that stands, and on arcs, whose bend is the axes' too.
TEST(AxisExtremes, OfArcsAndOfTurnsAboutTheTipAreMet) {
  Dice dice(1117);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    const double turn = dice.Magnitude(0.08, 4.0);
    const TipPose from{{0, 0, 0}, dice.Uniform(-3.2, 3.2), dice.Uniform(-2.0, 2.0)};
    const double a = from.a_rad + turn * dice.Uniform(-1.0, 1.0);
    const double b = from.b_rad + turn * (dice.Chance(0.5) ? 1.0 : -1.0);
    const MachineVector out = dice.Direction(), beside = dice.Direction();
    const MachineVector normal = out.cross(beside) * (1.0 / out.cross(beside).norm());
    const PathPiece path = dice.Chance(0.6)
                               ? PathPiece::Circle(from, out * dice.Magnitude(1.0, 300.0), normal,
                                                   dice.Magnitude(0.05, 12.0), a, b)
                               : PathPiece::Line(from, {{0, 0, 0}, a, b});
    ExpectLimits(path, AnyHead(dice), AnyWeakAxis(dice), 3e-9);
  }
}

// What is asked is near what the axes have, so that bounds of both angles together say whether they
// need be looked at one by one.
TEST(AxisExtremes, NoAxisIsAskedForMoreThanItHas) {
  Dice dice(1123);
  for (int round = 0; round < 400; ++round) {
    SCOPED_TRACE(round);
    AxisLimits axes = StandardMachine().axes;
    if (dice.Chance(0.5)) {  // then it is the bend that decides
      axes.speed *= 4.0;
      axes.jerk *= 10.0;
    }
    const TipPose from{{0, 0, 0}, dice.Uniform(-3.0, 3.0), dice.Uniform(-2.0, 2.0)};
    const double turn = dice.Magnitude(0.002, 0.6);
    const double a = from.a_rad + turn * (dice.Chance(0.5) ? 1.0 : -1.0);
    const double b = from.b_rad + turn * dice.Uniform(0.9, 1.1);
    const MachineVector way = dice.Direction() * dice.Magnitude(5.0, 300.0);
    const PathPiece path =
        dice.Chance(0.7)
            ? PathPiece::Line(from, {way, a, b})
            : PathPiece::Circle(from, way, MachineVector{way.y(), -way.x(), 0.0}.normalized(), 1.0,
                                a, b);
    const PathLimits asked{dice.Magnitude(50.0, 500.0), dice.Magnitude(30.0, 2000.0),
                           dice.Magnitude(1e4, 4e4)};
    const Head head = GantryHead{};
    const PathLimits limits = WithinAxes(path, head, axes, {}, asked);
    for (int k = 0; k <= 200; ++k) {
      const AxisDerivatives q = DerivativesAt(path, head, path.length() * k / 200.0);
      for (int i = 0; i < kAxisCount; ++i) {
        const double along = std::abs(q.first[i]), across = std::abs(q.second[i]);
        ASSERT_LE(along * limits.speed, axes.speed[i] * (1.0 + 1e-8)) << i;
        ASSERT_LE(across * limits.speed * limits.speed, 0.5 * axes.acceleration[i] * (1.0 + 1e-8));
        ASSERT_LE(across * limits.speed * limits.speed + along * limits.acceleration,
                  axes.acceleration[i] * (1.0 + 1e-3));
        ASSERT_LE(along * limits.jerk, axes.jerk[i] * (1.0 + 1e-8)) << i;
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion
