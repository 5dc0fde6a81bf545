// A STOP in a bend, and the START behind it, where the axes can do little of what they are asked
// for. motion.md section 6
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <span>
#include <vector>

#include "engine/motion/ride/interruption.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::stop_in_bend {
namespace {

// East and north at 50 mm/s: a line, the two halves of a bend that is passed steadily, a line.
std::vector<PlannedMotion> EastAndNorth() {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Line({}, {{100, 0, 0}});
  chain[1].path = PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
  chain[0].speed_fraction = chain[1].speed_fraction = 0.1;
  chain[0].fly = true;
  return Plan(chain);
}

AxisLimits WithAcceleration(double of_each_axis) {
  AxisLimits axes = StandardMachine().axes;
  axes.acceleration.setConstant(of_each_axis);
  return axes;
}

// Axes that cannot even keep to the bend have nothing to brake with: what is left of it is passed
// as planned, and behind it 50 mm/s take 25 * 2 sqrt(50 / 40000) mm to rest. Nothing of the way is
// left out. OPT-B.31
TEST(StopInBend, WhereTheAxesHaveNothingTheBendIsPassed) {
  const std::vector<PlannedMotion> plan = EastAndNorth();
  ASSERT_EQ(plan.size(), 4U);
  const std::span<const PlannedMotion> bend = std::span(plan).subspan(1);
  const AxisLimits axes = WithAcceleration(1.0);
  const double t = 0.5 * plan[1].speed.duration_s();
  const StopOnPath stop = StopAlong(bend, t, axes);
  const double braking = 25.0 * 2.0 * std::sqrt(50.0 / 40000.0);
  EXPECT_TRUE(stop.complete);
  EXPECT_EQ(stop.index, 2U);
  EXPECT_NEAR(stop.s, braking, 1e-9);
  ASSERT_EQ(stop.motions.size(), 3U);
  EXPECT_NEAR(stop.motions[0].path.length(), 0.5 * plan[1].path.length(), 1e-9);
  EXPECT_NEAR(stop.motions[1].path.length(), plan[2].path.length(), 1e-9);
  EXPECT_NEAR(stop.motions[2].path.length(), braking, 1e-9);
  MachinePoint at = plan[1].path.At(0.5 * plan[1].path.length()).point;
  double speed = 50.0;
  for (const PlannedMotion& motion : stop.motions) {
    EXPECT_LT((motion.path.from().point - at).norm(), 1e-6);
    EXPECT_NEAR(motion.speed.At(0.0).speed, speed, 1e-6);
    EXPECT_NEAR(motion.speed.end().s, motion.path.length(), 1e-9);
    EXPECT_EQ(motion.settling_s, 0.0);
    at = motion.path.to().point;
    speed = motion.speed.end().speed;
  }
  EXPECT_EQ(speed, 0.0);
  // Of what is behind the bend nothing is planned yet: it cannot be told where it will stand.
  EXPECT_FALSE(StopAlong(bend.first(2), t, axes).complete);
}

// With half of what the axes can a START in the bend is half as hard, and so on down to a
// sixteenth: each of these is tried before a gentler one is.
TEST(StopInBend, AStartIsAsGentleAsTheAxesNeed) {
  const std::vector<PlannedMotion> plan = EastAndNorth();
  ASSERT_EQ(plan.size(), 4U);
  const std::span<const PlannedMotion> bend = std::span(plan).subspan(1);
  std::set<long> halvings;
  double acceleration = 4000.0;
  for (int n = 0; n < 24; ++n, acceleration *= 0.8) {
    const AxisLimits axes = WithAcceleration(acceleration);
    const std::vector<PlannedMotion> rest = RestartAlong(bend, 0.1 * plan[1].path.length(), axes);
    ASSERT_EQ(rest.size(), 3U);
    ASSERT_GT(rest[0].speed.phase_count(), 0);
    if (!AxesCan(rest, axes)) continue;
    const double gentler = plan[1].limits.jerk / rest[0].speed.phase(0).jerk;
    halvings.insert(std::lround(std::log2(gentler)));
  }
  EXPECT_EQ(halvings, (std::set<long>{0, 1, 2, 3, 4}));
}

// At 50 mm/s the middle of the bend, whose curvature is K / d, asks X of the first half for most,
// and Y of the second: 0.1 % more than they can is no harm, and more than that is. Both ends of a
// bend are looked at, and what is no bend is not. motion.md 4.2
TEST(StopInBend, AxesCanDoAThousandthMore) {
  const std::vector<PlannedMotion> plan = EastAndNorth();
  ASSERT_EQ(plan.size(), 4U);
  const double c = std::sqrt(0.5), rho = 2.0 * std::sqrt(c);
  const double k = 0.75 * rho * c / std::pow(c * (1.875 - 0.4375 * rho), 2);
  const double asked = 50.0 * 50.0 * k / plan[1].corner.cut_mm * c;
  for (const std::size_t half : {1U, 2U}) {
    const auto can = [&](double acceleration) {
      AxisLimits axes = StandardMachine().axes;
      axes.acceleration[half == 1 ? 0 : 1] = acceleration;
      return AxesCan(std::span(plan).subspan(half, 1), axes);
    };
    EXPECT_TRUE(can(asked * 1.0005)) << half;
    EXPECT_TRUE(can(asked / 1.0009)) << half;
    EXPECT_FALSE(can(asked / 1.0011)) << half;
  }
  EXPECT_TRUE(AxesCan(std::span(plan).first(1), WithAcceleration(1.0)));
}

}  // namespace
}  // namespace rmlcell::motion::stop_in_bend
