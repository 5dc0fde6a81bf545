#include "engine/simulation/report/beam_work.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

constexpr double kWatts = 1500.0;
constexpr double kSpeedMax = 500.0;

// motion.md 8.1: the line through the origin and (speed, power); both in percent.
machine::PowerBySpeed Workdef1(double speed_percent, double power_percent) {
  return {.constant_percent = 0.0,
          .percent_per_mm_s = power_percent / (speed_percent / 100.0 * kSpeedMax)};
}

double EnergyOf(const motion::PathLimits& limits, double length, machine::PowerBySpeed power) {
  BeamWork beam(kWatts, kSpeedMax);
  const auto profile = motion::SpeedProfile::Span(length, 0.0, 0.0, limits);
  return beam.Moving(profile, 0.0, profile.duration_s(), 1.0, power);
}

// motion.md 8.1 and case W03: 200 mm at SPEED 8 with (8, 75): 1500 * 0.75 / 40 = 28.125 J/mm at any
// speed, ramps included.
TEST(BeamWork, EnergyPerMillimetreIsConstantWithoutSaturation) {
  const motion::PathLimits limits{.speed = 40.0, .acceleration = 2000.0, .jerk = 40000.0};
  EXPECT_NEAR(EnergyOf(limits, 200.0, Workdef1(8.0, 75.0)), 28.125 * 200.0, 1e-9);
  EXPECT_NEAR(EnergyOf(limits, 0.05, Workdef1(8.0, 75.0)), 28.125 * 0.05, 1e-12);
}

// Case W04: 200 mm at SPEED 10 with (6.5, 80): saturated above 40.625 mm/s; 6014.484172383 J.
TEST(BeamWork, EnergyWithSaturation) {
  EXPECT_NEAR(EnergyOf(kSlowLimits, 200.0, Workdef1(6.5, 80.0)), 6014.484172383, 1e-6);
}

// WORKDEF 0: constant power, so energy is power times time, whatever the speed.
TEST(BeamWork, ConstantPower) {
  const auto profile = motion::SpeedProfile::Span(100.0, 0.0, 0.0, kSlowLimits);
  EXPECT_NEAR(EnergyOf(kSlowLimits, 100.0, {.constant_percent = 60.0}),
              kWatts * 0.6 * profile.duration_s(), 1e-9);
}

// A constant and a slope together saturate where c + k v = 100.
TEST(BeamWork, ConstantAndSlope) {
  // Trapezoid: 1 s up to 10 mm/s, 1 s down. P = 50 + 10 v reaches 100 at v = 5, after half a
  // second. Each ramp: half a second from 50 to 100 %, half a second at 100 %.
  const motion::PathLimits limits{.speed = 10.0, .acceleration = 10.0};
  const double expected = kWatts * 2.0 * (0.5 * 0.75 + 0.5 * 1.0);
  EXPECT_NEAR(EnergyOf(limits, 10.0, {.constant_percent = 50.0, .percent_per_mm_s = 10.0}),
              expected, 1e-9);
}

// motion.md 8.2: time by speed, classes of 5 % of 500 mm/s = 25 mm/s. A trapezoid with 100 mm/s2 to
// 60 mm/s over 96 mm: 0.6 s up, 1 s at 60, 0.6 s down. By class: 0..25 0.25 s twice, 25..50 0.25 s
// twice, 50..75 0.1 s twice and the second at 60.
TEST(BeamWork, TimeBySpeed) {
  BeamWork beam(kWatts, kSpeedMax);
  const motion::PathLimits limits{.speed = 60.0, .acceleration = 100.0};
  const auto profile = motion::SpeedProfile::Span(96.0, 0.0, 0.0, limits);
  ASSERT_NEAR(profile.duration_s(), 2.2, 1e-12);
  beam.Moving(profile, 0.0, profile.duration_s(), 1.0, {.constant_percent = 100.0});
  beam.Standing(0.5, 0.0);
  const SimTime total = FromSeconds(2.7);
  const BeamHistogram histogram = beam.Histogram(total);
  EXPECT_EQ(histogram.by_speed[0], FromSeconds(0.5));
  EXPECT_NEAR(ToSeconds(histogram.by_speed[1]), 0.5, 1e-8);
  EXPECT_NEAR(ToSeconds(histogram.by_speed[2]), 0.5, 1e-8);
  EXPECT_NEAR(ToSeconds(histogram.by_speed[3]), 1.2, 1e-8);
  EXPECT_EQ(std::reduce(histogram.by_speed.begin(), histogram.by_speed.end()), total);
  EXPECT_EQ(histogram.by_power[0], FromSeconds(0.5));
  EXPECT_EQ(histogram.by_power[19], FromSeconds(2.2));
}

