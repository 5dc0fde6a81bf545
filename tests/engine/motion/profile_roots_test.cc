// What is found by steps towards a root has to be the root wherever it lies:
// peaks of spans, speeds that are reached, times at places. Many of each, since
// a step that is a little too long or too short ends elsewhere only here and
// there. motion.md 5.2
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion::profile_roots {
namespace {

constexpr double kWithoutEnd = std::numeric_limits<double>::infinity();
constexpr PathLimits kLimited{350.0, 2000.0, 40000.0};
constexpr PathLimits kTrapezoids{350.0, 2000.0, kWithoutEnd};

// How far the phases get, and how fast they are then: worked out from each of
// them alone.
PathState BehindThePhases(const SpeedProfile& profile) {
  PathState at = profile.phase_count() > 0 ? profile.phase(0).start : PathState{};
  for (int k = 0; k < profile.phase_count(); ++k) {
    const SpeedProfile::Phase& phase = profile.phase(k);
    const double t = phase.duration_s, a = phase.start.acceleration, j = phase.jerk;
    at.s += t * at.speed + t * t * a / 2.0 + t * t * t * j / 6.0;
    at.speed += t * a + t * t * j / 2.0;
  }
  return at;
}

// Ramps up and down with the peak between them that the limits do not reach:
// the phases end where the span does, whatever the speeds at its ends.
TEST(ProfileRoots, APeakUsesUpTheWayExactly) {
  std::mt19937_64 random(20260301);
  std::uniform_real_distribution<double> speed(0.0, 250.0), share(0.001, 1.0);
  for (const PathLimits& limits : {kLimited, kTrapezoids}) {
    for (int k = 0; k < 4000; ++k) {
      const double v0 = speed(random) * share(random), v1 = speed(random);
      const double least = RampLength(v0, v1, limits);
      const double most = RampLength(v0, 350.0, limits) + RampLength(350.0, v1, limits);
      const double length = least + (most - least) * share(random) * share(random);
      const SpeedProfile there = SpeedProfile::Span(length, v0, v1, limits);
      const PathState end = BehindThePhases(there);
      ASSERT_NEAR(end.s, length, 1e-11 * length) << k << ": " << v0 << " to " << v1;
      ASSERT_NEAR(end.speed, v1, 1e-9) << k << ": " << v0 << " to " << v1;
      const SpeedProfile back = SpeedProfile::Span(length, v1, v0, limits);
      ASSERT_NEAR(back.peak_speed(), there.peak_speed(), 1e-9) << k;
    }
  }
}

// From rest to rest as well, below and above the 10 mm from which on 2000 mm/s2 are reached.
TEST(ProfileRoots, FromRestToRestThePeakUsesUpTheWay) {
  for (const double length : {1e-3, 3.0, 9.0, 12.0, 15.0, 19.0, 30.0, 70.0}) {
    const double peak = SpeedProfile::Span(length, 0.0, 0.0, kLimited).peak_speed();
    EXPECT_NEAR(2.0 * RampLength(0.0, peak, kLimited), length, 1e-11 * length);
  }
}

// The ramp to the speed that is reached takes the way that there is.
TEST(ProfileRoots, WhatIsReachedTakesTheWholeWay) {
  std::mt19937_64 random(20260302);
  std::uniform_real_distribution<double> speed(0.5, 400.0), digits(-3.0, 2.0);
  for (const PathLimits& limits : {kLimited, kTrapezoids}) {
    for (int k = 0; k < 4000; ++k) {
      const double v0 = speed(random), length = std::pow(10.0, digits(random));
      const double v1 = Reach(v0, length, limits);
      // Near v0 a last digit of it is worth some way.
      const double digit = 1e-15 * v1;
      ASSERT_LE(RampLength(v0, v1 - digit, limits), length * (1.0 + 1e-11)) << k << ": " << v0;
      ASSERT_GE(RampLength(v0, v1 + digit, limits), length * (1.0 - 1e-11)) << k << ": " << v0;
    }
  }
}

// A place is passed at the time at which At is there, in every phase.
TEST(ProfileRoots, APlaceIsPassedWhenItIsReached) {
  std::mt19937_64 random(20260303);
  std::uniform_real_distribution<double> speed(0.0, 250.0), share(0.0, 1.0);
  for (int k = 0; k < 400; ++k) {
    const double v0 = k % 4 == 0 ? 0.0 : speed(random), v1 = k % 3 == 0 ? 0.0 : speed(random);
    const double length = RampLength(v0, v1, kLimited) + 60.0 * share(random);
    const SpeedProfile profile = SpeedProfile::Span(length, v0, v1, kLimited);
    double before = 0.0;
    for (int n = 1; n < 40; ++n) {
      const double s = length * n / 40.0;
      const double t = profile.TimeAt(s);
      ASSERT_NEAR(profile.At(t).s, s, 1e-11 * length) << k << " at " << s;
      ASSERT_GT(t, before) << k << " at " << s;
      before = t;
    }
  }
}

// The same near the ends of phases, where the root lies at an end of what is
// looked through.
TEST(ProfileRoots, APlaceNextToAPhaseIsPassedNextToIt) {
  for (const double v0 : {0.0, 3.0, 120.0}) {
    const SpeedProfile profile = SpeedProfile::Span(80.0, v0, 20.0, kLimited);
    double begin_s = 0.0;
    for (int k = 1; k < profile.phase_count(); ++k) {
      begin_s += profile.phase(k - 1).duration_s;
      const PathState& start = profile.phase(k).start;
      for (const double way : {1e-9, 1e-6, 1e-3}) {
        EXPECT_NEAR(profile.TimeAt(start.s - way), begin_s - way / start.speed, 2e-8) << k;
        EXPECT_NEAR(profile.TimeAt(start.s + way), begin_s + way / start.speed, 2e-8) << k;
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion::profile_roots
