#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "engine/core/units.h"
#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture.h"
#include "engine/simulation/picture/picture_difference.h"
#include "engine/simulation/picture/picture_page.h"
#include "engine/simulation/picture/plot.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/core/untold.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/xml_check.h"

// Whole pages against drawings/, so that no line, text or colour moves unseen: the same bytes on
// every machine. Where they stand is a matter of taste that no rule decides; what a page has to say
// and to measure has tests of its own in picture_test, picture_view_test, plot_test and
// path_difference_test. A page that is to look different is written anew by the failing test,
// looked at, and put in the place of the old one.
namespace rmlcell::simulation {
namespace drawings {

using machine::MotionUse;
using machine::Signal;
using machine::WaitKind;
using motion::MachineVector;
using motion::PathPiece;

void ExpectDrawn(const std::string& svg, const std::string& name) {
  EXPECT_EQ(XmlFault(svg), "");
  std::ifstream file(RMLCELL_SOURCE_DIR "/tests/engine/simulation/drawings/" + name);
  std::ostringstream agreed;
  agreed << file.rdbuf();
  if (agreed.str() == svg) return;
  const std::string made = testing::TempDir() + name;
  std::ofstream(made) << svg;
  std::istringstream before(agreed.str()), now(svg);
  std::string old_line, new_line;
  int line = 0;
  do {
    ++line;
    old_line.clear();
    new_line.clear();
    std::getline(before, old_line);
    std::getline(now, new_line);
  } while (old_line == new_line && before && now);
  ADD_FAILURE() << name << ':' << line << "\n  was " << old_line << "\n  is  " << new_line
                << "\nthe new drawing: " << made;
}

RunReport Judged(RunReport report) {
  report.judgement = Judge(report);
  return report;
}

machine::MachineShape SmallMill() {
  machine::MachineShape shape;
  shape.travel.Add(MachineVector{0, 0, -60});
  shape.travel.Add(MachineVector{200, 150, 0});
  shape.has_work_origin = true;
  shape.work_origin = {12, 15, -20};
  return shape;
}

machine::MachineShape LaserWithTable() {
  machine::MachineShape shape = Laser();
  shape.travel.Add(MachineVector{-600, -600, -1300});
  shape.travel.Add(MachineVector{3600, 3100, 1100});
  return shape;
}

std::string PictureOf(const Script& script, const machine::MachineShape& shape,
                      const RunReport& report, const PictureOptions& options = {}) {
  PictureRecorder recorder(shape);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  return recorder.Svg(Judged(report), options);
}

RunReport MillReport() {
  RunReport report;
  report.finished = true;
  report.family = "rml1";
  report.title = "cover <2>";
  report.inputs_hash = "0123456789abcdef";
  report.engine_version = "1.2.3";
  report.cycle_time = FromSeconds(83.25);
  report.steps_executed = 17;
  report.total.cut_mm = 123.4567;
  report.total.travel_mm = 45.678912;
  report.total.plunges = 3;
  report.cut.Add(MachineVector{20, 20, -26});
  report.cut.Add(MachineVector{152.25, 90.125, -20});
  report.findings.resize(2);
  report.findings_dropped = Untold(3);
  return report;
}

// Lines, arcs both ways, a drilled hole, depths of which each gets its shade, all from above; the
// work origin lies within the panel.
Script Cover() {
  Script script;
  const MotionOptions cut{.use = MotionUse::kCut};
  const MotionOptions plunge{.use = MotionUse::kPlunge};
  const MotionOptions retract{.use = MotionUse::kRetract};
  script.Line({10, 10, -15}, {20, 20, -15}).Line({20, 20, -15}, {20, 20, -21}, plunge);
  script.Line({20, 20, -21}, {150, 20, -21}, cut);
  script.Motion(
      Planned(PathPiece::Circle({{150, 20, -21}}, {140, 20, -21}, {0, 0, 1}, kPi / 2, 0, 0)), cut);
  script.Line({140, 30, -21}, {140, 90, -23.5}, cut);
  script.Motion(Planned(PathPiece::Circle({{140, 90, -23.5}}, {110, 90, -23.5}, {0, 0, -1},
                                          kTurn * 0.75, 0, 0)),
                cut);
  script.Line({110, 60 + 60, -23.5}, {110, 120, -15}, retract);
  script.Line({110, 120, -15}, {40, 80, -15}).Line({40, 80, -15}, {40, 80, -26}, plunge);
  script.Line({40, 80, -26}, {40, 80, -15}, retract);
  script.Line({40, 80, -15}, {60, 80, -15}).Line({60, 80, -15}, {60, 80, -22}, plunge);
  script.Line({60, 80, -22}, {80, 100, -24}, cut);
  return script;
}

TEST(Drawing, MillFromAbove) {
  ExpectDrawn(PictureOf(Cover(), SmallMill(), MillReport(), {.width_px = 1000}), "mill.svg");
}

// The same beside each other from two sides, where depth is no shade; the run was stopped.
TEST(Drawing, MillFromTwoSides) {
  RunReport report = MillReport();
  report.findings.clear();
  report.findings_dropped = {};
  report.cut = {};
  report.tip.Add(MachineVector{10, 10, -26});
  report.tip.Add(MachineVector{152.25, 120, -15});
  report.total.cut_mm = 0.0;
  report.cycle_time = FromSeconds(59.9994);
  report.outcome = {.kind = machine::OutcomeKind::kBudgetExceeded,
                    .place = {.program = 1, .step = 9}};
  ExpectDrawn(PictureOf(Cover(), SmallMill(), report,
                        {.views = {PictureView::kXZ, PictureView::kYZ}, .width_px = 1000}),
              "mill_sides.svg");
}

// A contour with a slanted hole and a turning head; it failed in the last step.
Script Hood() {
  Script script;
  const MotionOptions cut{
      .use = MotionUse::kCut, .beam_on = true, .power = {.constant_percent = 80}};
  const auto pierce = [&] {
    script.Signal(Signal::kBeam, 1, 50).Wait(WaitKind::kPierce, 0.5, true, 50.0);
  };
  script.Motion(Planned(PathPiece::Line({{21, 2201, -350}}, {{1100, 700, -300}})));
  pierce();
  script.Motion(Planned(PathPiece::Line({{1100, 700, -300}}, {{1500, 700, -300}, 0.0, 0.5})), cut);
  script.Motion(
      Planned(PathPiece::Line({{1500, 700, -300}, 0.0, 0.5}, {{1500, 950, -220}, 0.0, 0.5})), cut);
  script.Signal(Signal::kBeam, 0);
  script.Motion(
      Planned(PathPiece::Line({{1500, 950, -220}, 0.0, 0.5}, {{1360, 820, -300}, 0.0, 0.3})));
  pierce();
  const double lean = 0.6;
  script.Motion(Planned(PathPiece::Circle({{1360, 820, -300}, 0.0, 0.3}, {1300, 820, -300},
                                          {0, -std::sin(lean), std::cos(lean)}, kTurn, 0.0, 0.3)),
                cut);
  script.Motion(Planned(PathPiece::Circle({{1360, 820, -300}, 0.0, 0.3}, {1360, 900, -300},
                                          {1, 0, 0}, kPi, 0.0, 0.3)),
                cut);
  return script;
}

RunReport HoodReport() {
  RunReport report;
  report.finished = true;
  report.family = "optimo";
  report.title = "A hood with a title that goes on and on, so that it can not stand there whole: ö";
  report.cycle_time = FromSeconds(3723.4);
  report.steps_executed = 12;
  report.total.cut_mm = 1288.5;
  report.total.beam_on = FromSeconds(61.25);
  report.total.pierces = 2;
  report.total.cut_energy_j = 52345.0;
  report.total.pierce_energy_j = 750.0;
  report.cut.Add(MachineVector{1100, 700, -350});
  report.cut.Add(MachineVector{1500, 980, -220});
  report.outcome = {.kind = machine::OutcomeKind::kFailed,
                    .code = ErrorCode::kHoleRadiusZero,
                    .place = {.program = 45, .step = 7}};
  return report;
}

TEST(Drawing, LaserInFourViews) {
  ExpectDrawn(PictureOf(Hood(), LaserWithTable(), HoodReport()), "laser.svg");
}

// Only what was asked for, in the order of asking, and from below; the smallest page.
TEST(Drawing, LaserInThreeViews) {
  RunReport report = HoodReport();
  report.outcome = {};
  ExpectDrawn(PictureOf(Hood(), Laser(), report,
                        {.views = {PictureView::kDirection, PictureView::kYZ, PictureView::kXY},
                         .direction = {2, 1, -1},
                         .width_px = 10}),
              "laser_views.svg");
}

TEST(Drawing, NothingMoved) {
  ExpectDrawn(PictureOf(Script(), {}, {}, {.width_px = 700}), "nothing.svg");
}

// A small part in the corner of a large machine, drawn coarser.
TEST(Drawing, SmallAndCoarse) {
  machine::MachineShape shape = SmallMill();
  shape.travel.Add(MachineVector{4000, 3000, 0});
  PathSketch sketch(shape, 12);
  motion::PlannedMotion planned;
  for (int k = 0; k < 40; ++k) {
    planned.path = LineFrom({0.1 * k, k % 2 * 0.3, -1}, {0.1 * k + 0.1, (k + 1) % 2 * 0.3, -1});
    sketch.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = planned.path.length()});
  }
  ExpectDrawn(PicturePage(sketch, shape, MillReport(), {.width_px = 800}), "coarse.svg");
}

