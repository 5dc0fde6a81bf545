// How far bends reach, axes of a mill that turn, speeds below 1 mm/s, and figures that are counted
// where nobody tells them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/material/height_map.h"
#include "engine/simulation/path/path_extent.h"
#include "engine/simulation/report/beam_work.h"
#include "engine/simulation/report/move_speeds.h"
#include "engine/simulation/report/report_recorder.h"
#include "engine/simulation/toolpath/toolpath_recorder.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;

// What a coordinate does by very many places of its way.
class LookedFor {
 public:
  void Add(double value) {
    if (count_++ == 0) low_ = high_ = last_ = value;
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
    travel_ += std::abs(value - last_);
    last_ = value;
  }
  // Between two places a coordinate that turns round goes on by the square of their distance.
  void Expect(const CoordinateSweep& sweep, double near, const std::string& what) const {
    EXPECT_LE(sweep.minimum, low_ + 1e-9) << what;
    EXPECT_GE(sweep.maximum, high_ - 1e-9) << what;
    EXPECT_NEAR(sweep.minimum, low_, near) << what;
    EXPECT_NEAR(sweep.maximum, high_, near) << what;
    EXPECT_GE(sweep.travel, travel_ - 1e-9) << what;
    EXPECT_NEAR(sweep.travel, travel_, 4.0 * near) << what;
  }

 private:
  int count_ = 0;
  double low_ = 0.0;
  double high_ = 0.0;
  double last_ = 0.0;
  double travel_ = 0.0;
};

// motion.md 8.2: the box reaches the true extremes, of tip, column and rotary axes, round any bend.
TEST(ExactExtremes, OfAnyBend) {
  std::mt19937 random(23);  // NOLINT: the same every time
  std::uniform_real_distribution<double> place(-100.0, 100.0), angle(-0.6, 0.6);
  const motion::Head head = motion::GantryHead{.length_mm = 300.0};
  const auto pose = [&](bool turns) {
    motion::TipPose made{{place(random), place(random), 0.3 * place(random)}};
    made.a_rad = turns ? angle(random) : 0.0;
    made.b_rad = turns ? angle(random) : 0.25;
    return made;
  };
  int bends = 0, turned = 0;
  for (int k = 0; k < 60; ++k) {
    const bool turns = k % 3 != 0;
    for (const auto& planned : PlannedCorner(pose(turns), pose(turns), pose(turns))) {
      const PathPiece& path = planned.path;
      if (path.kind() != PathPiece::Kind::kBlend) continue;
      ++bends;
      PartShape shape({path, head, 0.0, path.length()});
      const PointSweep tip = TipSweep(shape), column = ColumnSweep(shape);
      const auto rotary = RotarySweep(shape);
      std::array<LookedFor, 3> tips, columns;
      std::array<LookedFor, 2> angles;
      constexpr int kPlaces = 4000;
      for (int n = 0; n <= kPlaces; ++n) {
        const motion::PathPose at = path.At(path.length() * n / kPlaces);
        const motion::MachinePoint above = head.ColumnOf({at.point, at.a_rad, at.b_rad}).column;
        for (int i = 0; i < 3; ++i) {
          tips[static_cast<std::size_t>(i)].Add(at.point[i]);
          columns[static_cast<std::size_t>(i)].Add(above[i]);
        }
        angles[0].Add(at.a_rad);
        angles[1].Add(at.b_rad);
      }
      const double near = 1e-5 * path.length() + 1e-9;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::string what = std::to_string(k) + " axis " + std::to_string(i);
        tips[i].Expect(tip[i], near, "tip " + what);
        columns[i].Expect(column[i], 10.0 * near, "column " + what);
        if (i < 2) angles[i].Expect(rotary[i], near, "angle " + what);
        turned += tip[i].turns;
      }
    }
  }
  EXPECT_GT(bends, 80);
  EXPECT_GT(turned, 20);
}

// The rotary axis of a mill is A: along a line and round an arc it turns by its share of the way,
// and B does nothing.
TEST(ExactExtremes, TheRotaryAxisOfAMillIsA) {
  const auto line = Planned(PathPiece::Line({{0, 0, 0}, 0.5, 0.0}, {{60, 80, 0}, 2.5, 0.0}));
  const auto arc =
      Planned(PathPiece::Circle({{20, 0, 0}, 0.5, 0.0}, {0, 0, 0}, {0, 0, 1}, kTurn, 2.5, 0.0));
  for (const motion::PlannedMotion* planned : {&line, &arc}) {
    const double share = 2.0 / planned->path.length();
    const MotionPeaks peaks = PeaksBetween(*planned, false, 0.0, planned->speed.duration_s());
    const double acceleration = std::sqrt(50.0 * 40000.0);
    EXPECT_NEAR(peaks.axis_speed[3], 50.0 * share, 1e-9);
    EXPECT_NEAR(peaks.axis_acceleration[3], acceleration * share, 1e-6);
    EXPECT_NEAR(peaks.axis_jerk[3], 40'000.0 * share, 40'000.0 * share * 1e-6);
    EXPECT_EQ(peaks.axis_speed[4], 0.0);
    EXPECT_EQ(peaks.axis_acceleration[4], 0.0);
    EXPECT_EQ(peaks.axis_jerk[4], 0.0);
  }
}