// Under WORKDEF 1 with 1 % per mm/s the classes of power are of 5 mm/s: on the ramps of 0.6 s each
// takes 0.05 s twice, and the second at 60 mm/s falls into [60, 65).
TEST(BeamWork, TimeByPower) {
  BeamWork beam(kWatts, kSpeedMax);
  const motion::PathLimits limits{.speed = 60.0, .acceleration = 100.0};
  const auto profile = motion::SpeedProfile::Span(96.0, 0.0, 0.0, limits);
  // The bounds at 25 and 50 mm/s are those of a class of speed, too: 30 % on the ramps, 60 %
  // between.
  EXPECT_NEAR(beam.Moving(profile, 0.0, profile.duration_s(), 1.0, {.percent_per_mm_s = 1.0}),
              kWatts * (1.2 * 0.3 + 1.0 * 0.6), 1e-9);
  const BeamHistogram histogram = beam.Histogram(FromSeconds(2.2));
  for (std::size_t bin = 0; bin < 12; ++bin) {
    EXPECT_NEAR(ToSeconds(histogram.by_power[bin]), 0.1, 1e-8) << bin;
  }
  EXPECT_NEAR(ToSeconds(histogram.by_power[12]), 1.0, 1e-8);
  EXPECT_EQ(histogram.by_power[13], SimTime::zero());
}

// Up to the last class: with 2 % by mm/s 100 % are reached at 50 mm/s. On each ramp every class has
// 0.025 s, and the last one what is above it, too: 0.1 s of each ramp and the second between.
TEST(BeamWork, TimeByPowerUpToTheLimit) {
  BeamWork beam(kWatts, kSpeedMax);
  const auto profile =
      motion::SpeedProfile::Span(96.0, 0.0, 0.0, {.speed = 60.0, .acceleration = 100.0});
  EXPECT_NEAR(beam.Moving(profile, 0.0, profile.duration_s(), 1.0, {.percent_per_mm_s = 2.0}),
              kWatts * (2.0 * (0.5 * 0.5 + 0.1) + 1.0), 1e-9);
  const BeamHistogram histogram = beam.Histogram(FromSeconds(2.2));
  for (std::size_t bin = 0; bin < 19; ++bin) {
    EXPECT_NEAR(ToSeconds(histogram.by_power[bin]), 0.05, 1e-8) << bin;
  }
  EXPECT_NEAR(ToSeconds(histogram.by_power[19]), 0.05 + 1.2, 1e-8);
}

// The highest class of speed begins at 95 % of 500 mm/s: a ramp from 470 to 480 mm/s is as long
// below it as above, and faster ones are all above.
TEST(BeamWork, TheHighestClassOfSpeed) {
  BeamWork beam(kWatts, kSpeedMax);
  const auto profile =
      motion::SpeedProfile::Span(47.5, 470.0, 480.0, {.speed = 480.0, .acceleration = 100.0});
  ASSERT_NEAR(profile.duration_s(), 0.1, 1e-9);
  beam.Moving(profile, 0.0, profile.duration_s(), 1.0, {.constant_percent = 100.0});
  const BeamHistogram histogram = beam.Histogram(FromSeconds(profile.duration_s()));
  EXPECT_NEAR(ToSeconds(histogram.by_speed[19]), 0.05, 1e-8);
  EXPECT_NEAR(ToSeconds(histogram.by_speed[20]), 0.05, 1e-8);
}

