#include "engine/simulation/path/motion_peaks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "engine/simulation/path/profile_phases.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;

MotionPeaks Whole(const motion::PlannedMotion& planned, bool five_axis) {
  return PeaksBetween(planned, five_axis, 0.0, planned.speed.duration_s());
}

// motion.md 12, S01: 100 mm at 50 mm/s reach 50 mm/s; the ramp is short (50 <= a2/j = 100), so the
// acceleration peaks at sqrt(50 * 40000). The move is along (3,4,0)/5.
TEST(MotionPeaks, LineSharesItsSpeedAmongTheAxes) {
  const auto planned = Planned(LineFrom({0, 0, 0}, {60, 80, 0}));
  const MotionPeaks peaks = Whole(planned, false);
  const double acceleration = std::sqrt(50.0 * 40000.0);
  EXPECT_NEAR(peaks.tip_speed, 50.0, 1e-9);
  EXPECT_NEAR(peaks.tip_acceleration, acceleration, 1e-6);
  EXPECT_NEAR(peaks.axis_speed[0], 30.0, 1e-9);
  EXPECT_NEAR(peaks.axis_speed[1], 40.0, 1e-9);
  EXPECT_EQ(peaks.axis_speed[2], 0.0);
  EXPECT_NEAR(peaks.axis_acceleration[1], 0.8 * acceleration, 1e-6);
}

