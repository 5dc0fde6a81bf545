// A STOP and the START behind it where only one motion, one place or one speed makes the
// difference. motion.md section 6
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <vector>

#include "engine/motion/kinematics/axes.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "engine/motion/ride/interruption.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::interruption_ends {
namespace {

// Straight on along X, a move each: how long, and with which share of the acceleration.
struct Straight {
  double length_mm;
  double acceleration = 1.0;
};
std::vector<PlannedMotion> PlanOf(const std::vector<Straight>& moves, double speed_fraction) {
  std::vector<MoveCommand> chain;
  double at = 0.0;
  for (const Straight& move : moves) {
    MoveCommand& command = chain.emplace_back();
    command.path = PathPiece::Line({{at, 0, 0}}, {{at + move.length_mm, 0, 0}});
    command.speed_fraction = speed_fraction;
    command.acceleration_fraction = move.acceleration;
    command.fly = chain.size() < moves.size();
    command.tag = chain.size();
    at += move.length_mm;
  }
  return Plan(chain);
}
const AxisLimits kAxesOfAll = StandardMachine().axes;

double LengthOf(const std::vector<PlannedMotion>& motions) {
  double sum = 0.0;
  for (const PlannedMotion& motion : motions) sum += motion.path.length();
  return sum;
}

// What is behind 1 mm of the way is what is left of it, as behind any other place.
TEST(InterruptionEnds, OneMillimetreOnIsNotTheBegin) {
  const std::vector<PlannedMotion> plan = PlanOf({{100.0}}, 0.1);
  ASSERT_EQ(plan.size(), 1U);
  const std::vector<PlannedMotion> rest = RestartAlong(plan, 1.0, kAxesOfAll);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].path.length(), 99.0);
  EXPECT_EQ(rest[0].path.from().point.x(), 1.0);
}

// 1 mm/s is no rest: at the end of a move that is passed so, a STOP brakes on the next one, and
// where that is not planned yet it says so.
TEST(InterruptionEnds, OneMillimetreASecondIsNoRest) {
  const std::vector<PlannedMotion> plan = PlanOf({{10.0}, {10.0, 0.5}}, 0.002);
  ASSERT_EQ(plan.size(), 2U);
  ASSERT_EQ(plan[0].speed.end().speed, 1.0);
  const double passed = plan[0].speed.duration_s();
  const StopOnPath stop = StopAlong(plan, passed, kAxesOfAll);
  EXPECT_TRUE(stop.complete);
  EXPECT_EQ(stop.index, 1U);
  EXPECT_NEAR(stop.s, 1.0 * std::sqrt(1.0 / 20000.0), 1e-9);
  ASSERT_EQ(stop.motions.size(), 1U);
  EXPECT_FALSE(StopAlong(std::span(plan).first(1), passed, kAxesOfAll).complete);
}

// A STOP brakes at once, with what the weakest move on the way has, though whoever went on to the
// stronger one behind it would stand sooner. ACCEL 5 is 100 mm/s2 and 2000 mm/s3. OPT-B.31
TEST(InterruptionEnds, BrakesAtOnceBeforeAStrongerMove) {
  const std::vector<PlannedMotion> plan = PlanOf({{100.0, 0.05}, {100.0}}, 0.1);
  ASSERT_EQ(plan.size(), 2U);
  const double t = plan[0].speed.TimeAt(99.5);
  ASSERT_NEAR(plan[0].speed.At(t).speed, 50.0, 1e-9);
  const StopOnPath stop = StopAlong(plan, t, kAxesOfAll);
  ASSERT_TRUE(stop.complete);
  EXPECT_NEAR(LengthOf(stop.motions), 25.0 * (50.0 / 100.0 + 100.0 / 2000.0), 1e-6);
  EXPECT_LT(stop.motions.front().speed.end().speed, 50.0 - 1e-6);
}

// Where such a ramp goes beyond what is planned, it says so, though who went on to the stronger
// move would stand on that.
TEST(InterruptionEnds, MoreIsToBePlannedBehindAStrongerMove) {
  const std::vector<PlannedMotion> plan = PlanOf({{100.0, 0.05}, {5.0}, {100.0, 0.9}}, 0.1);
  ASSERT_EQ(plan.size(), 3U);
  const double t = plan[0].speed.TimeAt(99.5);
  EXPECT_FALSE(StopAlong(std::span(plan).first(2), t, kAxesOfAll).complete);
  const StopOnPath stop = StopAlong(plan, t, kAxesOfAll);
  ASSERT_TRUE(stop.complete);
  EXPECT_EQ(stop.index, 2U);
  EXPECT_NEAR(LengthOf(stop.motions), 25.0 * (50.0 / 100.0 + 100.0 / 2000.0), 1e-6);
}