// A move that an axis allows 0.3 mm/s is slow at 0.5 mm/s, too, and reaches what it is allowed.
TEST(ExactExtremes, SlowMovesBelowAMillimetreASecond) {
  motion::PlannedMotion planned;
  planned.path = LineFrom({}, {10, 0, 0});
  planned.ends_move = true;
  planned.limits = {.speed = 0.3, .acceleration = 2000.0, .jerk = 40'000.0};
  planned.speed = motion::SpeedProfile::Span(10.0, 0.0, 0.0, planned.limits);
  const auto slow = MoveSpeeds(Laser()).Add({.place = {.program = 3, .step = 8},
                                             .motion = &planned,
                                             .travelled = 10.0,
                                             .programmed_mm_s = 0.5});
  ASSERT_TRUE(slow);
  EXPECT_EQ(slow->wanted_mm_s, 0.5);
  EXPECT_EQ(slow->allowed_mm_s, 0.3);
  EXPECT_NEAR(slow->reached_mm_s, 0.3, 1e-9);
}

// A beam that goes at half a millimetre a second does not stand; where 0.8 is all that there is,
// that is 62.5 % of it.
TEST(ExactExtremes, TheSlowestBeamMoves) {
  for (const double highest : {500.0, 0.8}) {
    BeamWork beam(1500.0, highest);
    EXPECT_NEAR(beam.Moving(motion::SpeedProfile::Steady(10.0, 0.5), 0.0, 20.0, 1.0,
                            {.constant_percent = 40.0}, nullptr),
                0.4 * 1500.0 * 20.0, 1e-6);
    const BeamHistogram times = beam.Histogram(FromSeconds(20.0));
    EXPECT_EQ(times.by_speed[highest > 1.0 ? 1 : 13], FromSeconds(20.0)) << highest;
    EXPECT_EQ(times.by_power[8], FromSeconds(20.0)) << highest;
  }
}

// A finding whose text is not made any more is counted among those that are not told.
TEST(ExactExtremes, FindingsWithoutATextAreCounted) {
  ReportRecorder recorder({});
  FakeRun run(Script().Step(1, 1), recorder);
  run.Advance(kForever);
  const Diagnostic found{.code = ErrorCode::kRml1Clipped, .severity = Severity::kWarning};
  recorder.OnCounted(SimTime(0), found);
  recorder.OnCounted(SimTime(1), found);
  recorder.Finish(run.state().time);
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.findings_dropped.count(), 2U);
  EXPECT_TRUE(report.findings.empty());
}

// motion.md 9: power in classes of 5 % of the rated power; a ramp that asks for more than that at a
// high speed has all of it, and one that asks for less than nothing has none.
TEST(ExactExtremes, PowerByTheSpeedHasItsEnds) {
  const auto power_class = [](const machine::PowerBySpeed& power) {
    int found = -1;
    ToolpathRecorder recorder(Laser(), {}, [&](std::string_view bytes) {
      const auto block = DecodeToolpathBlock(bytes);
      EXPECT_TRUE(block);
      if (block) found = block->runs.at(0).power_class;
      return true;
    });
    motion::PlannedMotion steady;
    steady.path = LineFrom({}, {100, 0, 0});
    steady.speed = motion::SpeedProfile::Steady(100.0, 50.0);
    Script script;
    script.Step(1, 1).Motion(steady, {.use = machine::MotionUse::kCut,
                                      .beam_on = true,
                                      .power = power,
                                      .programmed_mm_s = 50.0});
    FakeRun run(script, recorder);
    run.Advance(kForever);
    recorder.Finish();
    return found;
  };
  EXPECT_EQ(power_class({.constant_percent = 10.0, .percent_per_mm_s = 1.0}), 12);
  EXPECT_EQ(power_class({.constant_percent = 60.0, .percent_per_mm_s = 2.0}), 20);
  EXPECT_EQ(power_class({.constant_percent = 60.0, .percent_per_mm_s = -2.0}), 0);
}

// As wide as a block may be, which is more than libpng takes by itself: a million cells and one.
TEST(ExactExtremes, AMapOfAMillionColumns) {
  const HeightField field =
      HeightField::Of({.x_max = 1'000'001.0, .y_max = 1.0, .bottom = -1.0, .top = 0.0, .cell = 1.0})
          .value();
  std::string bytes;
  ASSERT_TRUE(WriteHeightMap(field, [&](std::string_view part) {
    bytes += part;
    return true;
  }));
  const auto map = ReadHeightMap(bytes);
  ASSERT_TRUE(map) << map.error().detail;
  EXPECT_EQ(map->columns, 1'000'001U);
  EXPECT_EQ(map->rows, 1U);
  EXPECT_EQ(map->heights.back(), 0.0f);
}

}  // namespace
}  // namespace rmlcell::simulation
