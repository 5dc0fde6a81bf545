#include "engine/simulation/report/axis_log.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rmlcell::simulation {
namespace {

machine::MachineShape Shape(bool five_axis) {
  machine::MachineShape shape;
  shape.five_axis = five_axis;
  shape.limits = motion::MachineLimits{};
  shape.limits->tip_speed_mm_s = 500.0;
  shape.limits->tip_acceleration_mm_s2 = 2000.0;
  shape.limits->tip_jerk_mm_s3 = HUGE_VAL;
  for (std::size_t i = 0; i < motion::kAxisCount; ++i) {
    const auto axis = static_cast<double>(i + 1);
    shape.limits->axes.speed[i] = 100.0 * axis;
    shape.limits->axes.acceleration[i] = 1000.0 * axis;
    shape.limits->axes.jerk[i] = i == 0 ? HUGE_VAL : 10'000.0 * axis;
  }
  return shape;
}

CoordinateSweep Sweep(double from, double to) {
  const int sign = to > from ? 1 : to < from ? -1 : 0;
  return {.minimum = std::min(from, to),
          .maximum = std::max(from, to),
          .travel = std::abs(to - from),
          .turns = 0,
          .first_sign = sign,
          .last_sign = sign};
}

struct Way {
  PointSweep xyz{};
  std::array<CoordinateSweep, 2> ab{};
  MotionPeaks peaks{};
  double tip_path_mm = 0.0;
  bool tip_limited = true;
};

void Add(AxisLog& log, const Way& way) {
  log.Add({.xyz = way.xyz,
           .ab = way.ab,
           .peaks = way.peaks,
           .tip_path_mm = way.tip_path_mm,
           .tip_limited = way.tip_limited});
}

ScopeFigures Written(const AxisLog& log) {
  ScopeFigures figures;
  log.WriteTo(figures);
  return figures;
}

TEST(Axes, HaveNames) {
  const char* names[] = {"X", "Y", "Z", "A", "B"};
  for (int axis = 0; axis < 5; ++axis) {
    EXPECT_EQ(AxisName(axis), names[axis]);
    EXPECT_EQ(IsRotaryAxis(axis), axis >= 3);
  }
}

// motion.md 8.2: travel is the sum of the ways, the range that of all of them; each axis its own.
TEST(AxisLog, TravelAndRange) {
  AxisLog log(Shape(true));
  Add(log, {.xyz = {Sweep(10, 30), Sweep(5, 5), Sweep(-1, -4)},
            .ab = {Sweep(0.5, 1.0), Sweep(-2, -1)},
            .tip_path_mm = 20.0});
  Add(log, {.xyz = {Sweep(30, 15), Sweep(5, 6), Sweep(-4, 0)},
            .ab = {Sweep(1.0, 0.25), Sweep(-1, -3)},
            .tip_path_mm = 15.0});
  const ScopeFigures figures = Written(log);
  ASSERT_EQ(figures.axes.size(), 5u);
  const double travel[] = {35, 1, 7, 1.25, 3};
  const double low[] = {10, 5, -4, 0.25, -3};
  const double high[] = {30, 6, 0, 1.0, -1};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(figures.axes[i].name, AxisName(static_cast<int>(i)));
    EXPECT_EQ(figures.axes[i].rotary, i >= 3);
    EXPECT_EQ(figures.axes[i].travel, travel[i]) << i;
    EXPECT_EQ(figures.axes[i].minimum, low[i]) << i;
    EXPECT_EQ(figures.axes[i].maximum, high[i]) << i;
  }
  EXPECT_EQ(figures.tip_figures.name, "tip");
  EXPECT_EQ(figures.tip_figures.travel, 35.0);
}

// motion.md 8.2: a reversal is a change of direction, within a motion or between two, also when the
// axis stood still meanwhile.
TEST(AxisLog, Reversals) {
  AxisLog log(Shape(true));
  const auto x = [&](const CoordinateSweep& sweep) { Add(log, {.xyz = {sweep, {}, {}}}); };
  const auto reversals = [&] { return Written(log).axes[0].reversals; };
  x(Sweep(0, 10));
  x(Sweep(10, 20));
  EXPECT_EQ(reversals(), 0u);
  x(Sweep(20, 20));
  x(Sweep(20, 5));
  EXPECT_EQ(reversals(), 1u);
  x(Sweep(5, 0));
  EXPECT_EQ(reversals(), 1u);
  x({.minimum = 0, .maximum = 9, .travel = 18, .turns = 1, .first_sign = 1, .last_sign = -1});
  EXPECT_EQ(reversals(), 3u);  // back again, and its turn
  x(Sweep(0, -5));
  EXPECT_EQ(reversals(), 3u);
  x(Sweep(-5, 0));
  EXPECT_EQ(reversals(), 4u);
  EXPECT_EQ(Written(log).axes[1].reversals, 0u);
}

