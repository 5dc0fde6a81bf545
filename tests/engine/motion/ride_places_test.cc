// A STOP and a START at the very places where one motion ends and the next begins, and polylines at
// the tolerance itself. motion.md 6, 9
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "engine/motion/geometry/blend_curve.h"
#include "engine/motion/ride/interruption.h"
#include "engine/motion/ride/path_ride.h"
#include "engine/motion/ride/trajectory.h"
#include "tests/engine/motion/items_text.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::ride_places {
namespace {

// Lines straight on at 50 mm/s, each with a mark behind it: 11, 12 ... Without OVERSH the
// machine stands between them for no time, without /FLY it settles there.
PathRide RideOverLines(std::size_t count, bool fly, double length_mm = 100.0) {
  Planner planner(StandardMachine());
  for (std::size_t k = 0; k < count; ++k) {
    const double x = length_mm * static_cast<double>(k);
    MoveCommand move;
    move.path = PathPiece::Line({{x, 0, 0}}, {{x + length_mm, 0, 0}});
    move.speed_fraction = 0.1;
    move.overshoot_fraction = 0.0;
    move.fly = fly && k + 1 < count;
    move.tag = k + 1;
    EXPECT_TRUE(planner.Append(move));
    planner.Mark(11 + k);
  }
  planner.Stop();
  PathRide ride(HoldRamp::kStays);
  while (const std::optional<PlannedItem> item = planner.Next()) ride.Plan(*item);
  return ride;
}

// STOP while it settles: nothing is passed any more, and all that follows waits for START.
TEST(RidePlaces, AStopWhileItSettlesPassesNoMark) {
  PathRide ride = RideOverLines(2, false);
  const AxisLimits axes = StandardMachine().axes;
  const SimTime now = ride.Begin(std::chrono::seconds(5)).arrival + std::chrono::milliseconds(20);
  const auto plan = ride.PlanStop(now, axes);
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->ramp.motions.empty());
  ride.Stop(*plan, axes);
  EXPECT_EQ(ItemsOf(ride.to_come()), "");
  EXPECT_EQ(ItemsOf(ride.interrupted()), " 1 m11 2 m12");
}

// STOP where one line is over and stands without settling: of it its mark is left, and the next one
// ends as ever, be it short or long.
TEST(RidePlaces, AStopBetweenTwoMotionsLeavesTheSecond) {
  for (const double length_mm : {100.0, 0.5}) {
    PathRide ride = RideOverLines(4, true, length_mm);
    const AxisLimits axes = StandardMachine().axes;
    const auto plan = ride.PlanStop(ride.Begin(std::chrono::seconds(5)).arrival, axes);
    ASSERT_TRUE(plan);
    ride.Stop(*plan, axes);
    EXPECT_EQ(ItemsOf(ride.to_come()), "");
    EXPECT_EQ(ItemsOf(ride.interrupted()), " m11 2 m12 3 m13 4 m14");
    const auto& second = std::get<PlannedMotion>(ride.interrupted()[1]);
    EXPECT_EQ(second.path.from().point.x(), length_mm);
    EXPECT_EQ(second.path.to().point.x(), 2.0 * length_mm);
    EXPECT_TRUE(second.ends_move);
  }
}

// In COORD ROBOT, too, nothing but the settling is left of a move at its end: it stands there.
TEST(RidePlaces, AMoveOfTheAxesStandsAtItsEnd) {
  MoveCommand move;
  move.kind = MoveCommand::Kind::kPointToPointAxes;
  move.path = PathPiece::Joint({{0, 0, 0}, 0.1, 0.2}, {{300, -200, 100}, 0.7, -0.4});
  const std::vector<PlannedMotion> plan = Plan({move});
  ASSERT_EQ(plan.size(), 1U);
  const std::vector<PlannedMotion> rest =
      RestartAlong(plan, plan[0].path.length(), StandardMachine().axes);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].path.kind(), PathPiece::Kind::kJoint);
  EXPECT_EQ(rest[0].path.length(), 0.0);
  EXPECT_EQ(rest[0].path.from().point, plan[0].path.to().point);
  EXPECT_EQ(rest[0].path.to().a_rad, 0.7);
  EXPECT_EQ(rest[0].speed.duration_s(), 0.0);
  EXPECT_EQ(rest[0].settling_s, 0.048);
}

// A move that may be taken up at 20 mm/s only, but is not planned yet as far as anybody asks, is no
// bound of the one before it.
TEST(RidePlaces, WhatIsNotAheadIsNoBound) {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Line({}, {{50, 0, 0}});
  chain[1].path = PathPiece::Line({{50, 0, 0}}, {{100, 0, 0}});
  chain[0].fly = true;
  chain[0].speed_fraction = chain[1].speed_fraction = 0.1;
  chain[1].acceleration_fraction = 0.9;  // else they are one
  std::vector<PlannedMotion> plan = Plan(chain);
  ASSERT_EQ(plan.size(), 2U);
  plan[1].restart_speed = 20.0;
  const AxisLimits axes = StandardMachine().axes;
  EXPECT_NEAR(RestartAlong(std::span(plan).first(1), 5.0, axes)[0].speed.end().speed, 50.0, 1e-9);
  EXPECT_NEAR(RestartAlong(plan, 5.0, axes)[0].speed.end().speed, 20.0, 1e-9);
}