// Within the ramps the jerk is that of the limits, and the axes share it, also on a move that turns
// the rotary axis of a mill alone; on a steady circle it is v3/R2, from accelerations that turn.
TEST(MotionPeaks, JerkOfTheRamps) {
  const MotionPeaks line = Whole(Planned(LineFrom({0, 0, 0}, {60, -80, 0})), false);
  EXPECT_NEAR(line.tip_jerk, 40'000.0, 1e-6);
  EXPECT_NEAR(line.axis_jerk[0], 24'000.0, 1e-6);
  EXPECT_NEAR(line.axis_jerk[1], 32'000.0, 1e-6);
  EXPECT_EQ(line.axis_jerk[2], 0.0);
  motion::PlannedMotion circle;
  circle.path = PathPiece::Circle({{20, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0);
  circle.speed = motion::SpeedProfile::Steady(circle.path.length(), 50.0);
  const double jerk = 50.0 * 50.0 * 50.0 / (20.0 * 20.0);
  for (const bool five_axis : {false, true}) {
    const MotionPeaks turning = Whole(circle, five_axis);
    EXPECT_NEAR(turning.tip_jerk, jerk, 0.002 * jerk);
    EXPECT_NEAR(turning.axis_jerk[0], jerk, 0.002 * jerk);
    EXPECT_NEAR(turning.axis_jerk[1], jerk, 0.002 * jerk);
    EXPECT_NEAR(turning.axis_jerk[2], 0.0, 1e-9);
  }
}

// Round a circle of R while the speed grows by a jerk j from rest the jerk grows, too: as the mean
// between two samples it is highest in the last of four, and on the way to rest in the first one.
TEST(MotionPeaks, JerkIsHighestAtAnEndOfThePhase) {
  const double radius = 1.0;
  const double jerk = 40'000.0;
  const double part_s = 0.02;  // within the first phase, and short enough for four samples
  const auto circle =
      Planned(PathPiece::Circle({{radius, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0));
  const auto acceleration = [&](double t) {
    const double s = jerk * t * t * t / 6.0, v = 0.5 * jerk * t * t, a = jerk * t;
    const double angle = s / radius, inward = v * v / radius;
    return motion::MachineVector{-a * std::sin(angle) - inward * std::cos(angle),
                                 a * std::cos(angle) - inward * std::sin(angle), 0.0};
  };
  const auto mean_jerk = [&](int k) {
    const double t = part_s / 4.0;
    return (acceleration(t * k) - acceleration(t * (k - 1))).norm() / t;
  };
  ASSERT_GT(mean_jerk(4), 1.01 * mean_jerk(3));
  ASSERT_GT(mean_jerk(3), mean_jerk(1));
  const double end_s = circle.speed.duration_s();
  for (const bool five_axis : {false, true}) {
    EXPECT_NEAR(PeaksBetween(circle, five_axis, 0.0, part_s).tip_jerk, mean_jerk(4),
                1e-6 * mean_jerk(4));
    EXPECT_NEAR(PeaksBetween(circle, five_axis, end_s - part_s, end_s).tip_jerk, mean_jerk(4),
                1e-6 * mean_jerk(4));
  }
}

// A stretch in which the acceleration changes its sign has its highest or lowest speed there, from
// 200 mm/s2 with a jerk of -1000 mm/s3 after 0.2 s; any other at an end.
TEST(PhasePart, LevelsOutWhereTheAccelerationIsZero) {
  const auto level = [](double acceleration, double jerk) {
    return PhasePart{.duration_s = 0.5, .jerk = jerk, .start = {1.0, 10.0, acceleration}}.LevelAt();
  };
  EXPECT_DOUBLE_EQ(level(200.0, -1000.0), 0.2);
  EXPECT_DOUBLE_EQ(level(-200.0, 1000.0), 0.2);
  EXPECT_EQ(level(200.0, -100.0), 0.5);
  EXPECT_EQ(level(200.0, 1000.0), 0.0);
  EXPECT_EQ(level(200.0, 0.0), 0.0);
}

// S02: 30 mm never reach 350 mm/s; the peak is 200 mm/s, half way.
TEST(MotionPeaks, PeakBetweenTwoPhasesIsSeen) {
  const auto planned = Planned(LineFrom({0, 0, 0}, {0, 0, 30}),
                               {.speed = 350.0, .acceleration = 2000.0, .jerk = 40000.0});
  EXPECT_NEAR(Whole(planned, false).axis_speed[2], 200.0, 1e-6);
}

// Up to a time within the profile only: after 1 ms with 40000 mm/s3 the speed is j t2/2 = 0.02.
TEST(MotionPeaks, PartOfTheProfile) {
  const auto planned = Planned(LineFrom({0, 0, 0}, {100, 0, 0}));
  const MotionPeaks peaks = PeaksBetween(planned, false, 0.0, 0.001);
  EXPECT_NEAR(peaks.tip_speed, 0.02, 1e-12);
  EXPECT_NEAR(peaks.tip_acceleration, 40.0, 1e-9);
}

// At constant speed v on a circle of radius R the tip is accelerated by v2/R; motion.md 5.1.
TEST(MotionPeaks, CircleAcceleratesAcross) {
  const auto circle =
      Planned(PathPiece::Circle({{20, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0));
  const MotionPeaks peaks = Whole(circle, false);
  EXPECT_NEAR(peaks.tip_speed, 50.0, 1e-9);
  // Tangential ramps and v2/R = 125 never act together in full.
  EXPECT_GE(peaks.tip_acceleration, std::sqrt(50.0 * 40000.0) * (1 - 1e-9));
  EXPECT_NEAR(peaks.axis_speed[0], 50.0, 50.0 * 0.002);
  EXPECT_LE(peaks.axis_speed[0], 50.0 + 1e-9);
  const MotionPeaks cruise = PeaksBetween(circle, false, 0.5, 2.0);
  EXPECT_NEAR(cruise.tip_acceleration, 2500.0 / 20.0, 1e-9);
}

// K07: at A = 0.528, B = 1.5708 a tip speed of 50 along X with A' = 0.3 gives the column 127.743 in
// X and 45.343 in Y. Here the move does that at its start: 50 mm/s, 0.3 rad/s, i.e. 0.006 rad/mm.
TEST(MotionPeaks, ColumnIsSwungByTheHead) {
  motion::PlannedMotion planned;
  planned.path = PathPiece::Line({{0, 0, 0}, 0.528, 1.5708}, {{1, 0, 0}, 0.534, 1.5708});
  planned.head = motion::GantryHead{.length_mm = 300.0};
  planned.speed = motion::SpeedProfile::Span(1.0, 50.0, 50.0, kSlowLimits);
  const MotionPeaks peaks = PeaksBetween(planned, true, 0.0, 1e-9);
  EXPECT_NEAR(peaks.axis_speed[0], 127.743476981, 1e-5);
  EXPECT_NEAR(peaks.axis_speed[1], 45.342604543, 1e-5);
  EXPECT_NEAR(peaks.axis_speed[3], 0.3, 1e-9);
  EXPECT_NEAR(peaks.axis_acceleration[0], 13.602781363, 1e-4);
  EXPECT_NEAR(peaks.axis_acceleration[1], 23.323043094, 1e-4);
}

// C01: on the curve of the corner the tip keeps 50 mm/s and is accelerated by v2 K/d, with the K of
// motion.md 4.2 for 90 degrees (rho = 2 sqrt(cos 45)) and d = 4.050462937 mm.
TEST(MotionPeaks, CurveOfACorner) {
  const auto motions = PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}});
  ASSERT_EQ(motions.size(), 4u);
  const double half = std::sqrt(0.5);  // sine and cosine of half the turn
  const double rho = 2.0 * std::sqrt(half);
  const double whole = 15.0 / 8.0 - 7.0 * rho / 16.0;
  const double bend = 0.75 * rho * half / (half * whole * half * whole);
  double acceleration = 0.0;
  for (std::size_t k = 1; k <= 2; ++k) {
    const MotionPeaks peaks = Whole(motions[k], true);
    EXPECT_NEAR(peaks.tip_speed, 50.0, 1e-6);
    acceleration = std::max(acceleration, peaks.tip_acceleration);
  }
  EXPECT_NEAR(acceleration, 2500.0 * bend / 4.050462937, 1e-3);
}

// The axes of a mill go as the tip does round the bend of a chain, and its rotary axis as A: no
// other axis moves.
TEST(MotionPeaks, BendOfAMill) {
  const auto motions = PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}});
  for (std::size_t k = 1; k <= 2; ++k) {
    const MotionPeaks peaks = Whole(motions[k], false);
    EXPECT_NEAR(peaks.tip_speed, 50.0, 1e-6);
    EXPECT_NEAR(peaks.axis_speed[k - 1], 50.0, 1e-6);  // along X into it, along Y out of it
    EXPECT_NEAR(peaks.axis_speed[2], 0.0, 1e-9);
    for (const std::size_t rotary : {3u, 4u}) {
      EXPECT_EQ(peaks.axis_speed[rotary], 0.0);
      EXPECT_EQ(peaks.axis_acceleration[rotary], 0.0);
      EXPECT_EQ(peaks.axis_jerk[rotary], 0.0);
    }
    EXPECT_LE(peaks.axis_acceleration[0], peaks.tip_acceleration * (1 + 1e-9));
    EXPECT_GT(peaks.axis_acceleration[0], 0.3 * peaks.tip_acceleration);
  }
}

// COORD ROBOT, B turns at 1 rad/s about a standing column: the tip goes at 300 mm/s on a circle,
// and is accelerated by w2 L = 300 mm/s2 towards the column.
TEST(MotionPeaks, TipIsSwungInRobotCoordinates) {
  motion::PlannedMotion planned;
  planned.path = PathPiece::Joint({{0, 0, 0}, 0.0, 0.0}, {{0, 0, 0}, 0.0, 1.0});
  planned.head = motion::GantryHead{.length_mm = 300.0};
  const motion::PathLimits limits{.speed = 1.0, .acceleration = 10.0, .jerk = 100.0};
  planned.speed = motion::SpeedProfile::Span(1.0, 1.0, 1.0, limits);
  const MotionPeaks peaks = Whole(planned, true);
  EXPECT_NEAR(peaks.tip_speed, 300.0, 1e-6);
  EXPECT_NEAR(peaks.tip_acceleration, 300.0, 1e-3);
  EXPECT_NEAR(peaks.axis_speed[4], 1.0, 1e-12);
}

// motion.md 2.4: round half a circle of R at a steady v an axis has v^2/R at most, and v there.
// From samples 0.05 rad apart at most, so at most 0.2 % too low, however short or long the arc is.
TEST(MotionPeaks, SamplesLieAsCloseOnAnyArc) {
  for (const double radius : {0.1, 1.0, 100.0}) {
    motion::PlannedMotion planned;
    const auto arc = motion::PathPiece::ArcThrough({{radius, 0, 0}, 0, 0}, {0, radius, 0},
                                                   {{-radius, 0, 0}, 0, 0});
    ASSERT_TRUE(arc);
    planned.path = arc->path;
    planned.speed = motion::SpeedProfile::Steady(planned.path.length(), 60.0);
    const MotionPeaks peaks = PeaksBetween(planned, true, 0.0, planned.speed.duration_s());
    const double highest = 60.0 * 60.0 / radius;
    EXPECT_NEAR(peaks.axis_acceleration[0], highest, 0.002 * highest) << radius;
    EXPECT_NEAR(peaks.axis_acceleration[1], highest, 0.002 * highest) << radius;
    EXPECT_NEAR(peaks.axis_speed[0], 60.0, 0.002 * 60.0) << radius;
    EXPECT_NEAR(peaks.tip_acceleration, highest, 1e-6 * highest) << radius;
  }
}

// Jerks are those within the phases: from 2000 mm/s2 to none and on to -2000 the acceleration
// steps, and nothing else changes it on a line with a head that turns evenly (but for the turning,
// which 1e-6 rad leave at nothing).
TEST(MotionPeaks, AStepBetweenPhasesIsNoJerk) {
  motion::PlannedMotion planned;
  planned.path = PathPiece::Line({{0, 0, 0}, 0.0, 0.0}, {{100, 0, 0}, 1e-6, 0.0});
  planned.head = motion::GantryHead{.length_mm = 300.0};
  planned.speed =
      motion::SpeedProfile::Span(100.0, 0.0, 0.0, {.speed = 50.0, .acceleration = 2000.0});
  ASSERT_EQ(planned.speed.phase_count(), 3);
  const MotionPeaks peaks = Whole(planned, true);
  EXPECT_NEAR(peaks.tip_acceleration, 2000.0, 1e-9);
  EXPECT_NEAR(peaks.tip_jerk, 0.0, 1e-6);
  EXPECT_NEAR(peaks.axis_jerk[0], 0.0, 1e-6);
}

}  // namespace
}  // namespace rmlcell::simulation