// Peaks are the highest of all motions, each axis its own; limits are those of the machine, and one
// that is not finite is none.
TEST(AxisLog, PeaksAndLimits) {
  AxisLog log(Shape(true));
  Add(log, {.peaks = {.tip_speed = 40.0,
                      .tip_acceleration = 300.0,
                      .axis_speed = {1, 2, 3, 4, 5},
                      .axis_acceleration = {11, 12, 13, 14, 15},
                      .tip_jerk = 7000.0,
                      .axis_jerk = {21, 22, 23, 24, 25}}});
  Add(log, {.peaks = {.tip_speed = 30.0,
                      .tip_acceleration = 400.0,
                      .axis_speed = {0, 0, 0, 0, 6},
                      .axis_acceleration = {0, 0, 0, 16, 0},
                      .tip_jerk = 6000.0,
                      .axis_jerk = {0, 0, 26, 0, 0}}});
  const ScopeFigures figures = Written(log);
  const double speed[] = {1, 2, 3, 4, 6};
  const double acceleration[] = {11, 12, 13, 16, 15};
  const double jerk[] = {21, 22, 26, 24, 25};
  for (std::size_t i = 0; i < 5; ++i) {
    const auto axis = static_cast<double>(i + 1);
    EXPECT_EQ(figures.axes[i].peak_speed, speed[i]);
    EXPECT_EQ(figures.axes[i].peak_acceleration, acceleration[i]);
    EXPECT_EQ(figures.axes[i].peak_jerk, jerk[i]);
    EXPECT_EQ(figures.axes[i].speed_limit, 100.0 * axis);
    EXPECT_EQ(figures.axes[i].acceleration_limit, 1000.0 * axis);
    EXPECT_EQ(figures.axes[i].jerk_limit, i == 0 ? 0.0 : 10'000.0 * axis);
  }
  EXPECT_EQ(figures.tip_figures.peak_speed, 40.0);
  EXPECT_EQ(figures.tip_figures.peak_acceleration, 400.0);
  EXPECT_EQ(figures.tip_figures.peak_jerk, 7000.0);
  EXPECT_EQ(figures.tip_figures.speed_limit, 500.0);
  EXPECT_EQ(figures.tip_figures.acceleration_limit, 2000.0);
  EXPECT_EQ(figures.tip_figures.jerk_limit, 0.0);
}

// motion.md 3.5: in PTP only the axes have limits: where such a motion has the peak, the tip has no
// share of a limit; speed and acceleration each for itself.
TEST(AxisLog, APeakOfAMotionWithoutLimitsHasNone) {
  AxisLog log(Shape(true));
  Add(log, {.peaks = {.tip_speed = 40.0, .tip_acceleration = 300.0}});
  Add(log, {.peaks = {.tip_speed = 40.0, .tip_acceleration = 301.0}, .tip_limited = false});
  EXPECT_EQ(Written(log).tip_figures.speed_limit, 500.0);
  EXPECT_EQ(Written(log).tip_figures.acceleration_limit, 0.0);
  EXPECT_EQ(Written(log).tip_figures.peak_acceleration, 301.0);
  Add(log, {.peaks = {.tip_speed = 41.0, .tip_acceleration = 0.0}, .tip_limited = false});
  EXPECT_EQ(Written(log).tip_figures.speed_limit, 0.0);
}

// A rotary axis that a mill never turned is left out; one that it turned is there.
TEST(AxisLog, AMillHasTheRotaryAxesThatItTurned) {
  AxisLog log(Shape(false));
  Add(log, {.xyz = {Sweep(0, 1), {}, {}}});
  EXPECT_EQ(Written(log).axes.size(), 3u);
  Add(log, {.ab = {Sweep(0, 1), {}}});
  const ScopeFigures figures = Written(log);
  ASSERT_EQ(figures.axes.size(), 4u);
  EXPECT_EQ(figures.axes[3].name, "A");
}

}  // namespace
}  // namespace rmlcell::simulation
