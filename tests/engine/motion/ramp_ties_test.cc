// Ramps over stretches where a limit is just kept, where the first or the last
// stretch is the slow one, and where the passes over stretches do not meet the
// ends. motion.md 5.4
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "engine/motion/profile/ramp_plan.h"
#include "tests/engine/motion/level_one.h"

namespace rmlcell::motion::ramp_ties {
namespace {

constexpr PathLimits kFast{.speed = 200.0, .acceleration = 2000.0, .jerk = 40000.0};

std::vector<double> SplitsOf(const RampPlan& plan) {
  std::vector<double> lengths;
  for (const SpeedProfile& ramp : plan.ramps())
    lengths.push_back(std::round(ramp.end().s * 1e9) / 1e9);
  return lengths;
}

double SpeedAt(const SpeedProfile& ramp, double s) {
  SpeedProfile::Place place;
  ramp.Advance(place, s);
  return ramp.SpeedAt(place);
}

// From 20 mm/s to rest over 0.6 and 0.25 mm, the first at 20 mm/s at most: one
// ramp that is nowhere faster than it begins takes the place of both. It
// cruises and brakes for 0.447 mm.
TEST(RampTies, AsSlowAsItBeginsIsAllowed) {
  std::vector<RampCell> cells{{.length = 0.6, .limits = kFast}, {.length = 0.25, .limits = kFast}};
  cells[0].limits.speed = 20.0;
  TimeByLevelOne(cells, 20.0, 0.0);
  RampPlan plan;
  plan.Plan(cells, 20.0);
  const double ramp_s = 2.0 * std::sqrt(20.0 / 40000.0);
  const double time = (0.85 - 10.0 * ramp_s) / 20.0 + ramp_s;
  EXPECT_NEAR(TimeOf(plan), time, 1e-9);
  EXPECT_LT(time, LevelOneTime(cells, 20.0) - 5e-3);
}

// The last or the first of many allows 16 mm/s, where one ramp has 25: it is by
// itself, and one ramp takes all others.
TEST(RampTies, ASlowFirstOrLastStretchIsByItself) {
  for (const std::size_t count : {60U, 61U}) {
    const double others = count == 60 ? 17.7 : 18.0;
    std::vector<RampCell> cells(count, {.length = 0.3, .limits = kFast});
    cells.back().limits.speed = 16.0;
    TimeByLevelOne(cells, 0.0, 0.0);
    RampPlan plan;
    plan.Plan(cells, 0.0);
    EXPECT_EQ(SplitsOf(plan), (std::vector{others, 0.3}));
    std::ranges::reverse(cells);
    TimeByLevelOne(cells, 0.0, 0.0);
    plan.Plan(cells, 0.0);
    EXPECT_EQ(SplitsOf(plan), (std::vector{0.3, others}));
  }
}

// A bend among many that is slow at one of its places is by itself as a slow
// stretch would be.
TEST(RampTies, ABendThatOneRampBreaksIsByItself) {
  std::vector<RampCell> cells(61, {.length = 0.3, .limits = kFast});
  cells.back().length = 100.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  const std::vector<double> bend{150.0, 120.0, 65.0, 120.0, 150.0};
  cells[8].most = bend;
  RampPlan plan;
  plan.Plan(cells, 0.0);
  EXPECT_EQ(SplitsOf(plan), (std::vector{2.4, 0.3, 115.3}));
}

// 1 mm is the way from (200)^(2/3) mm/s to rest, where level 1 stands; to what
// 0.2 mm to the end would allow it is too short, since a ramp to rest has more
// time. Level 1 it is then, and no ramp that is steeper than its limits.
TEST(RampTies, WhatThePassesCannotMeetIsLevelOne) {
  const double start = std::pow(200.0, 2.0 / 3.0);
  std::vector<RampCell> cells{{.length = 1.0 + 1e-9, .limits = kFast},
                              {.length = 0.2, .limits = kFast}};
  cells[1].limits.speed = 12.0;
  cells[0].end_speed = cells[1].end_speed = 0.0;
  const double meets = Reach(0.0, 0.2, kFast);
  ASSERT_LT(meets, 12.0);
  ASSERT_GT(RampLength(start, meets, kFast), 1.05);
  RampPlan plan;
  plan.Plan(cells, start);
  EXPECT_DOUBLE_EQ(TimeOf(plan), LevelOneTime(cells, start));
  for (const SpeedProfile& ramp : plan.ramps()) {
    for (int k = 0; k < ramp.phase_count(); ++k)
      EXPECT_LE(std::abs(ramp.phase(k).jerk), 40000.0 * (1.0 + 1e-6));
  }
}

// From 3.15 mm/s on 0.158 mm end at 9.45, from rest at 10: who is as fast as he may be at the end
// of the first stretch is slower at that of the second, and with a jerk of 4 mm/s3 behind it these
// 0.55 mm/s cost more time than they gave. Then it is level 1.
TEST(RampTies, WhatIsSlowerThanLevelOneIsNotTaken) {
  constexpr PathLimits kWeak{.speed = 30.0, .acceleration = 2000.0, .jerk = 4.0};
  std::vector<RampCell> cells{{.length = 0.028, .limits = kFast, .end_speed = 0.0},
                              {.length = 0.1582, .limits = kFast, .end_speed = 10.0},
                              {.length = 200.0, .limits = kWeak, .end_speed = 30.0}};
  const double first = Reach(0.0, cells[0].length, kFast);
  const double second = Reach(first, cells[1].length, kFast);
  ASSERT_NEAR(first, 3.15, 0.01);
  ASSERT_NEAR(second, 9.45, 0.01);
  const double level_one = LevelOneTime(cells, 0.0);
  ASSERT_GT(SpeedProfile::Span(0.1862, 0.0, second, kFast).duration_s() +
                SpeedProfile::Span(200.0, second, 30.0, kWeak).duration_s(),
            level_one + 0.03);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  EXPECT_EQ(SplitsOf(plan), (std::vector{0.028, 0.1582, 200.0}));
  EXPECT_DOUBLE_EQ(TimeOf(plan), level_one);
}

// So it is behind a way that was much faster than its level 1, and before further cells that are
// none of the plan: each way is compared with its own level 1, and with all of it.
TEST(RampTies, EachWayIsComparedWithItsOwnLevelOne) {
  constexpr PathLimits kWeak{.speed = 30.0, .acceleration = 2000.0, .jerk = 4.0};
  std::vector<RampCell> steps(100, {.length = 1.0, .limits = kFast});
  TimeByLevelOne(steps, 0.0, 0.0);
  std::vector<RampCell> cells{{.length = 0.028, .limits = kFast, .end_speed = 0.0},
                              {.length = 0.1582, .limits = kFast, .end_speed = 10.0},
                              {.length = 200.0, .limits = kWeak, .end_speed = 30.0},
                              {.length = 500.0, .limits = kWeak, .end_speed = 30.0}};
  RampPlan plan;
  plan.Plan(steps, 0.0);
  ASSERT_LT(TimeOf(plan) + 0.1, LevelOneTime(steps, 0.0));
  plan.Plan(std::span(cells).first(3), 0.0);
  EXPECT_EQ(SplitsOf(plan), (std::vector{0.028, 0.1582, 200.0}));
}

// A weak stretch makes one ramp over it and a strong one as weak: from 60 mm/s
// to rest such a ramp is longer than both, so that it is none.
TEST(RampTies, ARampThatIsTooLongIsNone) {
  std::vector<RampCell> cells{{.length = 2.6, .limits = kFast}, {.length = 0.5, .limits = kFast}};
  cells[1].limits.acceleration = 400.0;
  cells[1].limits.jerk = 8000.0;
  TimeByLevelOne(cells, 60.0, 0.0);
  ASSERT_GT(RampLength(60.0, 0.0, cells[1].limits), 3.2);
  RampPlan plan;
  plan.Plan(cells, 60.0);
  ASSERT_EQ(plan.ramps().size(), 2U);
  EXPECT_NEAR(TimeOf(plan), LevelOneTime(cells, 60.0), 1e-12);
}

// A ramp over a strong stretch and a weak one has the acceleration of the weak one, also where
// their jerk is the same.
TEST(RampTies, OneRampKeepsTheWeakestAcceleration) {
  for (const bool weak_first : {true, false}) {
    std::vector<RampCell> cells(2, {.length = 4.0, .limits = kFast});
    cells[weak_first ? 0 : 1].limits.acceleration = 400.0;
    TimeByLevelOne(cells, 0.0, 0.0);
    RampPlan plan;
    plan.Plan(cells, 0.0);
    EXPECT_LE(TimeOf(plan), LevelOneTime(cells, 0.0) + 1e-12);
    for (std::size_t k = 0; k < 2; ++k) {
      const RampPlan::Timing& timing = plan.timing()[k];
      const SpeedProfile part = plan.ramps()[timing.ramp].Part(timing.from, timing.to);
      for (int n = 0; n < part.phase_count(); ++n) {
        const SpeedProfile::Phase& phase = part.phase(n);
        const double before = std::abs(phase.start.acceleration);
        const double behind = std::abs(phase.start.acceleration + phase.duration_s * phase.jerk);
        EXPECT_LE(std::max(before, behind), cells[k].limits.acceleration * (1.0 + 1e-6));
      }
    }
  }
}

// Braking from 60 mm/s through a bend that is at 50 soon: one ramp brakes too late for it, although
// it is slower than that where the bend ends.
TEST(RampTies, ABendIsLookedAtFromItsBegin) {
  std::vector<RampCell> cells{{.length = 2.6, .limits = kFast}, {.length = 0.8, .limits = kFast}};
  cells[0].limits.speed = 60.0;
  TimeByLevelOne(cells, 60.0, 0.0);
  RampPlan plan;
  plan.Plan(cells, 60.0);
  ASSERT_EQ(plan.ramps().size(), 1U);
  const std::vector<double> bend{60.0, 58.0, 50.0, 50.0, 50.0};
  ASSERT_LT(plan.ramps()[0].At(plan.ramps()[0].TimeAt(2.6)).speed, 49.0);
  ASSERT_GT(plan.ramps()[0].At(plan.ramps()[0].TimeAt(1.3)).speed, 51.0);
  cells[0].most = bend;
  plan.Plan(cells, 60.0);
  EXPECT_EQ(plan.ramps().size(), 2U);
}

// Braking from 60 mm/s, and up to 60 in reverse: the slower stretch is passed at 44.6 mm/s and
// less. That it allows a little more is enough, however fast the ramp is elsewhere.
TEST(RampTies, AStretchIsKeptByTheSpeedsOnIt) {
  for (const bool brakes : {true, false}) {
    std::vector<RampCell> cells{{.length = 2.6, .limits = kFast}, {.length = 0.8, .limits = kFast}};
    cells[0].limits.speed = 60.0;
    if (!brakes) std::ranges::reverse(cells);
    const double start = brakes ? 60.0 : 0.0, end = brakes ? 0.0 : 60.0;
    TimeByLevelOne(cells, start, end);
    RampPlan plan;
    plan.Plan(cells, start);
    ASSERT_EQ(plan.ramps().size(), 1U) << brakes;
    const double between = SpeedAt(plan.ramps()[0], cells[0].length), time = TimeOf(plan);
    ASSERT_NEAR(between, 44.6, 0.1) << brakes;
    cells[brakes ? 1 : 0].limits.speed = 1.01 * between;
    TimeByLevelOne(cells, start, end);
    plan.Plan(cells, start);
    EXPECT_EQ(plan.ramps().size(), 1U) << brakes;
    EXPECT_NEAR(TimeOf(plan), time, 1e-9) << brakes;
  }
}

// One ramp over 1 and 3 mm is at 47 mm/s between them. Where a little less is allowed there, or at
// a place of a bend on the way, by more than last digits, that is kept.
TEST(RampTies, LimitsAreKeptButForLastDigits) {
  const std::vector<RampCell> two{{.length = 1.0, .limits = kFast},
                                  {.length = 3.0, .limits = kFast}};
  const auto plan_of = [](std::vector<RampCell> cells) {
    TimeByLevelOne(cells, 0.0, 0.0);
    RampPlan plan;
    plan.Plan(cells, 0.0);
    return plan;
  };
  const RampPlan of_two = plan_of(two);
  ASSERT_EQ(of_two.ramps().size(), 1U);
  const double between = SpeedAt(of_two.ramps()[0], 1.0);
  ASSERT_NEAR(between, 47.0, 1.0);

  std::vector<RampCell> capped = two;
  capped[0].end_cap = between * (1.0 - 1e-10);
  const RampPlan of_capped = plan_of(capped);
  const RampPlan::Timing first = of_capped.timing()[0];
  EXPECT_LE(SpeedAt(of_capped.ramps()[first.ramp], first.to), capped[0].end_cap * (1.0 + 2e-11));

  const double most = SpeedAt(of_two.ramps()[0], 0.75) * (1.0 - 1e-7);
  const std::vector<double> bend{150.0, 150.0, 150.0, most, 150.0};
  std::vector<RampCell> bent = two;
  bent[0].most = bend;
  const RampPlan of_bent = plan_of(bent);
  EXPECT_LE(SpeedAt(of_bent.ramps()[of_bent.timing()[0].ramp], 0.75), most * (1.0 + 1e-8));
}

// A bend is asked at both its ends, too: 40 mm/s where one ramp over 1 and 3 mm has 47. What just
// allows the speed of that ramp leaves it as it is.
TEST(RampTies, ABendIsLookedAtFromEndToEnd) {
  std::vector<RampCell> cells(2, {.limits = kFast});
  cells[0].length = 1.0;
  cells[1].length = 3.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  ASSERT_EQ(plan.ramps().size(), 1U);
  const double time = TimeOf(plan), within = SpeedAt(plan.ramps()[0], 0.75);
  const auto speed_between = [&plan] {
    const RampPlan::Timing& first = plan.timing()[0];
    return SpeedAt(plan.ramps()[first.ramp], first.to);
  };
  ASSERT_GT(speed_between(), 46.0);
  const std::vector<double> slow_begin{40.0, 150.0, 150.0, 150.0, 150.0};
  const std::vector<double> slow_end{150.0, 150.0, 150.0, 150.0, 40.0};
  for (const std::size_t bent : {0U, 1U}) {
    std::vector<RampCell> bend = cells;
    bend[bent].most = bent == 0 ? slow_end : slow_begin;
    plan.Plan(bend, 0.0);
    EXPECT_LE(speed_between(), 40.0 * (1.0 + 1e-8));
    EXPECT_GT(TimeOf(plan), time + 1e-4);
  }
  const std::vector<double> just{150.0, 150.0, 150.0, within, 150.0, 1.0};
  cells[0].most = std::span(just).first(5);  // what lies behind it is another bend's
  plan.Plan(cells, 0.0);
  EXPECT_NEAR(TimeOf(plan), time, 1e-12);
}

}  // namespace
}  // namespace rmlcell::motion::ramp_ties