// A ramp of the plan runs across the end of a move, those from rest end at each of them: 0.5 mm
// from the target it is no faster than can be braked in them, (0.5 sqrt(j))^(2/3), and stands at
// the target. motion.md 5.2
TEST(InterruptionEnds, FromRestARampEndsAtEachMove) {
  const std::vector<PlannedMotion> plan = PlanOf({{100.0}, {0.5, 0.9}}, 0.1);
  ASSERT_EQ(plan.size(), 2U);
  ASSERT_NE(plan[0].speed.end().acceleration, 0.0);
  ASSERT_GT(plan[0].speed.end().speed, 20.0);
  const std::vector<PlannedMotion> rest = RestartAlong(plan, 40.0, kAxesOfAll);
  ASSERT_EQ(rest.size(), 2U);
  const double most = std::pow(0.5 * std::sqrt(0.9 * 40000.0), 2.0 / 3.0);
  EXPECT_NEAR(rest[0].speed.end().speed, most, 1e-6);
  EXPECT_EQ(rest[0].speed.end().acceleration, 0.0);
  EXPECT_EQ(rest[0].corner.speed, rest[0].speed.end().speed);
  EXPECT_EQ(rest[1].speed.end().speed, 0.0);
  EXPECT_NEAR(rest[1].speed.end().s, 0.5, 1e-12);
  EXPECT_NEAR(rest[1].speed.duration_s(), 2.0 * std::sqrt(most / (0.9 * 40000.0)), 1e-9);
}

// Three moves under one ramp, each weaker than the one before: what is passed at the end of each is
// what the moves behind it can brake, each with its own limits and length.
TEST(InterruptionEnds, EachMoveUnderARampBrakesWithItsOwnLimits) {
  const std::vector<PlannedMotion> plan = PlanOf({{100.0}, {0.4, 0.95}, {0.6, 0.8}}, 0.1);
  ASSERT_EQ(plan.size(), 3U);
  ASSERT_NE(plan[0].speed.end().acceleration, 0.0);
  ASSERT_NE(plan[1].speed.end().acceleration, 0.0);
  std::vector<PlannedMotion> rest = RestartAlong(plan, 40.0, kAxesOfAll);
  ASSERT_EQ(rest.size(), 3U);
  const double last = Reach(0.0, 0.6, plan[2].limits);
  const double middle = Reach(last, 0.4, plan[1].limits);
  EXPECT_NEAR(rest[1].speed.end().speed, std::min(last, plan[1].speed.end().speed), 1e-9);
  EXPECT_NEAR(rest[0].speed.end().speed, std::min(middle, plan[0].speed.end().speed), 1e-9);
  EXPECT_EQ(rest[2].speed.end().speed, 0.0);
}

// A move that may be taken up at 20 mm/s only is not entered faster, the last one neither.
TEST(InterruptionEnds, AMoveIsNotEnteredFasterThanItIsTakenUp) {
  std::vector<PlannedMotion> plan = PlanOf({{50.0}, {50.0, 0.9}}, 0.1);
  ASSERT_EQ(plan.size(), 2U);
  ASSERT_EQ(plan[0].speed.end().speed, 50.0);
  plan[1].restart_speed = 20.0;
  const std::vector<PlannedMotion> rest = RestartAlong(plan, 10.0, kAxesOfAll);
  ASSERT_EQ(rest.size(), 2U);
  EXPECT_NEAR(rest[0].speed.end().speed, 20.0, 1e-9);
  EXPECT_LE(rest[1].speed.peak_speed(), 20.0 + 1e-9);
}

// As soon as a planned speed is reached again where the plan neither speeds up nor slows down, all
// that comes is as it was planned, its ramps across moves, too.
TEST(InterruptionEnds, WhatComesBehindIsAsPlanned) {
  const std::vector<PlannedMotion> plan =
      PlanOf({{60.0}, {60.0, 0.9}, {40.0, 0.8}, {0.5, 0.9}}, 0.1);
  ASSERT_EQ(plan.size(), 4U);
  ASSERT_EQ(plan[0].speed.end().acceleration, 0.0);
  ASSERT_NE(plan[2].speed.end().acceleration, 0.0);
  const std::vector<PlannedMotion> rest = RestartAlong(plan, 10.0, kAxesOfAll);
  ASSERT_EQ(rest.size(), 4U);
  EXPECT_EQ(rest[0].speed.end().speed, 50.0);
  for (std::size_t k = 1; k < 4; ++k) {
    EXPECT_EQ(rest[k].speed.duration_s(), plan[k].speed.duration_s()) << k;
    EXPECT_EQ(rest[k].speed.end().speed, plan[k].speed.end().speed) << k;
    EXPECT_EQ(rest[k].speed.end().acceleration, plan[k].speed.end().acceleration) << k;
  }
}

