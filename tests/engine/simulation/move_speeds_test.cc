#include "engine/simulation/report/move_speeds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/motion/standard_machine.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using motion::PathLimits;
using motion::PathPiece;

// All that the tip has: 2000 mm/s2 and 40 000 mm/s3, and half of it.
constexpr PathLimits kAll{.speed = 1e9, .acceleration = 2000.0, .jerk = 40'000.0};
constexpr PathLimits kHalf{.speed = 1e9, .acceleration = 1000.0, .jerk = 20'000.0};

machine::MachineShape Shape() {
  machine::MachineShape shape;
  shape.limits = motion::StandardMachine();
  return shape;
}

motion::PlannedMotion MoveAt(const PathPiece& path, PathLimits limits, double speed,
                             double entry = 0.0, double exit = 0.0) {
  limits.speed = speed;
  motion::PlannedMotion planned;
  planned.path = path;
  planned.limits = limits;
  planned.speed = motion::SpeedProfile::Span(path.length(), entry, exit, limits);
  planned.ends_move = true;
  return planned;
}

machine::MotionDone Done(const motion::PlannedMotion& planned, double wanted) {
  return {.place = {.program = 3, .step = 8},
          .motion = &planned,
          .from = 0.0,
          .travelled = planned.path.length(),
          .programmed_mm_s = wanted};
}

PathPiece LineOf(double length) { return LineFrom({}, {length, 0, 0}); }

std::optional<SlowMove> Judged(const motion::PlannedMotion& planned, double wanted,
                               const machine::MachineShape& shape = Shape()) {
  return MoveSpeeds(shape).Add(Done(planned, wanted));
}

// A millionth of the speed is rounding; without a programmed speed there is none to reach.
TEST(MoveSpeeds, AMillionthIsNoShortfall) {
  motion::PlannedMotion steady;
  steady.path = LineOf(100.0);
  steady.ends_move = true;
  steady.speed = motion::SpeedProfile::Steady(100.0, 50.0);
  EXPECT_FALSE(Judged(steady, 50.0));
  EXPECT_FALSE(Judged(steady, 50.0 * (1.0 + 0.9e-6)));
  EXPECT_TRUE(Judged(steady, 50.0 * (1.0 + 1.1e-6)));
  EXPECT_FALSE(Judged(steady, 0.0));
}

// A move that goes nowhere has no way to reach a speed on.
TEST(MoveSpeeds, AMoveToWhereItStandsIsNotSlow) {
  EXPECT_FALSE(Judged(MoveAt(LineOf(0.0), kAll, 10.0), 10.0));
}

// motion.md 5.2, 8.2: from rest up to v without reaching the acceleration and down again takes
// 2 v sqrt(v/j): 0.316 mm for 10 mm/s. On 0.3 mm it is (0.15 sqrt(j))^(2/3).
TEST(MoveSpeeds, TooShortOrTooLittleAcceleration) {
  const auto cause = [](double length, const PathLimits& limits) {
    const auto slow = Judged(MoveAt(LineOf(length), limits, 10.0), 10.0);
    EXPECT_TRUE(slow) << length;
    return slow ? slow->cause : SlowCause::kAxis;
  };
  constexpr PathLimits kFew{.speed = 0.0, .acceleration = 100.0, .jerk = 2000.0};
  EXPECT_EQ(cause(0.31, kAll), SlowCause::kShort);
  EXPECT_EQ(cause(0.31, kFew), SlowCause::kShort);
  EXPECT_EQ(cause(0.32, kFew), SlowCause::kAcceleration);
  EXPECT_FALSE(Judged(MoveAt(LineOf(0.32), kAll, 10.0), 10.0));
  const auto slow = Judged(MoveAt(LineOf(0.3), kAll, 10.0), 10.0);
  ASSERT_TRUE(slow);
  EXPECT_EQ(slow->place.program, 3);
  EXPECT_EQ(slow->place.step, 8);
  EXPECT_EQ(slow->wanted_mm_s, 10.0);
  EXPECT_EQ(slow->allowed_mm_s, 10.0);
  EXPECT_NEAR(slow->reached_mm_s, std::pow(30.0, 2.0 / 3.0), 1e-6);
  EXPECT_EQ(slow->count, 1u);
  // Of a machine whose limits are not known only that it was short.
  EXPECT_EQ(Judged(MoveAt(LineOf(0.32), kFew, 10.0), 10.0, {})->cause, SlowCause::kShort);
}

// On an arc the way has 0.6 of the acceleration of the tip. To 100 mm/s and back: with 2000 mm/s2
// 10 mm, with 1200 it is v/2 (v/a + a/j) = 5.67 mm each way.
TEST(MoveSpeeds, AnArcHasAShareOfTheAcceleration) {
  const auto cause = [](const PathPiece& path) {
    return Judged(MoveAt(path, kHalf, 100.0), 100.0)->cause;
  };
  const auto arc = [](double length) {
    return PathPiece::Circle({{1000, 0, 0}}, {0, 0, 0}, {0, 0, 1}, length / 1000.0, 0.0, 0.0);
  };
  EXPECT_EQ(cause(LineOf(9.9)), SlowCause::kShort);
  EXPECT_EQ(cause(LineOf(10.1)), SlowCause::kAcceleration);
  EXPECT_EQ(cause(arc(11.2)), SlowCause::kShort);
  EXPECT_EQ(cause(arc(11.4)), SlowCause::kAcceleration);
}

// From 50 to 100 mm/s takes 75 mm/s * 2 sqrt(50/j) = 5.303 mm, from rest 5 mm: what the neighbours
// leave counts at each end, also when the move is told in parts.
TEST(MoveSpeeds, SpeedsAtBothEndsCount) {
  const auto cause = [](double length, double entry, double exit) {
    const motion::PlannedMotion planned = MoveAt(LineOf(length), kHalf, 100.0, entry, exit);
    MoveSpeeds speeds(Shape());
    machine::MotionDone first = Done(planned, 100.0), second = first;
    first.travelled = second.from = 0.5 * length;
    second.profile_start_s = 0.5 * planned.speed.duration_s();
    EXPECT_FALSE(speeds.Add(first));
    const auto slow = speeds.Add(second);
    EXPECT_TRUE(slow);
    machine::MotionDone rest = second;  // it was over already
    rest.from = length;
    EXPECT_FALSE(speeds.Add(rest));
    return slow ? slow->cause : SlowCause::kAxis;
  };
  EXPECT_EQ(cause(10.1, 0.0, 0.0), SlowCause::kAcceleration);
  EXPECT_EQ(cause(10.2, 50.0, 0.0), SlowCause::kShort);
  EXPECT_EQ(cause(10.4, 50.0, 0.0), SlowCause::kAcceleration);
  EXPECT_EQ(cause(10.2, 0.0, 50.0), SlowCause::kShort);
  EXPECT_EQ(cause(10.4, 0.0, 50.0), SlowCause::kAcceleration);
  EXPECT_EQ(cause(10.5, 50.0, 50.0), SlowCause::kShort);
  EXPECT_EQ(cause(10.7, 50.0, 50.0), SlowCause::kAcceleration);
}

// What was reached is all that the line or arc allows: its radius, sqrt(0.8 * 2000 * 2), or an
// axis, here A, which turns by 1 rad a millimetre.
TEST(MoveSpeeds, WhatTheWayAllows) {
  const double radius_speed = std::sqrt(3200.0);
  motion::PlannedMotion arc = MoveAt(
      PathPiece::Circle({{2, 0, 0}}, {0, 0, 0}, {0, 0, 1}, 6.0, 0.0, 0.0), kAll, radius_speed);
  const auto round = Judged(arc, 100.0);
  ASSERT_TRUE(round);
  EXPECT_EQ(round->cause, SlowCause::kRadius);
  EXPECT_EQ(round->axis, "");
  EXPECT_NEAR(round->allowed_mm_s, radius_speed, 1e-9);
  EXPECT_NEAR(round->reached_mm_s, radius_speed, 1e-6);
  machine::MachineShape gantry = Shape();
  gantry.five_axis = true;
  motion::PlannedMotion turn =
      MoveAt(PathPiece::Line({{0, 0, 0}, 0.0, 0.0}, {{9, 0, 0}, 9.0, 0.0}), kAll, kTurn);
  turn.head = motion::GantryHead{.length_mm = 300.0};
  const auto held = Judged(turn, 100.0, gantry);
  ASSERT_TRUE(held);
  EXPECT_EQ(held->cause, SlowCause::kAxis);
  EXPECT_EQ(held->axis, "A");
  EXPECT_NEAR(held->allowed_mm_s, kTurn, 1e-9);
}

}  // namespace
}  // namespace rmlcell::simulation
