// Level 2 of motion.md 5.4: ramps across the ends of stretches.
#include "engine/motion/profile/ramp_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/engine/motion/level_one.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr PathLimits kCellLimits{.speed = 100.0, .acceleration = 2000.0, .jerk = 40000.0};

// From rest to 100 mm/s takes 5 mm (50 mm/s for 2 sqrt(100/40000) = 0.1 s): over ten stretches of 1
// mm with one limit that is one ramp and 5 mm at full speed. Level 1 stops speeding up at each end.
TEST(RampPlan, OneRampOverStretchesOfOneLimit) {
  std::vector<RampCell> cells(100,
                              RampCell{.length = 1.0, .limits = kCellLimits, .end_speed = 0.0});
  TimeByLevelOne(cells, 0.0, 100.0);
  ASSERT_EQ(cells.back().end_speed, 100.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  EXPECT_NEAR(TimeOf(plan), 0.1 + 95.0 / 100.0, 1e-12);
  EXPECT_GT(LevelOneTime(cells, 0.0), TimeOf(plan) + 0.05);
  ASSERT_EQ(plan.timing().size(), 100u);
  EXPECT_EQ(plan.timing()[3].from, 3.0);
  EXPECT_EQ(plan.timing()[3].to, 4.0);
  EXPECT_EQ(plan.timing()[4].ramp, plan.timing()[0].ramp);  // the whole speed-up is one ramp
}

// Braking to rest all the way, level 1 is at its last reach at every end, also of a first stretch
// so short that the length of its ramp hangs on the last digits of its speeds. One ramp over the
// last two stretches is faster by far, however long the first one is.
TEST(RampPlan, LastDigitsOfAShortStretchDoNotKeepTheRestApart) {
  for (int k = 1; k <= 2000; ++k) {
    std::vector<RampCell> cells(3, RampCell{.length = 1.0, .limits = kCellLimits});
    cells[0].length = 1e-5 * k;
    cells[1].end_speed = Reach(0.0, cells[2].length, kCellLimits);
    cells[0].end_speed = Reach(cells[1].end_speed, cells[1].length, kCellLimits);
    const double start = Reach(cells[0].end_speed, cells[0].length, kCellLimits);
    RampPlan plan;
    plan.Plan(cells, start);
    const double joined =
        SpeedProfile::Span(2.0, cells[0].end_speed, 0.0, kCellLimits).duration_s() +
        SpeedProfile::Span(cells[0].length, start, cells[0].end_speed, kCellLimits).duration_s();
    EXPECT_LT(joined, 0.97 * LevelOneTime(cells, start));
    EXPECT_LE(TimeOf(plan), joined * (1 + 1e-12)) << cells[0].length;
  }
}

// Where one ramp over a long way is too fast at the end of one stretch, it is as much too fast at
// the start of the next with the same limit: a tie, which last digits must not decide. With every
// length, speed, acceleration and jerk times c the time is the same. motion.md 10, property 6
TEST(RampPlan, ScaledLongWaysTakeTheSameTime) {
  const auto time_of = [](double c) {
    const auto cell = [c](double length, double speed, double end_cap) {
      return RampCell{.length = length * c,
                      .limits = {speed * c, 300.0 * c, 6000.0 * c},
                      .end_cap = end_cap * c};
    };
    std::vector<RampCell> cells{cell(6.1, 150, 73),   cell(4.5, 103, 100),   cell(4.5, 103, 73),
                                cell(4.4, 150, 37),   cell(0.8, 37, 37),     cell(3, 150, 3.1),
                                cell(0.06, 3.1, 3.1), cell(0.05, 6.2, 0.47), cell(7e-4, 0.47, 0.47),
                                cell(0.004, 150, 150)};
    TimeByLevelOne(cells, 0.0, 0.0);
    RampPlan plan;
    plan.Plan(cells, 0.0);
    return TimeOf(plan);
  };
  const double time = time_of(1.0);
  for (int k = 1; k <= 200; ++k) EXPECT_NEAR(time_of(1.0 + 0.01 * k), time, 1e-9 * time) << k;
}

// A stretch in the middle that allows only 20 mm/s is passed at 20, and not at more just before it.
TEST(RampPlan, SlowStretchIsKept) {
  std::vector<RampCell> cells(9, RampCell{.length = 2.0, .limits = kCellLimits, .end_speed = 0.0});
  cells[4].limits.speed = 20.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  EXPECT_LE(TimeOf(plan), LevelOneTime(cells, 0.0));
  const RampPlan::Timing& slow = plan.timing()[4];
  const SpeedProfile& ramp = plan.ramps()[slow.ramp];
  for (int k = 0; k <= 20; ++k) {
    const double s = slow.from + (slow.to - slow.from) * k / 20.0;
    EXPECT_LE(ramp.At(ramp.TimeAt(s)).speed, 20.0 * (1 + 1e-9));
  }
}

// A point between two fast stretches may have a limit of its own (OVERSH straight on).
TEST(RampPlan, SlowPointIsKept) {
  std::vector<RampCell> cells(6, RampCell{.length = 3.0, .limits = kCellLimits, .end_speed = 0.0});
  cells[2].end_cap = 30.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  const RampPlan::Timing& before = plan.timing()[2];
  const SpeedProfile& ramp = plan.ramps()[before.ramp];
  EXPECT_LE(ramp.At(ramp.TimeAt(before.to)).speed, 30.0 * (1 + 1e-9));
  EXPECT_LE(TimeOf(plan), LevelOneTime(cells, 0.0));
}

// Random stretches, limits and points: every limit holds in every stretch, ramps join at equal
// speeds, nothing is slower than level 1.
TEST(RampPlan, RandomStretchesKeepTheirLimitsAndAreNeverSlower) {
  Dice dice(7);
  RampPlan plan;
  int faster = 0;
  for (int round = 0; round < 3000; ++round) {
    const auto count = static_cast<std::size_t>(dice.Uniform(1.0, 40.0));
    std::vector<RampCell> cells(count);
    double acceleration = 2000.0;
    for (RampCell& cell : cells) {
      if (dice.Chance(0.1)) acceleration = dice.Magnitude(50.0, 2000.0);
      cell.length = dice.Magnitude(0.01, 20.0);
      cell.limits = {dice.Chance(0.6) ? 100.0 : dice.Magnitude(5.0, 300.0), acceleration,
                     20.0 * acceleration};
      if (dice.Chance(0.2)) cell.end_cap = dice.Magnitude(2.0, 100.0);
    }
    TimeByLevelOne(cells, 0.0, dice.Chance(0.5) ? 0.0 : 50.0);
    plan.Plan(cells, 0.0);
    const double level_one = LevelOneTime(cells, 0.0);
    ASSERT_LE(TimeOf(plan), level_one * (1 + 1e-9)) << round;
    if (TimeOf(plan) < 0.99 * level_one) ++faster;
    double speed = 0.0;
    for (const SpeedProfile& ramp : plan.ramps()) {
      ASSERT_NEAR(ramp.At(0.0).speed, speed, 1e-9);
      speed = ramp.end().speed;
    }
    ASSERT_EQ(speed, cells.back().end_speed);
    for (std::size_t k = 0; k < count; ++k) {
      const RampPlan::Timing& timing = plan.timing()[k];
      const SpeedProfile part = plan.ramps()[timing.ramp].Part(timing.from, timing.to);
      ASSERT_NEAR(part.end().s, cells[k].length, 1e-9 * (1.0 + timing.to));
      ASSERT_LE(part.end().speed, cells[k].end_cap * (1 + 1e-9));
      for (int n = 0; n < part.phase_count(); ++n) {
        const SpeedProfile::Phase& phase = part.phase(n);
        const double after = phase.start.acceleration + phase.duration_s * phase.jerk;
        ASSERT_LE(std::max(std::abs(phase.start.acceleration), std::abs(after)),
                  cells[k].limits.acceleration * (1 + 1e-6) + 1e-6);
        ASSERT_LE(std::abs(phase.jerk), cells[k].limits.jerk * (1 + 1e-6));
        for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
          const double t = share * phase.duration_s;
          const double here =
              phase.start.speed + t * (phase.start.acceleration + 0.5 * t * phase.jerk);
          ASSERT_LE(here, cells[k].limits.speed * (1 + 1e-6)) << round << " cell " << k;
        }
      }
    }
  }
  EXPECT_GT(faster, 1000);
}

