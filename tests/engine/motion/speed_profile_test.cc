#include "engine/motion/profile/speed_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr double kNoJerkLimit = std::numeric_limits<double>::infinity();
constexpr PathLimits kPathLimits{350.0, 2000.0, 40000.0};

// Speed, acceleration and place at both sides of each phase edge agree, and no limit is passed.
void ExpectSound(const SpeedProfile& p, double length, double v0, double v1,
                 const PathLimits& limits) {
  SCOPED_TRACE(testing::Message() << length << " mm, " << v0 << " to " << v1);
  const double speed = std::max({limits.speed, v0, v1});
  PathState last{0.0, v0, 0.0};
  double time = 0.0;
  for (int k = 0; k < p.phase_count(); ++k) {
    const SpeedProfile::Phase& phase = p.phase(k);
    EXPECT_NEAR(phase.start.s, last.s, 1e-9 * std::max(1.0, length));
    EXPECT_NEAR(phase.start.speed, last.speed, 1e-7 * speed);
    if (std::isfinite(limits.jerk)) {
      EXPECT_NEAR(phase.start.acceleration, last.acceleration, 1e-7 * limits.acceleration);
      EXPECT_LE(std::abs(phase.jerk), limits.jerk);
    }
    const double t = phase.duration_s;
    last.acceleration = phase.start.acceleration + t * phase.jerk;
    last.speed = phase.start.speed + t * (phase.start.acceleration + 0.5 * t * phase.jerk);
    last.s = phase.start.s +
             t * (phase.start.speed + t * (0.5 * phase.start.acceleration + t * phase.jerk / 6));
    EXPECT_LE(std::abs(last.acceleration), limits.acceleration * (1 + 1e-9));
    EXPECT_LE(last.speed, speed * (1 + 1e-9));
    EXPECT_GE(last.speed, -1e-7 * speed);
    time += t;
  }
  EXPECT_NEAR(time, p.duration_s(), 1e-12 * std::max(1.0, time));
  EXPECT_NEAR(last.s, length, 1e-9 * std::max(1.0, length));
  EXPECT_NEAR(last.speed, v1, 1e-6 * speed);
  EXPECT_EQ(p.At(p.duration_s()).s, length);
  EXPECT_EQ(p.At(p.duration_s()).speed, v1);
}

// motion.md 5.2: t = 2 sqrt(D/j) up to D = a^2/j = 100 mm/s, D/a + a/j above.
TEST(Ramp, BothRegimesMeetAtTheBoundary) {
  EXPECT_DOUBLE_EQ(RampTime(0, 25, kPathLimits), 2.0 * std::sqrt(25.0 / 40000.0));
  EXPECT_DOUBLE_EQ(RampTime(10, 210, kPathLimits), 200.0 / 2000.0 + 0.05);
  EXPECT_NEAR(RampTime(0, 100 * (1 - 1e-9), kPathLimits),
              RampTime(0, 100 * (1 + 1e-9), kPathLimits), 1e-9);
  EXPECT_DOUBLE_EQ(RampLength(210, 10, kPathLimits), 110.0 * 0.15);
  EXPECT_DOUBLE_EQ(RampTime(0, 50, {350, 2000, kNoJerkLimit}), 0.025);
  EXPECT_EQ(RampTime(70, 70, kPathLimits), 0.0);
}

// motion.md 5.2: a ramp down is the ramp up in reverse, to the last digit.
TEST(Ramp, IsTheSameUpAndDown) {
  for (const double v0 : {0.0, 1e-9, 10.0, 33.3, 210.0}) {
    for (const double v1 : {0.0, 7.7, 33.3, 350.0}) {
      for (const double jerk : {40000.0, kNoJerkLimit}) {
        const PathLimits limits{350, 2000, jerk};
        EXPECT_EQ(RampTime(v0, v1, limits), RampTime(v1, v0, limits)) << v0 << ' ' << v1;
        EXPECT_EQ(RampLength(v0, v1, limits), RampLength(v1, v0, limits)) << v0 << ' ' << v1;
      }
    }
  }
}

// OPT-2.36: run-up from rest to 50 mm/s takes 0.0707 s, with ACCEL 50 0.1000 s.
TEST(Ramp, ManualsRunUp) {
  EXPECT_NEAR(RampTime(0, 50, kPathLimits), 0.0707, 5e-5);
  EXPECT_NEAR(RampTime(0, 50, {350, 1000, 20000}), 0.1000, 5e-5);
}

