// On parts so short that nothing changes along them, bounds of the axes are their derivatives: with
// a tool beside the axis of the head, while A and B turn unevenly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/path/axis_pieces.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using motion::AxisValues;
using motion::PathPiece;

// One by one, so that none of the offsets hides behind another.
std::vector<motion::Head> HeadsWithTools() {
  std::vector<motion::Head> heads;
  for (const motion::ToolOffset& tool :
       {motion::ToolOffset{}, {.x_mm = 120.0}, {.y_mm = -90.0, .z_mm = 40.0}, {80.0, 70.0, -60.0}})
    heads.emplace_back(motion::GantryHead{.length_mm = 300.0, .tool = tool});
  return heads;
}

struct DerivedAxes {
  AxisValues first;
  AxisValues second;
  AxisValues third;
};

AxisValues AxisRates(const PartCurve& curve, double p) {
  const motion::MachineVector column = curve.ColumnRate(p);
  const motion::PathDerivatives rate = curve.Rate(p);
  return {column.x(), column.y(), column.z(), rate.a, rate.b};
}

// By differences, of the fourth order.
DerivedAxes DerivedAt(const PartCurve& curve, double p, double h) {
  const AxisValues here = AxisRates(curve, p), up = AxisRates(curve, p + h),
                   down = AxisRates(curve, p - h), up2 = AxisRates(curve, p + 2.0 * h),
                   down2 = AxisRates(curve, p - 2.0 * h);
  return {here, (8.0 * (up - down) - (up2 - down2)) / (12.0 * h),
          (16.0 * (up + down) - 30.0 * here - (up2 + down2)) / (12.0 * h * h)};
}

void ExpectDerived(const AxisValues& bound, const AxisValues& derived, const std::string& what) {
  for (int i = 0; i < motion::kAxisCount; ++i) {
    const double scale =
        i < 3 ? derived.head<3>().cwiseAbs().maxCoeff() : derived.tail<2>().cwiseAbs().maxCoeff();
    const double at = std::abs(derived[i]);
    EXPECT_GE(bound[i], at - 1e-6 * scale - 1e-9) << what << ' ' << i;
    EXPECT_LE(bound[i], at + 0.02 * scale + 1e-9) << what << ' ' << i;
  }
}

void ExpectDerivatives(const PathPiece& path, const motion::Head& head, double share) {
  const double from = share * path.length(), to = from + 2e-4 * path.length();
  CurveMeasure measure, whole_measure;
  const PartCurve part({path, head, from, to}, measure);
  const PartCurve whole({path, head, 0.0, path.length()}, whole_measure);
  const AxisPieces pieces(part, AxisPieces::kFew);
  ASSERT_TRUE(pieces.known());
  for (std::size_t k = 0; k < AxisPieces::kFew; ++k) {
    const double middle = part.begin() + pieces.width() * (static_cast<double>(k) + 0.5);
    const DerivedAxes derived = DerivedAt(whole, middle, 2e-3 * (whole.end() - whole.begin()));
    const AxisPieces::Piece& piece = pieces.pieces()[k];
    const std::string what = " piece " + std::to_string(k) + " at " + std::to_string(share);
    EXPECT_LE((piece.middle - derived.first).norm(), 1e-9 * derived.first.norm()) << what;
    ExpectDerived(piece.first, derived.first, "first" + what);
    ExpectDerived(piece.second, derived.second, "second" + what);
    ExpectDerived(piece.third, derived.third, "third" + what);
  }
}

TEST(TurningArm, BoundsOfAShortPartOfABendAreItsDerivatives) {
  for (const motion::Head& head : HeadsWithTools()) {
    for (const auto& corner :
         {PlannedCorner({{0, 0, 0}, 0.0, 0.1}, {{100, 0, 0}, 0.4, 0.1}, {{100, 100, 0}, 0.4, 0.6}),
          PlannedCorner({{0, 0, 0}, 0.1, 0.5}, {{100, 0, 20}, 0.6, 0.2}, {{150, 90, 40}, 0.1, 0.7}),
          PlannedCorner({{0, 0, 0}, 0.6, 0.8}, {{90, 0, 20}, 0.1, 0.2},
                        {{150, -90, 40}, 0.3, 0.9})}) {
      for (const std::size_t half : {1, 2}) {
        for (const double share : {0.1, 0.35, 0.6, 0.9})
          ExpectDerivatives(corner.at(half).path, head, share);
      }
    }
  }
}

