// Feeds, ways, measures and powers below 1: they are as much something as larger ones.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>

#include "engine/simulation/material/height_field.h"
#include "engine/simulation/material/mill_tool.h"
#include "engine/simulation/material/milling_recorder.h"
#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture_page.h"
#include "engine/simulation/picture/plot.h"
#include "engine/simulation/report/contour_log.h"
#include "engine/simulation/report/report_recorder.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachinePoint;

constexpr machine::Place kSmallStep{.program = 1, .step = 3};

// A cut at 0.5 mm/s through a block of 20 x 12 mm, 5 mm thick, with a tool of 3 mm.
MillingFigures FiguresOfASlowCut(const MachinePoint& from, const MachinePoint& to) {
  MillingRecorder recorder(
      {}, {.stock = {.x_max = 20.0, .y_max = 12.0, .bottom = 0.0, .top = 5.0, .cell = 0.25},
           .tool = {.radius_mm = 1.5}});
  motion::PlannedMotion planned;
  planned.path = LineFrom(from, to);
  recorder.OnMotion({.place = kSmallStep,
                     .use = MotionUse::kCut,
                     .motion = &planned,
                     .travelled = planned.path.length(),
                     .programmed_mm_s = 0.5});
  return recorder.Figures();
}

// motion.md 9: what cuts at half a millimetre a second cuts at a feed. It is a pass, and no travel
// into the block.
TEST(SmallFigures, ASlowFeedIsAFeed) {
  const MillingFigures figures = FiguresOfASlowCut({2, 6, 4}, {18, 6, 4});
  EXPECT_EQ(figures.gouges, 0U);
  EXPECT_NEAR(figures.deepest_pass_mm, 1.0, 1e-6);
  EXPECT_EQ(figures.pass_place.step, 3);
  EXPECT_EQ(figures.pass_mm_s, 0.5);
}

// docs/material.md: what is cut beside the block at such a feed is as much in the wrong place.
TEST(SmallFigures, ASlowFeedBesideTheBlockIsTold) {
  EXPECT_NEAR(FiguresOfASlowCut({30, 0, 4}, {40, 0, 4}).beside_mm, 10.0, 1e-9);
}

// A person gets the same answer for a fine tool as for a large one.
TEST(SmallFigures, FineToolsAreCheckedToo) {
  const auto refused = [](const MillTool& tool) {
    const Status status = CheckTool(tool);
    return status ? std::string() : std::string(status.error().detail);
  };
  EXPECT_EQ(refused({.shape = MillTool::Shape::kBall, .radius_mm = 1.5, .flute_mm = 0.5}),
            "the tool cuts for 0.5 mm, and its end alone is 1.5 mm high: make flute longer");
  EXPECT_EQ(refused({.radius_mm = 1.5, .shank_radius_mm = 0.5}),
            "a shank begins where the tool ceases to cut: say flute=LENGTH, too");
  EXPECT_EQ(refused({.radius_mm = 1.5, .flute_mm = 0.5, .shank_radius_mm = 3.0}), "");
  EXPECT_EQ(
      refused({.radius_mm = 1.5, .flute_mm = 5.0, .holder_radius_mm = 0.5, .holder_from_mm = 4.0}),
      "the holder begins below the end of what cuts");
}

// In a slot of 2 mm a shank of 1.5 mm has room; one as wide as the tool of 3 mm goes 1 mm into its
// sides.
TEST(SmallFigures, ASlimShankHasRoomInASlot) {
  HeightField field =
      HeightField::Of({.x_max = 20.0, .y_max = 12.0, .bottom = -5.0, .top = 0.0, .cell = 0.25})
          .value();
  field.Cut({.radius_mm = 1.0}, {2, 6, -3}, {18, 6, -3});
  const auto depth = [&](double shank_radius_mm) {
    const MillTool tool{.radius_mm = 1.5, .flute_mm = 2.0, .shank_radius_mm = shank_radius_mm};
    return field.ShankDepthOf(tool, {2, 6, -3}, {18, 6, -3});
  };
  EXPECT_EQ(depth(0.75), 0.0);
  EXPECT_NEAR(depth(1.5), 1.0, 1e-6);
}

