// The curve of a bend by itself: its bounds, its length, its sharpest place. motion.md 4.2, 4.3, 9.
#include "engine/motion/geometry/corner_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "engine/motion/corner/corner.h"
#include "engine/motion/geometry/blend_curve.h"
#include "engine/motion/geometry/least.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "tests/engine/motion/expect_near.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

PlainCorner PlainAt(double degrees, double cut) {
  const double turn = degrees * kRadPerDegree;
  return {.at = {{7, -2, 3}, 0.4, -0.3},
          .tangent_in = {1, 0, 0},
          .tangent_out = {std::cos(turn), 0, std::sin(turn)},
          .cut_mm = cut};
}

// Two lines between which the head turns in other ways.
CornerCurve Turning(double degrees, double cut) {
  const double turn = degrees * kRadPerDegree;
  const PathPiece in = PathPiece::Line({{-50, 0, 0}, 0.1, 0.6}, {{0, 0, 0}, 0.4, 0.8});
  const PathPiece out = PathPiece::Line({{0, 0, 0}, 0.4, 0.8},
                                        {{50 * std::cos(turn), 50 * std::sin(turn), 0}, -0.1, 0.3});
  return CornerCurve(EndAt(in, 50.0 - cut), EndAt(out, cut), cut);
}

// Eight nodes of Gauss and Legendre, the two at equal distances from the middle together: to the
// last digit what Speed gives there, since places by length, and with them plans, hang on it.
TEST(CornerCurve, ItsLengthIsMadeOfItsSpeeds) {
  constexpr std::array kNodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                              0.9602898564975363};
  constexpr std::array kWeights{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                0.1012285362903763};
  for (const CornerCurve& curve :
       {CornerCurve(PlainAt(75.0, 0.7)), Turning(40.0, 1.3), Turning(130.0, 0.02)}) {
    for (const double to : {0.01, 0.3, 0.77, 1.0}) {
      const double from = 0.1 * to;
      const double middle = 0.5 * (from + to);
      const double half = 0.5 * (to - from);
      double sum = 0.0;
      for (std::size_t k = 0; k < kNodes.size(); ++k) {
        sum += kWeights[k] *
               (curve.Speed(middle - half * kNodes[k]) + curve.Speed(middle + half * kNodes[k]));
      }
      EXPECT_EQ(curve.Integral(from, to), half * sum) << to;
    }
  }
}

// p(u) of 4.2 in its Hermite form, at u = 1/2: p0/2 + p1/2 + (5/32)(v0 - v1) + (c0 + c1)/64.
TEST(CornerCurve, MiddleOfTheHermiteForm) {
  const CurveEnd from{.pose = {{1, 2, 3}, 0.5, -0.5},
                      .tangent = {1, 0, 0},
                      .curvature = {0, 0.2, 0.1},
                      .a_rate = 0.03,
                      .b_rate = -0.01};
  const CurveEnd to{.pose = {{4, 6, 3.5}, 0.9, -0.2},
                    .tangent = {0, 0.6, 0.8},
                    .curvature = {0.3, 0, -0.1},
                    .a_rate = -0.05,
                    .b_rate = 0.02};
  const CornerCurve curve(from, to, 2.5);
  const double scale = 2.5 * 2.0 * std::sqrt(std::sqrt(0.5));  // 90 degrees
  const PathPose middle = curve.At(0.5);
  ExpectNear(middle.point,
             (from.pose.point + to.pose.point) * 0.5 +
                 (from.tangent - to.tangent) * (scale * 5.0 / 32.0) +
                 (from.curvature + to.curvature) * (scale * scale / 64.0),
             1e-12);
  EXPECT_NEAR(middle.a_rad, 0.7 + 5.0 / 32.0 * scale * 0.08, 1e-12);
  EXPECT_NEAR(middle.b_rad, -0.35 - 5.0 / 32.0 * scale * 0.03, 1e-12);
  // The slope there: 15/8 (p1 - p0) - 7/16 (v0 + v1) + (c1 - c0)/32.
  ExpectNear(curve.Derivative(0.5, 1).point,
             (to.pose.point - from.pose.point) * 1.875 -
                 (from.tangent + to.tangent) * (0.4375 * scale) +
                 (to.curvature - from.curvature) * (scale * scale / 32.0),
             1e-12);
}