Script CurvesOfALaser() {
  Script script;
  script.Step(1, 1).Wait(WaitKind::kPierce, 1.0, true, 50.0);
  script.Motion(
      Planned(LineFrom({0, 0, 0}, {40, 10, 0}),
              {.speed = 20.0, .acceleration = 200.0, .jerk = 4000.0}, 0.048),
      {.beam_on = true, .power = {.percent_per_mm_s = 75.0 / 40.0}, .programmed_mm_s = 25.0});
  script.Find(ErrorCode::kHoleRadiusZero, "radius is 0").Halt("STOP & <look>");
  script.Motion(Planned(PathPiece::Line({{40, 10, 0}, 0.0, 0.0}, {{60, 10, 5}, 0.3, -0.2}),
                        {.speed = 10.0, .acceleration = 100.0, .jerk = 4000.0}));
  script.Halt("HOLD").Nothing(1.5).Halt("a reason so long that it would leave the page");
  return script;
}

TEST(Drawing, PlotOfALaser) {
  PlotRecorder recorder(Laser());
  FakeRun run(CurvesOfALaser(), recorder,
              {{FromSeconds(5.0), machine::InputKind::kStart},
               {FromSeconds(8.0), machine::InputKind::kStart}});
  run.Advance(kForever);
  RunReport report = HoodReport();
  report.cycle_time = run.state().time;
  report.inputs_hash = "fedcba9876543210";
  report.engine_version = "1.2.3";
  ExpectDrawn(recorder.Svg(Judged(report),
                           {.curves = {PlotCurve::kSpeed, PlotCurve::kPower, PlotCurve::kAxes},
                            .width_px = 900}),
              "plot.svg");
}

