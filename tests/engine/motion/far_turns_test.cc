// Paths that turn farther than any travel, whose limits are those of bounds, and rates of exactly
// one. motion.md 2.4, 3.5, 5.1
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/corner/bend_speed.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "tests/engine/motion/expect_near.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr PathLimits kWhatever{.speed = 1e6, .acceleration = 1e9, .jerk = 1e12};

// One axis has these, the others do not lack anything.
AxisLimits OnlyWeak(std::size_t axis, double speed, double acceleration, double jerk) {
  AxisLimits axes;
  axes.speed.fill(1e12);
  axes.acceleration.fill(1e15);
  axes.jerk.fill(1e18);
  axes.speed[axis] = speed;
  axes.acceleration[axis] = acceleration;
  axes.jerk[axis] = jerk;
  return axes;
}

struct MostAsked {
  double along, across;  // the most of |q'| and of |q''|
};

// V <= V_i/|q'|, V <= sqrt(0.5 A_i/|q''|), a <= (A_i - |q''| V^2)/|q'|, j <= J_i/|q'|: where the
// most of both comes together a bound is the limit itself.
void ExpectLimitsOf(const PathPiece& path, const Head& head, std::size_t axis,
                    const MostAsked& asked) {
  SCOPED_TRACE(axis);
  const auto limits = [&](double speed, double acceleration, double jerk) {
    return WithinAxes(path, head, OnlyWeak(axis, speed, acceleration, jerk), {}, kWhatever);
  };
  const PathLimits by_speed = limits(7.0, 1e15, 1e18);
  EXPECT_NEAR(by_speed.speed, std::min(1e6, 7.0 / asked.along), 1e-9 * by_speed.speed);
  const PathLimits by_jerk = limits(1e12, 1e15, 900.0);
  EXPECT_NEAR(by_jerk.jerk, std::min(1e12, 900.0 / asked.along), 1e-9 * by_jerk.jerk);
  const PathLimits bent = limits(1e12, 50.0, 1e18);
  EXPECT_NEAR(bent.speed, std::min(1e6, std::sqrt(25.0 / asked.across)), 1e-9 * bent.speed);
  const double taken = asked.across * bent.speed * bent.speed;
  EXPECT_NEAR(bent.acceleration, std::min(1e9, (50.0 - taken) / asked.along),
              1e-9 * bent.acceleration);
  // Slow: the bend takes less than half.
  const PathLimits slow = limits(0.5 * asked.along * bent.speed, 50.0, 1e18);
  EXPECT_NEAR(slow.speed, 0.5 * bent.speed, 1e-9 * slow.speed);
  EXPECT_NEAR(slow.acceleration,
              std::min(1e9, (50.0 - asked.across * slow.speed * slow.speed) / asked.along),
              1e-9 * slow.acceleration);
}

// Twelve turns of a circle of 40 mm that is tilted about X: X goes all of it, Y and Z the cosine
// and the sine of the tilt.
TEST(FarTurns, OfATiltedCircle) {
  const PathPiece path =
      PathPiece::Circle({{40, 0, 0}}, {}, {0.0, -0.6, 0.8}, 12.0 * kTurn, 0.0, 0.0);
  ExpectLimitsOf(path, MillHead{}, 0, {1.0, 1.0 / 40.0});
  ExpectLimitsOf(path, MillHead{}, 1, {0.8, 0.8 / 40.0});
  ExpectLimitsOf(path, MillHead{}, 2, {0.6, 0.6 / 40.0});
}

// In a plane across an axis that axis does nothing.
TEST(FarTurns, OfACircleAcrossAnAxis) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    MachineVector normal, out;
    normal[static_cast<int>(axis)] = 1.0;
    out[static_cast<int>((axis + 1) % 3)] = 30.0;
    const PathPiece path = PathPiece::Circle({out}, {}, normal, 12.0 * kTurn, 0.0, 0.0);
    const PathLimits limits =
        WithinAxes(path, MillHead{}, OnlyWeak(axis, 1e-3, 1e-3, 1e-3), {}, kWhatever);
    EXPECT_EQ(limits.speed, kWhatever.speed) << axis;
    EXPECT_EQ(limits.acceleration, kWhatever.acceleration) << axis;
    EXPECT_EQ(limits.jerk, kWhatever.jerk) << axis;
  }
}

// A turns twelve times on 200 mm with the head lying: the column goes round the tip, 250 mm off, by
// 12 turns/200 mm, and along X with the tip as well.
TEST(FarTurns, OfALyingHead) {
  const PathPiece path =
      PathPiece::Line({{0, 0, 0}, 1.0, kPi / 2}, {{-200, 0, 0}, 1.0 + 12.0 * kTurn, kPi / 2});
  const Head head = GantryHead{.length_mm = 250.0};
  const double rate = 12.0 * kTurn / 200.0;
  ExpectLimitsOf(path, head, 0, {1.0 + 250.0 * rate, 250.0 * rate * rate});
  ExpectLimitsOf(path, head, 1, {250.0 * rate, 250.0 * rate * rate});
  ExpectLimitsOf(path, head, 3, {rate, 0.0});
}