// A corner of two lines made from the corner is that made from the cut points.
TEST(CornerCurve, PlainIsTheSameCurve) {
  for (const double degrees : {1.0, 90.0, 170.0}) {
    const PlainCorner corner = PlainAt(degrees, 2.0);
    const CornerCurve plain(corner);
    const CornerCurve ends(
        {.pose = corner.Start(), .tangent = corner.tangent_in, .curvature = {}},
        {.pose = corner.Finish(), .tangent = corner.tangent_out, .curvature = {}}, 2.0);
    ExpectNear(corner.Start().point, {5, -2, 3}, 1e-12);
    ExpectNear(corner.Finish().point, corner.at.point + corner.tangent_out * 2.0, 1e-12);
    for (const double u : {0.0, 0.2, 0.5, 0.9, 1.0}) {
      ExpectNear(plain.At(u).point, ends.At(u).point, 1e-12);
      ExpectNear(plain.SecondByLength(u).point, ends.SecondByLength(u).point, 1e-11);
      EXPECT_EQ(plain.At(u).a_rad, 0.4);
      EXPECT_EQ(plain.At(u).b_rad, -0.3);
      EXPECT_EQ(plain.HeadAt(u).a_rad, 0.4);
      EXPECT_EQ(plain.HeadAt(u).b_rad, -0.3);
    }
    EXPECT_FALSE(plain.in_axes());
  }
}

// Derivatives by arc length against differences along it; path jerk is |p'''| at speed 1 in a
// plane.
TEST(CornerCurve, DerivativesByLength) {
  const CornerCurve curve = Turning(70.0, 4.0);
  const CornerLength length(curve);
  const double h = 1e-3;
  for (const double share : {0.2, 0.5, 0.83}) {
    const auto at = [&](double d) {
      return curve.At(length.ParameterAt(curve, share * length.total() + d));
    };
    const double u = length.ParameterAt(curve, share * length.total());
    const PathDerivatives first = curve.FirstByLength(u), second = curve.SecondByLength(u);
    ExpectNear(first.point, (at(h).point - at(-h).point) * (0.5 / h), 1e-6);
    EXPECT_NEAR(first.a, (at(h).a_rad - at(-h).a_rad) * (0.5 / h), 1e-6);
    EXPECT_NEAR(first.b, (at(h).b_rad - at(-h).b_rad) * (0.5 / h), 1e-6);
    ExpectNear(second.point, (at(h).point - at(0).point * 2.0 + at(-h).point) * (1.0 / (h * h)),
               1e-5);
    EXPECT_NEAR(second.a, (at(h).a_rad - 2 * at(0).a_rad + at(-h).a_rad) / (h * h), 1e-5);
    EXPECT_NEAR(second.b, (at(h).b_rad - 2 * at(0).b_rad + at(-h).b_rad) / (h * h), 1e-5);
    const double q = 5e-3;
    const MachineVector third =
        (at(3 * q).point - at(q).point * 3.0 + at(-q).point * 3.0 - at(-3 * q).point) *
        (1.0 / (8 * q * q * q));
    EXPECT_NEAR(curve.JerkPerCube(u), third.norm(), 1e-3 * third.norm());
  }
}

// Bounds of the derivatives by u hold all along, and are met at an end or nearly.
TEST(CornerCurve, BoundsHold) {
  for (const double degrees : {0.5, 20.0, 60.0, 100.0}) {
    const CornerCurve curve = Turning(degrees, 5.0);
    const CornerCurve::Bounds bounds = curve.DerivativeBounds();
    double slowest = HUGE_VAL, tip = 0.0, a1 = 0.0, b1 = 0.0, a2 = 0.0, b2 = 0.0;
    for (int k = 0; k <= 2000; ++k) {
      const PathDerivatives first = curve.Derivative(k / 2000.0, 1);
      const PathDerivatives second = curve.Derivative(k / 2000.0, 2);
      slowest = std::min(slowest, first.point.norm());
      tip = std::max(tip, second.point.norm());
      a1 = std::max(a1, std::abs(first.a));
      b1 = std::max(b1, std::abs(first.b));
      a2 = std::max(a2, std::abs(second.a));
      b2 = std::max(b2, std::abs(second.b));
    }
    const auto above = [&](double bound, double seen) {
      EXPECT_GE(bound, seen * (1 - 1e-9)) << degrees;
      EXPECT_LE(bound, 2.0 * seen) << degrees;
    };
    EXPECT_LE(bounds.slowest, slowest * (1 + 1e-9)) << degrees;
    EXPECT_GE(bounds.slowest, (degrees < 30.0 ? 0.8 : 0.1) * slowest) << degrees;
    above(bounds.tip_second, tip);
    above(bounds.a_first, a1);
    above(bounds.b_first, b1);
    above(bounds.a_second, a2);
    above(bounds.b_second, b2);
  }
}

