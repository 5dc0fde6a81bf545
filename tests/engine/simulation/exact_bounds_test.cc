// Both sides of bounds at the bound itself, signs of ways along an axis, and a peak within a phase.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/machine/verdict.h"
#include "engine/simulation/path/path_extent.h"
#include "engine/simulation/report/move_speeds.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;
using motion::SpeedProfile;

constexpr double kAllButAMillionth = 1.0 - 1e-6;

std::optional<SlowMove> JudgedAs(const motion::PlannedMotion& planned, double wanted,
                                 const machine::MachineShape& shape) {
  return MoveSpeeds(shape).Add({.place = {.program = 3, .step = 8},
                                .motion = &planned,
                                .travelled = planned.path.length(),
                                .programmed_mm_s = wanted});
}

motion::PlannedMotion MoveOver(const PathPiece& path, const SpeedProfile& speed,
                               const motion::PathLimits& limits) {
  motion::PlannedMotion planned;
  planned.path = path;
  planned.speed = speed;
  planned.limits = limits;
  planned.ends_move = true;
  return planned;
}

// A millionth of the speed is rounding, of the speed asked for and of that allowed: round 2 mm the
// radius allows sqrt(0.8 * 2000 * 2) mm/s.
TEST(ExactBounds, JustAMillionthIsRounding) {
  const machine::MachineShape shape = Laser();
  const PathPiece line = LineFrom({}, {100, 0, 0});
  const motion::PathLimits limits{.speed = 1e9, .acceleration = 2000.0, .jerk = 40'000.0};
  const auto steady = [&](double speed) {
    return MoveOver(line, SpeedProfile::Steady(100.0, speed), limits);
  };
  EXPECT_FALSE(JudgedAs(steady(50.0 * kAllButAMillionth), 50.0, shape));
  EXPECT_TRUE(JudgedAs(steady(50.0 * (kAllButAMillionth - 1e-12)), 50.0, shape));
  const double allowed = std::sqrt(3200.0);
  const PathPiece arc = PathPiece::Circle({{2, 0, 0}}, {0, 0, 0}, {0, 0, 1}, 6.0, 0.0, 0.0);
  const auto round =
      JudgedAs(MoveOver(arc, SpeedProfile::Steady(arc.length(), allowed * kAllButAMillionth),
                        {.speed = allowed, .acceleration = 1200.0, .jerk = 40'000.0}),
               100.0, shape);
  ASSERT_TRUE(round);
  EXPECT_EQ(round->cause, SlowCause::kRadius);
}

// A move that has a millionth less than all of the acceleration, or of the jerk, has it all. From
// rest to rest v^2 = a L without a limit on jerk, and v^3 = j L^2 / 4 with nothing but that: this
// one is so short that the millionth decides.
TEST(ExactBounds, AllButAMillionthIsAllOfTheAcceleration) {
  machine::MachineShape shape = Laser();
  const auto cause = [&](double length, const motion::PathLimits& limits) {
    const auto slow = JudgedAs(MoveOver(LineFrom({}, {length, 0, 0}),
                                        SpeedProfile::Span(length, 0.0, 0.0, limits), limits),
                               limits.speed, shape);
    EXPECT_TRUE(slow) << length;
    return slow ? slow->cause : SlowCause::kAxis;
  };
  // With all of the jerk it comes to v (1 - 2.5e-6 / 3).
  const double v = 10.0;
  const double by_jerk = 2.0 * std::sqrt(v * v * v * (1.0 - 2.5e-6) / 40'000.0);
  EXPECT_EQ(cause(by_jerk, {v, 2000.0, 40'000.0 * kAllButAMillionth}), SlowCause::kShort);
  EXPECT_EQ(cause(by_jerk, {v, 2000.0, 40'000.0 * (1.0 - 1.5e-6)}), SlowCause::kAcceleration);
  shape.limits->tip_jerk_mm_s3 = HUGE_VAL;
  const double by_acceleration = v * v * (1.0 - 1.5e-6) / 2000.0;
  EXPECT_EQ(cause(by_acceleration, {.speed = v, .acceleration = 2000.0 * kAllButAMillionth}),
            SlowCause::kShort);
  EXPECT_EQ(cause(by_acceleration, {.speed = v, .acceleration = 2000.0 * (1.0 - 1.5e-6)}),
            SlowCause::kAcceleration);
}

// What lies above its limit by a hundred-thousandth is rounding; more is not.
TEST(ExactBounds, AHundredThousandthIsNotAbove) {
  const auto verdict = [](double mm) {
    RunReport report;
    report.cut_figures.near_end[1] = {.value = mm, .place = {.program = 1, .step = 3}};
    return Judge(report).verdict;
  };
  EXPECT_EQ(verdict(0.00001), machine::Verdict::kGood);
  EXPECT_EQ(verdict(0.0000101), machine::Verdict::kDoubtful);
}

// A pass by a tool of which no width is known is as deep as nothing.
TEST(ExactBounds, WithoutAWidthNoPassIsDeep) {
  const auto deep = [](double diameter_mm) {
    RunReport report;
    MillingFigures& milling = report.milling.emplace();
    milling.removed_mm3 = 5.0;
    milling.tool_diameter_mm = diameter_mm;
    milling.deepest_pass_mm = 3.0;
    return std::ranges::any_of(Judge(report).reasons, [](const machine::Reason& reason) {
      return reason.code == ErrorCode::kCellDeepPass;
    });
  };
  EXPECT_FALSE(deep(0.0));
  EXPECT_TRUE(deep(2.5));
  EXPECT_FALSE(deep(3.0));
}

// motion.md 8.2: each coordinate of a straight way goes up, down, or stands.
TEST(ExactBounds, AStraightWayHasItsSigns) {
  const auto expect = [](const CoordinateSweep& sweep, double from, double to) {
    const int sign = to > from ? 1 : to < from ? -1 : 0;
    EXPECT_EQ(sweep.first_sign, sign);
    EXPECT_EQ(sweep.last_sign, sign);
    EXPECT_EQ(sweep.turns, 0);
    EXPECT_EQ(sweep.travel, std::abs(to - from));
    EXPECT_EQ(sweep.minimum, std::min(from, to));
    EXPECT_EQ(sweep.maximum, std::max(from, to));
  };
  const double from[] = {1.0, 2.0, 4.0};
  for (int way = 0; way < 27; ++way) {
    const double to[] = {from[0] + way % 3 - 1, from[1] + way / 3 % 3 - 1, from[2] + way / 9 - 1};
    if (way == 13) continue;  // nowhere
    const PathPiece line = LineFrom({from[0], from[1], from[2]}, {to[0], to[1], to[2]});
    PartShape shape({line, motion::MillHead{}, 0.0, line.length()});
    const PointSweep tip = TipSweep(shape), column = ColumnSweep(shape);
    for (std::size_t i = 0; i < 3; ++i) {
      expect(tip[i], from[i], to[i]);
      expect(column[i], from[i], to[i]);
    }
  }
  const PathPiece turn = PathPiece::Line({{0, 0, 0}, 0.5, 1.0}, {{9, 0, 0}, 0.25, 1.0});
  PartShape shape({turn, motion::MillHead{}, 0.0, turn.length()});
  const auto rotary = RotarySweep(shape);
  expect(rotary[0], 0.5, 0.25);
  expect(rotary[1], 1.0, 1.0);
}

// Stopped while it still accelerates a tip becomes faster yet, by a^2 / 2j, until it does not any
// more.
TEST(ExactBounds, ATipThatIsStoppedPeaksOnTheWay) {
  const motion::PlannedMotion whole = Planned(LineFrom({}, {100, 0, 0}));
  const double since = std::sqrt(25.0 * 2.0 / 40'000.0);  // half of the speed, at its acceleration
  const double acceleration = 40'000.0 * since;
  motion::PlannedMotion stopped = whole;
  stopped.speed = whole.speed.StopFrom(since, whole.limits);
  const MotionPeaks peaks = PeaksBetween(stopped, true, 0.0, stopped.speed.duration_s());
  EXPECT_NEAR(peaks.tip_speed, 25.0 + acceleration * acceleration / 80'000.0, 1e-6);
  EXPECT_NEAR(peaks.axis_speed[0], peaks.tip_speed, 1e-9);
}

}  // namespace
}  // namespace rmlcell::simulation
