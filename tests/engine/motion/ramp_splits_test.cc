// Which stretches one ramp takes, and where longer ways are split. motion.md 5.4
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/motion/profile/ramp_plan.h"
#include "tests/engine/motion/level_one.h"

namespace rmlcell::motion {
namespace {

constexpr PathLimits kStretch{.speed = 100.0, .acceleration = 2000.0, .jerk = 40000.0};

std::vector<double> LengthsOf(const RampPlan& plan) {
  std::vector<double> lengths;
  for (const SpeedProfile& ramp : plan.ramps())
    lengths.push_back(std::round(ramp.end().s * 1e9) / 1e9);
  return lengths;
}

// Sixty steps of 0.3 mm and 100 mm behind them. Level 1 creeps over the steps, so that no limit is
// met at their ends, where one ramp has some 100 mm/s after nine of them and 177 after 41.
std::vector<RampCell> StepsAndALongWay() {
  std::vector<RampCell> cells(61, {.length = 0.3, .limits = kStretch});
  for (RampCell& cell : cells) cell.limits.speed = 200.0;
  cells.back().length = 100.0;
  return cells;
}

std::vector<double> SplitsOf(std::vector<RampCell> cells) {
  TimeByLevelOne(cells, 0.0, 0.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  return LengthsOf(plan);
}

// What is broken by half as much again as it allows: a stretch is one by itself, with a ramp on
// each side of it; a point is the end of one and the start of the other.
TEST(RampSplits, AreWhereOneRampBreaksALimit) {
  std::vector<RampCell> cells = StepsAndALongWay();
  cells[8].limits.speed = 65.0;
  EXPECT_EQ(SplitsOf(cells), (std::vector{2.4, 0.3, 115.3}));
  cells = StepsAndALongWay();
  cells[7].end_cap = 62.0;
  EXPECT_EQ(SplitsOf(cells), (std::vector{2.4, 115.6}));
}

// Of two, the one that is broken most, be it the first or the last: what is broken less may no
// longer be broken then.
TEST(RampSplits, AreWhereOneRampBreaksMost) {
  std::vector<RampCell> cells = StepsAndALongWay();
  cells[8].limits.speed = 65.0;
  // A ramp from the end of the first is slower at the second than one over all.
  TimeByLevelOne(cells, 0.0, 0.0);
  const PathLimits fast = cells[9].limits;
  const SpeedProfile all = SpeedProfile::Span(118.0, 0.0, 0.0, fast);
  const SpeedProfile rest = SpeedProfile::Span(115.3, cells[8].end_speed, 0.0, fast);
  const double at_all = all.At(all.TimeAt(12.3)).speed, at_rest = rest.At(rest.TimeAt(9.6)).speed;
  ASSERT_GT(at_all, at_rest + 1.0);
  cells[40].limits.speed = 0.5 * (at_all + at_rest);
  EXPECT_EQ(SplitsOf(cells), (std::vector{2.4, 0.3, 115.3}));
  cells[8].limits.speed = 90.0;
  cells[40].limits.speed = 60.0;
  const std::vector<double> splits = SplitsOf(cells);
  ASSERT_GE(splits.size(), 3U);
  EXPECT_EQ(splits.back(), 105.7);
  EXPECT_EQ(splits[splits.size() - 2], 0.3);
}

// Where one that is a little slower all along is faster than those of a split there is one.
TEST(RampSplits, AreNoneWhereOneSlowerRampIsFaster) {
  std::vector<RampCell> cells = StepsAndALongWay();
  cells.pop_back();
  cells[8].limits.speed = 90.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  ASSERT_EQ(LengthsOf(plan), (std::vector{18.0}));
  EXPECT_NEAR(plan.ramps()[0].peak_speed(), 90.0, 1e-9);
  EXPECT_EQ(plan.timing()[59].ramp, 0U);
  EXPECT_NEAR(plan.timing()[59].from, 17.7, 1e-9);
}

// One ramp over all would be as weak as its weakest stretch. That of 1e-3 mm holds up nobody: a way
// that no ramp breaks is halved where its stretches are faster by themselves. So it is behind a
// stretch that is passed as fast as it may be.
TEST(RampSplits, AWeakStretchDoesNotHoldUpTheRest) {
  std::vector<RampCell> cells(12, {.length = 1.0, .limits = kStretch});
  cells[0].length = 1e-3;
  cells[0].limits.acceleration = 40.0;
  cells[0].limits.jerk = 800.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  const double level_one = LevelOneTime(cells, 0.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  EXPECT_LT(TimeOf(plan), 0.9 * level_one);
  EXPECT_EQ(LengthsOf(plan), (std::vector{0.001, 5.0, 6.0}));
  cells.insert(cells.begin(), RampCell{.length = 20.0, .limits = kStretch});
  cells[0].limits.speed = 5.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  plan.Plan(cells, 0.0);
  EXPECT_EQ(LengthsOf(plan), (std::vector{20.0, 0.001, 5.0, 6.0}));
}

// What comes behind such a way is none of it: 4 s at 5 mm/s make no one ramp over all of it faster.
TEST(RampSplits, AWayIsComparedWithItsOwnStretchesAlone) {
  std::vector<RampCell> cells(13, {.length = 1.0, .limits = kStretch});
  cells[0] = {.length = 1e-3, .limits = {.speed = 100.0, .acceleration = 40.0, .jerk = 800.0}};
  cells[12].length = 20.0;
  cells[12].limits.speed = 5.0;
  TimeByLevelOne(cells, 0.0, 0.0);
  ASSERT_EQ(cells[11].end_speed, 5.0);
  RampPlan plan;
  plan.Plan(cells, 0.0);
  ASSERT_GE(plan.ramps().size(), 3U);
  EXPECT_EQ(LengthsOf(plan).front(), 0.001);
  EXPECT_EQ(LengthsOf(plan).back(), 20.0);
}

// So it is where a bend allows less in its middle than at its ends. Up with 2000 mm/s2 from 50 mm/s
// at 0.833 mm, one ramp over all has 93.6 mm/s at 2.4 mm, where that stretch begins, 96.8 half way
// along it and 99.8 at its end.
TEST(RampSplits, AreWhereOneRampIsTooFastWithinABend) {
  for (const double middle : {65.0, 95.0, 98.0}) {
    const std::array<double, 3> most{200.0, middle, 200.0};
    std::vector<RampCell> cells = StepsAndALongWay();
    cells[8].most = most;
    const std::vector<double> one{118.0}, split{2.4, 0.3, 115.3};
    EXPECT_EQ(SplitsOf(cells), middle > 97.0 ? one : split) << middle;
  }
}

}  // namespace
}  // namespace rmlcell::motion
