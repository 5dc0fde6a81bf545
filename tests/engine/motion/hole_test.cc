#include "engine/motion/geometry/hole.h"

#include <gtest/gtest.h>

#include "engine/core/units.h"
#include "tests/engine/motion/expect_near.h"

namespace rmlcell::motion {
namespace {

const HoleCommand kHole{.from = {{130, 50, -540}, 0.1, 0.0},
                        .centre = {{100, 50, -550}, 0.1, 0.5},
                        .normal_point = {100, 50, -450},
                        .radius_mm = 25.0};

// Entry at the nearest point of the circle, then once round counter-clockwise. OPT-2.23, OPT-2.24,
// OPT-2.32
TEST(Hole, EntersAtTheNearestPointAndTurnsLeft) {
  const Result<HolePath> hole = HoleThrough(kHole);
  ASSERT_TRUE(hole);
  EXPECT_FALSE(hole->starts_on_axis);
  EXPECT_NEAR(hole->lead.length() + hole->circle.length(), std::hypot(5.0, 10.0) + 50.0 * kPi,
              1e-12);
  ExpectNear(hole->lead.to().point, {125, 50, -550});
  EXPECT_EQ(hole->lead.to().b_rad, 0.5);
  const double quarter = 0.25 * hole->circle.length();
  ExpectNear(hole->circle.At(quarter).point, {100, 75, -550});
  ExpectNear(hole->circle.At(2 * quarter).point, {75, 50, -550});
  ExpectNear(hole->circle.At(3 * quarter).point, {100, 25, -550});
  EXPECT_EQ(hole->circle.to().point, hole->circle.from().point);
  EXPECT_EQ(hole->circle.b_rate(), 0.0);
}

// The distance of the normal point has no effect. OPT-2.25
TEST(Hole, UsesOnlyTheDirectionOfTheNormalPoint) {
  HoleCommand near = kHole;
  near.normal_point.z() = -549.9;
  const Result<HolePath> hole = HoleThrough(near);
  ASSERT_TRUE(hole);
  ExpectNear(hole->circle.At(0.25 * hole->circle.length()).point, {100, 75, -550});
}

// Seen from the other side the turn is the other way. OPT-B.10
TEST(Hole, IsRightHandedAboutTheNormal) {
  const Result<HolePath> hole = HoleThrough(
      {.from = {{10, 0, 0}}, .centre = {{0, 0, 0}}, .normal_point = {0, 0, -1}, .radius_mm = 5.0});
  ASSERT_TRUE(hole);
  ExpectNear(hole->circle.At(0.25 * hole->circle.length()).point, {0, -5, 0});
}

// OPT-B.12, OPT-2.28: on the axis the entry lies along the program's X, or Y when X is the axis.
TEST(Hole, StartOnTheAxis) {
  HoleCommand hole{
      .from = {{0, 0, 7}}, .centre = {{0, 0, 0}}, .normal_point = {0, 0, 1}, .radius_mm = 5.0};
  ASSERT_TRUE(HoleThrough(hole));
  EXPECT_TRUE(HoleThrough(hole)->starts_on_axis);
  ExpectNear(HoleThrough(hole)->circle.from().point, {5, 0, 0});
  hole.normal_point = {1, 0, 0};
  hole.from.tip = {3, 0, 0};
  ExpectNear(HoleThrough(hole)->circle.from().point, {0, 5, 0});
  hole.program_x = {0, 0, 1};  // a turned work offset
  ExpectNear(HoleThrough(hole)->circle.from().point, {0, 0, 5});
}

// OPT-2.32: without a straight part the head turns over the circle.
TEST(Hole, StartOnTheCircle) {
  HoleCommand hole = kHole;
  hole.from = {{125, 50, -550}, 0.1, 0.0};
  const Result<HolePath> path = HoleThrough(hole);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->lead.length(), 0.0);
  EXPECT_EQ(path->circle.from().b_rad, 0.0);
  EXPECT_EQ(path->circle.to().b_rad, 0.5);
}

// OPT-B.13, OPT-B.15, OPT-2.27: radius first, then the normal point.
TEST(Hole, Errors) {
  HoleCommand hole = kHole;
  hole.normal_point = hole.centre.tip + MachineVector{0, 0, 1e-6};
  EXPECT_EQ(HoleThrough(hole).error().code, ErrorCode::kCellHoleNormal);
  hole.radius_mm = 0.0;
  EXPECT_EQ(HoleThrough(hole).error().code, ErrorCode::kCellHoleRadius);
  hole.radius_mm = -1.0;
  EXPECT_EQ(HoleThrough(hole).error().code, ErrorCode::kCellHoleRadius);
}

}  // namespace
}  // namespace rmlcell::motion
