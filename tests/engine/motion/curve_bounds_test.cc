// What is known of a corner curve without looking along it: bounds from its control points, and
// with them whether the axes follow. motion.md 4.2, 4.3.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/motion/corner/corner.h"
#include "engine/motion/geometry/corner_curve.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

CurveEnd RandomEnd(Dice& dice) {
  return {.pose = {dice.Direction() * dice.Magnitude(0.1, 50.0), dice.Uniform(-3, 3),
                   dice.Uniform(-2, 2)},
          .tangent = dice.Direction(),
          .curvature = dice.Direction() * dice.Magnitude(0.01, 2.0),
          .a_rate = dice.Uniform(-0.5, 0.5),
          .b_rate = dice.Uniform(-0.5, 0.5)};
}

// The curve as a Bezier curve of degree five: its ends say where the control points lie, and the
// differences of those are the control points of its derivatives.
template <class T>
struct Controls {
  std::array<T, 5> first;
  std::array<T, 4> second;
  Controls(const T& p0, const T& p1, const T& v0, const T& v1, const T& c0, const T& c1) {
    const std::array<T, 6> p{
        p0, p0 + v0 * 0.2, p0 + v0 * 0.4 + c0 * 0.05, p1 - v1 * 0.4 + c1 * 0.05, p1 - v1 * 0.2, p1};
    for (std::size_t k = 0; k < 5; ++k) first[k] = (p[k + 1] - p[k]) * 5.0;
    for (std::size_t k = 0; k < 4; ++k) second[k] = (first[k + 1] - first[k]) * 4.0;
  }
};

