#include "engine/simulation/path/axis_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using motion::AxisValues;
using motion::PathPiece;

const motion::Head kHead = motion::GantryHead{.length_mm = 300.0};
constexpr double kReach_mm = 300.0;  // from the tip to the column, whatever A and B are

// The first halves of corners on which both axes of the head turn, one of them there and back.
std::vector<PathPiece> TurningBends() {
  std::vector<PathPiece> bends;
  for (const auto& corner :
       {PlannedCorner({{0, 0, 0}, 0.0, 0.1}, {{100, 0, 0}, 0.2, 0.1}, {{100, 100, 0}, 0.2, 0.4}),
        PlannedCorner({{0, 0, 0}, 0.1, 0.5}, {{100, 0, 20}, 0.4, 0.2},
                      {{150, 90, 40}, 0.1, 0.7})}) {
    EXPECT_EQ(corner.size(), 4u);
    bends.push_back(corner[1].path);
    bends.push_back(corner[2].path);
  }
  return bends;
}

// The axes as they go with the parameter, differentiated once more by differences.
AxisValues RatesAt(const PartCurve& curve, double p) {
  const motion::MachineVector column = curve.ColumnRate(p);
  const motion::PathDerivatives rate = curve.Rate(p);
  return {column.x(), column.y(), column.z(), rate.a, rate.b};
}
AxisValues SecondAt(const PartCurve& curve, double p, double step) {
  return (RatesAt(curve, p + step) - RatesAt(curve, p - step)) / (2.0 * step);
}
AxisValues ThirdAt(const PartCurve& curve, double p, double step) {
  return (RatesAt(curve, p + step) - 2.0 * RatesAt(curve, p) + RatesAt(curve, p - step)) /
         (step * step);
}

// What the axes do at most over a stretch of the parameter, as differences find it.
struct Seen {
  AxisValues first = AxisValues::Zero();
  AxisValues second = AxisValues::Zero();
  AxisValues third = AxisValues::Zero();

  void Add(const Seen& other) {
    first = first.cwiseMax(other.first);
    second = second.cwiseMax(other.second);
    third = third.cwiseMax(other.third);
  }
};

Seen SeenIn(const PartCurve& curve, double begin, double width) {
  Seen seen;
  const double step = 0.02 * width;
  for (int k = 0; k <= 20; ++k) {
    const double p = begin + width * (0.02 + 0.96 * k / 20);
    seen.Add({RatesAt(curve, p).cwiseAbs(), SecondAt(curve, p, step).cwiseAbs(),
              ThirdAt(curve, p, step).cwiseAbs()});
  }
  return seen;
}

// No bound is below what was seen in its piece, nor above it by more than this share of the most
// that axes of its kind do anywhere on the part.
void ExpectWithin(const AxisValues& bounds, const AxisValues& seen, const AxisValues& most,
                  double share, const char* what) {
  for (int i = 0; i < motion::kAxisCount; ++i) {
    const double scale = i < 3 ? most.head<3>().maxCoeff() : most.tail<2>().maxCoeff();
    EXPECT_GE(bounds[i], seen[i] - 1e-4 * scale) << what << ' ' << i;
    EXPECT_LE(bounds[i], seen[i] + share * scale + 1e-9) << what << ' ' << i;
  }
}

struct Shares {
  double first, second, third;
};

void ExpectBounds(const PathPiece& path, std::size_t count, const Shares& above) {
  const PathPart part{path, kHead, 0.1 * path.length(), path.length()};
  CurveMeasure measure;
  const PartCurve curve(part, measure);
  const AxisPieces pieces(curve, count);
  ASSERT_TRUE(pieces.known());
  ASSERT_EQ(pieces.pieces().size(), count);
  const double width = pieces.width();
  EXPECT_NEAR(width, (curve.end() - curve.begin()) / static_cast<double>(count), 1e-12);
  const auto begin_of = [&](std::size_t k) {
    return curve.begin() + width * static_cast<double>(k);
  };
  Seen most;
  for (std::size_t k = 0; k < count; ++k) most.Add(SeenIn(curve, begin_of(k), width));
  for (std::size_t k = 0; k < count; ++k) {
    const AxisPieces::Piece& piece = pieces.pieces()[k];
    const AxisValues middle = RatesAt(curve, begin_of(k) + 0.5 * width);
    EXPECT_LE((piece.middle - middle).norm(), 1e-9 * middle.norm());
    const Seen seen = SeenIn(curve, begin_of(k), width);
    ExpectWithin(piece.first, seen.first, most.first, above.first, "first");
    ExpectWithin(piece.second, seen.second, most.second, above.second, "second");
    ExpectWithin(piece.third, seen.third, most.third, above.third, "third");
  }
}

