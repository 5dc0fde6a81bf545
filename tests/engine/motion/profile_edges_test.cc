// Edges of profiles and plans: no way, accelerations of one, speeds that rounding leaves, ends that
// are met to the last digits only.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "engine/motion/profile/ramp_plan.h"
#include "engine/motion/profile/speed_passes.h"
#include "engine/motion/profile/speed_profile.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

// Behind its end, by a last digit, there is no way either: the speed stays what it is.
TEST(Reach, WithoutAWayTheSpeedStays) {
  for (const double jerk : {40000.0, kEndless}) {
    const PathLimits limits{350.0, 2000.0, jerk};
    for (const double speed : {0.0, 0.3, 70.0}) {
      for (const double length : {0.0, -1e-12, -3.0}) {
        EXPECT_EQ(Reach(speed, length, limits), speed) << length;
      }
    }
  }
}

// At 1 mm/s2 from rest s is half of t squared: the time at a place is that of its acceleration,
// whatever number that is.
TEST(SpeedProfile, TimesWithAnAccelerationOfOne) {
  for (const double a : {0.5, 1.0, 2.0}) {
    const SpeedProfile p = SpeedProfile::Span(400.0, 0.0, 0.0, {20.0, a, kEndless});
    for (const double s : {0.02, 2.0, 18.0}) {
      EXPECT_NEAR(p.TimeAt(s), std::sqrt(2.0 * s / a), 1e-12) << a;
      EXPECT_NEAR(p.TimeAt(400.0 - s), p.duration_s() - std::sqrt(2.0 * s / a), 1e-9) << a;
    }
  }
}

// What takes no time is as one that was never made.
TEST(SpeedProfile, OfNoLengthIsAsNone) {
  const SpeedProfile none = SpeedProfile::Span(0.0, 30.0, 30.0, {350.0, 2000.0, 40000.0});
  EXPECT_EQ(none.peak_speed(), SpeedProfile().peak_speed());
  EXPECT_EQ(none.phase_count(), 0);
}

// An acceleration whose end is rest, to the last digit on either side: no phase goes backwards.
TEST(From, NoPhaseGoesBackwards) {
  Dice dice(31);
  int below = 0;
  for (int round = 0; round < 20'000; ++round) {
    const PathLimits limits{dice.Magnitude(1.0, 500.0), dice.Magnitude(50.0, 5000.0),
                            dice.Magnitude(100.0, 1e6)};
    const double a = -limits.acceleration * dice.Uniform(0.01, 1.0);
    const double t = -a / limits.jerk;
    // The speed that is gone when the acceleration is: written otherwise than the profile does.
    const double speed = 0.5 * a * a / limits.jerk;
    if (speed + t * (a + 0.5 * t * limits.jerk) < 0.0) ++below;
    const SpeedProfile p = SpeedProfile::From({0.0, speed, a}, 1000.0, 0.0, limits);
    for (int k = 0; k < p.phase_count(); ++k) ASSERT_GE(p.phase(k).start.speed, 0.0) << round;
  }
  EXPECT_GT(below, 1000);
}

// Level 1 may end faster, by last digits, than a ramp over the last stretch: then that is the end
// of the plan all the same, since no speed at the ends of the whole way changes.
TEST(RampPlan, EndsAtItsOwnSpeedToTheLastDigit) {
  constexpr PathLimits kOne{.speed = 100.0, .acceleration = 2000.0, .jerk = 40000.0};
  for (int more = 0; more <= 8; ++more) {
    std::vector<RampCell> cells(3, RampCell{.length = 0.7, .limits = kOne});
    double speed = 0.0;
    for (RampCell& cell : cells) speed = cell.end_speed = Reach(speed, cell.length, kOne);
    for (int digit = 0; digit < more; ++digit)
      cells.back().end_speed = std::nextafter(cells.back().end_speed, 1e9);
    RampPlan plan;
    plan.Plan(cells, 0.0);
    EXPECT_EQ(plan.ramps().back().end().speed, cells.back().end_speed) << more;
  }
}