// The highest speed of a ramp between two places, from its phases: within one the speed turns where
// the acceleration is zero, if at all.
double HighestBetween(const SpeedProfile& ramp, double from, double to) {
  double highest = std::max(ramp.At(ramp.TimeAt(from)).speed, ramp.At(ramp.TimeAt(to)).speed);
  for (int n = 0; n < ramp.phase_count(); ++n) {
    const SpeedProfile::Phase& phase = ramp.phase(n);
    if (from <= phase.start.s && phase.start.s <= to)
      highest = std::max(highest, phase.start.speed);
  }
  return highest;
}

// One ramp over the cells from `first` to `last`, as motion.md 5.4 has it: with the least of their
// limits and the greatest of their speeds where that breaks none, else as fast as the slowest that
// it breaks. Infinite: its ends do not allow it.
double TimeOfOneRamp(const std::vector<RampCell>& cells, double start, std::size_t first,
                     std::size_t last) {
  const double begin = first == 0 ? start : cells[first - 1].end_speed;
  const double end = cells[last].end_speed;
  PathLimits limits{0.0, HUGE_VAL, HUGE_VAL};
  double length = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    limits.speed = std::max(limits.speed, cells[k].limits.speed);
    limits.acceleration = std::min(limits.acceleration, cells[k].limits.acceleration);
    limits.jerk = std::min(limits.jerk, cells[k].limits.jerk);
    length += cells[k].length;
  }
  if (first < last && RampLength(begin, end, limits) > length * (1 + 1e-12)) return HUGE_VAL;
  const SpeedProfile fast = SpeedProfile::Span(length, begin, end, limits);
  if (first == last) return fast.duration_s();
  double slowest_broken = HUGE_VAL;
  const auto keep = [&](double speed, double cap, double room = 1e-12) {
    if (speed > cap * (1 + room)) slowest_broken = std::min(slowest_broken, cap);
  };
  double from = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    const double to = std::min(from + cells[k].length, length);
    keep(HighestBetween(fast, from, to), cells[k].limits.speed);
    if (k < last) keep(fast.At(fast.TimeAt(to)).speed, cells[k].end_cap);
    for (std::size_t n = 0; n < cells[k].most.size(); ++n) {
      const double share = static_cast<double>(n) / static_cast<double>(cells[k].most.size() - 1);
      keep(fast.At(fast.TimeAt(from + share * (to - from))).speed, cells[k].most[n], 1e-9);
    }
    from = to;
  }
  if (slowest_broken == HUGE_VAL) return fast.duration_s();
  if (slowest_broken < std::max(begin, end)) return HUGE_VAL;
  limits.speed = slowest_broken;
  return SpeedProfile::Span(length, begin, end, limits).duration_s();
}