// At rest where one move ends and the next one would have gone straight on, the next one begins at
// rest; of the first nothing is left.
TEST(InterruptionEnds, FromTheEndOfAMoveTheNextOneBeginsAtRest) {
  const std::vector<PlannedMotion> plan = PlanOf({{50.0}, {50.0, 0.9}}, 0.1);
  ASSERT_EQ(plan.size(), 2U);
  ASSERT_EQ(plan[0].speed.end().speed, 50.0);
  const std::vector<PlannedMotion> rest = RestartAlong(plan, 50.0, kAxesOfAll);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].tag, 2U);
  EXPECT_EQ(rest[0].speed.At(0.0).speed, 0.0);
  EXPECT_NEAR(rest[0].speed.end().s, 50.0, 1e-12);
}

// Of a plan that ends in the middle of a ramp, as far as it is planned, nothing else is looked at.
TEST(InterruptionEnds, WhatIsNotPlannedYetIsNotBegun) {
  const std::vector<PlannedMotion> plan = PlanOf({{100.0}, {0.5, 0.9}}, 0.1);
  ASSERT_NE(plan[0].speed.end().acceleration, 0.0);
  const std::vector<PlannedMotion> rest = RestartAlong(std::span(plan).first(1), 40.0, kAxesOfAll);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_NEAR(rest[0].speed.end().speed, plan[0].speed.end().speed, 1e-9);
}

bool AxesCanDo(const PlannedMotion& motion, const SpeedProfile& speed) {
  for (int k = 0; k <= 64; ++k) {
    const PathState state = speed.At(speed.duration_s() * k / 64);
    const AxisDerivatives q = DerivativesAt(motion.path, motion.head, state.s);
    for (const std::size_t i : kAxes) {
      const double asked =
          q.first[i] * state.acceleration + q.second[i] * state.speed * state.speed;
      if (std::abs(asked) > kAxesOfAll.acceleration[i]) return false;
    }
  }
  return true;
}

// In a bend in which the head turns: wherever the axes can brake at once with a half, a quarter, an
// eighth or a sixteenth of the limit, the machine stands no later than that.
TEST(InterruptionEnds, BrakesMoreGentlyWhereThatIsSooner) {
  int gentle = 0;
  const auto look = [&](std::span<const PlannedMotion> ahead, double t) {
    const PlannedMotion& bend = ahead.front();
    for (const double share : {1.0, 0.5, 0.25, 0.125, 0.0625}) {
      PathLimits limits = bend.limits;
      limits.acceleration *= share;
      const SpeedProfile ramp = bend.speed.StopFrom(t, limits);
      if (ramp.end().s > bend.path.length()) return;
      if (!AxesCanDo(bend, ramp)) continue;
      double time = 0.0;
      for (const PlannedMotion& motion : StopAlong(ahead, t, kAxesOfAll).motions)
        time += motion.speed.duration_s();
      EXPECT_LE(time, ramp.duration_s() + 1e-9) << share;
      gentle += share < 1.0 ? 1 : 0;
      return;
    }
  };
  for (std::uint64_t seed = 122; seed <= 131; ++seed) {
    const std::vector<PlannedMotion> plan =
        Plan(RandomChain(seed, 6, {.all_fly = true, .shortest_mm = 0.5, .longest_mm = 5.0}));
    for (std::size_t k = 0; k < plan.size(); ++k) {
      if (plan[k].path.kind() != PathPiece::Kind::kBlend) continue;
      for (const double share : {0.0, 0.2, 0.4, 0.6, 0.8})
        look(std::span(plan).subspan(k), share * plan[k].speed.duration_s());
    }
  }
  EXPECT_GT(gentle, 0);
}

AxisLimits WithAccelerations(double share) {
  AxisLimits axes = kAxesOfAll;
  for (std::size_t i = 0; i < kAxisCount; ++i) axes.acceleration[i] *= share;
  return axes;
}