// A plan that was fast and is slow now: what it kept of the way before, with more phases in it,
// tells nothing of this one.
TEST(RampPlan, NothingIsLeftOfAFasterWay) {
  Dice dice(29);
  RampPlan used;
  const auto way = [&dice](double speed, double accelerated) {
    std::vector<RampCell> cells(static_cast<std::size_t>(dice.Uniform(9.0, 30.0)));
    for (RampCell& cell : cells) {
      cell.length = dice.Magnitude(0.05, 3.0);
      cell.limits = {speed * dice.Uniform(0.7, 1.5), accelerated, 20.0 * accelerated};
    }
    double from = 0.0;
    const auto reachable = [](double at, const RampCell& cell, double cap) {
      if (cap <= at || RampLength(at, cap, cell.limits) <= cell.length) return cap;
      return std::min(cap, Reach(at, cell.length, cell.limits));
    };
    for (std::size_t k = 0; k < cells.size(); ++k) {
      double cap = cells[k].limits.speed;
      if (k + 1 < cells.size()) cap = std::min(cap, cells[k + 1].limits.speed);
      if (k + 1 == cells.size()) cap = 0.0;
      from = cells[k].end_speed = reachable(from, cells[k], cap);
    }
    for (std::size_t k = cells.size() - 1; k-- > 0;) {
      cells[k].end_speed = reachable(cells[k + 1].end_speed, cells[k + 1], cells[k].end_speed);
    }
    return cells;
  };
  for (int round = 0; round < 400; ++round) {
    const std::vector<RampCell> fast = way(300.0, 5000.0), slow = way(20.0, 300.0);
    used.Plan(fast, 0.0);
    used.Plan(slow, 0.0);
    RampPlan fresh;
    fresh.Plan(slow, 0.0);
    ASSERT_EQ(used.ramps().size(), fresh.ramps().size()) << round;
    for (std::size_t k = 0; k < slow.size(); ++k) {
      const RampPlan::Timing& timing = used.timing()[k];
      ASSERT_EQ(timing.ramp, fresh.timing()[k].ramp) << round;
      const SpeedProfile part = used.ramps()[timing.ramp].Part(timing.from, timing.to);
      ASSERT_LE(part.peak_speed(), slow[k].limits.speed * (1 + 1e-6)) << round;
    }
  }
}

// What is accepted is final, and keeps the speed that it was accepted with whatever comes behind.
TEST(SpeedPasses, AcceptedKnotsAreFinal) {
  constexpr PathLimits kOne{300.0, 2000.0, 40000.0};
  SpeedPasses passes;
  for (int knot = 0; knot < 6; ++knot) passes.Push(0.5, kOne, 200.0);
  ASSERT_LT(passes.Settle(), 3U);
  passes.Accept(3);
  EXPECT_EQ(passes.final_count(), 3U);
  EXPECT_EQ(passes.open_count(), 3U);
  const double speed = passes.speed(2);
  for (int knot = 0; knot < 60; ++knot) passes.Push(0.5, kOne, 200.0);
  passes.Settle();
  EXPECT_EQ(passes.speed(2), speed);
}

// Between two ramps it goes at exactly the speed of the limits, whatever the phases of the first
// one add up to.
TEST(SpeedProfile, ACruiseHasExactlyItsSpeed) {
  Dice dice(47);
  int cruises = 0;
  for (int round = 0; round < 2000; ++round) {
    const PathLimits limits{dice.Magnitude(1.0, 500.0), dice.Magnitude(50.0, 5000.0),
                            dice.Magnitude(100.0, 1e6)};
    const double length = 2.0 * RampLength(0.0, limits.speed, limits) + 10.0;
    const SpeedProfile p = SpeedProfile::Span(length, 0.0, 0.0, limits);
    ASSERT_EQ(p.peak_speed(), limits.speed) << round;
    for (int k = 0; k < p.phase_count(); ++k) {
      const SpeedProfile::Phase& phase = p.phase(k);
      if (phase.jerk != 0.0 || phase.start.acceleration != 0.0) continue;
      ++cruises;
      ASSERT_EQ(phase.start.speed, limits.speed) << round;
    }
  }
  EXPECT_EQ(cruises, 2000);
}

}  // namespace
}  // namespace rmlcell::motion
