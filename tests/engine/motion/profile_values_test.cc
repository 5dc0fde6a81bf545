// Profiles in closed form where figures are neither 0 nor 1: bounds of the
// speed, a jerk of one, ways that do not begin at 0, and what is exactly
// enough. motion.md 5.2, 6
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/motion/profile/speed_profile.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::profile_values {
namespace {

constexpr double kWithoutEnd = std::numeric_limits<double>::infinity();
constexpr PathLimits kUsual{350.0, 2000.0, 40000.0};

double AtMost(const SpeedProfile& profile, double s) {
  SpeedProfile::Place place;
  profile.Advance(place, s);
  return profile.SpeedAtMost(place);
}

// S02 of motion.md 12: six phases of 0.05 s with 50, 150, 200, 150 and 50 mm/s
// between them. Up from the start of a phase and down from its end v^2 changes
// by no more than twice the acceleration at one of its ends for each mm; with a
// steady acceleration by exactly that.
TEST(ProfileValues, TheSpeedIsBoundedByTheEndsOfAPhase) {
  const SpeedProfile p = SpeedProfile::Span(30.0, 0.0, 0.0, kUsual);
  ASSERT_EQ(p.phase_count(), 6);
  constexpr double kA = 2000.0;
  const auto up = [](double v, double way) { return std::sqrt(v * v + 2.0 * kA * way); };
  for (const double way : {0.02, 0.3, 0.7}) {
    const double from_rest = std::min(up(0.0, way), 50.0);
    EXPECT_NEAR(AtMost(p, way), from_rest, 1e-6) << way;
    EXPECT_NEAR(AtMost(p, 30.0 - way), from_rest, 1e-6) << way;
  }
  const double steady = p.phase(1).start.s, peak = p.phase(3).start.s;
  for (const double way : {0.3, 2.0, 4.9}) {
    EXPECT_NEAR(AtMost(p, steady + way), up(50.0, way), 1e-6) << way;
    EXPECT_NEAR(AtMost(p, 30.0 - steady - way), up(50.0, way), 1e-6) << way;
  }
  for (const double way : {0.1, 1.0, 3.0}) {
    const double near_peak = std::min(up(150.0, way), 200.0);
    EXPECT_NEAR(AtMost(p, p.phase(2).start.s + way), near_peak, 1e-6) << way;
    EXPECT_NEAR(AtMost(p, 2.0 * peak - p.phase(2).start.s - way), near_peak, 1e-6) << way;
  }
}

// A bound is above what it bounds, by room for rounding: in a cruise of 350 mm/s, too.
TEST(ProfileValues, TheBoundOfACruiseIsNotBelowIt) {
  const SpeedProfile p = SpeedProfile::Span(400.0, 0.0, 0.0, kUsual);
  ASSERT_EQ(p.phase_count(), 7);
  EXPECT_GE(AtMost(p, 200.0), 350.0);
  EXPECT_LE(AtMost(p, 200.0), 350.0 * (1.0 + 1e-9));
}

// A profile that takes the place of one with more phases has nothing of those: by the last digits
// before its end it is next to rest, and its end is passed when it is over.
TEST(ProfileValues, NothingIsLeftOfMorePhases) {
  const SpeedProfile seven = SpeedProfile::Span(400.0, 0.0, 0.0, kUsual);
  ASSERT_EQ(seven.phase_count(), 7);
  Dice dice(61);
  for (int round = 0; round < 20'000; ++round) {
    const double length = dice.Magnitude(1e-2, 100.0);
    SpeedProfile p = seven;
    p = SpeedProfile::Span(length, 0.0, 0.0,
                           {dice.Magnitude(1.0, 500.0), dice.Magnitude(50.0, 5000.0), kWithoutEnd});
    ASSERT_LE(p.phase_count(), 3);
    ASSERT_EQ(p.TimeAt(length), p.duration_s()) << round;
    double t = p.duration_s();
    for (int step = 0; step < 4; ++step) {
      t = std::nextafter(t, 0.0);
      ASSERT_LT(p.At(t).speed, 1e-6) << round;
      ASSERT_NEAR(p.At(t).s, length, 1e-9 * length) << round;
    }
  }
}

// At 1 mm/s3 from rest s is t^3 / 6 until 2 mm/s2 are reached; a part of that
// goes the same way.
TEST(ProfileValues, AJerkOfOneBendsTheWay) {
  const SpeedProfile p = SpeedProfile::Span(1000.0, 0.0, 0.0, {40.0, 2.0, 1.0});
  for (const double t : {0.5, 1.0, 1.9}) {
    const double way = t * t * t / 6.0;
    EXPECT_NEAR(p.At(t).s, way, 1e-12);
    EXPECT_NEAR(p.PlaceAt(t), way, 1e-12);
    EXPECT_NEAR(p.At(p.duration_s() - t).s, 1000.0 - way, 1e-9);
  }
  EXPECT_NEAR(p.phase(1).start.s, 8.0 / 6.0, 1e-12);
  const double from = 1.0 / 6.0, begin_s = 1.0;
  const SpeedProfile part = p.Part(from, 900.0);
  for (const double t : {0.3, 0.8}) {
    const double later = begin_s + t;
    EXPECT_NEAR(part.At(t).s, later * later * later / 6.0 - from, 1e-9);
    EXPECT_NEAR(part.At(t).speed, 0.5 * later * later, 1e-9);
  }
}

// The way that is left counts from where it is: 50 mm/s, 5 mm/s asked for, and
// 0.05 mm more than it takes to stop, which is too little to slow down twice.
TEST(ProfileValues, TheWayLeftCountsFromWhereItIs) {
  const double down = 50.0 * std::sqrt(50.0 / 40000.0);
  for (const double s : {0.0, 10.0, 700.0}) {
    const SpeedProfile p =
        SpeedProfile::From({s, 50.0, 0.0}, s + down + 0.05, 0.0, {5.0, 2000.0, 40000.0});
    EXPECT_NEAR(p.duration_s(), 2.0 * std::sqrt(50.0 / 40000.0) + 0.001, 1e-9) << s;
    EXPECT_NEAR(p.At(0.001).speed, 50.0, 1e-6) << s;
  }
}

// 16 mm/s2 and 16 mm/s3: from 64 to 32 mm/s in 3 s and 144 mm, from there to
// rest in 3 s and 48 mm. Exactly that way is not too short for the new speed.
TEST(ProfileValues, ExactlyEnoughIsEnoughToSlowDown) {
  const PathLimits limits{32.0, 16.0, 16.0};
  const SpeedProfile just = SpeedProfile::From({0.0, 64.0, 0.0}, 192.0, 0.0, limits);
  EXPECT_NEAR(just.duration_s(), 6.0, 1e-12);
  EXPECT_NEAR(just.At(3.0).s, 144.0, 1e-12);
  // Below it the present speed is kept: 5 s and 160 mm to rest.
  const SpeedProfile less = SpeedProfile::From({0.0, 64.0, 0.0}, 191.0, 0.0, limits);
  EXPECT_NEAR(less.duration_s(), 5.0 + 31.0 / 64.0, 1e-12);
}

// The way between two neighbouring numbers near 500 mm/s is passed at their
// mean, steadily, in less than a ramp takes; a ramp that misses its length by
// last digits alone stays one.
TEST(ProfileValues, NeighbouringSpeedsAreOne) {
  const PathLimits limits{500.0, 2000.0, 40000.0};
  const double v0 = 499.0, v1 = std::nextafter(v0, 600.0);
  for (const double share : {1e-3, 0.9995}) {
    const double length = share * RampLength(v0, v1, limits);
    for (const bool up : {true, false}) {
      const SpeedProfile p = SpeedProfile::Span(length, up ? v0 : v1, up ? v1 : v0, limits);
      ASSERT_EQ(p.phase_count(), 1);
      EXPECT_EQ(p.phase(0).start.acceleration, 0.0);
      EXPECT_EQ(p.phase(0).jerk, 0.0);
      EXPECT_DOUBLE_EQ(p.duration_s(), length / v0);
      EXPECT_EQ(p.end().speed, up ? v1 : v0);
      EXPECT_EQ(p.peak_speed(), v1);
    }
  }
  const double ramp_s = RampTime(100.0, 250.0, limits);
  const double ramp_mm = RampLength(100.0, 250.0, limits);
  const SpeedProfile squeezed = SpeedProfile::Span(ramp_mm * (1.0 - 1e-8), 100.0, 250.0, limits);
  ASSERT_EQ(squeezed.phase_count(), 3);
  EXPECT_NEAR(squeezed.duration_s(), ramp_s * (1.0 - 1e-8), 1e-12);
  EXPECT_NEAR(squeezed.phase(1).start.acceleration, 2000.0, 1e-3);
  const SpeedProfile less = SpeedProfile::Span(ramp_mm * (1.0 - 1e-10), 100.0, 250.0, limits);
  EXPECT_NEAR(less.duration_s(), ramp_s * (1.0 - 1e-10), 1e-13);
}

// Where it ends it neither speeds up nor slows down; a part that ends on the
// way has what is there.
TEST(ProfileValues, AnEndHasNoAcceleration) {
  for (const double jerk : {40000.0, kWithoutEnd}) {
    const PathLimits limits{350.0, 2000.0, jerk};
    EXPECT_EQ(SpeedProfile::Span(30.0, 0.0, 70.0, limits).end().acceleration, 0.0);
    EXPECT_EQ(SpeedProfile::Span(0.0, 7.0, 7.0, limits).end().acceleration, 0.0);
    EXPECT_EQ(SpeedProfile::OneRamp(20.0, 80.0, limits).end().acceleration, 0.0);
    EXPECT_EQ(SpeedProfile::From({3.0, 40.0, 90.0}, 90.0, 10.0, limits).end().acceleration, 0.0);
    EXPECT_EQ(SpeedProfile::Span(30.0, 0.0, 0.0, limits).StopFrom(0.1, limits).end().acceleration,
              0.0);
  }
  const SpeedProfile p = SpeedProfile::Span(30.0, 0.0, 0.0, kUsual);
  EXPECT_NEAR(p.Part(2.0, 5.0).end().acceleration, 2000.0, 1e-9);
}

// The least is at y^2 = 2 v0 for short ways, at half of a^2 / j for long ones;
// outside of the starting speeds that are asked for, at the nearer end of them.
TEST(ProfileValues, TheLeastReachIsAtItsStartingSpeed) {
  const double y = std::cbrt(0.5 * 2.0 * std::sqrt(40000.0));
  EXPECT_DOUBLE_EQ(ReachMinimum(0.0, 300.0, 2.0, kUsual), Reach(0.5 * y * y, 2.0, kUsual));
  EXPECT_DOUBLE_EQ(ReachMinimum(0.0, 300.0, 90.0, kUsual), Reach(50.0, 90.0, kUsual));
  EXPECT_DOUBLE_EQ(ReachMinimum(0.0, 20.0, 90.0, kUsual), Reach(20.0, 90.0, kUsual));
  EXPECT_DOUBLE_EQ(ReachMinimum(80.0, 200.0, 90.0, kUsual), Reach(80.0, 90.0, kUsual));
}

// Below 1 mm/s2 and from 1 mm/s: what speeds up brings that to zero first, on the way to 1 mm/s,
// and stops from there. 0.5 mm/s2 at 0.25 mm/s3 after 2 s are 0.5 mm/s, and 0.5 more in 2 s.
TEST(ProfileValues, AStopEndsEvenALittleAcceleration) {
  const PathLimits limits{9.0, 4.0, 0.25};
  const SpeedProfile p = SpeedProfile::Span(100.0, 0.0, 0.0, limits);
  const SpeedProfile stop = p.StopFrom(2.0, limits);
  EXPECT_NEAR(stop.peak_speed(), 1.0, 1e-12);
  EXPECT_NEAR(stop.At(2.0).speed, 1.0, 1e-12);
  EXPECT_NEAR(stop.duration_s(), 2.0 + 2.0 * std::sqrt(1.0 / 0.25), 1e-12);
}

// Near the end of S02, at 18 mm/s and -1200 mm/s2, less jerk than it ends with would go backwards:
// it ends as it would have.
TEST(ProfileValues, AStopOfLittleJerkEndsWhereTheMotionDoes) {
  const SpeedProfile p = SpeedProfile::Span(30.0, 0.0, 0.0, kUsual);
  for (const double jerk : {15000.0, 25000.0, 30000.0, 39000.0}) {
    const SpeedProfile stop = p.StopFrom(0.27, {350.0, 2000.0, jerk});
    EXPECT_NEAR(stop.end().s, 30.0, 1e-9) << jerk;
    EXPECT_NEAR(stop.duration_s(), 0.03, 1e-9) << jerk;
    for (int k = 0; k <= 30; ++k)
      EXPECT_NEAR(stop.At(1e-3 * k).speed, p.At(0.27 + 1e-3 * k).speed, 1e-6);
  }
}

// Between two speeds of 1 mm/s, as between any others, the peak is where both ramps take the way.
TEST(ProfileValues, APeakBetweenSpeedsOfOne) {
  for (const double speed : {0.5, 1.0, 2.0}) {
    for (const double length : {1e-3, 0.05, 20.0}) {
      const SpeedProfile p = SpeedProfile::Span(length, speed, speed, kUsual);
      EXPECT_NEAR(2.0 * RampLength(speed, p.peak_speed(), kUsual), length, 1e-9) << speed;
    }
  }
}

// The begin of a motion from rest is passed at once.
TEST(ProfileValues, TheBeginIsPassedAtOnce) {
  for (const double jerk : {40000.0, kWithoutEnd}) {
    const SpeedProfile p = SpeedProfile::Span(9.0, 0.0, 0.0, {350.0, 1.0, jerk});
    EXPECT_EQ(p.TimeAt(0.0), 0.0);
    EXPECT_EQ(p.Part(0.0, 4.0).duration_s(), p.TimeAt(4.0));
  }
}

// 1 mm/s2 is brought to zero as any other: at 1 mm/s3 in 1 s, on the way to half a mm/s more.
TEST(ProfileValues, AnAccelerationOfOneIsEnded) {
  const SpeedProfile p = SpeedProfile::From({0.0, 10.0, 1.0}, 400.0, 0.0, {10.0, 2.0, 1.0});
  EXPECT_NEAR(p.peak_speed(), 10.5, 1e-12);
  EXPECT_NEAR(p.At(1.0).speed, 10.5, 1e-12);
  EXPECT_EQ(p.At(0.0).acceleration, 1.0);
  // With a jerk of a quarter in 4 s, from 5 to 7 mm/s.
  const SpeedProfile longer = SpeedProfile::From({0.0, 5.0, 1.0}, 400.0, 0.0, {9.0, 4.0, 0.25});
  EXPECT_EQ(longer.phase(0).jerk, -0.25);
  EXPECT_NEAR(longer.phase(0).duration_s, 4.0, 1e-12);
  EXPECT_NEAR(longer.At(4.0).speed, 7.0, 1e-12);
}

}  // namespace
}  // namespace rmlcell::motion::profile_values