// B turns backwards; and of both the sum is what the column may be thrown by at most.
TEST(FarTurns, OfBAndOfBoth) {
  const Head head = GantryHead{.length_mm = 250.0};
  const double rate = 12.0 * kTurn / 200.0;
  const PathPiece b =
      PathPiece::Line({{0, 0, 0}, 0.0, 1.0}, {{0, 0, -200}, 0.0, 1.0 - 12.0 * kTurn});
  ExpectLimitsOf(b, head, 2, {1.0 + 250.0 * rate, 250.0 * rate * rate});
  ExpectLimitsOf(b, head, 1, {250.0 * rate, 250.0 * rate * rate});
  ExpectLimitsOf(b, head, 4, {rate, 0.0});
  const PathPiece both =
      PathPiece::Line({{0, 0, 0}, 0.0, 1.0}, {{0, 200, 0}, 6.0 * kTurn, 1.0 - 6.0 * kTurn});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double along = 0.0, across = 0.0;
    for (int k = 0; k <= 20000; ++k) {
      const AxisDerivatives q = DerivativesAt(both, head, 0.01 * k);
      along = std::max(along, std::abs(q.first[axis]));
      across = std::max(across, std::abs(q.second[axis]));
    }
    const PathLimits limits =
        WithinAxes(both, head, OnlyWeak(axis, 7.0, 1e15, 900.0), {}, kWhatever);
    const double most = (axis == 1 ? 1.0 : 0.0) + 250.0 * rate;
    EXPECT_LE(limits.speed, 7.0 / along) << axis;
    EXPECT_GE(limits.speed, 7.0 / most * (1 - 1e-9)) << axis;
    EXPECT_LE(limits.jerk, 900.0 / along) << axis;
    EXPECT_GE(limits.jerk, 900.0 / most * (1 - 1e-9)) << axis;
    const PathLimits bent = WithinAxes(both, head, OnlyWeak(axis, 1e12, 50.0, 1e18), {}, kWhatever);
    EXPECT_LE(bent.speed, std::sqrt(25.0 / across)) << axis;
    EXPECT_GE(bent.speed, std::sqrt(25.0 / (250.0 * rate * rate)) * (1 - 1e-9)) << axis;
  }
}

// On a circle while the head turns the bends of both add up: what the axis is asked for in the bend
// is no more than it has, and no less than where both come together.
TEST(FarTurns, OfACircleWhileTheHeadTurns) {
  const Head head = GantryHead{.length_mm = 0.3};
  const PathPiece flat =
      PathPiece::Circle({{40, 0, 0}, 0.0, kPi / 2}, {}, {0, 0, 1}, kTurn, 70.0, kPi / 2);
  const PathPiece upright =
      PathPiece::Circle({{0, 40, 0}, 0.0, -35.0}, {}, {1, 0, 0}, kTurn, 0.0, 35.0);
  const double rate = 70.0 / (40.0 * kTurn), whirl = 0.3 * rate * rate;
  for (const auto& [path, axis] :
       {std::pair{&flat, 0U}, {&flat, 1U}, {&upright, 1U}, {&upright, 2U}}) {
    double across = 0.0;
    for (int k = 0; k <= 20000; ++k)
      across = std::max(
          across, std::abs(DerivativesAt(*path, head, path->length() * k / 2e4).second[axis]));
    ASSERT_GT(across, 1.5 * std::max(whirl, 1.0 / 40.0));
    const double speed =
        WithinAxes(*path, head, OnlyWeak(axis, 1e12, 50.0, 1e18), {}, kWhatever).speed;
    EXPECT_LE(speed, std::sqrt(25.0 / across)) << axis;
    EXPECT_GE(speed, std::sqrt(25.0 / (1.0 / 40.0 + whirl)) * (1 - 1e-9)) << axis;
  }
}

// Without a limit on jerk none comes from the axes.
TEST(FarTurns, OfTrapezoids) {
  const PathPiece path = PathPiece::Circle({{40, 0, 0}}, {}, {0, 0, 1}, 12.0 * kTurn, 0.0, 0.0);
  const PathLimits limits = WithinAxes(path, MillHead{}, OnlyWeak(0, 1e12, 1e15, 1e-3), {},
                                       {.speed = 1e3, .acceleration = 1e3});
  EXPECT_TRUE(std::isinf(limits.jerk));
  // Nor where the head turns a little, and some places tell it.
  const PathPiece little = PathPiece::Line({{0, 0, 0}, 0.0, 1.0}, {{100, 0, 0}, 0.01, 1.0});
  const PathLimits slow = WithinAxes(little, GantryHead{}, OnlyWeak(0, 10.0, 1e15, 1e-3), {},
                                     {.speed = 1e3, .acceleration = 1e3});
  EXPECT_LT(slow.speed, 10.5);
  EXPECT_TRUE(std::isinf(slow.jerk));
}