// The gentler ramps are tried in turn: a half, a quarter, an eighth, a sixteenth, and that at the
// last, whatever the axes can.
TEST(InterruptionEnds, EachShareIsTriedInTurn) {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Line({}, {{100, 0, 0}});
  chain[1].path = PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
  chain[0].fly = true;
  chain[0].speed_fraction = chain[1].speed_fraction = 0.1;
  const std::vector<PlannedMotion> plan = Plan(chain);
  ASSERT_EQ(plan.size(), 4U);
  const double half_way = 0.5 * plan[1].path.length();
  std::set<double> shares;
  for (double share = 1.0; share > 1e-3; share *= 0.95) {
    const std::vector<PlannedMotion> rest =
        RestartAlong(std::span(plan).subspan(1), half_way, WithAccelerations(share));
    ASSERT_FALSE(rest.empty());
    ASSERT_GT(rest[0].speed.phase_count(), 0);
    shares.insert(std::round(rest[0].speed.phase(0).jerk / plan[1].limits.jerk * 1e9) / 1e9);
  }
  EXPECT_EQ(shares, (std::set{0.0625, 0.125, 0.25, 0.5, 1.0}));
}

// What a bend asks of an axis may be 0.1 % more than that can, and no more, at its ends as on the
// way: X is asked for most where the first half of a bend from X to Y ends, and Y where the second
// half begins.
TEST(InterruptionEnds, ATenthOfAPercentMoreIsNoHarm) {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Joint({}, {{100, 0, 0}});
  chain[1].path = PathPiece::Joint({{100, 0, 0}}, {{100, 100, 0}});
  for (MoveCommand& move : chain) move.kind = MoveCommand::Kind::kPointToPointAxes;
  chain[0].fly = true;
  const std::vector<PlannedMotion> plan = Plan(chain);
  ASSERT_EQ(plan.size(), 4U);
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    const PlannedMotion& bend = plan[axis + 1];
    ASSERT_EQ(bend.path.kind(), PathPiece::Kind::kBlend);
    const double end_s = axis == 0 ? bend.speed.duration_s() : 0.0;
    const PathState state = bend.speed.At(end_s);
    const AxisDerivatives q = DerivativesAt(bend.path, bend.head, state.s);
    const double asked = std::abs(q.second[axis]) * state.speed * state.speed;
    ASSERT_GT(asked, 100.0);
    const std::span<const PlannedMotion> alone = std::span(plan).subspan(axis + 1, 1);
    AxisLimits axes = kAxesOfAll;
    axes.acceleration.setConstant(1e9);
    axes.acceleration[axis] = asked / 1.0005;
    EXPECT_TRUE(AxesCan(alone, axes)) << axis;
    axes.acceleration[axis] = asked / 1.0015;
    EXPECT_FALSE(AxesCan(alone, axes)) << axis;
  }
}

// What has braked to rest by the time at which its acceleration is zero fits into what that takes:
// 1 s and 10 - 20 / 3 mm from 10 mm/s.
TEST(InterruptionEnds, WhatIsAtRestThenFits) {
  const PathLimits limits{.speed = 50.0, .acceleration = 40.0, .jerk = 20.0};
  EXPECT_TRUE(FromFits({0.0, 10.0, -20.0}, 3.334, 0.0, limits));
  EXPECT_TRUE(FromFits({0.0, 10.0, -20.0}, 10.0 - 20.0 / 3.0, 0.0, limits));
  EXPECT_FALSE(FromFits({0.0, 10.0, -20.0}, 3.332, 0.0, limits));
}

// Below 1 mm/s a ramp is as short as it is: 0.2 mm/s to rest take 0.2 sqrt(0.2 / j).
TEST(InterruptionEnds, SlowRampsFitIntoLittle) {
  const PathLimits limits{.speed = 50.0, .acceleration = 2000.0, .jerk = 40000.0};
  const double need = 0.2 * std::sqrt(0.2 / 40000.0);
  EXPECT_TRUE(FromFits({3.0, 0.2, 0.0}, 3.0 + need * 1.001, 0.0, limits));
  EXPECT_FALSE(FromFits({3.0, 0.2, 0.0}, 3.0 + need * 0.999, 0.0, limits));
}

// What speeds up by 1 mm/s2 first stops doing so, too.
TEST(InterruptionEnds, HoweverSlowlyItSpeedsUp) {
  const PathLimits limits{.speed = 50.0, .acceleration = 2.0, .jerk = 4.0};
  // 0.25 s, on average at v + a t / 3, to 10.125 mm/s; from there to rest.
  const double first = 0.25 * (10.0 + 0.25 / 3.0);
  const double need = first + 0.5 * 10.125 * (10.125 / 2.0 + 0.5);
  EXPECT_TRUE(FromFits({0.0, 10.0, 1.0}, need * 1.0001, 0.0, limits));
  EXPECT_FALSE(FromFits({0.0, 10.0, 1.0}, need * 0.9999, 0.0, limits));
}

}  // namespace
}  // namespace rmlcell::motion::interruption_ends