TEST(TurningArm, BoundsOfAShortPartOfALineAreItsDerivatives) {
  for (const motion::Head& head : HeadsWithTools()) {
    for (const PathPiece& path : {PathPiece::Line({{0, 0, 0}, 0.1, 0.5}, {{10, 5, 2}, 1.3, 0.9}),
                                  PathPiece::Line({{0, 0, 0}, 0.1, 0.5}, {{0, 0, 0}, 0.9, -0.4}),
                                  PathPiece::Line({{0, 0, 0}, 0.2, 1.1}, {{4, 0, 0}, 0.2, 0.1})})
      for (const double share : {0.1, 0.5, 0.9}) ExpectDerivatives(path, head, share);
  }
}

// The third derivatives of a bend are quadratic, so that the fourth ones go straight from end to
// end.
motion::PathDerivatives FourthAt(const PartCurve& curve, double p) {
  const double h = 1e-3;
  const motion::PathDerivatives up = curve.Derivative(p + h, 3), down = curve.Derivative(p - h, 3);
  const double per = 0.5 / h;
  return {(up.point - down.point) * per, (up.a - down.a) * per, (up.b - down.b) * per};
}

double Greatest(double a, double b) { return std::max(std::abs(a), std::abs(b)); }

// From the middle of a piece each derivative changes by half of its width times the bound of the
// next one; an arm of length r whose angles have the derivatives t1 to t4 at most has a fourth one
// of r (t1^4 + 6 t1^2 t2 + 3 t2^2 + 4 t1 t3 + t4), as the chain rule makes it.
void ExpectReach(const PathPiece& path, const motion::Head& head, double from, double to) {
  CurveMeasure measure;
  const PartCurve curve({path, head, from * path.length(), to * path.length()}, measure);
  const AxisPieces pieces(curve, AxisPieces::kFew);
  ASSERT_TRUE(pieces.known());
  const motion::PathDerivatives begin = FourthAt(curve, curve.begin());
  const motion::PathDerivatives end = FourthAt(curve, curve.end());
  motion::MachineVector tip;
  for (int i = 0; i < 3; ++i) tip[i] = Greatest(begin.point[i], end.point[i]);
  const double t4 = Greatest(begin.a, end.a) + Greatest(begin.b, end.b);
  const double half = 0.5 * pieces.width();
  for (std::size_t k = 0; k < AxisPieces::kFew; ++k) {
    const double p = curve.begin() + half * static_cast<double>(2 * k + 1);
    const auto turning = [&](int order) {
      const motion::PathDerivatives at = curve.Derivative(p, order);
      return std::abs(at.a) + std::abs(at.b);
    };
    const double t3 = turning(3) + half * t4;
    const double t2 = turning(2) + half * t3;
    const double t1 = turning(1) + half * t2;
    const double arm = head.ColumnOf({}).column.norm() * (t1 * t1 * t1 * t1 + 6.0 * t1 * t1 * t2 +
                                                          3.0 * t2 * t2 + 4.0 * t1 * t3 + t4);
    const AxisPieces::Piece& piece = pieces.pieces()[k];
    EXPECT_NEAR(piece.tip_third, curve.Derivative(p, 3).point.norm() + half * tip.norm(),
                1e-6 * piece.tip_third);
    const DerivedAxes middle = DerivedAt(curve, p, 2e-3);
    for (int i = 0; i < motion::kAxisCount; ++i) {
      const double fourth = i < 3 ? tip.norm() + arm : t4;
      const double near = 1e-5 * fourth + 1e-9;
      EXPECT_NEAR(piece.third[i], std::abs(middle.third[i]) + half * fourth, near) << i;
      EXPECT_NEAR(piece.second[i], std::abs(middle.second[i]) + half * piece.third[i], near) << i;
      EXPECT_NEAR(piece.first[i], std::abs(middle.first[i]) + half * piece.second[i], near) << i;
    }
  }
}