TEST(AxisPieces, AreForLinesTurnsAndBends) {
  EXPECT_TRUE(AxisPieces::AreFor(LineFrom({0, 0, 0}, {1, 0, 0})));
  EXPECT_TRUE(AxisPieces::AreFor(PathPiece::Line({{0, 0, 0}, 0, 0}, {{0, 0, 0}, 1, 0})));
  EXPECT_TRUE(AxisPieces::AreFor(TurningBends()[0]));
  EXPECT_FALSE(AxisPieces::AreFor(PathPiece::Joint({{0, 0, 0}, 0, 0}, {{1, 0, 0}, 1, 0})));
  EXPECT_FALSE(AxisPieces::AreFor(
      PathPiece::Circle({{20, 0, 0}, 0.1, 0.2}, {0, 0, 0}, {0, 0, 1}, 2.0, 0.4, 0.5)));
}

// About a standing tip with A alone, at B = pi/2, the column goes on a circle of 300 mm: from the
// middle of a piece, where X goes by 300 cos, Y by 300 sin, to its ends each derivative changes by
// half a width times a bound of the next one. The fourth one is 300 at most.
TEST(AxisPieces, OfATurnOfA) {
  const PathPiece turn = PathPiece::Line({{0, 0, 0}, 0.0, 0.5 * kPi}, {{0, 0, 0}, 0.8, 0.5 * kPi});
  const PathPart part{turn, kHead, 0.0, turn.length()};
  CurveMeasure measure;
  const PartCurve curve(part, measure);
  const AxisPieces pieces(curve, AxisPieces::kFew);
  const double per = 0.8 / turn.length();  // A by the parameter
  const double half = 0.5 * pieces.width();
  EXPECT_NEAR(half * per, 0.1, 1e-12);
  for (std::size_t k = 0; k < AxisPieces::kFew; ++k) {
    const double a = 0.1 + 0.2 * static_cast<double>(k);
    const AxisPieces::Piece& piece = pieces.pieces()[k];
    const double r = kReach_mm;
    const double fourth = r * std::pow(per, 4);
    const double x[] = {r * std::cos(a) * per, r * std::sin(a) * per * per,
                        r * std::cos(a) * std::pow(per, 3)};
    const double y[] = {r * std::sin(a) * per, r * std::cos(a) * per * per,
                        r * std::sin(a) * std::pow(per, 3)};
    EXPECT_NEAR(std::abs(piece.middle[0]), x[0], 1e-9);
    EXPECT_NEAR(std::abs(piece.middle[1]), y[0], 1e-9);
    EXPECT_NEAR(piece.middle[2], 0.0, 1e-9);
    for (int i = 0; i < 2; ++i) {
      const auto& at = i == 0 ? x : y;
      const double third = at[2] + half * fourth;
      const double second = at[1] + half * third;
      EXPECT_NEAR(piece.third[i], third, 1e-9) << i;
      EXPECT_NEAR(piece.second[i], second, 1e-9) << i;
      EXPECT_NEAR(piece.first[i], at[0] + half * second, 1e-9) << i;
    }
    EXPECT_NEAR(piece.middle[3], per, 1e-12);
    EXPECT_NEAR(piece.first[3], per, 1e-12);
    EXPECT_NEAR(piece.second[3], 0.0, 1e-12);
    EXPECT_NEAR(piece.third[3], 0.0, 1e-12);
    EXPECT_EQ(piece.first[4], 0.0);
    EXPECT_EQ(piece.slowest, 1.0);  // the parameter is the way
    EXPECT_EQ(piece.fastest, 1.0);
    EXPECT_EQ(piece.tip_second, 0.0);
    EXPECT_EQ(piece.curvature, 0.0);
    EXPECT_EQ(piece.change, 0.0);
  }
}

// Of any way the derivatives of the axes, as differences find them, lie within the bounds, which
// are below one per cent too high in many pieces, and some per cent in a few; of the second and the
// third less is known.
TEST(AxisPieces, BoundsHoldAndAreTight) {
  std::vector<PathPiece> ways = TurningBends();
  ways.push_back(PathPiece::Line({{0, 0, 0}, 0.1, 0.5}, {{10, 5, 2}, 0.3, 0.1}));
  ways.push_back(PathPiece::Line({{0, 0, 0}, 0.1, 0.5}, {{0, 0, 0}, 0.5, -0.4}));
  for (const PathPiece& way : ways) {
    ExpectBounds(way, AxisPieces::kFew, {0.1, 0.4, 2.0});
    ExpectBounds(way, AxisPieces::kMany, {0.01, 0.03, 0.5});
  }
}

