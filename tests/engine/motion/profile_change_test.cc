// What becomes of a profile and of a plan on the way: parts, overrides, STOP and START, in closed
// form. motion.md 5.2, 6.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "engine/motion/ride/interruption.h"
#include "tests/engine/motion/expect_near.h"
#include "tests/engine/motion/random_chain.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

constexpr PathLimits kLimits{350.0, 2000.0, 40000.0};

// S02 of section 12: 30 mm in 0.3 s, six phases of 0.05 s; a jerk of 40000 brings 2000 mm/s2 and
// 50 mm/s in one of them, so that the peak is 50 + 100 + 50.
SpeedProfile S02() { return SpeedProfile::Span(30.0, 0, 0, kLimits); }

TEST(SpeedProfile, PhasesOfS02) {
  const SpeedProfile p = S02();
  ASSERT_EQ(p.phase_count(), 6);
  constexpr double kJerk[6] = {40000, 0, -40000, -40000, 0, 40000};
  constexpr double kStart[6] = {0, 50, 150, 200, 150, 50};
  constexpr double kAcceleration[6] = {0, 2000, 2000, 0, -2000, -2000};
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(p.phase(k).duration_s, 0.05, 1e-12);
    EXPECT_NEAR(p.phase(k).jerk, kJerk[k], 1e-9);
    EXPECT_NEAR(p.phase(k).start.speed, kStart[k], 1e-9);
    EXPECT_NEAR(p.phase(k).start.acceleration, kAcceleration[k], 1e-9);
  }
  EXPECT_NEAR(p.peak_speed(), 200.0, 1e-9);
  EXPECT_NEAR(p.phase(1).start.s, 40000.0 * 1.25e-4 / 6.0, 1e-12);
  EXPECT_NEAR(p.PlaceAt(0.05), 40000.0 * 1.25e-4 / 6.0, 1e-12);
  EXPECT_NEAR(p.PlaceAt(0.21), p.At(0.21).s, 1e-14);
  EXPECT_EQ(p.PlaceAt(-1.0), 0.0);
  EXPECT_EQ(p.PlaceAt(0.3), 30.0);
  EXPECT_NEAR(p.At(0.2).speed, 150.0, 1e-9);
  EXPECT_NEAR(p.At(0.22).acceleration, -2000.0, 1e-9);
}

// When a place is passed, and back; a part is the same between two places.
TEST(SpeedProfile, TimesAndParts) {
  for (const PathLimits& limits :
       {kLimits, PathLimits{350, 2000, kNoLimit}, PathLimits{60, 900, 8000}}) {
    const SpeedProfile p = SpeedProfile::Span(30.0, 20.0, 45.0, limits);
    EXPECT_EQ(p.TimeAt(-1.0), 0.0);
    EXPECT_NEAR(p.TimeAt(30.0), p.duration_s(), 1e-12);
    EXPECT_NEAR(p.TimeAt(31.0), p.duration_s(), 1e-12);
    for (const double t : {0.01, 0.1, 0.17, 0.3}) {
      if (t > p.duration_s()) continue;
      EXPECT_NEAR(p.TimeAt(p.At(t).s), t, 1e-10);
    }
    for (const auto& [from, to] : {std::pair{0.0, 7.0}, {3.0, 4.0}, {11.0, 29.0}, {14.0, 30.0}}) {
      const SpeedProfile part = p.Part(from, to);
      const double begin = p.TimeAt(from);
      EXPECT_NEAR(part.duration_s(), p.TimeAt(to) - begin, 1e-9);
      EXPECT_NEAR(part.end().s, to - from, 1e-12);
      EXPECT_NEAR(part.end().speed, p.At(p.TimeAt(to)).speed, 1e-6);
      double peak = 0.0;
      for (int k = 0; k <= 40; ++k) {
        const double t = part.duration_s() * k / 40.0;
        EXPECT_NEAR(part.At(t).s + from, p.At(begin + t).s, 1e-8);
        EXPECT_NEAR(part.At(t).speed, p.At(begin + t).speed, 1e-6);
        peak = std::max(peak, p.At(begin + t).speed);
      }
      EXPECT_GE(part.peak_speed(), peak * (1 - 1e-9));
      EXPECT_LE(part.peak_speed(), p.peak_speed() * (1 + 1e-12));
    }
  }
}

