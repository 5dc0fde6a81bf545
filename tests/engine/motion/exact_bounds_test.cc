// Values that lie on a bound to the last bit: each bound of the rules belongs
// to one of its sides. motion.md 1, 4.3, 4.4, 4.5, 5.1
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/corner/axes_corner.h"
#include "engine/motion/corner/bend_speed.h"
#include "engine/motion/corner/corner.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// Straight on into Y by so much for each mm of X.
Corner BentAsideBy(double aside) {
  return Corner::Between(PathPiece::Line({{-1, 0, 0}}, {}), PathPiece::Line({}, {{1, aside, 0}}));
}

// theta <= 1e-6 is no turn: half of what lies between the tangents is half a
// millionth.
TEST(ExactBounds, AMillionthOfATurnIsNone) {
  const auto half_of = [](double aside) {
    const MachineVector in = PathPiece::Line({{-1, 0, 0}}, {}).Tangent(0.0);
    return 0.5 * (in - PathPiece::Line({}, {{1, aside, 0}}).Tangent(0.0)).norm();
  };
  double aside = 1e-6 * (1.0 - 1e-12);
  while (half_of(aside) < 0.5e-6) aside = std::nextafter(aside, 1.0);
  ASSERT_EQ(half_of(aside), 0.5e-6);
  EXPECT_TRUE(BentAsideBy(aside).straight());
  EXPECT_EQ(BentAsideBy(aside).passage(), Passage::kThrough);
  EXPECT_EQ(BentAsideBy(aside * (1.0 + 1e-9)).passage(), Passage::kBlend);
}

// Curvatures within 1e-9 of each other are equal, that itself included: of 9e9 / 2^43 a billionth
// has no rounding.
TEST(ExactBounds, CurvaturesMeetWithinABillionth) {
  const double curvature = std::ldexp(9e9, -43), less = std::ldexp(9e9 - 9.0, -43);
  const auto arc_of = [](double wanted, double sweep) {
    double radius = 1.0 / wanted * (1.0 - 1e-15);
    const auto arc = [&] {
      return PathPiece::Circle({}, {0, radius, 0}, {0, 0, 1}, sweep, 0.0, 0.0);
    };
    for (int n = 0; n < 40 && arc().Curvature(0.0).y() != wanted; ++n)
      radius = std::nextafter(radius, 1e9);
    return arc();
  };
  // So short that it does not turn.
  const PathPiece in = arc_of(curvature, 1e-20), out = arc_of(less, 1.0);
  const MachineVector of_in = in.Curvature(in.length()), of_out = out.Curvature(0.0);
  ASSERT_EQ((of_in - of_out).norm(), 1e-9 * of_in.norm());
  EXPECT_EQ(Corner::Between(in, out).passage(), Passage::kThrough);
  const PathPiece wider = arc_of(std::ldexp(9e9 - 9.01, -43), 1.0);
  EXPECT_EQ(Corner::Between(in, wider).passage(), Passage::kBlend);
}

// More than 175 degrees between the speeds of the axes is a way back; 175 are a
// bend.
TEST(ExactBounds, AxesTurnBackByMoreThan175Degrees) {
  MachineLimits machine = StandardMachine();
  machine.axes.speed.fill(1.0);
  const double cosine = std::cos(175.0 * kRadPerDegree), sine = std::sin(175.0 * kRadPerDegree);
  const auto passage = [&](double x, double y) {
    const AxisPose corner{{0, 0, 0}, 0, 0};
    return AxesCorner(PathPiece::Joint({{-1, 0, 0}, 0, 0}, corner),
                      PathPiece::Joint(corner, {{x, y, 0}, 0, 0}), 1.0, machine)
        .passage();
  };
  constexpr double kCosine = -0.99619469809174555;
  EXPECT_NEAR(kCosine, cosine, 1e-15);
  double y = sine * (1.0 - 1e-13);
  while (kCosine * std::sqrt(cosine * cosine + y * y) > cosine) y = std::nextafter(y, 1.0);
  ASSERT_EQ(kCosine * std::sqrt(cosine * cosine + y * y), cosine);
  EXPECT_EQ(passage(cosine, y), Passage::kBlend);
  EXPECT_EQ(passage(cosine, y * (1.0 - 1e-12)), Passage::kStopReversal);
}