// The ramp to the speed reached takes exactly the length, on both sides of the regime boundary.
TEST(Reach, InvertsTheRampLength) {
  for (const double v0 : {0.0, 1e-12, 1e-6, 0.3, 50.0, 180.0, 500.0}) {
    const double boundary = RampLength(v0, v0 + 100.0, kPathLimits);
    for (const double length :
         {1e-9, 1e-3, 0.4, boundary * (1 - 1e-9), boundary * (1 + 1e-9), 300.0}) {
      const double v1 = Reach(v0, length, kPathLimits);
      // To the last digits of v1: near 500 mm/s one unit of them is worth 1e-6 mm.
      const double digit = 4e-16 * v1;
      EXPECT_LE(RampLength(v0, std::max(v0, v1 - digit), kPathLimits), length * (1 + 1e-9)) << v0;
      EXPECT_GE(RampLength(v0, v1 + digit, kPathLimits), length * (1 - 1e-9)) << v0;
      EXPECT_GE(v1, v0);
    }
    EXPECT_DOUBLE_EQ(Reach(v0, 10.0, {350, 2000, kNoJerkLimit}), std::sqrt(v0 * v0 + 40000.0));
  }
  EXPECT_EQ(Reach(7.0, 0.0, kPathLimits), 7.0);
}

// Rest to rest, both sides of length 2 a^3 / j^2 = 10 mm: there the peak is 100 mm/s, reached by
// two jerk phases of 0.05 s each way. motion.md 5.2.
TEST(Span, RestToRestAtTheRegimeBoundary) {
  for (const double length : {10.0 * (1 - 1e-9), 10.0, 10.0 * (1 + 1e-9)}) {
    const SpeedProfile p = SpeedProfile::Span(length, 0, 0, kPathLimits);
    EXPECT_NEAR(p.peak_speed(), 100.0, 1e-6);
    EXPECT_NEAR(p.duration_s(), 0.2, 1e-9);
    ExpectSound(p, length, 0, 0, kPathLimits);
  }
}

TEST(Span, SoundInEveryRegime) {
  for (const double jerk : {40000.0, kNoJerkLimit}) {
    const PathLimits limits{350.0, 2000.0, jerk};
    for (const double v0 : {0.0, 1e-9, 0.5, 25.0, 150.0, 350.0}) {
      for (const double v1 : {0.0, 0.5, 24.9, 150.0, 350.0}) {
        const double least = RampLength(v0, v1, limits);
        for (const double more : {0.0, 1e-12, 1e-6, 0.01, 1.0, 30.0, 1000.0}) {
          ExpectSound(SpeedProfile::Span(least + more, v0, v1, limits), least + more, v0, v1,
                      limits);
        }
      }
    }
  }
}

// Forwards and backwards take the same time and the same peak.
TEST(Span, IsSymmetric) {
  std::mt19937_64 random(20260101);
  std::uniform_real_distribution<double> speed(0.0, 350.0);
  std::uniform_real_distribution<double> extra(-6.0, 3.0);
  for (int k = 0; k < 1000; ++k) {
    const double v0 = speed(random), v1 = speed(random);
    const double length = RampLength(v0, v1, kPathLimits) + std::pow(10.0, extra(random));
    const SpeedProfile there = SpeedProfile::Span(length, v0, v1, kPathLimits);
    const SpeedProfile back = SpeedProfile::Span(length, v1, v0, kPathLimits);
    EXPECT_NEAR(there.duration_s(), back.duration_s(), 1e-12 * std::max(1.0, there.duration_s()));
    EXPECT_NEAR(there.peak_speed(), back.peak_speed(), 1e-9);
  }
}

// A jerk limit that grows without bound costs at most a/j per ramp against the trapezoid.
TEST(Span, TendsToTheTrapezoid) {
  for (const double length : {0.1, 20.0, 1000.0}) {
    const double trapezoid =
        SpeedProfile::Span(length, 0, 0, {350, 2000, kNoJerkLimit}).duration_s();
    for (const double jerk : {4e6, 4e8}) {
      const double limited = SpeedProfile::Span(length, 0, 0, {350, 2000, jerk}).duration_s();
      EXPECT_GE(limited, trapezoid);
      EXPECT_LE(limited - trapezoid, 2.0 * 2000.0 / jerk * (1 + 1e-9));
    }
  }
}