template <std::size_t N>
double Largest(const std::array<double, N>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

// Each bound is the extreme of the control points: of the speed from below along the bisector of
// the tangents.
TEST(CurveBounds, AreThoseOfTheControlPoints) {
  Dice dice(3);
  for (int round = 0; round < 300; ++round) {
    const CurveEnd from = RandomEnd(dice), to = RandomEnd(dice);
    const double cut = dice.Magnitude(0.1, 10.0);
    const double scale =
        2.0 * std::sqrt(std::sqrt(0.5 * (1.0 + from.tangent.dot(to.tangent)))) * cut;
    const Controls<MachinePoint> tip(from.pose.point, to.pose.point, from.tangent * scale,
                                     to.tangent * scale, from.curvature * (scale * scale),
                                     to.curvature * (scale * scale));
    const Controls<double> a(from.pose.a_rad, to.pose.a_rad, from.a_rate * scale, to.a_rate * scale,
                             0.0, 0.0);
    const Controls<double> b(from.pose.b_rad, to.pose.b_rad, from.b_rate * scale, to.b_rate * scale,
                             0.0, 0.0);
    const MachineVector bisector = from.tangent + to.tangent;
    double slowest = HUGE_VAL, second = 0.0;
    for (const MachinePoint& control : tip.first) {
      slowest = std::min(slowest, control.dot(bisector) / bisector.norm());
    }
    for (const MachinePoint& control : tip.second) second = std::max(second, control.norm());
    const CornerCurve::Bounds bounds = CornerCurve(from, to, cut).DerivativeBounds();
    const double room = 1e-9 * (1.0 + second);
    ASSERT_NEAR(bounds.slowest, slowest, room) << round;
    ASSERT_NEAR(bounds.tip_second, second, room) << round;
    ASSERT_NEAR(bounds.a_first, Largest(a.first), room) << round;
    ASSERT_NEAR(bounds.b_first, Largest(b.first), room) << round;
    ASSERT_NEAR(bounds.a_second, Largest(a.second), room) << round;
    ASSERT_NEAR(bounds.b_second, Largest(b.second), room) << round;
  }
}

// The short cut of 4.3 says yes up to the bounds themselves, for each figure of each axis: the tip
// at 1 mm for each mm of way, what turns by its bound, and the column by the arm besides.
TEST(AxesFollow, UpToTheBoundsThemselves) {
  const CurveEnd from{
      .pose = {{-4, 0, 0}, 0.1, 0.2}, .tangent = {1, 0, 0}, .a_rate = 0.01, .b_rate = -0.02};
  const CurveEnd to{.pose = {{3.2, 2.4, 0}, 0.15, 0.1},
                    .tangent = {0.8, 0.6, 0},
                    .a_rate = 0.02,
                    .b_rate = -0.005};
  const CornerCurve curve(from, to, 4.0);
  const CornerCurve::Bounds by_u = curve.DerivativeBounds();
  const double per_mm = 1.0 / by_u.slowest;
  const double a = by_u.a_first * per_mm, b = by_u.b_first * per_mm;
  // d2/ds2 = (d2/du2 - d/ds (p' p'')/|p'|) / |p'|^2, each term as large as it may be.
  const double stretch = by_u.tip_second * per_mm;
  const double aa = (by_u.a_second + by_u.a_first * stretch) * per_mm * per_mm;
  const double bb = (by_u.b_second + by_u.b_first * stretch) * per_mm * per_mm;
  constexpr double kSpeed = 16.0, kBend = 0.125, kArm = 32.0;
  const double column = 1.0 + kArm * (a + b);
  const double bent = kBend + kArm * (aa + bb + (a + b) * (a + b));
  const std::array<double, 5> speeds{column, column, column, a, b};
  const std::array<double, 5> bends{bent, bent, bent, aa, bb};
  const auto follow = [&](std::size_t axis, double speed_room, double bend_room) {
    MachineLimits machine;
    machine.axes.speed.fill(1e9);
    machine.axes.acceleration.fill(1e9);
    machine.axes.speed[axis] = speeds[axis] * kSpeed * speed_room;
    machine.axes.acceleration[axis] = bends[axis] * (kSpeed * kSpeed) * bend_room;
    return AxesFollow(curve, GantryHead{.length_mm = kArm}, machine, kSpeed, kBend);
  };
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    EXPECT_TRUE(follow(axis, 1.0, 1.0)) << axis;
    EXPECT_FALSE(follow(axis, 1.0 - 1e-12, 1.0)) << axis;
    EXPECT_FALSE(follow(axis, 1.0, 1.0 - 1e-12)) << axis;
  }
  // A curve that turns back has no bound of its speed from below: nothing is known.
  const CornerCurve back({.pose = {{0, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {}},
                         {.pose = {{-40, 1, 0}, 0, 0}, .tangent = {0.8, 0.6, 0}, .curvature = {}},
                         4.0);
  ASSERT_LT(back.DerivativeBounds().slowest, 0.0);
  MachineLimits strong;
  strong.axes.speed.fill(1e9);
  strong.axes.acceleration.fill(1e9);
  EXPECT_FALSE(AxesFollow(back, GantryHead{}, strong, 1.0, 0.0));
}

// The place where the parameter moves slowest, of curves beside arcs of all kinds: no place of a
// dense search is slower.
TEST(CornerCurve, SlowestPlaceIsTheSlowest) {
  Dice dice(5);
  int inside = 0;
  for (int round = 0; round < 400; ++round) {
    const double cut = 1.0, turn = dice.Uniform(0.0, 2.9);
    const double bend = dice.Uniform(-0.9, 0.9), bend_out = dice.Uniform(-0.9, 0.9);
    const CurveEnd from{
        .pose = {{-1, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {0, bend, 0}};
    const MachineVector out{std::cos(turn), std::sin(turn), 0};
    const CurveEnd to{.pose = {out, 0, 0},
                      .tangent = out,
                      .curvature = MachineVector{-out.y(), out.x(), 0} * bend_out};
    const CornerCurve curve(from, to, cut);
    const double place = curve.SlowestPlace();
    ASSERT_TRUE(place >= 0.0 && place <= 1.0) << round << " at " << place;
    double slowest = HUGE_VAL;
    for (int k = 0; k <= 800; ++k) slowest = std::min(slowest, curve.Speed(k / 800.0));
    ASSERT_LE(curve.Speed(place), slowest * (1 + 1e-6)) << round << " at " << place;
    if (place > 0.0 && place < 1.0) ++inside;
  }
  EXPECT_GT(inside, 50);
  EXPECT_LT(inside, 400);
}

// With every length times c the slowest place stays where it is, and the distance from a point is c
// times as great. motion.md 10, property 6
TEST(CornerCurve, PlacesAreAlikeAtEveryScale) {
  const auto of = [](double turn, double scale) {
    const MachineVector out{std::cos(turn), std::sin(turn), 0};
    return CornerCurve(
        {.pose = {{-scale, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {0, 0.6 / scale, 0}},
        {.pose = {out * scale, 0, 0},
         .tangent = out,
         .curvature = MachineVector{-out.y(), out.x(), 0} * (-0.4 / scale)},
        scale);
  };
  const MachinePoint beside{0.1, -0.35, 0.2};
  for (const double turn : {0.7, 1.9, 2.6}) {
    const CornerCurve curve = of(turn, 1.0);
    for (const double scale : {1e-4, 1e-2, 1e3}) {
      const CornerCurve scaled = of(turn, scale);
      EXPECT_NEAR(scaled.SlowestPlace(), curve.SlowestPlace(), 1e-9) << turn << " " << scale;
      EXPECT_NEAR(scaled.DistanceFrom(beside * scale) / scale, curve.DistanceFrom(beside), 1e-9)
          << turn << " " << scale;
    }
  }
}

// Slow at both ends, and slower still at one narrow place between them. With w = u - 1/2 and a
// scale of 1 the curve goes along X at 1/16 + 7.5 w^2 - 15 w^4 and along Y at 128 w (2 w^2 - 1/2):
// so at 1 at its ends, at 1/16 in its middle, and 0.02 beside that at more than 1 again.
TEST(CornerCurve, SlowestPlaceBetweenSlowEnds) {
  const CornerCurve curve(
      {.pose = {{0, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {0, 128, 0}},
      {.pose = {{0.5, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {0, 128, 0}}, 0.5);
  EXPECT_NEAR(curve.Speed(0.0), 1.0, 1e-9);
  EXPECT_NEAR(curve.Speed(0.5), 0.0625, 1e-9);
  EXPECT_GT(curve.Speed(0.48), 1.0);
  EXPECT_NEAR(curve.SlowestPlace(), 0.5, 1e-9);
}

}  // namespace
}  // namespace rmlcell::motion