// Lengths of other formulas have room for one part in 1e9 of the way, and no more.
TEST(RidePlaces, FitsWithRoomForRounding) {
  const PathLimits limits{350.0, 2000.0, 40000.0};
  const double down = 25.0 * 2.0 * std::sqrt(50.0 / 40000.0);
  for (const double from : {0.0, 20.0}) {
    EXPECT_TRUE(FromFits({from, 50.0, 0.0}, from + down * (1.0 - 0.5e-9), 0.0, limits)) << from;
    EXPECT_FALSE(FromFits({from, 50.0, 0.0}, from + down * (1.0 - 2e-9), 0.0, limits)) << from;
  }
}

// How far the middle of each quarter of a piece of a bend is from its chord.
std::array<double, 4> MissesOfQuarters(const PathPiece& path) {
  const BlendCurve blend(path);
  const double from = blend.ParameterAt(0.0), to = blend.ParameterAt(path.length());
  const double middle = 0.5 * (from + to);
  const std::array<double, 5> u{from, 0.5 * (from + middle), middle, 0.5 * (middle + to), to};
  std::array<MachinePoint, 5> at;
  for (std::size_t k = 1; k < 4; ++k) at[k] = blend.curve().At(u[k]).point;
  at.front() = path.from().point;
  at.back() = path.to().point;
  std::array<double, 4> misses{};
  for (std::size_t k = 0; k < 4; ++k) {
    const MachinePoint on_curve = blend.curve().At(0.5 * (u[k] + u[k + 1])).point;
    misses[k] = (on_curve - ((at[k] + at[k + 1]) * 0.5)).norm();
  }
  return misses;
}

// A chord that misses its bend by exactly the tolerance is near enough; by a last digit more it is
// halved.
TEST(RidePlaces, AChordMayMissByTheTolerance) {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Line({}, {{100, 0, 0}});
  chain[1].path = PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
  chain[0].fly = true;
  for (const PlannedMotion& motion : Plan(chain)) {
    if (motion.path.kind() != PathPiece::Kind::kBlend) continue;
    const auto misses = MissesOfQuarters(motion.path);
    const double worst = *std::ranges::max_element(misses);
    std::vector<MachinePoint> just, less;
    AppendPolyline(motion.path, worst, just);
    AppendPolyline(motion.path, std::nextafter(worst, 0.0), less);
    EXPECT_EQ(just.size(), 5U);
    EXPECT_EQ(less.size(), 6U);
  }
}

// Where a motion settles it stands, whatever speed its profile has at the end.
TEST(RidePlaces, WhatSettlesStands) {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Line({}, {{50, 0, 0}});
  chain[1].path = PathPiece::Line({{50, 0, 0}}, {{100, 0, 0}});
  chain[0].fly = true;
  chain[0].speed_fraction = chain[1].speed_fraction = 0.1;
  PlannedMotion first = Plan(chain)[0];
  first.settling_s = 0.048;
  const MotionView view(first);
  EXPECT_NEAR(view.At(first.speed.duration_s()).tip_speed(), 50.0, 1e-9);
  EXPECT_EQ(view.At(first.speed.duration_s() + 1e-3).tip_speed(), 0.0);
  EXPECT_EQ(view.At(first.speed.duration_s() + 1e-3).tip.tip.x(), 50.0);
}

// Where a bend is gone through more gently it is so by its speed, too, whose square the bend takes
// of the axes. OPT-B.31
TEST(RidePlaces, GentlerInABendIsSlower) {
  const AxisLimits axes = StandardMachine().axes;
  int gentler = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const std::vector<PlannedMotion> plan =
        Plan(RandomChain(seed, 6, {.all_fly = true, .shortest_mm = 0.5, .longest_mm = 5.0}));
    for (std::size_t k = 0; k < plan.size(); ++k) {
      if (plan[k].path.kind() != PathPiece::Kind::kBlend) continue;
      const PlannedMotion rest =
          RestartAlong(std::span(plan).subspan(k), 0.1 * plan[k].path.length(), axes).front();
      const double share = rest.speed.phase(0).jerk / plan[k].limits.jerk;
      const double most = std::min(plan[k].limits.speed, plan[k].restart_speed);
      EXPECT_LE(rest.speed.peak_speed(), most * std::sqrt(share) * (1.0 + 1e-9)) << seed;
      gentler += share < 0.75 ? 1 : 0;
    }
  }
  EXPECT_GT(gentler, 0);
}

}  // namespace
}  // namespace rmlcell::motion::ride_places