// The tip along a bend: how fast it goes by the parameter, how that changes, and how it curves.
TEST(AxisPieces, BoundsOfTheTip) {
  for (const PathPiece& way : TurningBends()) {
    const PathPart part{way, kHead, 0.0, way.length()};
    CurveMeasure measure;
    const PartCurve curve(part, measure);
    const AxisPieces pieces(curve, AxisPieces::kMany);
    ASSERT_TRUE(pieces.known());
    const double half = 0.5 * pieces.width();
    double begin = curve.begin();
    for (const AxisPieces::Piece& piece : pieces.pieces()) {
      double slow = HUGE_VAL, fast = 0.0, second = 0.0, third = 0.0, curvature = 0.0, change = 0.0;
      double change_low = HUGE_VAL, change_high = -HUGE_VAL;
      const motion::MachineVector middle = curve.Derivative(begin + half, 1).point;
      const double middle_grows =
          middle.dot(curve.Derivative(begin + half, 2).point) / middle.norm();
      for (int k = 0; k <= 20; ++k) {
        const double p = begin + pieces.width() * k / 20;
        const motion::MachineVector one = curve.Derivative(p, 1).point;
        const motion::MachineVector two = curve.Derivative(p, 2).point;
        const double speed = one.norm();
        slow = std::min(slow, speed);
        fast = std::max(fast, speed);
        second = std::max(second, two.norm());
        third = std::max(third, curve.Derivative(p, 3).point.norm());
        curvature = std::max(curvature, one.cross(two).norm() / (speed * speed * speed));
        const double grows = one.dot(two) / speed;
        change = std::max(change, std::abs(grows));
        change_low = std::min(change_low, grows);
        change_high = std::max(change_high, grows);
      }
      EXPECT_LE(piece.slowest, slow * (1 + 1e-9));
      EXPECT_GE(piece.slowest, slow * 0.98);
      EXPECT_GE(piece.fastest, fast * (1 - 1e-9));
      EXPECT_LE(piece.fastest, fast * 1.02);
      EXPECT_GE(piece.tip_second, second * (1 - 1e-9));
      EXPECT_LE(piece.tip_second, second * 1.1);
      EXPECT_GE(piece.tip_third, third * (1 - 1e-9));
      EXPECT_LE(piece.tip_third, third * 1.3);
      EXPECT_GE(piece.curvature, curvature * (1 - 1e-9));
      EXPECT_LE(piece.curvature, curvature * 1.1);
      EXPECT_GE(piece.change, change * (1 - 1e-9));
      EXPECT_GE(piece.second_change * pieces.width(), (change_high - change_low) * (1 - 1e-9));
      EXPECT_LE(piece.second_change, 1.3 * (third + second * second / slow));
      // From the middle of the piece as far as the next bound allows.
      EXPECT_NEAR(piece.change, std::abs(middle_grows) + half * piece.second_change, 1e-9);
      EXPECT_NEAR(piece.slowest, middle.norm() - half * piece.change, 1e-9);
      EXPECT_NEAR(piece.fastest, middle.norm() + half * piece.change, 1e-9);
      begin += pieces.width();
    }
  }
}

// An axis that keeps its direction is said to, one that turns round or stands is not: the column
// over B from -0.5 to 0.5 goes one way in Y, up and down in Z, and not in X. Where nothing is
// known, nothing is said.
TEST(AxisPieces, AxesThatGoOneWay) {
  const auto one_way = [](double a_from, double b_from, double a_to, double b_to) {
    const PathPiece turn = PathPiece::Line({{0, 0, 0}, a_from, b_from}, {{0, 0, 0}, a_to, b_to});
    const PathPart part{turn, kHead, 0.0, turn.length()};
    CurveMeasure measure;
    const PartCurve curve(part, measure);
    const AxisPieces pieces(curve, AxisPieces::kFew);
    std::string axes;
    for (int axis = 0; axis < motion::kAxisCount; ++axis)
      axes += pieces.GoesOneWay(axis) ? "xyzab"[axis] : '.';
    return axes;
  };
  EXPECT_EQ(one_way(0, -0.5, 0, 0.5), ".y..b");
  EXPECT_EQ(one_way(0, 0.5, 0, -0.5), ".y..b");
  EXPECT_EQ(one_way(0, 0.3, 0, 0.9), ".yz.b");
  EXPECT_EQ(one_way(0, 0.9, 0, 0.3), ".yz.b");
  EXPECT_EQ(one_way(0, -0.9, 0, -0.3), ".yz.b");
  EXPECT_EQ(one_way(0.2, 0.8, 0.6, 0.8), "xy.a.");
  EXPECT_EQ(one_way(0.6, 0.8, 0.2, 0.8), "xy.a.");
  EXPECT_EQ(one_way(-0.3, 0.8, 0.3, 0.8), "x..a.");
}

}  // namespace
}  // namespace rmlcell::simulation