// At() returns the place within a phase by its cubic: S02 is symmetric about 0.15 s, half way.
TEST(Span, PlaceAtAnyTime) {
  const SpeedProfile p = SpeedProfile::Span(30.0, 0, 0, kPathLimits);
  EXPECT_NEAR(p.At(0.15).s, 15.0, 1e-12);
  EXPECT_NEAR(p.At(0.15).speed, 200.0, 1e-9);
  EXPECT_NEAR(p.At(0.03).s, 40000.0 * 0.03 * 0.03 * 0.03 / 6.0, 1e-12);
  EXPECT_NEAR(p.At(0.03).acceleration, 1200.0, 1e-9);
  EXPECT_EQ(p.At(-1.0).s, 0.0);
  EXPECT_EQ(p.At(9.0).s, 30.0);
  EXPECT_EQ(SpeedProfile{}.At(1.0).s, 0.0);
  EXPECT_EQ(SpeedProfile::Span(0.0, 0, 0, kPathLimits).duration_s(), 0.0);
}

// No way takes no time, also at full speed, where others are one steady phase.
TEST(Span, OfNoLengthHasNoPhase) {
  for (const double speed : {0.0, 50.0, 350.0}) {
    const SpeedProfile p = SpeedProfile::Span(0.0, speed, speed, kPathLimits);
    EXPECT_EQ(p.phase_count(), 0) << speed;
    EXPECT_EQ(p.duration_s(), 0.0) << speed;
    EXPECT_EQ(p.end().s, 0.0) << speed;
    EXPECT_EQ(p.end().speed, speed) << speed;
  }
  const SpeedProfile steady = SpeedProfile::Span(7.0, 350.0, 350.0, kPathLimits);
  EXPECT_EQ(steady.phase_count(), 1);
  EXPECT_EQ(steady.duration_s(), 7.0 / 350.0);
}

// A trapezoid of 100 mm/s and 1000 mm/s2 over 110 mm: 0.1 s up, 1 s steady, 0.1 s down. Where one
// phase ends the next has begun; both ends are passed at their times.
TEST(Span, PhasesOfATrapezoidBeginWhereOthersEnd) {
  const SpeedProfile p = SpeedProfile::Span(110.0, 0.0, 0.0, {100.0, 1000.0, kNoJerkLimit});
  ASSERT_EQ(p.phase_count(), 3);
  const double up = p.phase(0).duration_s, cruise = p.phase(1).duration_s;
  EXPECT_NEAR(up, 0.1, 1e-15);
  EXPECT_NEAR(cruise, 1.0, 1e-14);
  EXPECT_EQ(p.At(0.5 * up).acceleration, 1000.0);
  EXPECT_EQ(p.At(up).acceleration, 0.0);
  EXPECT_EQ(p.At(up + 0.5 * cruise).acceleration, 0.0);
  EXPECT_EQ(p.At(up + cruise + 0.05).acceleration, -1000.0);
  EXPECT_EQ(p.At(p.duration_s()).acceleration, 0.0);
  EXPECT_EQ(p.TimeAt(0.0), 0.0);
  EXPECT_EQ(p.TimeAt(110.0), p.duration_s());
  EXPECT_NEAR(p.TimeAt(5.0), 0.1, 1e-12);
  EXPECT_NEAR(p.TimeAt(1.25), 0.05, 1e-12);
  EXPECT_NEAR(p.TimeAt(108.75), 1.15, 1e-12);
}

// Rounding carries no place beyond the end, and no speed below rest.
TEST(Span, NoPlaceIsBeyondItsEnd) {
  Dice dice(12);
  for (int round = 0; round < 20'000; ++round) {
    const PathLimits limits{dice.Magnitude(1.0, 500.0), dice.Magnitude(50.0, 5000.0),
                            dice.Chance(0.3) ? kNoJerkLimit : dice.Magnitude(100.0, 1e6)};
    const double length = dice.Magnitude(1e-3, 1000.0);
    const SpeedProfile p = SpeedProfile::Span(length, 0.0, 0.0, limits);
    double t = p.duration_s();
    for (int step = 0; step < 4; ++step, t = std::nextafter(t, 0.0)) {
      ASSERT_LE(p.At(t).s, length) << round;
      ASSERT_GE(p.At(t).speed, 0.0) << round;
      ASSERT_LE(p.PlaceAt(t), length) << round;
    }
  }
}