// A place that only moves on gives the parts one behind the other.
TEST(SpeedProfile, PartsOneBehindTheOther) {
  const SpeedProfile p = SpeedProfile::Span(100.0, 0, 0, {50, 2000, 40000});
  SpeedProfile::Place place;
  SpeedProfile part;
  double time = 0.0;
  for (int k = 1; k <= 200; ++k) {
    p.PartTo(place, 0.5 * k, part);
    EXPECT_EQ(place.s, 0.5 * k);
    EXPECT_NEAR(part.end().s, 0.5, 1e-12);
    EXPECT_NEAR(part.At(0.0).speed, p.At(time).speed, 1e-5);
    time += part.duration_s();
    EXPECT_NEAR(time, p.TimeAt(0.5 * k), 1e-9);
  }
  EXPECT_NEAR(time, 2.0 + 2.0 * std::sqrt(50.0 / 40000.0), 1e-9);
}

TEST(SpeedProfile, ScaledIsTheSameInTime) {
  const SpeedProfile p = S02(), twice = p.Scaled(2.0);
  EXPECT_EQ(twice.duration_s(), p.duration_s());
  EXPECT_DOUBLE_EQ(twice.peak_speed(), 2.0 * p.peak_speed());
  EXPECT_DOUBLE_EQ(twice.end().s, 60.0);
  for (const double t : {0.02, 0.12, 0.2, 0.3}) {
    EXPECT_NEAR(twice.At(t).s, 2.0 * p.At(t).s, 1e-12);
    EXPECT_NEAR(twice.At(t).speed, 2.0 * p.At(t).speed, 1e-10);
    EXPECT_NEAR(twice.At(t).acceleration, 2.0 * p.At(t).acceleration, 1e-9);
  }
}

// While it slows down a STOP changes nothing: the motion ends where and when it would. OPT-B.31
TEST(StopFrom, SlowingDownGoesOn) {
  for (const double t : {0.16, 0.2, 0.22, 0.251, 0.27, 0.299}) {
    const SpeedProfile stop = S02().StopFrom(t, kLimits);
    EXPECT_NEAR(stop.end().s, 30.0, 1e-9) << t;
    EXPECT_NEAR(stop.duration_s(), 0.3 - t, 1e-9) << t;
    EXPECT_NEAR(stop.peak_speed(), S02().At(t).speed, 1e-9) << t;
  }
  // With twice the acceleration: at 150 mm/s and -2000 mm/s2 the ramp began at 200 as it were,
  // 0.05 s to -4000, 0 at that, 0.1 s back: 200 = 4000^2/40000/2. It ends after 0.15 s less.
  const SpeedProfile hard = S02().StopFrom(0.2, {350.0, 4000.0, 40000.0});
  const double grow = (std::sqrt(200.0 * 40000.0) - 2000.0) / 40000.0;
  EXPECT_NEAR(hard.duration_s(), grow + std::sqrt(200.0 / 40000.0), 1e-9);
  // With less than it slows down by it goes on as it does: 0.05 s at -2000, 0.05 s to 0.
  const SpeedProfile weak = S02().StopFrom(0.2, {350.0, 1000.0, 40000.0});
  EXPECT_NEAR(weak.duration_s(), 0.1, 1e-9);
  EXPECT_NEAR(weak.end().s, 30.0, 1e-9);
  // Trapezoid: 150 mm/s at 2000 mm/s2.
  const SpeedProfile abrupt = S02().StopFrom(0.2, {350.0, 2000.0, kNoLimit});
  EXPECT_NEAR(abrupt.duration_s(), 0.075, 1e-9);
}