// The speed of the tip is that along the path times what the tip goes by it: with a quarter the
// ramp to 60 mm/s is one to 15 mm/s, all in the first class.
TEST(BeamWork, TheTipMayBeSlowerThanThePath) {
  BeamWork beam(kWatts, kSpeedMax);
  const auto profile =
      motion::SpeedProfile::Span(96.0, 0.0, 0.0, {.speed = 60.0, .acceleration = 100.0});
  // 4 % by mm/s: up to 60 %, 30 % on the ramps.
  EXPECT_NEAR(beam.Moving(profile, 0.0, profile.duration_s(), 0.25, {.percent_per_mm_s = 4.0}),
              kWatts * (1.2 * 0.3 + 1.0 * 0.6), 1e-9);
  const BeamHistogram histogram = beam.Histogram(FromSeconds(2.2));
  EXPECT_EQ(histogram.by_speed[1], FromSeconds(2.2));
  for (std::size_t bin = 0; bin < 12; ++bin) {
    EXPECT_NEAR(ToSeconds(histogram.by_power[bin]), 0.1, 1e-8) << bin;
  }
}

// Bounds of classes: the power of a class begins at its lower bound, 100 % belongs to the last one,
// what lies outside to the ends; a speed of 0 and a machine without a known highest speed to class
// 0.
TEST(BeamWork, ClassesBeginAtTheirLowerBound) {
  const auto power_class = [](double percent) {
    BeamWork beam(kWatts, kSpeedMax);
    const double energy = beam.Standing(2.0, percent);
    EXPECT_NEAR(energy, kWatts * 2.0 * std::clamp(percent, 0.0, 100.0) / 100.0, 1e-9) << percent;
    const BeamHistogram histogram = beam.Histogram(FromSeconds(2.0));
    EXPECT_EQ(histogram.by_speed[0], FromSeconds(2.0));
    return std::ranges::find(histogram.by_power, FromSeconds(2.0)) - histogram.by_power.begin();
  };
  EXPECT_EQ(power_class(-5.0), 0);
  EXPECT_EQ(power_class(4.99), 0);
  EXPECT_EQ(power_class(5.0), 1);
  EXPECT_EQ(power_class(94.99), 18);
  EXPECT_EQ(power_class(95.0), 19);
  EXPECT_EQ(power_class(100.0), 19);
  EXPECT_EQ(power_class(130.0), 19);
  const auto speed_class = [](double speed, double speed_max) {
    BeamWork beam(kWatts, speed_max);
    const auto steady = motion::SpeedProfile::Steady(speed * 2.0, speed);
    beam.Moving(steady, 0.0, 2.0, 1.0, {.constant_percent = 50.0});
    const BeamHistogram histogram = beam.Histogram(FromSeconds(2.0));
    return std::ranges::find(histogram.by_speed, FromSeconds(2.0)) - histogram.by_speed.begin();
  };
  EXPECT_EQ(speed_class(1.0, kSpeedMax), 1);
  EXPECT_EQ(speed_class(26.0, kSpeedMax), 2);
  EXPECT_EQ(speed_class(474.0, kSpeedMax), 19);
  EXPECT_EQ(speed_class(476.0, kSpeedMax), 20);
  EXPECT_EQ(speed_class(600.0, kSpeedMax), 20);
  EXPECT_EQ(speed_class(26.0, 0.0), 0);
}

// A power that falls with the speed, as a negative slope makes it: 80 % at rest, none from 8 mm/s
// on. On a ramp of 1 s to 10 mm/s each class of 5 % takes 0.05 s, and the last 0.2 s have none.
TEST(BeamWork, APowerThatFallsWithTheSpeed) {
  BeamWork beam(kWatts, kSpeedMax);
  const auto profile =
      motion::SpeedProfile::Span(10.0, 0.0, 0.0, {.speed = 10.0, .acceleration = 10.0});
  EXPECT_NEAR(
      beam.Moving(profile, 0.0, 2.0, 1.0, {.constant_percent = 80.0, .percent_per_mm_s = -10.0}),
      kWatts * 2.0 * 0.8 * 0.4, 1e-9);
  const BeamHistogram histogram = beam.Histogram(FromSeconds(2.0));
  EXPECT_NEAR(ToSeconds(histogram.by_power[0]), 0.1 + 0.4, 1e-8);
  for (std::size_t bin = 1; bin < 16; ++bin) {
    EXPECT_NEAR(ToSeconds(histogram.by_power[bin]), 0.1, 1e-8) << bin;
  }
  EXPECT_EQ(histogram.by_power[16], SimTime::zero());
}