TEST(TurningArm, WithinAPieceDerivativesChangeByTheNextOne) {
  for (const auto& corner :
       {PlannedCorner({{0, 0, 0}, 0.0, 0.1}, {{100, 0, 0}, 0.4, 0.1}, {{100, 100, 0}, 0.4, 0.6}),
        PlannedCorner({{0, 0, 0}, 0.6, 0.8}, {{90, 0, 20}, 0.1, 0.2},
                      {{150, -90, 40}, 0.3, 0.9})}) {
    for (const std::size_t half : {1, 2}) {
      ExpectReach(corner.at(half).path, HeadsWithTools()[3], 0.0, 1.0);
      ExpectReach(corner.at(half).path, HeadsWithTools()[0], 0.3, 0.8);
    }
  }
}

std::string OneWayOf(const PathPiece& path) {
  CurveMeasure measure;
  const motion::Head head = motion::GantryHead{.length_mm = 300.0};
  const PartCurve curve({path, head, 0.0, path.length()}, measure);
  const AxisPieces pieces(curve, AxisPieces::kFew);
  std::string axes;
  for (int axis = 0; axis < motion::kAxisCount; ++axis)
    axes += pieces.GoesOneWay(axis) ? "xyzab"[axis] : '.';
  return axes;
}

// An axis that turns round a little before its end does not go one way.
TEST(TurningArm, ATurnNearTheEndIsNotOneWay) {
  for (const double far : {0.8, -0.8}) {
    for (const double near : {0.02, 0.08}) {
      const double past = far > 0.0 ? -near : near;
      EXPECT_EQ(OneWayOf(PathPiece::Line({{0, 0, 0}, 0, far}, {{0, 0, 0}, 0, past})), ".y..b");
      EXPECT_EQ(OneWayOf(PathPiece::Line({{0, 0, 0}, 0, past}, {{0, 0, 0}, 0, far})), ".y..b");
    }
  }
}

// Round a corner that leads nearly back the tip comes near to standing: of that nothing is known.
TEST(TurningArm, WhereTheTipNearlyStandsNothingIsKnown) {
  int unknown = 0;
  const std::vector<motion::Head> heads = HeadsWithTools();
  for (const double aside : {1.0, 10.0, 30.0, 200.0}) {
    const auto corner =
        PlannedCorner({{0, 0, 0}, 0.0, 0.1}, {{100, 0, 0}, 0.4, 0.1}, {{0, aside, 0}, 0.4, 0.6});
    for (const motion::PlannedMotion& planned : corner) {
      const PathPiece& path = planned.path;
      if (path.kind() != PathPiece::Kind::kBlend) continue;
      CurveMeasure measure;
      const PartCurve curve({path, heads[0], 0.0, path.length()}, measure);
      double slowest = HUGE_VAL, fastest = 0.0;
      for (int k = 0; k <= 1000; ++k) {
        const double p = curve.begin() + (curve.end() - curve.begin()) * k / 1000;
        slowest = std::min(slowest, curve.Derivative(p, 1).point.norm());
        fastest = std::max(fastest, curve.Derivative(p, 1).point.norm());
      }
      const AxisPieces pieces(curve, AxisPieces::kFew);
      if (pieces.known()) {
        for (const AxisPieces::Piece& piece : pieces.pieces()) EXPECT_GT(piece.slowest, 0.0);
        continue;
      }
      ++unknown;
      EXPECT_LT(slowest, 0.5 * fastest);
      for (int axis = 0; axis < motion::kAxisCount; ++axis)
        EXPECT_FALSE(pieces.GoesOneWay(axis)) << aside;
    }
  }
  EXPECT_GT(unknown, 0);
}

}  // namespace
}  // namespace rmlcell::simulation