// A new speed on the way (case O01): at 50 mm/s in 1000 mm, 250 mm done, up to 72.5.
TEST(From, FasterAndSlower) {
  const PathState cruising{250.0, 50.0, 0.0};
  const SpeedProfile faster = SpeedProfile::From(cruising, 1000.0, 0.0, {72.5, 2000.0, 40000.0});
  const double up = 2.0 * std::sqrt(22.5 / 40000.0), down = 2.0 * std::sqrt(72.5 / 40000.0);
  EXPECT_NEAR(faster.duration_s(), up + down + (750.0 - 61.25 * up - 36.25 * down) / 72.5, 1e-9);
  EXPECT_NEAR(faster.peak_speed(), 72.5, 1e-9);
  EXPECT_EQ(faster.end().s, 1000.0);
  EXPECT_NEAR(faster.At(0.0).s, 250.0, 1e-12);
  const SpeedProfile slower = SpeedProfile::From(cruising, 1000.0, 0.0, {5.0, 2000.0, 40000.0});
  const double fall = 2.0 * std::sqrt(45.0 / 40000.0), rest = 2.0 * std::sqrt(5.0 / 40000.0);
  EXPECT_NEAR(slower.duration_s(), fall + rest + (750.0 - 27.5 * fall - 2.5 * rest) / 5.0, 1e-9);
  EXPECT_EQ(slower.peak_speed(), 50.0);
  // Too near to slow down twice: the present speed is kept as long as it can be.
  const double near = 25.0 * 2.0 * std::sqrt(50.0 / 40000.0) + 0.05;
  const SpeedProfile kept = SpeedProfile::From({0.0, 50.0, 0.0}, near, 0.0, {5.0, 2000.0, 40000.0});
  EXPECT_NEAR(kept.duration_s(), 2.0 * std::sqrt(50.0 / 40000.0) + 0.05 / 50.0, 1e-9);
}

// First the acceleration goes to zero: from 18 mm/s and 1200 mm/s2, 0.03 s and 18 mm/s more; from
// -1200 as much less. Without a limit on jerk at once.
TEST(From, EndsTheAccelerationFirst) {
  const double way = 0.03 * (18.0 + 1200.0 * 0.03 / 3.0);
  const SpeedProfile up = SpeedProfile::From({0.0, 18.0, 1200.0}, 50.0, 36.0, {36, 2000, 40000});
  EXPECT_NEAR(up.duration_s(), 0.03 + (50.0 - way) / 36.0, 1e-9);
  const SpeedProfile down = SpeedProfile::From({0.0, 54.0, -1200.0}, 50.0, 36.0, {36, 2000, 40000});
  EXPECT_NEAR(down.duration_s(), 0.03 + (50.0 - 0.03 * (54.0 - 12.0)) / 36.0, 1e-9);
  const SpeedProfile abrupt =
      SpeedProfile::From({0.0, 36.0, 900.0}, 50.0, 36.0, {36, 2000, kNoLimit});
  EXPECT_NEAR(abrupt.duration_s(), 50.0 / 36.0, 1e-12);
}

// Whether that can be done: 25 mm/s on average for 0.0707 s, 1.7678 mm, from 50 mm/s to rest; with
// an acceleration to be ended first a little more.
// Between speeds that differ by rounding no way is needed; and none is left behind the end.
TEST(FromFits, WhatDiffersByRounding) {
  EXPECT_TRUE(FromFits({10.0, 50.0, 0.0}, 10.0, 50.0, kLimits));
  EXPECT_TRUE(FromFits({10.0, 50.0, 0.0}, 10.0, 50.0 * (1.0 + 0.9e-9), kLimits));
  EXPECT_FALSE(FromFits({10.0, 50.0, 0.0}, 10.0, 50.0 * (1.0 + 1.1e-9), kLimits));
  EXPECT_FALSE(FromFits({10.0, 50.0, 0.0}, 10.0 - 1e-6, 50.0, kLimits));
  EXPECT_TRUE(FromFits({10.0, 0.0, 0.0}, 10.0, 0.0, kLimits));
}

