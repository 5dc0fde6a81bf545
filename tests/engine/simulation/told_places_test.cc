// What a report, a picture and a plot say of what nobody told before, and where a page puts it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "engine/machine/verdict.h"
#include "engine/simulation/material/target.h"
#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture_page.h"
#include "engine/simulation/picture/plot.h"
#include "engine/simulation/report/report_recorder.h"
#include "engine/simulation/run/simulate.h"
#include "tests/engine/simulation/fake_family.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/png_picture.h"

namespace rmlcell::simulation {
namespace {

using machine::WaitKind;

// The findings that make a part bad are marked, others are not.
TEST(ToldPlaces, FindingsAreMarkedByTheVerdict) {
  Script script;
  script.Step(1, 1)
      .Find(ErrorCode::kRml1SpeedRounded, "rounded")
      .Find(ErrorCode::kHoleRadiusZero, "radius is 0")
      .Ends(machine::OutcomeKind::kFailed, ErrorCode::kHoleRadiusZero, "radius is 0");
  const auto result = Simulate(FakeFamily(script), FakeFamily::Setup(), {});
  ASSERT_TRUE(result);
  const std::vector<Finding>& findings = result->report.findings;
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].diagnostic.judged, Judged::kNo);
  EXPECT_EQ(findings[1].diagnostic.judged, Judged::kBad);
}

// beam_work.h: where nobody knows the highest speed of the tip all of a beam counts as standing.
TEST(ToldPlaces, WithoutLimitsThereAreNoClassesOfSpeed) {
  for (const bool limited : {true, false}) {
    machine::MachineShape shape = Laser();
    if (!limited) shape.limits.reset();
    motion::PlannedMotion steady;
    steady.path = LineFrom({}, {100, 0, 0});
    steady.speed = motion::SpeedProfile::Steady(100.0, 50.0);
    Script script;
    script.Step(1, 1).Motion(steady, {.beam_on = true, .power = {.constant_percent = 50.0}});
    ReportRecorder recorder(shape);
    FakeRun run(script, recorder);
    run.Advance(kForever);
    recorder.Finish(run.state().time);
    const RunReport report = recorder.Report(run);
    EXPECT_EQ(report.beam.by_speed[0], limited ? SimTime(0) : FromSeconds(2.0));
    EXPECT_EQ(report.tip_figures.jerk_limit, limited ? 40'000.0 : 0.0);
  }
}

// LIVE-6.09: a run that begins at a step counts its time and its steps from there.
TEST(ToldPlaces, WhatWasBeforeIsNobodys) {
  Script script;
  script.Step(1, 1).Wait(WaitKind::kDwell, 5.0).Step(1, 2).Wait(WaitKind::kDwell, 1.5);
  machine::RunObserver nobody;
  FakeRun run(script, nobody);
  run.Advance(FromSeconds(5.0));
  ASSERT_EQ(run.state().time, FromSeconds(5.0));
  const std::uint64_t before = run.steps_executed();
  ReportRecorder recorder({});
  recorder.Begin(run);
  recorder.OnWait({.start = FromSeconds(5.0),
                   .end = FromSeconds(6.0),
                   .place = {.program = 1, .step = 2},
                   .kind = WaitKind::kDwell});
  run.Advance(kForever);
  recorder.Finish(FromSeconds(6.5));
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.cycle_time, FromSeconds(1.5));
  EXPECT_EQ(report.total.time.dwell, FromSeconds(1.0));
  EXPECT_EQ(report.total.time.standstill, FromSeconds(0.5));
  EXPECT_EQ(report.steps_executed, run.steps_executed() - before);
}

// motion.md 8.1: a dwell pierces behind a beam that was switched on, not behind one that nobody
// switched on.
TEST(ToldPlaces, NoDotWithoutABeamThatWentOn) {
  const machine::Wait dwell{
      .end = FromSeconds(1.0), .kind = WaitKind::kDwell, .beam_on = true, .power_percent = 50.0};
  PictureRecorder nobody(Laser());
  nobody.OnWait(dwell);
  EXPECT_TRUE(nobody.sketch().dots().empty());
  PictureRecorder switched(Laser());
  switched.OnSignal({.signal = machine::Signal::kBeam, .value = 1.0});
  switched.OnWait(dwell);
  EXPECT_EQ(switched.sketch().dots().size(), 1U);
}

// Until the first motion each axis stands where that begins.
TEST(ToldPlaces, AxesStandWhereTheFirstMotionBegins) {
  PlotRecorder recorder(Laser());
  Script script;
  script.Step(1, 1)
      .Wait(WaitKind::kDwell, 1.0)
      .Motion(Planned(motion::PathPiece::Line({{50, 60, 70}, 0.25, 0.5}, {{58, 68, 78}, 0.5, 0.75}),
                      kSlowLimits, 0.0, motion::GantryHead{.length_mm = 300.0}));
  FakeRun run(script, recorder);
  run.Advance(kForever);
  const TimeEnvelope& values = recorder.Values(run.state().time);
  const motion::AxisPose begin =
      motion::Head(motion::GantryHead{.length_mm = 300.0}).ColumnOf({{50, 60, 70}, 0.25, 0.5});
  const double expected[] = {begin.column.x(), begin.column.y(), begin.column.z(), 0.25, 0.5};
  const TimeEnvelope::Bucket& first = values.buckets().front();
  for (std::size_t axis = 0; axis < 5; ++axis) {
    EXPECT_NEAR(first.ranges[PlotSeries::kFirstAxis + axis].low, expected[axis], 1e-9) << axis;
    EXPECT_NEAR(first.ranges[PlotSeries::kFirstAxis + axis].high, expected[axis], 1e-9) << axis;
  }
}