TEST(Drawing, PlotOfNothing) {
  PlotRecorder recorder(SmallMill());
  RunReport report;
  report.cycle_time = FromSeconds(2.0);
  ExpectDrawn(recorder.Svg(Judged(report), {.curves = {PlotCurve::kAxes}, .width_px = 10}),
              "plot_nothing.svg");
}

PathSketch SketchOf(const Script& script, const machine::MachineShape& shape) {
  PictureRecorder recorder(shape);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  return recorder.sketch();
}

// A hole less and a step more, in a corner of a hood: once more, closer.
TEST(Drawing, DifferenceOfTwoHoods) {
  Script after = Hood();
  after.Signal(Signal::kBeam, 0);
  after.Motion(
      Planned(PathPiece::Line({{1360, 980, -300}, 0.0, 0.3}, {{1440, 930, -280}, 0.0, 0.3})));
  after.Signal(Signal::kBeam, 1, 50).Wait(WaitKind::kPierce, 0.5, true, 50.0);
  after.Motion(Planned(PathPiece::Line({{1440, 930, -280}}, {{1460, 930, -280}})),
               {.use = MotionUse::kCut, .beam_on = true});
  const machine::MachineShape shape = LaserWithTable();
  const PathSketch one = SketchOf(Hood(), shape);
  const PathSketch two = SketchOf(after, shape);
  ExpectDrawn(PictureOfDifference(
                  {.path = one, .title = "hood.S"}, {.path = two, .title = "hood 2.S"}, shape,
                  {{"cycle_time", "s", 61.5, 62.0625}, {"pierces", "", 2, 3}}, {.width_px = 1100}),
              "difference.svg");
}

// Removed and added everywhere, dots of both kinds, notes, a title that does not fit; a mill.
TEST(Drawing, DifferenceOfTwoCovers) {
  const machine::MachineShape shape = SmallMill();
  PathSketch coarse(shape, 12);
  motion::PlannedMotion planned;
  for (int k = 0; k < 40; ++k) {
    planned.path = LineFrom({2.0 * k, k % 2 * 9.0, -1}, {2.0 * k + 2.0, (k + 1) % 2 * 9.0, -1});
    coarse.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = planned.path.length()});
  }
  planned.path = LineFrom({60, 80, -15}, {60, 80, -22});
  coarse.Add({.use = MotionUse::kPlunge, .motion = &planned, .travelled = planned.path.length()});
  const PathSketch cover = SketchOf(Cover(), shape);
  ExpectDrawn(PictureOfDifference(
                  {.path = cover, .title = "a cover with so long a title that it is cut"},
                  {.path = coarse, .title = "b.rml", .note = "stopped at 1/7"}, shape,
                  {{"plunges", "", 3, 1}, {"cut_mm", "mm", 412.5, 412.5}}, {.width_px = 10}),
              "difference_mill.svg");
}

TEST(Drawing, DifferenceOfNothing) {
  const PathSketch empty({}, 10);
  ExpectDrawn(PictureOfDifference({.path = empty, .title = "a"}, {.path = empty, .title = "b"}, {},
                                  {}, {.width_px = 900}),
              "difference_nothing.svg");
}

}  // namespace drawings
}  // namespace rmlcell::simulation