// Without a limit on jerk the acceleration is gone at once: v * v / 2a.
TEST(FromFits, WithoutALimitOnJerk) {
  PathLimits limits = kLimits;
  limits.jerk = std::numeric_limits<double>::infinity();
  const double need = 50.0 * 50.0 / (2.0 * limits.acceleration);
  // However short the way is: the room for rounding is a share of it.
  const double speed = std::sqrt(2.0 * limits.acceleration * 1e-3);
  EXPECT_TRUE(FromFits({0.0, speed, 0.0}, 1e-3 * (1.0 + 1e-8), 0.0, limits));
  EXPECT_FALSE(FromFits({0.0, speed, 0.0}, 1e-3 * (1.0 - 1e-8), 0.0, limits));
  for (const double acceleration : {1200.0, 0.0, -1200.0}) {
    EXPECT_TRUE(FromFits({0.0, 50.0, acceleration}, need * 1.0001, 0.0, limits));
    EXPECT_FALSE(FromFits({0.0, 50.0, acceleration}, need * 0.9999, 0.0, limits));
  }
}

TEST(FromFits, JustAndJustNot) {
  const double need = 25.0 * 2.0 * std::sqrt(50.0 / 40000.0);
  EXPECT_TRUE(FromFits({10.0, 50.0, 0.0}, 10.0 + need * 1.0001, 0.0, kLimits));
  EXPECT_FALSE(FromFits({10.0, 50.0, 0.0}, 10.0 + need * 0.9999, 0.0, kLimits));
  EXPECT_TRUE(FromFits({0.0, 20.0, 0.0}, 70.0 * std::sqrt(30.0 / 40000.0) * 1.0001, 50.0, kLimits));
  EXPECT_FALSE(
      FromFits({0.0, 20.0, 0.0}, 70.0 * std::sqrt(30.0 / 40000.0) * 0.9999, 50.0, kLimits));
  // 18 mm/s, speeding up by 1200: 0.9 mm to 36 mm/s, from there to rest.
  const double more = 0.03 * (18.0 + 12.0) + 36.0 * std::sqrt(36.0 / 40000.0);
  EXPECT_TRUE(FromFits({0.0, 18.0, 1200.0}, more * 1.0001, 0.0, kLimits));
  EXPECT_FALSE(FromFits({0.0, 18.0, 1200.0}, more * 0.9999, 0.0, kLimits));
  // Slowing down by 1200 from 54: 1.26 mm to 36 mm/s.
  const double less = 0.03 * (54.0 - 12.0) + 36.0 * std::sqrt(36.0 / 40000.0);
  EXPECT_TRUE(FromFits({0.0, 54.0, -1200.0}, less * 1.0001, 0.0, kLimits));
  EXPECT_FALSE(FromFits({0.0, 54.0, -1200.0}, less * 0.9999, 0.0, kLimits));
  // It would come to rest before its acceleration ends.
  EXPECT_FALSE(FromFits({0.0, 17.0, -1200.0}, 100.0, 0.0, kLimits));
  EXPECT_TRUE(FromFits({0.0, 19.0, -1200.0}, 100.0, 0.0, kLimits));
  // Without a limit on jerk there is none to be ended: v^2 / 2a.
  EXPECT_TRUE(FromFits({0.0, 50.0, -1200.0}, 0.626, 0.0, {350, 2000, kNoLimit}));
  EXPECT_FALSE(FromFits({0.0, 50.0, -1200.0}, 0.624, 0.0, {350, 2000, kNoLimit}));
  // At the end already, at that speed or not.
  EXPECT_TRUE(FromFits({5.0, 50.0, 0.0}, 5.0, 50.0, kLimits));
  EXPECT_FALSE(FromFits({5.0, 50.0, 0.0}, 5.0, 49.0, kLimits));
}