// 574 is ten times what a turn of 175 degrees has: as much is a cusp, and less
// is none.
TEST(ExactBounds, TenTimesTheSharpestTurnIsACusp) {
  const PathPiece in = PathPiece::Line({{-50, 0, 0}}, {});
  const PathPiece out = PathPiece::Line({}, {{-40, 30, 0}});
  const CornerCurve curve(EndAt(in, 48.0), EndAt(out, 2.0), 2.0);
  const double bend = curve.SecondByLength(curve.SlowestPlace()).point.norm();
  double cut = 574.0 / bend * (1.0 - 1e-15);
  while (bend * cut < 574.0) cut = std::nextafter(cut, 1e9);
  ASSERT_EQ(bend * cut, 574.0);
  EXPECT_TRUE(curve.HasCusp(cut));
  EXPECT_FALSE(curve.HasCusp(cut * (1.0 - 1e-12)));
}

// Up to 60 rad, far more than any travel, the limits are those of the path
// itself: with the head upright A turns the column about where it stands, and
// asks nothing of X beyond the tip. Beyond 60 rad bounds do: 300 mm times what A turns for each mm.
TEST(ExactBounds, SixtyRadiansAreSearched) {
  AxisLimits axes;
  axes.speed.fill(1e9);
  axes.acceleration.fill(1e15);
  axes.jerk.fill(1e18);
  axes.speed[0] = 25.0;
  const auto speed_of = [&](double turn) {
    const PathPiece line = PathPiece::Line({{0, 0, 0}, -30.0, 0.0}, {{100, 0, 0}, -30.0 + turn, 0});
    return WithinAxes(line, GantryHead{}, axes, {}, {.speed = 500.0, .acceleration = 1e6}).speed;
  };
  EXPECT_NEAR(speed_of(60.0), 25.0, 1e-7);
  EXPECT_NEAR(speed_of(61.0), 25.0 / (1.0 + 300.0 * 0.61), 1e-9);
}

template <class At>
BendSpeeds SpeedsOf24(At at) {
  BendSpeeds speeds;
  for (std::size_t k = 0; k < speeds.most.size(); ++k) speeds.most[k] = at(k);
  return speeds;
}

// From 10 to 20 mm/s in 6 mm, a quarter of the half bend, which is as open
// behind the second step.
constexpr PathLimits kSixOf24{.acceleration = 1e9, .jerk = 250.0};
BendSpeeds OpensAtOnce() {
  return SpeedsOf24([](std::size_t k) { return k == 0 ? 10.0 : k == 1 ? 15.0 : 20.0; });
}

// The end of a ramp is a place of it: where the bend is a little tighter just there, the ramp goes
// no higher than that. Those from 10, 7.5, 5, 2.5 and 0 mm/s end between 5.657 and 6.149 mm, all
// behind the sixth step and before the seventh.
TEST(BendRampEnds, ADipAtTheVeryEndCounts) {
  constexpr double kHalf_mm = 24.0 * 5.65 / 6.0;
  BendSpeeds dipped = OpensAtOnce();
  dipped.most[6] = 19.9;
  EXPECT_NEAR(StretchesOf(OpensAtOnce(), kHalf_mm, kSixOf24).open, 20.0, 1e-12);
  const BendStretches bend = StretchesOf(dipped, kHalf_mm, kSixOf24);
  EXPECT_LT(bend.open, 19.95);
  EXPECT_GE(bend.open, 19.9 - 10.0 / 32.0);
}

// Last digits do not decide: what is above the speeds of the bend by one part
// in 1e9 is within them, at the end of a ramp as behind it.
TEST(BendRampEnds, OnePartIn1e9IsNotAboveTheBend) {
  double dip = 20.0 / (1.0 + 1e-9) * (1.0 - 1e-15);
  while (dip * (1.0 + 1e-9) < 20.0) dip = std::nextafter(dip, 20.0);
  ASSERT_EQ(dip * (1.0 + 1e-9), 20.0);
  const double half_mm = 24.0 * (1.0 - 1e-11);
  for (const std::size_t step : {std::size_t{6}, std::size_t{9}}) {
    BendSpeeds dipped = OpensAtOnce();
    dipped.most[step] = dip;
    EXPECT_EQ(StretchesOf(dipped, half_mm, kSixOf24).open, 20.0) << step;
    dipped.most[step] = 20.0 * (1.0 - 2e-9);
    EXPECT_LT(StretchesOf(dipped, half_mm, kSixOf24).open, 20.0) << step;
  }
}