// The highest speed on a curve against a dense search, each limit alone. motion.md 4.3
TEST(SpeedOnCurve, EachLimitAlone) {
  constexpr double kStrong = 1e9;
  const Head head = GantryHead{.length_mm = 250.0, .tool = {4.0, -2.0, 10.0}};
  for (const double degrees : {8.0, 75.0, 140.0}) {
    const CornerCurve curve = Turning(degrees, 6.0);
    MachineLimits strong;
    strong.tip_acceleration_mm_s2 = kStrong;
    strong.tip_jerk_mm_s3 = HUGE_VAL;
    strong.axes.speed.fill(kStrong);
    strong.axes.acceleration.fill(kStrong);
    const auto dense = [&](auto limit) {
      double least = HUGE_VAL;
      for (int k = 0; k <= 20000; ++k) least = std::min(least, limit(k / 20000.0));
      return least;
    };
    const auto expect = [&](const MachineLimits& machine, double want) {
      EXPECT_NEAR(SpeedOnCurve(curve, head, machine), want, 1e-6 * want) << degrees;
      // Who asks whether it is enough, and it is, gets something above that.
      EXPECT_GE(SpeedOnCurve(curve, head, machine, 0.5 * want), 0.5 * want);
      EXPECT_NEAR(SpeedOnCurve(curve, head, machine, 1.01 * want), want, 1e-6 * want);
    };
    MachineLimits machine = strong;
    machine.tip_acceleration_mm_s2 = 2000.0;
    expect(machine, dense([&](double u) {
             return std::sqrt(1600.0 / curve.SecondByLength(u).point.norm());
           }));
    machine = strong;
    machine.tip_jerk_mm_s3 = 40000.0;
    expect(machine, dense([&](double u) { return std::cbrt(32000.0 / curve.JerkPerCube(u)); }));
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      const auto demand = [&](double u) {
        return ThroughHead(head, curve.At(u), curve.FirstByLength(u), curve.SecondByLength(u));
      };
      machine = strong;
      machine.axes.speed[axis] = 10.0;
      expect(machine, dense([&](double u) { return 10.0 / std::abs(demand(u).first[axis]); }));
      machine = strong;
      machine.axes.acceleration[axis] = 70.0;
      expect(machine,
             dense([&](double u) { return std::sqrt(70.0 / std::abs(demand(u).second[axis])); }));
    }
  }
}

// In a bend of the first chain the acceleration of Y has its valley at u = 0.5121, between samples
// at which other limits are lower; in one of the second the jerk has its own at u = 0.9999, beside
// the last sample. Against a dense search about the lowest of 5,001 places. motion.md 4.3
TEST(SpeedOnCurve, ValleyOfOneBesideAnother) {
  const MachineLimits machine = StandardMachine();
  const Head head;
  int bends = 0;
  std::vector<PlannedMotion> motions =
      Plan(RandomChain(34715435417, 20, {.all_fly = true, .longest_mm = 0.1}));
  std::ranges::copy(Plan(RandomChain(1013, 30, {.all_fly = true})), std::back_inserter(motions));
  for (const PlannedMotion& motion : motions) {
    if (motion.path.kind() != PathPiece::Kind::kBlend || motion.path.plain_corner()) continue;
    const CornerCurve& curve = motion.path.curve();
    const auto allowed = [&](double u) {
      const PathDerivatives second = curve.SecondByLength(u);
      const AxisDerivatives q = ThroughHead(head, curve.At(u), curve.FirstByLength(u), second);
      double least = std::min(std::sqrt(1600.0 / second.point.norm()),
                              std::cbrt(32000.0 / curve.JerkPerCube(u)));
      for (std::size_t i = 0; i < kAxisCount; ++i) {
        least = std::min({least, machine.axes.speed[i] / std::abs(q.first[i]),
                          std::sqrt(machine.axes.acceleration[i] / std::abs(q.second[i]))});
      }
      return least;
    };
    double where = 0.0, least = HUGE_VAL;
    for (const double step : {2e-4, 2e-7}) {
      const double middle = step < 1e-4 ? where : 0.5;
      for (int k = -2500; k <= 2500; ++k) {
        const double u = std::clamp(middle + step * k, 0.0, 1.0);
        if (const double here = allowed(u); here < least) {
          least = here;
          where = u;
        }
      }
    }
    EXPECT_NEAR(SpeedOnCurve(curve, head, machine), least, 1e-9 * least) << where;
    ++bends;
  }
  EXPECT_GE(bends, 10);
}