// Without the time of a place being sought, its speed is bounded: never from below, and by no more
// than the ends of its phase have.
TEST(SpeedAtMost, IsNeverBelowTheSpeedThere) {
  Dice dice(46);
  int near = 0, places = 0;
  for (int round = 0; round < 3000; ++round) {
    const double j = dice.Chance(0.2) ? kNoJerkLimit : dice.Magnitude(100.0, 1e6);
    const PathLimits limits{dice.Magnitude(1.0, 500.0), dice.Magnitude(50.0, 5000.0), j};
    const double v0 = dice.Chance(0.3) ? 0.0 : limits.speed * dice.Uniform(0.0, 1.0);
    const double v1 = dice.Chance(0.3) ? 0.0 : limits.speed * dice.Uniform(0.0, 1.0);
    const double length = RampLength(v0, v1, limits) * dice.Magnitude(1.0001, 20.0) + 1e-3;
    const SpeedProfile profile = SpeedProfile::Span(length, v0, v1, limits);
    SpeedProfile::Place place;
    for (int k = 0; k <= 60; ++k) {
      profile.Advance(place, std::min(length * k / 60.0, length));
      const double speed = profile.SpeedAt(place), most = profile.SpeedAtMost(place);
      // At rest a place tells the speed to the root of its last digits.
      ASSERT_GE(most, speed - 1e-5 * profile.peak_speed()) << round << " at " << k;
      // Brute force: nowhere in its phase is it faster by more than the phase itself.
      ASSERT_LE(most, profile.peak_speed() * (1 + 1e-9)) << round << " at " << k;
      ++places;
      if (most <= speed * 1.05) ++near;
    }
  }
  EXPECT_GT(near, places / 2);  // and it tells something
}

// At the very end it is the speed there, and in a steady phase what all of it has.
TEST(SpeedAtMost, AtTheEndIsTheSpeedThere) {
  for (const double v1 : {0.0, 30.0, 350.0}) {
    const SpeedProfile p = SpeedProfile::Span(200.0, 0.0, v1, kPathLimits);
    SpeedProfile::Place place;
    p.Advance(place, 60.0);
    EXPECT_NEAR(p.SpeedAtMost(place), 350.0, 1e-6);
    p.Advance(place, 200.0);
    EXPECT_EQ(p.SpeedAtMost(place), v1);
    EXPECT_EQ(p.SpeedAt(place), v1);
  }
}

// OPT-B.31, case O03: from 100 mm/s to rest takes 0.1 s and 5 mm.
TEST(StopFrom, CruisingIsOneRamp) {
  const PathLimits limits{100.0, 2000.0, 40000.0};
  const SpeedProfile stop = SpeedProfile::Span(500.0, 0, 0, limits).StopFrom(2.0, limits);
  EXPECT_NEAR(stop.duration_s(), 0.1, 1e-12);
  EXPECT_NEAR(stop.end().s, 200.0, 1e-9);
  EXPECT_EQ(stop.At(1.0).speed, 0.0);
}

// At 0.03 s of S02: a = 1200, v = 18. Acceleration to zero takes 0.03 s and brings 36 mm/s, then
// 2 sqrt(36/40000) = 0.06 s to rest.
TEST(StopFrom, SpeedingUpFirstEndsTheAcceleration) {
  const SpeedProfile stop = SpeedProfile::Span(30.0, 0, 0, kPathLimits).StopFrom(0.03, kPathLimits);
  EXPECT_NEAR(stop.duration_s(), 0.09, 1e-12);
  EXPECT_NEAR(stop.peak_speed(), 36.0, 1e-9);
  EXPECT_NEAR(stop.At(0.03).speed, 36.0, 1e-9);
}

// A stop from any state is continuous, keeps the limits, ends at rest, and never passes the place
// where the motion would have come to rest. motion.md section 6.
TEST(StopFrom, AnyStateOfAnyProfile) {
  for (const double jerk : {40000.0, kNoJerkLimit}) {
    const PathLimits limits{350.0, 2000.0, jerk};
    for (const double length : {0.01, 5.0, 12.0, 30.0, 400.0}) {
      const SpeedProfile p = SpeedProfile::Span(length, 0, 0, limits);
      for (int k = 0; k <= 200; ++k) {
        const double t = p.duration_s() * k / 200;
        const SpeedProfile stop = p.StopFrom(t, limits);
        const PathState at = p.At(t);
        EXPECT_NEAR(stop.At(0.0).s, at.s, 1e-12 * length);
        EXPECT_NEAR(stop.At(0.0).speed, at.speed, 1e-9 + 1e-9 * at.speed);
        EXPECT_LE(stop.end().s, length * (1 + 1e-9));
        EXPECT_EQ(stop.end().speed, 0.0);
        for (int i = 0; i < stop.phase_count(); ++i) {
          EXPECT_LE(std::abs(stop.phase(i).start.acceleration), 2000.0 * (1 + 1e-9));
          EXPECT_GE(stop.phase(i).start.speed, -1e-9);
          if (i + 1 == stop.phase_count()) {
            const auto& last = stop.phase(i);
            const double d = last.duration_s;
            EXPECT_NEAR(last.start.speed + d * (last.start.acceleration + 0.5 * d * last.jerk), 0.0,
                        1e-6);
          }
        }
      }
    }
  }
}