// Beyond the centre of its bend a curve is nearest at one of its ends, and not
// where the foot of a perpendicular lies.
TEST(CurveDistance, BeyondTheCentreItIsThatOfAnEnd) {
  // Half a circle of radius 10 about the origin from (10, 0) over (0, 10),
  // nearly.
  const CurveEnd from{.pose = {{10, 0, 0}, 0, 0}, .tangent = {0, 1, 0}, .curvature = {-0.1, 0, 0}};
  const CurveEnd to{.pose = {{0, 10, 0}, 0, 0}, .tangent = {-1, 0, 0}, .curvature = {0, -0.1, 0}};
  const CornerCurve curve(from, to, 5.0 * kPi / (2.0 * std::pow(2.0, 0.75)) * 2.0);
  const MachinePoint near_to{-3, -30, 0}, near_from{-30, -3, 0};
  const auto brute = [&](const MachinePoint& point) {
    double least = HUGE_VAL;
    for (int k = 0; k <= 4000; ++k)
      least = std::min(least, (curve.At(k / 4000.0).point - point).norm());
    return least;
  };
  for (const MachinePoint& point : {near_to, near_from, MachinePoint{-3, -3, 40}})
    EXPECT_NEAR(curve.DistanceFrom(point), brute(point), 1e-9);
  EXPECT_NEAR(curve.DistanceFrom(near_from), std::hypot(30.0, 13.0), 1e-9);
}

// The length of a bend comes from a table: near its ends as well, where all but nothing is turned
// and where 175 degrees are.
TEST(ExactBounds, LengthsAtBothEndsOfTheTable) {
  for (const double degrees : {0.01, 1.0, 3.0, 6.0, 6.5, 170.0, 174.8, 174.95, 174.99}) {
    const double turn = degrees * kRadPerDegree;
    const MachineVector out{std::cos(turn), std::sin(turn), 0};
    const Corner corner =
        Corner::Between(PathPiece::Line({{-9, 0, 0}}, {}), PathPiece::Line({}, {out * 9.0}));
    const CornerCurve curve(
        PlainCorner{.at = {}, .tangent_in = {1, 0, 0}, .tangent_out = out, .cut_mm = 2.0});
    EXPECT_NEAR(corner.PlainLength(2.0), CornerLength(curve).total(), 1e-9) << degrees;
  }
}

// What is no number stays one: a line to it has no length that could be taken for one.
TEST(ExactBounds, ALineToNowhereHasNoLength) {
  const double nowhere = std::nan("");
  for (const MachinePoint& to : {MachinePoint{nowhere, 0, 0}, MachinePoint{0, 0, nowhere}}) {
    const PathPiece line = PathPiece::Line({{0, 0, 0}, 0.1, 0.2}, {to, 0.1, 0.2});
    EXPECT_EQ(line.kind(), PathPiece::Kind::kLine);
    EXPECT_TRUE(std::isnan(line.length()));
  }
}

// The whole way is the end itself, of any curve.
TEST(CornerLength, TheWholeWayEndsAtTheEnd) {
  Dice dice(61);
  for (int round = 0; round < 200; ++round) {
    const double cut = dice.Magnitude(1e-3, 30.0), turn = dice.Uniform(0.01, 3.0);
    const MachineVector out{std::cos(turn), std::sin(turn), 0};
    const CornerCurve curve({.pose = {{-cut, 0, 0}, 0, 0}, .tangent = {1, 0, 0}, .curvature = {}},
                            {.pose = {out * cut, 0, 0}, .tangent = out, .curvature = {}}, cut);
    const CornerLength length(curve);
    EXPECT_EQ(length.ParameterAt(curve, length.total()), 1.0) << round;
    EXPECT_EQ(length.ParameterAt(curve, 0.0), 0.0) << round;
  }
}

}  // namespace
}  // namespace rmlcell::motion