// The short cut may only say yes where it is so, for each figure of each axis; and it does say yes
// where there is half as much again.
TEST(AxesFollow, NeverSaysYesInVain) {
  const Head head = GantryHead{.length_mm = 40.0};
  int yes = 0;
  for (const double degrees : {2.0, 10.0, 25.0, 50.0}) {
    const CornerCurve curve = Turning(degrees, 5.0);
    double bend = 0.0;
    for (int k = 0; k <= 4000; ++k)
      bend = std::max(bend, curve.SecondByLength(k / 4e3).point.norm());
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      for (AxisValues AxisLimits::*figure : {&AxisLimits::speed, &AxisLimits::acceleration}) {
        MachineLimits machine;
        machine.tip_acceleration_mm_s2 = 1e12;
        machine.tip_jerk_mm_s3 = HUGE_VAL;
        machine.axes.speed.fill(1e9);
        machine.axes.acceleration.fill(1e9);
        (machine.axes.*figure)[axis] = 1.0;
        const double most = SpeedOnCurve(curve, head, machine);
        EXPECT_FALSE(AxesFollow(curve, head, machine, most * (1 + 1e-6), bend)) << axis;
        EXPECT_FALSE(AxesFollow(curve, head, machine, most * 3.0, bend)) << axis;
        if (AxesFollow(curve, head, machine, most * 0.3, bend)) ++yes;
      }
    }
  }
  EXPECT_GE(yes, 30);  // of 40
}

// The way up to each place, measured in small steps, is what was asked for: gentle, sharp and
// turning.
TEST(CornerLength, InvertsTheLength) {
  for (const CornerCurve& curve :
       {CornerCurve(PlainAt(40.0, 3.0)), CornerCurve(PlainAt(150.0, 3.0)),
        CornerCurve(PlainAt(175.0, 3.0)), Turning(70.0, 4.0), Turning(160.0, 2.0)}) {
    const CornerLength length(curve);
    double way = 0.0, from = 0.0;
    for (int k = 1; k <= 100; ++k) {
      const double u = length.ParameterAt(curve, 0.01 * k * length.total());
      constexpr int kSteps = 200;  // of Simpson
      const double step = (u - from) / kSteps;
      for (int n = 0; n < kSteps; ++n) {
        const double at = from + n * step;
        way += step / 6.0 *
               (curve.Speed(at) + 4.0 * curve.Speed(at + 0.5 * step) + curve.Speed(at + step));
      }
      from = u;
      EXPECT_NEAR(way, 0.01 * k * length.total(), 1e-10 * length.total()) << k;
    }
    EXPECT_EQ(from, 1.0);
  }
}

// u by arc length, from the table: within 3e-9 of the length for turns up to 145 degrees, 1e-12 up
// to 90; both ends and the middle exactly. Sharper ones it does not know.
TEST(PlainMeasure, InvertsTheLength) {
  for (const double degrees : {1e-4, 0.3, 5.0, 33.3, 60.0, 89.9, 110.0, 130.0, 144.9}) {
    const PlainCorner corner = PlainAt(degrees, 3.0);
    const PlainMeasure measure(corner);
    ASSERT_TRUE(measure.known()) << degrees;
    EXPECT_EQ(measure.ParameterAt(0.0), 0.0);
    EXPECT_EQ(measure.ParameterAt(0.5), 0.5);
    EXPECT_EQ(measure.ParameterAt(1.0), 1.0);
    const CornerCurve curve(corner);
    const CornerLength length(curve);
    for (int k = 1; k < 64; ++k) {
      const double share = k / 64.0;
      const double exact = length.ParameterAt(curve, share * length.total());
      const double miss = (measure.ParameterAt(share) - exact) * curve.Speed(exact);
      EXPECT_LE(std::abs(miss), (degrees < 90.0 ? 2e-12 : 3e-9) * length.total())
          << degrees << " " << share;
    }
  }
  EXPECT_FALSE(PlainMeasure(PlainAt(145.1, 3.0)).known());
  EXPECT_FALSE(PlainMeasure(PlainAt(174.0, 3.0)).known());
}