// From 110 % at rest by 10 % a mm/s: full power up to 1 mm/s, none from 11 on. On ramps of 1.2 s to
// 12 mm/s and back each class has 0.05 s, and those at the ends 0.15 s.
TEST(BeamWork, APowerThatFallsFromBeyondTheLimit) {
  BeamWork beam(kWatts, kSpeedMax);
  const auto profile =
      motion::SpeedProfile::Span(14.4, 0.0, 0.0, {.speed = 12.0, .acceleration = 10.0});
  EXPECT_NEAR(
      beam.Moving(profile, 0.0, 2.4, 1.0, {.constant_percent = 110.0, .percent_per_mm_s = -10.0}),
      kWatts * 2.0 * (0.1 + 0.5), 1e-9);
  const BeamHistogram histogram = beam.Histogram(FromSeconds(2.4));
  for (std::size_t bin = 0; bin < kPowerBins; ++bin) {
    EXPECT_NEAR(ToSeconds(histogram.by_power[bin]), bin == 0 || bin == 19 ? 0.3 : 0.1, 1e-8) << bin;
  }
}

// The beam of the job counts for one program besides, as long as that is told.
TEST(BeamWork, CountsIntoAnotherAsWell) {
  BeamWork beam(kWatts, kSpeedMax);
  BeamTimes program;
  beam.Standing(0.5, 40.0);
  beam.AlsoInto(&program);
  beam.Standing(1.0, 40.0);
  beam.AlsoInto(nullptr);
  beam.Standing(2.0, 40.0);
  EXPECT_EQ(beam.Histogram(FromSeconds(3.5)).by_power[8], FromSeconds(3.5));
  const BeamHistogram of_program = program.Histogram(FromSeconds(1.0));
  EXPECT_EQ(of_program.by_power[8], FromSeconds(1.0));
  EXPECT_EQ(of_program.by_speed[0], FromSeconds(1.0));
}

// Times are whole nanoseconds and add up: what rounding leaves goes to the longest.
TEST(BeamWork, WhatRoundingLeavesGoesToTheLongest) {
  BeamWork beam(kWatts, kSpeedMax);
  beam.Standing(0.25, 2.0);
  beam.Standing(0.75, 12.0);
  const BeamHistogram histogram = beam.Histogram(FromSeconds(1.0) + SimTime(3));
  EXPECT_EQ(histogram.by_power[0], FromSeconds(0.25));
  EXPECT_EQ(histogram.by_power[2], FromSeconds(0.75) + SimTime(3));
}

// A tip that stands while A and B turn gets the power of speed 0.
TEST(BeamWork, StandingTipWhileTheHeadTurns) {
  BeamWork beam(kWatts, kSpeedMax);
  const motion::PathLimits limits{.speed = 1.0, .acceleration = 10.0};
  const auto profile = motion::SpeedProfile::Span(1.0, 0.0, 0.0, limits);
  EXPECT_EQ(beam.Moving(profile, 0.0, profile.duration_s(), 0.0, Workdef1(8.0, 75.0)), 0.0);
  const BeamHistogram histogram = beam.Histogram(FromSeconds(profile.duration_s()));
  EXPECT_EQ(histogram.by_speed[0], FromSeconds(profile.duration_s()));
}

// Parts of a profile add up to the whole.
TEST(BeamWork, PartsAddUp) {
  BeamWork beam(kWatts, kSpeedMax);
  const auto profile = motion::SpeedProfile::Span(200.0, 0.0, 0.0, kSlowLimits);
  const machine::PowerBySpeed power = Workdef1(6.5, 80.0);
  double sum = 0.0;
  for (int k = 0; k < 10; ++k) {
    sum += beam.Moving(profile, profile.duration_s() * k / 10, profile.duration_s() * (k + 1) / 10,
                       1.0, power);
  }
  EXPECT_NEAR(sum, 6014.484172383, 1e-6);
}

}  // namespace
}  // namespace rmlcell::simulation