// The least time of all ways to join neighbours that are not passed at the limit.
double TimeOfBestJoins(const std::vector<RampCell>& cells, double start) {
  std::vector<double> until(cells.size() + 1, HUGE_VAL);
  until[0] = 0.0;
  for (std::size_t end = 0; end < cells.size(); ++end) {
    for (std::size_t begin = end + 1; begin-- > 0;) {
      until[end + 1] =
          std::min(until[end + 1], until[begin] + TimeOfOneRamp(cells, start, begin, end));
      if (begin == 0) break;
      const double cap = std::min(
          {cells[begin - 1].limits.speed, cells[begin].limits.speed, cells[begin - 1].end_cap});
      if (cells[begin - 1].end_speed >= cap * (1 - 1e-12)) break;
    }
  }
  return std::min(until.back(), LevelOneTime(cells, start));
}

// Up to eight stretches: beside all ways to join them, tried by another program. A third of them
// are bends that are fast at their ends and slow in the middle.
TEST(RampPlan, FewStretchesAreJoinedInTheBestWay) {
  Dice dice(11);
  RampPlan plan;
  int joined = 0;
  for (int round = 0; round < 6000; ++round) {
    std::vector<RampCell> cells(static_cast<std::size_t>(dice.Uniform(2.0, 9.0)));
    std::vector<std::vector<double>> bends(cells.size());
    const double fastest = dice.Magnitude(20.0, 200.0);
    double acceleration = 2000.0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      RampCell& cell = cells[k];
      if (dice.Chance(0.1)) acceleration = dice.Magnitude(500.0, 2000.0);
      cell.length = dice.Magnitude(0.05, 5.0);
      cell.limits = {fastest * (dice.Chance(0.5) ? 1.0 : dice.Uniform(0.5, 1.5)), acceleration,
                     20.0 * acceleration};
      if (dice.Chance(0.2)) cell.end_cap = fastest * dice.Uniform(0.4, 1.2);
    }
    const double start = dice.Chance(0.4) ? 0.0 : fastest * 0.5;
    TimeByLevelOne(cells, start, dice.Chance(0.5) ? 0.0 : fastest * 0.5);
    if (RampLength(start, cells[0].end_speed, cells[0].limits) > cells[0].length) continue;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (!dice.Chance(0.3)) continue;
      const double end = cells[k].end_speed;
      const double top = std::max({end, k == 0 ? start : cells[k - 1].end_speed, 0.5 * fastest});
      for (const double share : {1.2, 1.1, 1.0, 1.1, 1.2}) bends[k].push_back(share * top);
      cells[k].most = bends[k];
    }
    plan.Plan(cells, start);
    const double best = TimeOfBestJoins(cells, start);
    ASSERT_NEAR(TimeOf(plan), best, 1e-8 * best) << round;
    if (best < 0.999 * LevelOneTime(cells, start)) ++joined;
  }
  EXPECT_GT(joined, 2000);
}