// Both halves of a blend are found by arc length, also where the table ends.
TEST(BlendCurve, HalvesMeetInTheMiddle) {
  for (const double degrees : {40.0, 144.0, 160.0}) {
    const PlainCorner corner = PlainAt(degrees, 3.0);
    const CornerCurve curve(corner);
    const double half = 0.5 * CornerLength(curve).total();
    PathPiece first, second;
    first.AssignCorner(corner, 0.0, half, corner.Start(), curve.At(0.5));
    second.AssignCorner(corner, half, half, curve.At(0.5), corner.Finish());
    EXPECT_NEAR(BlendCurve(first).ParameterAt(0.0), 0.0, 1e-12);
    EXPECT_NEAR(BlendCurve(first).ParameterAt(half), 0.5, 1e-9);
    EXPECT_NEAR(BlendCurve(second).ParameterAt(0.0), 0.5, 1e-9);
    EXPECT_NEAR(BlendCurve(second).ParameterAt(half), 1.0, 1e-9);
    // A part of a half keeps its places.
    const PathPiece part = second.Part(0.25 * half, 0.75 * half);
    EXPECT_NEAR(part.length(), 0.5 * half, 1e-12);
    ExpectNear(part.At(0.3 * part.length()).point, second.At(0.4 * half).point, 1e-9);
    ExpectNear(part.Tangent(0.2), second.Tangent(0.25 * half + 0.2), 1e-9);
    ExpectNear(part.Curvature(0.2), second.Curvature(0.25 * half + 0.2), 1e-8);
  }
}