// Below 1 mm/s and with an acceleration of 1 as elsewhere; and an acceleration that ends just where
// the way does, as fast as is wanted there, needs nothing more.
TEST(FromFits, SmallFiguresAndExactWays) {
  EXPECT_TRUE(FromFits({0.0, 0.5, 0.0}, 0.0018, 0.0, kLimits));  // 0.0017678 mm
  EXPECT_FALSE(FromFits({0.0, 0.5, 0.0}, 0.0017, 0.0, kLimits));
  // 1 mm/s2 at 0.25 mm/s3: 4 s from 5 to 7 mm/s, from there to rest.
  const PathLimits soft{9.0, 4.0, 0.25};
  const double total = 4.0 * (5.0 + 4.0 / 3.0) + 7.0 * std::sqrt(7.0 / 0.25);
  EXPECT_TRUE(FromFits({0.0, 5.0, 1.0}, total * 1.0001, 0.0, soft));
  EXPECT_FALSE(FromFits({0.0, 5.0, 1.0}, total * 0.9999, 0.0, soft));
  const double up = 0.03 * (18.0 + 1200.0 * 0.03 / 3.0), down = 0.03 * (18.0 - 1200.0 * 0.03 / 3.0);
  EXPECT_TRUE(FromFits({0.0, 18.0, 1200.0}, up, 36.0, kLimits));
  EXPECT_TRUE(FromFits({0.0, 18.0, -1200.0}, down, 0.0, kLimits));
}

std::vector<PlannedMotion> RightAngle() {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Line({}, {{100, 0, 0}});
  chain[1].path = PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
  chain[0].fly = true;
  chain[1].tag = 1;
  for (MoveCommand& move : chain) move.speed_fraction = 0.1;
  return Plan(chain);
}

// START on a line of 100 mm at 50 mm/s, 40 mm on: 60 mm from rest to rest, and it settles.
TEST(RestartAlong, FromRestOnALine) {
  std::vector<MoveCommand> chain(1);
  chain[0].path = PathPiece::Line({}, {{100, 0, 0}});
  chain[0].speed_fraction = 0.1;
  const std::vector<PlannedMotion> plan = Plan(chain);
  const auto rest = RestartAlong(plan, 40.0, StandardMachine().axes);
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].path.from().point, (MachineVector{40, 0, 0}));
  EXPECT_NEAR(rest[0].path.length(), 60.0, 1e-12);
  EXPECT_NEAR(rest[0].speed.duration_s(), 60.0 / 50.0 + 2.0 * std::sqrt(50.0 / 40000.0), 1e-9);
  EXPECT_EQ(rest[0].settling_s, 0.048);
  // At its very end only the settling is left; behind that nothing.
  const auto settling = RestartAlong(plan, 100.0, StandardMachine().axes);
  ASSERT_EQ(settling.size(), 1u);
  EXPECT_EQ(settling[0].speed.duration_s(), 0.0);
  EXPECT_EQ(settling[0].path.length(), 0.0);
  EXPECT_EQ(settling[0].path.from().point, (MachineVector{100, 0, 0}));
  EXPECT_EQ(settling[0].settling_s, 0.048);
  std::vector<PlannedMotion> no_settling = plan;
  no_settling[0].settling_s = 0.0;
  EXPECT_TRUE(RestartAlong(no_settling, 100.0, StandardMachine().axes).empty());
}

