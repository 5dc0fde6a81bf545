#include "engine/simulation/path/part_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;
using motion::PathPiece;

const motion::Head kArm = motion::GantryHead{.length_mm = 300.0};

// A head that turns and turns back within a corner turns, although the angles at its ends are
// equal; either axis alone is enough.
TEST(PartCurve, TurnsWhereOneAxisTurns) {
  EXPECT_FALSE(Turns(LineFrom({0, 0, 0}, {1, 0, 0})));
  EXPECT_TRUE(Turns(PathPiece::Line({{0, 0, 0}}, {{1, 0, 0}, 0.1, 0.0})));
  EXPECT_TRUE(Turns(PathPiece::Line({{0, 0, 0}}, {{1, 0, 0}, 0.0, 0.1})));
  struct Corner {
    double a, b;
    bool turns;
  };
  for (const Corner& corner : {Corner{0.0, 0.0, false}, {0.2, 0.0, true}, {0.0, 0.2, true}}) {
    const auto motions =
        PlannedCorner({{0, 0, 0}}, {{100, 0, 0}, corner.a, corner.b}, {{100, 100, 0}});
    ASSERT_EQ(motions.size(), 4u);
    for (const std::size_t half : {1u, 2u}) {
      EXPECT_EQ(Turns(motions[half].path), corner.turns) << corner.a << ' ' << corner.b;
    }
    // The whole corner as one piece.
    if (!corner.turns) continue;
    PathPiece whole = motions[1].path;
    whole.AssignCorner(motions[1].path.curve(), 0.0,
                       motions[1].path.length() + motions[2].path.length(), motions[1].path.from(),
                       motions[2].path.to());
    EXPECT_NEAR(whole.a_rate(), 0.0, 1e-12);
    EXPECT_NEAR(whole.b_rate(), 0.0, 1e-12);
    EXPECT_TRUE(Turns(whole));
  }
}

// What turns along a part: A and B by their angles, an arc by its tangent, a corner half a turn at
// most on top; only the part counts.
TEST(PartCurve, TurningOfAPart) {
  const PathPiece line = PathPiece::Line({{0, 0, 0}, 0.0, 0.5}, {{10, 0, 0}, 0.3, 0.1});
  EXPECT_NEAR(TurningOf({line, kArm, 0.0, 10.0}), 0.7, 1e-12);
  EXPECT_NEAR(TurningOf({line, kArm, 5.0, 10.0}), 0.35, 1e-12);
  const PathPiece arc = PathPiece::Circle({{20, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0);
  EXPECT_NEAR(TurningOf({arc, kArm, 0.0, 20.0}), 1.0, 1e-12);
  EXPECT_NEAR(TurningOf({arc, kArm, 20.0, 50.0}), 1.5, 1e-12);
  const auto corner = PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}});
  EXPECT_NEAR(TurningOf({corner[1].path, kArm, 0.0, 1.0}), kPi, 1e-12);
}

// Rates are the derivatives of the places, of tip and column, whatever kind of path it is.
TEST(PartCurve, RatesAreDerivatives) {
  const auto corner =
      PlannedCorner({{0, 0, 0}, 0.0, 0.1}, {{100, 0, 0}, 0.2, 0.1}, {{100, 100, 0}, 0.2, 0.4});
  ASSERT_EQ(corner.size(), 4u);
  for (const PathPiece& path :
       {PathPiece::Line({{0, 0, 0}, 0.1, 0.5}, {{10, 5, 2}, 0.3, 0.1}),
        PathPiece::Circle({{20, 0, 0}, 0.1, 0.2}, {0, 0, 0}, {0, 0, 1}, 2.0, 0.4, 0.5),
        PathPiece::Joint({{0, 0, 300}, 0.1, 0.5}, {{10, 5, 302}, 0.8, -0.4}), corner[1].path,
        corner[2].path}) {
    const PathPart part{path, kArm, 0.25 * path.length(), 0.75 * path.length()};
    CurveMeasure measure;
    const PartCurve curve(part, measure);
    const double p = 0.5 * (curve.begin() + curve.end());
    const double step = 1e-6 * (curve.end() - curve.begin());
    const motion::MachinePoint tip = (curve.Tip(p + step) - curve.Tip(p - step)) * (0.5 / step);
    const motion::MachinePoint column =
        (curve.Column(p + step) - curve.Column(p - step)) * (0.5 / step);
    const double scale = tip.norm() + column.norm();
    EXPECT_NEAR((curve.TipRate(p) - tip).norm(), 0.0, 1e-6 * scale);
    EXPECT_NEAR((curve.ColumnRate(p) - column).norm(), 0.0, 1e-6 * scale);
    EXPECT_NEAR((curve.Tip(curve.begin()) - TipAt(path, kArm, part.from)).norm(), 0.0, 1e-6);
    EXPECT_NEAR((curve.Tip(curve.end()) - TipAt(path, kArm, part.to)).norm(), 0.0, 1e-6);
  }
}

// What was measured is kept for the next look at the same curve, not for one with the same ends.
TEST(CurveMeasure, CurvesWithTheSameEnds) {
  const auto curve = [](double angle) {
    return motion::CornerCurve({.pose = {{0, 0, 0}}, .tangent = {1, 0, 0}, .curvature = {0, 0, 0}},
                               {.pose = {{16, 16, 0}},
                                .tangent = {std::sin(angle), std::cos(angle), 0},
                                .curvature = {0, 0, 0}},
                               16.0);
  };
  const motion::CornerCurve first = curve(0.0);
  CurveMeasure measure;
  int same_ends = 0;  // to the last bit
  for (int k = 1; k <= 1000; ++k) {
    const motion::CornerCurve other = curve(0.002 * k);
    if (other.At(0.0).point != first.At(0.0).point || other.At(1.0).point != first.At(1.0).point)
      continue;
    ++same_ends;
    EXPECT_EQ(measure.Of(first).total(), motion::CornerLength(first).total());
    EXPECT_EQ(measure.Of(other).total(), motion::CornerLength(other).total());
    EXPECT_NE(measure.Of(other).total(), measure.Of(first).total());
  }
  EXPECT_GT(same_ends, 0);
}

}  // namespace
}  // namespace rmlcell::simulation