// X or Y of a text on a page.
double PlaceOfText(const std::string& page, const std::string& text, const char* axis) {
  const std::size_t at = page.find(">" + text);
  EXPECT_NE(at, std::string::npos) << text;
  const std::string name = std::string(" ") + axis + "=\"";
  return std::stod(page.substr(page.rfind(name, at) + name.size()));
}
double HeightOf(const std::string& page, const std::string& text) {
  return PlaceOfText(page, text, "y");
}

// The column of a page goes down: each line below the one before, and no two on each other.
TEST(ToldPlaces, TheColumnGoesDown) {
  PathSketch sketch({}, 10);
  motion::PlannedMotion planned;
  planned.path = LineFrom({0, 0, 0}, {100, 80, 0});
  sketch.Add({.use = machine::MotionUse::kCut, .motion = &planned, .travelled = 100.0});
  sketch.AddLost({.from = {100, 80, 0}, .to = {130, 80, 0}});
  RunReport report;
  for (int k = 1; k <= 6; ++k) {
    report.judgement.reasons.push_back({.code = ErrorCode::kCellGouge,
                                        .verdict = machine::Verdict::kBad,
                                        .said = "reason " + std::to_string(k)});
  }
  const std::string page = PicturePage(sketch, {}, report, {});
  const double reason = HeightOf(page, "reason 4");
  const double more = HeightOf(page, "and 2 more");
  EXPECT_EQ(reason - HeightOf(page, "reason 3"), 22.0);
  EXPECT_EQ(more - reason, 22.0);
  EXPECT_EQ(HeightOf(page, "Figures") - more, 26.0);
  const double beyond = HeightOf(page, "beyond the travel, not cut");
  const double lost = HeightOf(page, "30.000 mm lost");
  EXPECT_EQ(lost - beyond, 19.0);
  EXPECT_EQ(HeightOf(page, "start<") - lost, 21.0);
  EXPECT_EQ(PlaceOfText(page, "30.000 mm lost", "x"),
            PlaceOfText(page, "beyond the travel, not cut", "x"));
}

// A peak within one step of a plot is drawn, up and down again.
TEST(ToldPlaces, APeakWithinAStepIsDrawn) {
  PlotRecorder recorder(Laser());
  Script script;
  script.Step(1, 1)
      .Wait(WaitKind::kPierce, 0.00001, true, 20.0)
      .Wait(WaitKind::kPierce, 0.00001, true, 80.0)
      .Wait(WaitKind::kPierce, 0.00001, true, 20.0);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  RunReport report;
  report.cycle_time = run.state().time;
  const std::string svg = recorder.Svg(report, {.curves = {PlotCurve::kPower}});
  const std::size_t begin = svg.find("<path d=\"") + 9;
  const std::string data = svg.substr(begin, svg.find('"', begin) - begin);
  double up = 0.0, down = 0.0;
  int numbers = 0;
  for (const char* at = data.c_str(); *at != 0;) {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end != at && ++numbers > 2 && numbers % 2 == 0) (number < 0.0 ? up : down) += number;
    at = end != at ? end : at + 1;
  }
  // 60 of 104 % of a panel of 130 px.
  EXPECT_NEAR(up, -130.0 * 60.0 / 104.0, 0.1) << data;
  EXPECT_NEAR(down, 130.0 * 60.0 / 104.0, 0.1) << data;
}

// With no tolerance a difference of a micrometre has the full colour, and less of it less.
TEST(ToldPlaces, AMicrometreHasTheFullColour) {
  constexpr Stock block{.x_max = 2.0, .y_max = 2.0, .bottom = -2.0, .top = 0.0, .cell = 1.0};
  const HeightField field = HeightField::Of(block).value();
  const auto colour = [&](float height) {
    std::string bytes;
    EXPECT_TRUE(WriteDifference(
        field,
        {.heights = std::make_shared<const std::vector<float>>(4, height), .tolerance_mm = 0.0},
        [&](std::string_view part) {
          bytes += part;
          return true;
        }));
    return PngPicture(bytes).At(0, 0);
  };
  EXPECT_EQ(colour(-1.0f), (Rgb{0, 60, 200}));
  EXPECT_EQ(colour(-0.01f), (Rgb{0, 60, 200}));
  // 0.3 + 0.7 * 0.75 of the way from 214.
  EXPECT_EQ(colour(-0.00075f), (Rgb{37, 87, 202}));
}

}  // namespace
}  // namespace rmlcell::simulation