// Reach is good to the last digits, and so is what a ramp to its speed is made of: where the change
// of speed is nothing but such digits the ramp must still be one that the machine may make.
// OPT-2.16, OPT-B.21
TEST(SpeedProfile, RampToWhatReachGivesKeepsItsLimits) {
  Dice dice(3);
  int tight = 0;  // ramps longer, by their own figures, than the way
  for (int round = 0; round < 200'000; ++round) {
    PathLimits limits{.speed = 500.0, .acceleration = dice.Magnitude(2.0, 2000.0)};
    if (round % 3 != 0) limits.jerk = 20.0 * limits.acceleration;
    const double v0 = dice.Chance(0.2) ? dice.Magnitude(1e-6, 500.0) : dice.Uniform(0.0, 500.0);
    const double length = dice.Magnitude(1e-14, 100.0);
    const double v1 = Reach(v0, length, limits);
    if (v1 > limits.speed) continue;
    if (RampLength(v0, v1, limits) > length * (1 + 1e-12)) ++tight;
    const bool up = round % 2 == 0;
    const SpeedProfile ramp = up ? SpeedProfile::Span(length, v0, v1, limits)
                                 : SpeedProfile::Span(length, v1, v0, limits);
    double speed = up ? v0 : v1;
    double way = 0.0;
    for (int k = 0; k < ramp.phase_count(); ++k) {
      const SpeedProfile::Phase& phase = ramp.phase(k);
      const double a = phase.start.acceleration, t = phase.duration_s;
      ASSERT_LE(std::max(std::abs(a), std::abs(a + t * phase.jerk)),
                limits.acceleration * (1 + 2e-6));
      ASSERT_LE(std::abs(phase.jerk), limits.jerk * (1 + 4e-6));
      ASSERT_NEAR(phase.start.speed, speed, 1e-10 * speed);
      speed = phase.start.speed + t * (a + 0.5 * t * phase.jerk);
      way += t * (phase.start.speed + t * (0.5 * a + t * phase.jerk / 6.0));
    }
    ASSERT_NEAR(speed, up ? v1 : v0, 1e-10 * v1);
    ASSERT_NEAR(way, length, 1e-10 * length);
  }
  EXPECT_GT(tight, 10'000);
}

// With 1 mm/s2 and without a limit on jerk: s = t^2 / 2 up to 50 mm, after 10 s at 10 mm/s.
TEST(SpeedProfile, TimesWithAnAccelerationOfOne) {
  const SpeedProfile p = SpeedProfile::Span(100.0, 0, 0, {100.0, 1.0, kNoJerkLimit});
  EXPECT_NEAR(p.TimeAt(0.5), 1.0, 1e-12);
  EXPECT_NEAR(p.TimeAt(8.0), 4.0, 1e-12);
  EXPECT_NEAR(p.TimeAt(50.0), 10.0, 1e-9);
  EXPECT_NEAR(p.TimeAt(100.0 - 0.5), 19.0, 1e-9);
}

// motion.md 5.2: 200 mm/s in 200/2000 + 0.05 s, at 110 mm/s on average; it is fastest at its upper
// end.
TEST(OneRamp, IsAsLongAsItTakes) {
  for (const auto& [v0, v1] : {std::pair{10.0, 210.0}, {210.0, 10.0}}) {
    const SpeedProfile ramp = SpeedProfile::OneRamp(v0, v1, kPathLimits);
    EXPECT_NEAR(ramp.duration_s(), 0.15, 1e-12);
    EXPECT_NEAR(ramp.end().s, 16.5, 1e-12);
    EXPECT_EQ(ramp.end().speed, v1);
    EXPECT_EQ(ramp.peak_speed(), 210.0);
    ExpectSound(ramp, ramp.end().s, v0, v1, kPathLimits);
  }
}

// motion.md 6: an acceleration that a lower override finds is brought to zero first, and the speed
// rises meanwhile: 1000 mm/s2 at 40,000 mm/s3 by 12.5 mm/s.
TEST(SpeedProfile, RisesWhileTheAccelerationEnds) {
  const PathLimits limits{.speed = 50.0, .acceleration = 2000.0, .jerk = 40'000.0};
  const SpeedProfile profile =
      SpeedProfile::From({.s = 0.0, .speed = 40.0, .acceleration = 1000.0}, 100.0, 0.0, limits);
  EXPECT_NEAR(profile.peak_speed(), 52.5, 1e-9);
  EXPECT_NEAR(profile.At(0.025).speed, 52.5, 1e-9);
  EXPECT_LE(profile.At(0.3).speed, 50.0 + 1e-9);
}

}  // namespace
}  // namespace rmlcell::motion