// START 0.5 mm before a bend: cbrt(0.5 sqrt(40000))^2 = 21.544 mm/s at its beginning, faster in it
// with 1200 mm/s2, what the half of its way lets it reach; the second half as planned from there.
// The bend that was passed at 50 is reported with the speed that it was passed at.
TEST(RestartAlong, FromRestBeforeABend) {
  const std::vector<PlannedMotion> plan = RightAngle();
  ASSERT_EQ(plan.size(), 4u);
  const double s = plan[0].path.length() - 0.5;
  const auto rest = RestartAlong(plan, s, StandardMachine().axes);
  ASSERT_EQ(rest.size(), 4u);
  const double first = std::pow(std::cbrt(0.5 * 200.0), 2);
  EXPECT_NEAR(rest[0].speed.end().speed, first, 1e-9);
  EXPECT_NEAR(rest[0].speed.duration_s(), 2.0 * std::sqrt(first / 40000.0), 1e-9);
  const PathLimits bend{50.0, 1200.0, 40000.0};
  const double middle = std::min(50.0, Reach(first, plan[1].path.length(), bend));
  EXPECT_NEAR(rest[1].speed.end().speed, middle, 1e-9);
  EXPECT_NEAR(rest[1].corner.speed, middle, 1e-9);
  EXPECT_EQ(rest[2].speed.end().speed, 50.0);
  EXPECT_EQ(rest[3].speed.duration_s(), plan[3].speed.duration_s());  // as planned
  // From far away all is as planned behind the first motion.
  const auto far = RestartAlong(plan, 10.0, StandardMachine().axes);
  EXPECT_EQ(far[0].speed.end().speed, 50.0);
  for (std::size_t k = 1; k < 4; ++k) {
    EXPECT_EQ(far[k].speed.duration_s(), plan[k].speed.duration_s());
    EXPECT_EQ(far[k].corner.speed, plan[k].corner.speed);
  }
}

// A STOP while the machine settles finds it standing; one for which too little is planned says so;
// none of its motions settles, and only what reaches its end ends its move.
TEST(StopAlong, EndsAndPlanEnds) {
  const std::vector<PlannedMotion> plan = RightAngle();
  const AxisLimits axes = StandardMachine().axes;
  const StopOnPath standing =
      StopAlong(std::span(plan).subspan(3), plan[3].speed.duration_s() + 0.01, axes);
  EXPECT_TRUE(standing.complete);
  EXPECT_TRUE(standing.motions.empty());
  EXPECT_EQ(standing.index, 0u);
  EXPECT_EQ(standing.s, plan[3].path.length());
  const double t = plan[0].speed.TimeAt(plan[0].path.length() - 0.1);
  EXPECT_FALSE(StopAlong(std::span(plan).first(1), t, axes).complete);
  EXPECT_TRUE(StopAlong(std::span(plan).first(2), t, axes).complete);
  // 0.07 s before the end of the plan it brakes already: to its end.
  const StopOnPath end =
      StopAlong(std::span(plan).subspan(3), plan[3].speed.duration_s() - 0.05, axes);
  ASSERT_EQ(end.motions.size(), 1u);
  EXPECT_NEAR(end.s, plan[3].path.length(), 1e-9);
  EXPECT_NEAR(end.motions[0].duration_s(), 0.05, 1e-9);
  EXPECT_EQ(end.motions[0].settling_s, 0.0);
  const StopOnPath early = StopAlong(plan, 1.0, axes);
  ASSERT_EQ(early.motions.size(), 1u);
  EXPECT_FALSE(early.motions[0].ends_move);
  EXPECT_EQ(early.motions[0].settling_s, 0.0);
  EXPECT_NEAR(early.s, plan[0].speed.At(1.0).s + 25.0 * 2.0 * std::sqrt(50.0 / 40000.0), 1e-9);
  // Over the corner, the first half of the bend whole: that one ends its move.
  const double late = plan[0].speed.TimeAt(plan[0].path.length() - 0.01);
  StopOnPath across = StopAlong(std::span(plan).subspan(1), plan[1].duration_s() - 0.005, axes);
  ASSERT_EQ(across.motions.size(), 2u);
  EXPECT_TRUE(across.motions[0].ends_move);
  EXPECT_FALSE(across.motions[1].ends_move);
  EXPECT_EQ(across.index, 1u);
  EXPECT_EQ(StopAlong(plan, late, axes).index, 1u);
}

}  // namespace
}  // namespace rmlcell::motion