// A head that turns by one radian for each millimetre throws the column as any other rate does.
TEST(RatesOfOne, ThrowTheColumnToo) {
  const Head head = GantryHead{.length_mm = 300.0};
  // Lying at A = 0 the head points to -Y: A turns the column along X.
  const PathPiece a = PathPiece::Line({{0, 0, 0}, 0.0, kPi / 2}, {{0, 1, 0}, 1.0, kPi / 2});
  EXPECT_EQ(a.a_rate(), 1.0);
  EXPECT_NEAR(DerivativesAt(a, head, 0.0).first[0], 300.0, 1e-9);
  EXPECT_NEAR(DerivativesAt(a, head, 0.0).second[1], 300.0, 1e-9);
  EXPECT_EQ(DerivativesAt(a, head, 0.0).first[3], 1.0);
  // Upright B turns it along -Y, and downwards from there.
  const PathPiece b = PathPiece::Line({{0, 0, 0}, 0.0, 0.0}, {{1, 0, 0}, 0.0, 1.0});
  EXPECT_EQ(b.b_rate(), 1.0);
  EXPECT_NEAR(DerivativesAt(b, head, 0.0).first[1], -300.0, 1e-9);
  EXPECT_NEAR(DerivativesAt(b, head, 0.0).second[2], -300.0, 1e-9);
  EXPECT_EQ(DerivativesAt(b, head, 0.0).first[4], 1.0);
  // On an arc as well.
  const PathPiece arc =
      PathPiece::Circle({{0, -5, 0}, 0.0, kPi / 2}, {}, {0, 0, 1}, 0.2, 1.0, kPi / 2);
  EXPECT_NEAR(DerivativesAt(arc, head, 0.0).first[0], 1.0 + 300.0 * arc.a_rate(), 1e-9);
}

// Nor do the limits of a move take it for one that stands.
TEST(RatesOfOne, AreLimitsOfTheMove) {
  const Head head = GantryHead{.length_mm = 300.0};
  const PathPiece a = PathPiece::Line({{0, 0, 0}, -1.0, kPi / 2}, {{0, 2, 0}, 1.0, kPi / 2});
  ASSERT_EQ(a.a_rate(), 1.0);
  const PathPiece b = PathPiece::Line({{0, 0, 0}, 0.0, -1.0}, {{2, 0, 0}, 0.0, 1.0});
  ASSERT_EQ(b.b_rate(), 1.0);
  // In the middle the column goes 300 mm for each: X with A, -Y with B.
  const PathLimits asked{.speed = 1e6, .acceleration = 1e9, .jerk = 1e12};
  EXPECT_NEAR(WithinAxes(a, head, OnlyWeak(0, 60.0, 1e15, 1e18), {}, asked).speed, 0.2, 1e-8);
  EXPECT_NEAR(WithinAxes(b, head, OnlyWeak(1, 60.0, 1e15, 1e18), {}, asked).speed, 0.2, 1e-8);
  EXPECT_NEAR(head.Rates(0.0, kPi / 2, {{0, 1, 0}, 1.0, 0.0})[0], 300.0, 1e-9);
  EXPECT_NEAR(head.Rates(0.0, 0.0, {{1, 0, 0}, 0.0, 1.0})[1], -300.0, 1e-9);
  const AxisValues steady = head.Rates(0.3, 0.4, {{1, 2, 3}, 0.0, 0.0});
  for (int axis = 0; axis < kAxisCount; ++axis)
    EXPECT_EQ(steady[axis], axis < 3 ? axis + 1.0 : 0.0) << axis;
}

// A jerk that is less than the speed: a dip to 9 behind a start at 10 mm/s is the speed of the
// whole bend, for any ramp from 10 is above it.
TEST(BendRampEnds, ADipCountsAtAJerkBelowTheSpeed) {
  BendSpeeds speeds;
  for (std::size_t k = 0; k < speeds.most.size(); ++k)
    speeds.most[k] = std::clamp(7.0 + static_cast<double>(k), 10.0, 20.0);
  speeds.most[2] = 9.0;
  const BendStretches bend = StretchesOf(speeds, 2.4, {.acceleration = 1e9, .jerk = 5.0});
  EXPECT_EQ(bend.count, 1U);
  EXPECT_EQ(bend.start, 9.0);
  EXPECT_EQ(bend.open, 9.0);
}

}  // namespace
}  // namespace rmlcell::motion