// docs/verdict.md: half a millimetre of a cut is a way, so the tip does not stand there.
TEST(SmallFigures, AShortCutIsNoStand) {
  ContourLog log(Laser());
  log.BeamOn(SimTime(0), kSmallStep);
  WorkFigures work;
  work.cut_mm = 0.5;
  work.time.motion = FromSeconds(1.0);
  work.beam_on = FromSeconds(1.0);
  const machine::MotionDone done{.place = kSmallStep, .power = {.constant_percent = 50.0}};
  const PointSweep column{};
  const std::array<CoordinateSweep, 2> rotary{};
  log.Add({.done = done, .work = work, .column = column, .rotary = rotary});
  RunReport report;
  log.WriteTo(report);
  EXPECT_EQ(report.cut_figures.standing_s, Extreme{});
}

// docs/verdict.md: half a percent of the power burns where the tip stands.
TEST(SmallFigures, AWeakBeamStandsToo) {
  ContourLog log(Laser());
  log.BeamOn(SimTime(0), kSmallStep);
  WorkFigures work;
  work.beam_on = FromSeconds(2.0);
  log.Add({.place = kSmallStep, .beam_on = true, .power_percent = 0.5}, work, false);
  RunReport report;
  log.WriteTo(report);
  EXPECT_EQ(report.cut_figures.standing_s, (Extreme{2.0, kSmallStep}));
}

// motion.md 8.1: half a millimetre of contour at half a millimetre a second has its energy, 1500 W
// at 1 % for each mm/s: 15 J/mm. And it is a contour: the tip has a limit of its own there.
TEST(SmallFigures, AShortSlowContourHasItsEnergyAndItsLimit) {
  Script script;
  script.Step(1, 1).Motion(Planned(LineFrom({0, 0, 0}, {0.5, 0, 0})),
                           {.use = MotionUse::kCut,
                            .beam_on = true,
                            .power = {.percent_per_mm_s = 1.0},
                            .programmed_mm_s = 0.5});
  ReportRecorder recorder(Laser());
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  const RunReport report = recorder.Report(run);
  EXPECT_NEAR(report.total.cut_energy_j, 7.5, 1e-6);
  EXPECT_EQ(report.tip_figures.speed_limit, 500.0);
}

bool IsOn(const std::string& page, std::string_view what) {
  return page.find(what) != std::string::npos;
}

// The picture says how much of the work was lost, however little it is.
TEST(SmallFigures, HalfAMillimetreThatWasLostIsNamed) {
  PathSketch sketch({}, 10);
  motion::PlannedMotion planned;
  planned.path = LineFrom({0, 0, 0}, {10, 0, 0});
  sketch.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = 10.0});
  sketch.AddLost({.from = {10, 0, 0}, .to = {10.5, 0, 0}});
  const std::string page = PicturePage(sketch, {}, {}, {});
  EXPECT_TRUE(IsOn(page, ">0.500 mm lost<"));
}

// The plot shows the speed that was asked for beside that of the tip, a slow one, too.
TEST(SmallFigures, ASlowSpeedThatWasAskedForIsPlotted) {
  const auto plot = [](double programmed_mm_s) {
    PlotRecorder recorder(Laser());
    Script script;
    script.Step(1, 1).Line({0, 0, 0}, {10, 0, 0},
                           {.use = MotionUse::kCut, .programmed_mm_s = programmed_mm_s});
    FakeRun run(script, recorder);
    run.Advance(kForever);
    RunReport report;
    report.cycle_time = run.state().time;
    return recorder.Svg(report, {.curves = {PlotCurve::kSpeed}});
  };
  EXPECT_TRUE(IsOn(plot(0.5), ">asked for<"));
  EXPECT_FALSE(IsOn(plot(0.0), ">asked for<"));
}

}  // namespace
}  // namespace rmlcell::simulation