// Longer ways are never slower than one ramp over them, as slow all along as their slowest place
// asks for.
TEST(RampPlan, LongWaysAreNeverSlowerThanOneRamp) {
  Dice dice(17);
  RampPlan plan;
  int compared = 0;
  for (int round = 0; round < 1200; ++round) {
    std::vector<RampCell> cells(static_cast<std::size_t>(dice.Uniform(9.0, 30.0)));
    const double fastest = dice.Magnitude(20.0, 200.0);
    for (RampCell& cell : cells) {
      cell.length = dice.Magnitude(0.01, 1.0);
      cell.limits = {fastest * dice.Uniform(0.8, 1.2), 2000.0, 40000.0};
      if (dice.Chance(0.2)) cell.end_cap = fastest * dice.Uniform(0.6, 1.2);
    }
    TimeByLevelOne(cells, 0.0, 0.0);
    const double one = TimeOfOneRamp(cells, 0.0, 0, cells.size() - 1);
    ASSERT_TRUE(std::isfinite(one));
    plan.Plan(cells, 0.0);
    bool touches = false;  // then it is no one way
    for (std::size_t k = 0; k + 1 < cells.size(); ++k) {
      const double cap =
          std::min({cells[k].limits.speed, cells[k + 1].limits.speed, cells[k].end_cap});
      touches = touches || cells[k].end_speed >= cap * (1 - 1e-12);
    }
    if (touches) continue;
    ++compared;
    ASSERT_LE(TimeOf(plan), one * (1 + 1e-9)) << round;
  }
  EXPECT_GT(compared, 100);
}

// What was begun and not done leaves nothing behind: the next ways are planned as by a new plan.
TEST(RampPlan, IsReusedAfterAWayThatWasNotDone) {
  Dice dice(23);
  const auto way = [&dice](double from, double to) {
    std::vector<RampCell> cells(static_cast<std::size_t>(dice.Uniform(from, to)));
    for (RampCell& cell : cells) {
      cell.length = dice.Magnitude(0.05, 3.0);
      cell.limits = {100.0 * dice.Uniform(0.5, 1.5), 2000.0, 40000.0};
    }
    TimeByLevelOne(cells, 0.0, 0.0);
    return cells;
  };
  RampPlan used;
  for (int round = 0; round < 300; ++round) {
    const std::vector<RampCell> left = way(2.0, 40.0), cells = way(1.0, 40.0);
    used.Begin(left, 0.0);
    for (int step = round % 12; step > 0 && !used.done(); --step) used.GoOn();
    used.Plan(cells, 0.0);
    RampPlan fresh;
    fresh.Plan(cells, 0.0);
    ASSERT_EQ(used.ramps().size(), fresh.ramps().size()) << round;
    ASSERT_EQ(used.timing().size(), cells.size()) << round;
    ASSERT_EQ(TimeOf(used), TimeOf(fresh)) << round;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      ASSERT_EQ(used.timing()[k].ramp, fresh.timing()[k].ramp) << round;
      ASSERT_EQ(used.timing()[k].from, fresh.timing()[k].from) << round;
      ASSERT_EQ(used.timing()[k].to, fresh.timing()[k].to) << round;
    }
  }
}

// Longer ways are split at what one ramp breaks most: a stretch by itself, with one ramp on each
// side of it, or the end of a stretch, with one ramp up to it and one from it.
TEST(RampPlan, LongWaysAreSplitWhereTheyAreSlow) {
  std::vector<RampCell> cells(15, {.length = 2.0, .limits = kCellLimits});
  cells[4].limits.speed = 40.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  ASSERT_EQ(plan.ramps().size(), 3U);
  EXPECT_NEAR(plan.ramps()[0].end().s, 8.0, 1e-12);
  EXPECT_NEAR(plan.ramps()[1].end().s, 2.0, 1e-12);
  EXPECT_NEAR(plan.ramps()[2].end().s, 20.0, 1e-12);
  EXPECT_EQ(plan.ramps()[2].At(0.0).speed, 40.0);
  cells[4].limits.speed = 100.0;
  cells[11].end_cap = 30.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  plan.Plan(cells, 0.0);
  ASSERT_EQ(plan.ramps().size(), 2U);
  EXPECT_NEAR(plan.ramps()[0].end().s, 24.0, 1e-12);
  EXPECT_EQ(plan.ramps()[0].end().speed, 30.0);
}

}  // namespace
}  // namespace rmlcell::motion