// On a straight way that is gone evenly every place is the slowest: the first of them.
TEST(CornerCurve, SlowestPlaceOfAStraightWay) {
  const CornerCurve straight({.pose = {{0, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {}},
                             {.pose = {{2, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {}},
                             1.0);
  EXPECT_EQ(straight.Speed(0.3), 2.0);
  EXPECT_EQ(straight.SlowestPlace(), 0.0);
  EXPECT_EQ(straight.JerkPerCube(0.3), 0.0);
}

// A bend of 1e-10 by u is what rounding leaves of none: there it begins to bend as it changes.
TEST(CornerCurve, JerkWhereItHardlyBends) {
  const MachineVector along{1, 0, 0}, change{0, 0, 1};
  EXPECT_EQ(CornerCurve::JerkPerCube(along, {0, 1e-10, 0}, change), 1.0);
  EXPECT_NEAR(CornerCurve::JerkPerCube(along, {0, 1.001e-10, 0}, change), 0.0, 1e-15);
  EXPECT_EQ(CornerCurve::JerkPerCube(along, {0, 0, 0}, change * 3.0), 3.0);
}

// Between ends far apart the curve is slowest at its ends: its length begins at the very first.
TEST(CornerLength, WhereItsBeginningIsTheSlowest) {
  const CornerCurve curve({.pose = {{0, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {}},
                          {.pose = {{10, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {}}, 0.1);
  const CornerLength length(curve);
  EXPECT_NEAR(length.total(), 10.0, 1e-12);
  EXPECT_EQ(length.ParameterAt(curve, 0.0), 0.0);
  EXPECT_EQ(length.ParameterAt(curve, length.total()), 1.0);
  for (const double s : {1e-3, 0.1, 5.0}) {
    EXPECT_NEAR(curve.At(length.ParameterAt(curve, s)).point.x(), s, 1e-12);
  }
}

// Two arcs of R 4 that meet back to back, joined between points 2 mm away: the more their tangents
// there turn back, the sharper the curve.
CornerCurve NearCusp(double degrees) {
  const double turn = 0.5 * degrees * kRadPerDegree;
  return CornerCurve({.pose = {{-std::cos(turn), -0.4, 0}, 0, 0},
                      .tangent = {std::cos(turn), std::sin(turn), 0},
                      .curvature = MachineVector{-std::sin(turn), std::cos(turn), 0} * 0.5},
                     {.pose = {{std::cos(turn), -0.4, 0}, 0, 0},
                      .tangent = {std::cos(turn), -std::sin(turn), 0},
                      .curvature = MachineVector{std::sin(turn), std::cos(turn), 0} * 0.5},
                     2.0);
}

// docs/decisions/0011: a cusp is a place ten times as sharp as K(175 degrees) / d, with
// K(175) = 0.75 rho sin / (cos (15/8 - 7 rho/16))^2 of 87.5 degrees.
TEST(CornerCurve, CuspIsTenTimesTheSharpestTurn) {
  const double c = std::cos(87.5 * kRadPerDegree), rho = 2.0 * std::sqrt(c);
  const double k =
      0.75 * rho * std::sin(87.5 * kRadPerDegree) / std::pow(c * (1.875 - 0.4375 * rho), 2);
  // Two arcs whose curve nearly stands still in its middle at some cuts: what lies on either side.
  const PathPiece in = PathPiece::ArcThrough({{11.482, 12.304, 0}}, {9.102, 3.016, 0}, {})->path;
  const PathPiece out = PathPiece::ArcThrough({}, {9.102, -3.016, 0}, {{11.482, -12.304, 0}})->path;
  int cusps = 0, curves = 0;
  double most_of_curves = 0.0, least_of_cusps = HUGE_VAL;
  for (int i = 1; i <= 20000; ++i) {
    const double cut = 0.5 * in.radius_mm() * i / 20000.0;
    const CornerCurve curve(EndAt(in, in.length() - cut), EndAt(out, cut), cut);
    const double place = curve.SlowestPlace();
    const double sharp = curve.SecondByLength(place).point.norm() * cut / k;
    if (curve.HasCusp(cut)) {
      ++cusps;
      least_of_cusps = std::min(least_of_cusps, sharp);
    } else {
      ++curves;
      most_of_curves = std::max(most_of_curves, sharp);
    }
    // It is where the parameter moves slowest.
    for (int n = 0; i % 2000 == 0 && n <= 400; ++n) {
      EXPECT_LE(curve.Speed(place), curve.Speed(n / 400.0) * (1 + 1e-9) + 1e-12);
    }
  }
  EXPECT_GT(curves, 100);
  EXPECT_GT(cusps, 10);
  EXPECT_GE(least_of_cusps, 9.99);
  EXPECT_LE(least_of_cusps, 10.5);
  EXPECT_LE(most_of_curves, 10.01);
  EXPECT_GE(most_of_curves, 9.5);
}

// Arc length and its inverse also where a curve nearly comes to a point: against 2 million chords.
TEST(CornerLength, NearACusp) {
  for (const double degrees : {120.0, 150.0, 172.0}) {
    const CornerCurve curve = NearCusp(degrees);
    const CornerLength length(curve);
    constexpr int kChords = 200000;
    double chords = 0.0;
    MachinePoint last = curve.At(0.0).point;
    for (int k = 1; k <= kChords; ++k) {
      const MachinePoint here = curve.At(static_cast<double>(k) / kChords).point;
      chords += (last - here).norm();
      last = here;
      if (k % 20000 != 0) continue;
      EXPECT_NEAR(length.ParameterAt(curve, chords), static_cast<double>(k) / kChords, 2e-6);
    }
    EXPECT_NEAR(length.total(), chords, 1e-7 * chords) << degrees;
    EXPECT_EQ(length.ParameterAt(curve, -1.0), 0.0);
    EXPECT_EQ(length.ParameterAt(curve, 2.0 * length.total()), 1.0);
  }
}

// The nearest point, at an end and between.
TEST(CornerCurve, DistanceFromAPoint) {
  const CornerCurve curve(PlainAt(90.0, 2.0));
  EXPECT_NEAR(curve.DistanceFrom({-95, -2, 3}), 100.0, 1e-9);
  EXPECT_NEAR(curve.DistanceFrom({7, -2, 105}), 100.0, 1e-9);
  EXPECT_NEAR(curve.DistanceFrom(curve.At(0.0).point), 0.0, 1e-15);
  EXPECT_NEAR(curve.DistanceFrom(curve.At(1.0).point), 0.0, 1e-15);
  const PathPose at = curve.At(0.3);
  const MachineVector tangent = curve.FirstByLength(0.3).point;
  const MachineVector across{-tangent.z(), 0, tangent.x()};
  EXPECT_NEAR(curve.DistanceFrom(at.point + across * 0.05), 0.05, 1e-9);
  EXPECT_NEAR(curve.DistanceFrom(at.point - across * 0.05), 0.05, 1e-9);
  EXPECT_NEAR(curve.DistanceFrom(at.point + MachineVector{0, 0.7, 0}), 0.7, 1e-9);
}

// In COORD ROBOT the curve is measured by time, which grows evenly with u.
TEST(CornerCurve, InAxesIsEven) {
  const PathPiece in = PathPiece::Joint({{0, 0, 0}, 0, 0}, {{100, 0, 0}, 1, 0});
  const PathPiece out = PathPiece::Joint({{100, 0, 0}, 1, 0}, {{100, 50, 0}, 1, -1});
  CornerCurve curve = CornerCurve::InAxes(EndAt(in, 0.9), EndAt(out, 0.1), 0.1);
  EXPECT_TRUE(curve.in_axes());
  EXPECT_DOUBLE_EQ(curve.way_s(), 0.2);
  ExpectNear(curve.FirstByLength(0.0).point, {100, 0, 0}, 1e-9);
  EXPECT_NEAR(curve.FirstByLength(1.0).b, -1.0, 1e-9);
  // Half way both are at half speed and the change is fastest: 3/2 of the change over the time.
  ExpectNear(curve.FirstByLength(0.5).point, {50, 25, 0}, 1e-9);
  ExpectNear(curve.SecondByLength(0.5).point, {-750, 375, 0}, 1e-8);
  EXPECT_NEAR(curve.SecondByLength(0.5).a, -7.5, 1e-9);
  EXPECT_NEAR(curve.SecondByLength(0.5).b, -7.5, 1e-9);
  const CornerLength length(curve);
  EXPECT_DOUBLE_EQ(length.total(), 0.2);
  EXPECT_DOUBLE_EQ(length.ParameterAt(curve, 0.05), 0.25);
  curve.MeasureBy(4.0);
  EXPECT_DOUBLE_EQ(curve.way_s(), 0.8);
}

// The least of a function: at either end, between samples, beyond the samples that are kept, and
// the lower of two that look alike at the samples.
TEST(LeastAlong, FindsTheLeast) {
  for (const int intervals : {16, 48, 64, 65, 130}) {
    for (const double where : {0.0, 0.013, 1.234, 2.9, 3.987, 4.0}) {
      const auto bowl = [where](double x) { return 2.0 + (x - where) * (x - where); };
      EXPECT_NEAR(LeastAlong(bowl, 4.0, intervals), 2.0, 1e-9) << intervals << " " << where;
    }
    const auto two = [](double x) {
      return 2.0 - std::exp(-std::pow((x - 1.03) / 0.4, 2)) * 0.1 -
             std::exp(-std::pow((x - 3.01) / 0.4, 2)) * 0.1001;
    };
    EXPECT_NEAR(LeastAlong(two, 4.0, intervals), 1.8999, 1e-8) << intervals;
  }
  // At sample 25 of 48 the second is lower than the first's valley beside it looks, and at 26 lower
  // still; the first comes down to 1 between 24 and 25.
  const auto both = [](double x) {
    const double k = x * 48.0;
    return std::array{1.0 + 0.4 * (k - 24.58) * (k - 24.58), 1.02 + 0.04 * (k - 26.0) * (k - 26.0)};
  };
  EXPECT_NEAR(LeastOfAll(both, 1.0, 48), 1.0, 1e-9);
  // Above `enough` it need not look closely: seventeen samples will do.
  int calls = 0;
  const auto counted = [&calls](double x) {
    ++calls;
    return 2.0 + x;
  };
  EXPECT_GE(LeastAlong(counted, 4.0, 16, 1.0), 1.0);
  EXPECT_EQ(calls, 17);
}

}  // namespace
}  // namespace rmlcell::motion
