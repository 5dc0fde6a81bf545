#include "engine/motion/geometry/path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "engine/core/units.h"
#include "tests/engine/motion/expect_near.h"

namespace rmlcell::motion {
namespace {

PathPiece ArcOf(const MachinePoint& from, const MachinePoint& via, const MachinePoint& to) {
  const Result<PathPiece::Arc3> arc = PathPiece::ArcThrough({from}, via, {to});
  EXPECT_TRUE(arc);
  return arc ? arc->path : PathPiece{};
}

// Frames are types: a place of a path is the tip's or the column's as its path says, and nothing
// takes a place in the machine for one in the program without saying so.
template <class Pose>
constexpr bool kSaysTip = requires(const Pose& pose) {
  pose.tip();
};
template <class Pose>
constexpr bool kSaysAxes = requires(const Pose& pose) {
  pose.axes();
};
static_assert(!kSaysTip<PathPose> && !kSaysAxes<PathPose>);
static_assert(!std::is_constructible_v<ProgramPoint, MachinePoint>);
static_assert(!std::is_constructible_v<TipPose, AxisPose>);
static_assert(!std::is_convertible_v<AxisPose, TipPose>);

TEST(PathPiece, SaysWhatItsPlacesAre) {
  const PathPiece line = PathPiece::Line({{0, 0, 0}}, {{10, 0, 0}});
  const PathPiece joint = PathPiece::Joint({{0, 0, 0}}, {{10, 0, 0}});
  EXPECT_EQ(line.TipAt(5.0), (TipPose{{5, 0, 0}}));
  EXPECT_EQ(joint.axes_to(), (AxisPose{{10, 0, 0}}));
  EXPECT_DEATH(static_cast<void>(joint.tip_to()), "in_axes");
  EXPECT_DEATH(static_cast<void>(line.axes_from()), "in_axes");
}

// From another place to the same end, and of the same kind.
TEST(PathPiece, IsMadeStraightFromAnotherPlace) {
  const PathPiece line = PathPiece::Line({{0, 0, 0}}, {{10, 0, 0}});
  const PathPiece joint = PathPiece::Joint({{0, 0, 0}}, {{10, 0, 0}});
  const PathPose there = line.At(4.0);
  EXPECT_EQ(line.StraightFrom(there).length(), 6.0);
  EXPECT_EQ(line.StraightFrom(there).tip_to(), line.tip_to());
  EXPECT_TRUE(joint.StraightFrom(there).in_axes());
  EXPECT_EQ(joint.StraightFrom(there).axes_from(), (AxisPose{{4, 0, 0}}));
}

// The manual's line of 2-2: at X = 1700 the tip is at Y 1170, Z -200 and A = B = 0.25. OPT-2.15
TEST(PathLine, AdvancesTipAndHeadTogether) {
  const PathPiece line =
      PathPiece::Line({{1200, 1120, -150}, 0, 0}, {{2200, 1220, -250}, 0.5, 0.5});
  EXPECT_NEAR(line.length(), std::sqrt(1000.0 * 1000.0 + 2.0 * 100.0 * 100.0), 1e-12);
  const PathPose middle = line.At(0.5 * line.length());
  ExpectNear(middle.point, {1700, 1170, -200}, 1e-9);
  EXPECT_NEAR(middle.a_rad, 0.25, 1e-15);
  EXPECT_NEAR(middle.b_rad, 0.25, 1e-15);
  EXPECT_EQ(line.At(line.length()), line.to());
  EXPECT_EQ(line.At(0.0), line.from());
}

// OPT-2.17: a tip that stands while the head turns; motion.md 3.1.
TEST(PathLine, BecomesRotaryWhenTheTipStands) {
  const PathPiece turn = PathPiece::Line({{1, 2, 3}, 0, 0}, {{1, 2, 3 + 1e-7}, 0, 1.5708});
  EXPECT_EQ(turn.kind(), PathPiece::Kind::kRotary);
  EXPECT_EQ(turn.length(), 1.0);
  EXPECT_EQ(turn.tip_length_mm(), 0.0);
  EXPECT_DOUBLE_EQ(turn.At(0.5).b_rad, 0.7854);
  const PathPiece nothing = PathPiece::Line({{1, 2, 3}, 4, 5}, {{1, 2, 3}, 4, 5});
  EXPECT_EQ(nothing.length(), 0.0);
}

// Where nothing moves nothing changes along the way.
TEST(PathPiece, OfNoLengthHasNoRates) {
  const PathPiece stands = PathPiece::Joint({{1, 2, 3}, 4, 5}, {{1, 2, 3}, 4, 5});
  EXPECT_EQ(stands.First(0.0).point, MachineVector(0, 0, 0));
  EXPECT_EQ(stands.First(0.0).a, 0.0);
  EXPECT_EQ(stands.First(0.0).b, 0.0);
}

// OPT-2.18: radius 10, centre (10,0,0), length 31.416.
TEST(PathArc, GoesThroughTheViaPoint) {
  const PathPiece arc = ArcOf({0, 0, 0}, {10, 10, 0}, {20, 0, 0});
  EXPECT_NEAR(arc.radius_mm(), 10.0, 1e-12);
  ExpectNear(arc.centre(), {10, 0, 0}, 1e-12);
  EXPECT_NEAR(arc.length(), 10.0 * kPi, 1e-12);
  ExpectNear(arc.At(0.5 * arc.length()).point, {10, 10, 0}, 1e-12);
  ExpectNear(arc.normal(), {0, 0, -1}, 1e-15);
}

// The manual's tilted arc of 2-3, longer than a half circle. OPT-2.19
TEST(PathArc, MayBeTiltedAndLongerThanAHalfCircle) {
  const PathPiece arc = ArcOf({1000, 1120, -150}, {1210, 1125, -125}, {1200, 1120, -150});
  ExpectNear(arc.centre(), {1100, 1130.577, -97.115}, 5e-4);
  EXPECT_NEAR(arc.radius_mm(), 113.616, 5e-4);
  EXPECT_NEAR(arc.length(), 469.327, 5e-4);
  EXPECT_GT(arc.sweep_rad(), kPi);
}

// Every case of the table of motion.md 3.2. OPT-B.16, OPT-B.18
TEST(PathArc, DegenerateCases) {
  using Case = PathPiece::ArcCase;
  const auto through = [](const MachinePoint& via, const MachinePoint& to, double b = 0.0) {
    return PathPiece::ArcThrough({{0, 0, 0}}, via, {to, 0.0, b});
  };
  EXPECT_EQ(through({5, 0, 0}, {10, 0, 0})->kind, Case::kLineWarned);      // between
  EXPECT_EQ(through({5, 9e-5, 0}, {10, 0, 0})->kind, Case::kLineWarned);   // nearly on the line
  EXPECT_EQ(through({5, 1.1e-4, 0}, {10, 0, 0})->kind, Case::kArc);        // just off it
  EXPECT_EQ(through({0, 0, 0}, {10, 0, 0})->kind, Case::kLineWarned);      // via is the start
  EXPECT_EQ(through({10, 9e-5, 0}, {10, 0, 0})->kind, Case::kLineWarned);  // via is the target
  EXPECT_EQ(through({0, 0, 0}, {0, 0, 0}, 1.0)->kind, Case::kNoTipMotion);
  EXPECT_EQ(through({0, 0, 0}, {0, 0, 0}, 1.0)->path.kind(), PathPiece::Kind::kRotary);
  EXPECT_EQ(through({0, 0, 0}, {0, 0, 0})->path.length(), 0.0);
  for (const MachinePoint& via : {MachineVector{15, 0, 0}, MachineVector{-5, 0, 0}}) {
    ASSERT_FALSE(through(via, {10, 0, 0}));
    EXPECT_EQ(through(via, {10, 0, 0}).error().code, ErrorCode::kCellArcUndefined);
  }
  EXPECT_EQ(through({5, 5, 0}, {0, 0, 0}).error().code, ErrorCode::kCellArcUndefined);
  const double bad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(through({bad, 5, 0}, {9, 0, 0}).error().code, ErrorCode::kCellArcUndefined);
  EXPECT_EQ(through({1, 5, 0}, {bad, 0, 0}).error().code, ErrorCode::kCellArcUndefined);
}

// Sagitta h over a chord of 1000: R = (c^2 / 4 + h^2) / (2 h). At R = 6e8 mm the arc still starts,
// bulges and ends where it should to 1e-9 mm; motion.md 3.2.
TEST(PathArc, StaysAccurateWhenNearlyStraight) {
  for (const double h : {2e-4, 1e-2, 1.0}) {
    const PathPiece arc = ArcOf({3000, 2000, -500}, {3500, 2000 - h, -500}, {4000, 2000, -500});
    EXPECT_NEAR(arc.radius_mm() / ((250000.0 + h * h) / (2.0 * h)), 1.0, 1e-8);
    ExpectNear(arc.At(0.5 * arc.length()).point, {3500, 2000 - h, -500}, 1e-9);
    ExpectNear(arc.At(arc.length() * (1.0 - 1e-12)).point, {4000, 2000, -500}, 2e-9);
    // Half way to the via point a parabola is off by less than h^3: y = 3/4 h.
    EXPECT_NEAR(arc.At(0.25 * arc.length()).point.y(), 2000 - 0.75 * h, 1e-6 * h + 1e-9);
  }
}

// motion.md section 10: a full circle by two arcs has length 2 pi R and ends where it began.
// OPT-B.17
TEST(PathArc, TwoArcsMakeACircle) {
  const PathPiece first = ArcOf({0, 139.7, 354.584}, {139.7, 0, 354.584}, {0, -139.7, 354.584});
  const PathPiece second = ArcOf({0, -139.7, 354.584}, {-139.7, 0, 354.584}, {0, 139.7, 354.584});
  EXPECT_NEAR(first.length() + second.length(), kTurn * 139.7, 1e-9);
  ExpectNear(second.At(second.length() * (1.0 - 1e-13)).point, {0, 139.7, 354.584}, 1e-9);
}

// The head goes straight from its start to its target angle, in proportion to the arc. OPT-2.20,
// OPT-B.19
TEST(PathArc, TurnsTheHeadInProportion) {
  const Result<PathPiece::Arc3> arc =
      PathPiece::ArcThrough({{0, 139.7, 354.584}, 3.1416, 1.5708}, {139.7, 0, 354.584},
                            {{0, -139.7, 354.584}, 0.0, 1.5708});
  ASSERT_TRUE(arc);
  EXPECT_NEAR(arc->path.At(0.5 * arc->path.length()).a_rad, 1.5708, 1e-12);
  EXPECT_NEAR(arc->path.a_rate(), -3.1416 / (kPi * 139.7), 1e-12);
}

// Tangent and curvature are the derivatives of the position.
TEST(PathArc, DerivativesAgreeWithDifferences) {
  const PathPiece arc = ArcOf({1, 2, 3}, {4, -5, 6}, {7, 8, -9});
  const double h = 1e-4;
  for (const double share : {0.1, 0.37, 0.9}) {
    const double s = share * arc.length();
    const MachineVector before = arc.At(s - h).point, here = arc.At(s).point,
                        after = arc.At(s + h).point;
    ExpectNear(arc.Tangent(s), (after - before) * (0.5 / h), 1e-8);
    ExpectNear(arc.Curvature(s), (after - here * 2.0 + before) * (1.0 / (h * h)), 1e-6);
    EXPECT_NEAR(arc.Tangent(s).norm(), 1.0, 1e-14);
    EXPECT_NEAR(arc.Curvature(s).norm(), 1.0 / arc.radius_mm(), 1e-14);
  }
}

TEST(PathPart, IsTheSamePathBetweenTwoPlaces) {
  const PathPiece arc = ArcOf({1, 2, 3}, {4, -5, 6}, {7, 8, -9});
  const PathPiece part = arc.Part(0.2 * arc.length(), 0.7 * arc.length());
  EXPECT_NEAR(part.length(), 0.5 * arc.length(), 1e-12);
  ExpectNear(part.At(0.3 * part.length()).point, arc.At(0.35 * arc.length()).point, 1e-12);
  ExpectNear(part.Tangent(part.length()), arc.Tangent(0.7 * arc.length()), 1e-14);
  const PathPiece line = PathPiece::Line({{0, 0, 0}, 0, 0}, {{10, 0, 0}, 1, 2});
  EXPECT_NEAR(line.Part(2, 5).At(1).b_rad, 0.6, 1e-15);
}

// OPT-2.13: the column passes (50, 25, 0) at half way.
TEST(PathJoint, IsStraightInTheAxes) {
  const PathPiece move = PathPiece::Joint({{0, 0, 0}, 0, 0}, {{100, 50, 0}, 0, 0});
  EXPECT_EQ(move.length(), 1.0);
  ExpectNear(move.At(0.5).point, {50, 25, 0}, 1e-12);
  EXPECT_EQ(PathPiece::Joint({{1, 2, 3}, 4, 5}, {{1, 2, 3}, 4, 5}).length(), 0.0);
}

}  // namespace
}  // namespace rmlcell::motion
