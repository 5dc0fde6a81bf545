#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/families/families.h"
#include "engine/simulation/run/simulate.h"
#include "tests/engine/simulation/shape_of.h"

// The figures of motion.md 8.2 for whole programs, each worked out by hand. The standard machine
// stands at column (21.02, 2201.2, -50), tip 300 mm below it; 500 mm/s, 2000 mm/s2, 40,000 mm/s3
// for the tip and X, Y, Z.
namespace rmlcell::simulation {
namespace {

struct Told {
  std::map<std::string, std::string> parameters{};
  double override_percent = 100.0;
};

// Programs by slot; that of the lowest one is started.
RunReport ReportOf(const std::map<int, std::string>& programs, const Told& told = {}) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  machine::RunSetup setup{machine::Parameters(family.parameters())};
  for (const auto& [name, value] : told.parameters) {
    EXPECT_TRUE(setup.parameters.Set(name, std::string_view(value)).ok());
  }
  for (const auto& [slot, text] : programs) {
    machine::Translation made =
        family.Translate({.name = "test.S", .bytes = text}, setup.parameters, {});
    EXPECT_TRUE(made.ok) << text;
    setup.programs[slot].object = machine::Bytes::Of(std::move(made.object));
  }
  setup.main_program = programs.begin()->first;
  setup.forecast = true;
  setup.override_percent = told.override_percent;
  const auto result = Simulate(family, std::move(setup), {});
  EXPECT_TRUE(result);
  return result->report;
}
RunReport ReportOf(const std::string& text, const Told& told = {}) {
  return ReportOf(std::map<int, std::string>{{1, text}}, told);
}

const AxisFigures& Axis(const ScopeFigures& scope, std::string_view name) {
  return *std::ranges::find(scope.axes, name, &AxisFigures::name);
}

const std::string kContour = "COORD ABSOL\nPATH LIN\n";

// motion.md 8.2: peaks in units and as shares of their limits, jerk, travel, reversals. X goes 1000
// mm there and back at 70 % of its speed, with all of its acceleration and jerk.
TEST(ReportFigures, PeaksOfAnAxis) {
  const RunReport report =
      ReportOf("COORD ROBOT\nMOVE (1021.02,2201.2,-50.,0.,0.)\nMOVE (21.02,2201.2,-50.,0.,0.)\n");
  const AxisFigures& x = Axis(report, "X");
  EXPECT_NEAR(x.peak_speed, 350.0, 1e-6);
  EXPECT_NEAR(x.peak_speed / x.speed_limit, 0.7, 1e-9);
  EXPECT_NEAR(x.peak_acceleration, 2000.0, 1e-6);
  EXPECT_NEAR(x.peak_acceleration / x.acceleration_limit, 1.0, 1e-9);
  EXPECT_NEAR(x.peak_jerk, 40000.0, 1e-3);
  EXPECT_NEAR(x.jerk_limit, 40000.0, 1e-9);
  EXPECT_NEAR(x.travel, 2000.0, 1e-3);
  EXPECT_EQ(x.reversals, 1u);
  EXPECT_NEAR(Axis(report, "Y").peak_speed, 0.0, 1e-3);  // 2201.2 has no exact REAL
  EXPECT_NEAR(report.tip_figures.peak_speed, 350.0, 1e-6);
  EXPECT_NEAR(report.tip_figures.peak_jerk, 40000.0, 1e-3);
  // PTP: only the axes have limits (3.5), so the tip has no share of one.
  EXPECT_EQ(report.tip_figures.speed_limit, 0.0);
  EXPECT_EQ(report.tip_figures.acceleration_limit, 0.0);
}

// motion.md 2.4: round an arc of R 20 at a steady 60 mm/s the jerk is v^3/R^2 = 540 mm/s3; the ramp
// to 60 adds its own 0.8 * 40,000 along the arc at most. From samples, so to a part in a thousand.
TEST(ReportFigures, JerkOfAnArc) {
  motion::PlannedMotion planned;
  const auto arc =
      motion::PathPiece::ArcThrough({{20, 0, 0}, 0, 0}, {0, 20, 0}, {{-20, 0, 0}, 0, 0});
  ASSERT_TRUE(arc);
  planned.path = arc->path;
  planned.speed = motion::SpeedProfile::Steady(planned.path.length(), 60.0);
  const MotionPeaks peaks = PeaksBetween(planned, true, 0.0, planned.speed.duration_s());
  EXPECT_NEAR(peaks.tip_jerk, 540.0, 0.5);
  EXPECT_NEAR(peaks.axis_jerk[0], 540.0, 1.0);
  EXPECT_NEAR(peaks.axis_jerk[1], 540.0, 1.0);
  EXPECT_EQ(peaks.axis_jerk[2], 0.0);
}

std::string Cut(const std::string& workdef, const std::string& speed) {
  return kContour + "WORKDEF 1,0 " + workdef + "\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED " + speed +
         "\nWORK 1,0/ON\nMOVE (1200.,1000.,-400.,0.,0.)\nWORK 1,0/OFF\n";
}

// motion.md 8.1: without saturation the energy per mm is 1500 W * 0.75 / (0.08 * 500 mm/s) = 28.125
// J/mm, at any speed and override, ramps included.
TEST(ReportFigures, EnergyPerMillimetreDoesNotDependOnTheSpeed) {
  for (const std::string speed : {"2.", "8.", "10."}) {
    for (const double override_percent : {55.0, 100.0}) {
      const RunReport report =
          ReportOf(Cut("(8.,75.,1.,50.)", speed), {.override_percent = override_percent});
      EXPECT_NEAR(report.total.energy_j_per_mm(), 28.125, 1e-9) << speed;
      EXPECT_NEAR(report.total.energy_j_per_mm_max, 28.125, 1e-9) << speed;
      EXPECT_NEAR(report.total.cut_energy_j, 5625.0, 1e-3);
      EXPECT_NEAR(report.total.pierce_energy_j, 750.0, 1e-6);
    }
  }
}

// Case W04 of motion.md 12: with saturation the crossing times are closed: 6014.484172383 J.
TEST(ReportFigures, EnergyWithSaturation) {
  const RunReport report = ReportOf(Cut("(6.5,80.,1.5,95.)", "10."));
  EXPECT_NEAR(report.total.cut_energy_j, 6014.484172383, 1e-3);
  EXPECT_NEAR(report.total.energy_j_per_mm(), 30.072420862, 1e-6);
  EXPECT_NEAR(ToSeconds(report.total.beam_on), 5.618710678, 1e-6);
}

// motion.md 8.2: time by tip speed and by power. The ramp to 40 mm/s lasts 2 sqrt(40/40000) s and
// passes 25 mm/s, 5 % of the highest speed, sqrt(2 * 15/40000) s before its end. 72 % of power
// belong to 40 mm/s.
TEST(ReportFigures, HistogramsOfTheBeam) {
  const RunReport report = ReportOf(Cut("(8.,72.,1.,52.)", "8."));
  const double ramp = 2.0 * std::sqrt(40.0 / 40000.0);
  const double above = std::sqrt(30.0 / 40000.0);
  const double cruise = (200.0 - 40.0 * ramp) / 40.0;
  EXPECT_NEAR(ToSeconds(report.beam.by_speed[0]), 1.0 + 0.048, 1e-5);
  EXPECT_NEAR(ToSeconds(report.beam.by_speed[1]), 2.0 * (ramp - above), 1e-5);
  EXPECT_NEAR(ToSeconds(report.beam.by_speed[2]), cruise + 2.0 * above, 1e-5);
  EXPECT_NEAR(ToSeconds(report.beam.by_power[10]), 1.0, 0.01);  // the pierce at 52 %, and the ramps
  EXPECT_NEAR(ToSeconds(report.beam.by_power[14]), cruise, 0.03);
  const auto sum = [](const auto& bins) {
    return std::accumulate(bins.begin(), bins.end(), SimTime::zero());
  };
  EXPECT_EQ(sum(report.beam.by_speed), report.total.beam_on);
  EXPECT_EQ(sum(report.beam.by_power), report.total.beam_on);
  EXPECT_EQ(report.programs.at(1).beam, report.beam);
}

// Cases C01 and C11 of motion.md 12: a bend of 90 degrees leaves its corner by 1.358847515 mm, on
// the bisector; a turn of 178 degrees is a stop.
TEST(ReportFigures, Corners) {
  const std::string start = kContour + "SPEED 10\nMOVE (1000.,1000.,-400.,0.,0.)\n";
  const RunReport bend =
      ReportOf(start + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)\n");
  EXPECT_EQ(bend.corners.blended, 1u);
  EXPECT_EQ(bend.corners.stops, 2u);
  EXPECT_NEAR(bend.corners.deviation_mm_max, 1.358847515, 1e-6);
  EXPECT_EQ(bend.corners.deviation_place.step, 5);
  EXPECT_NEAR(bend.corners.deviation_point.x(), 1100.0 - 1.358847515 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(bend.corners.deviation_point.y(), 1000.0 + 1.358847515 / std::sqrt(2.0), 1e-6);
  const RunReport back =
      ReportOf(start + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1000.,1001.,-400.,0.,0.)\n");
  EXPECT_EQ(back.corners.reversals, 1u);
  const RunReport close =
      ReportOf(start + "MOVE (1001.,1000.,-400.,0.,0.)/FLY\nMOVE (1001.,1100.,-400.,0.,0.)\n");
  EXPECT_EQ(close.corners.capped, 1u);  // C07
  EXPECT_NEAR(close.corners.deviation_mm_max, 0.167739779, 1e-6);
}

// motion.md 8.2: why a move does not reach its speed. L01: X allows 125 of 150 mm/s. S03: 1 mm
// gives 21.5443469 mm/s. R 2: sqrt(0.5 * 2000 * 2). ACCEL 2 on 10 mm: (-2 + sqrt(4 + 4 * 40 * 10))
// / 2 mm/s.
TEST(ReportFigures, WhyMovesAreTooSlow) {
  const RunReport report =
      ReportOf(kContour +
               "SPEED 30\nMOVE (1000.,1000.,-400.,0.,1.570796)\n"
               "MOVE (1100.,1000.,-400.,1.,1.570796)\n"  // 5
               "MOVE (1100.,1001.,-400.,1.,1.570796)\n"  // 6
               "PATH CIR\nSPEED 100\n"
               "MOVE (1104.,1001.,-400.,1.,1.570796)/VIA (1102.,1003.,-400.,1.,1.570796)\n"  // 9
               "PATH LIN\nSPEED 10\nACCEL 2\n"
               "MOVE (1104.,1011.,-400.,1.,1.570796)\n");  // 13
  ASSERT_EQ(report.slow_moves.size(), 4u);
  const auto expect = [&](std::size_t n, int step, SlowCause cause, double wanted, double reached) {
    const SlowMove& move = report.slow_moves[n];
    EXPECT_EQ(move.place.step, step);
    EXPECT_EQ(SlowCauseText(move.cause), SlowCauseText(cause)) << step;
    EXPECT_NEAR(move.wanted_mm_s, wanted, 1e-6) << step;
    EXPECT_NEAR(move.reached_mm_s, reached, 1e-3) << step;
  };
  expect(0, 5, SlowCause::kAxis, 150.0, 125.0);
  EXPECT_EQ(report.slow_moves[0].axis, "X");
  EXPECT_NEAR(report.slow_moves[0].allowed_mm_s, 125.0, 1e-3);
  expect(1, 6, SlowCause::kShort, 150.0, 21.5443469);
  expect(2, 9, SlowCause::kRadius, 500.0, std::sqrt(0.5 * 2000.0 * 2.0));
  expect(3, 13, SlowCause::kAcceleration, 50.0, (-2.0 + std::sqrt(4.0 + 4.0 * 40.0 * 10.0)) / 2.0);
  EXPECT_EQ(report.shortfall.moves, 4u);
  EXPECT_EQ(report.shortfall.by_axis, 1u);
  EXPECT_EQ(report.shortfall.by_radius, 1u);
  EXPECT_EQ(report.shortfall.too_short, 1u);
  EXPECT_EQ(report.shortfall.by_acceleration, 1u);
  EXPECT_EQ(report.shortfall.worst.step, 9);  // a tenth of what it asks for
}

// OPT-3.14, OPT-3.15: the shutter of ARROW stays open to the end of the program, that of EFA-51
// follows the beam.
TEST(ReportFigures, ShutterByStepAndProgram) {
  const std::string text = "DELAY 2.\nWORK 0,0/ON\nDELAY 3.\nWORK 0,0/OFF\nDELAY 1.\n";
  const RunReport arrow = ReportOf(text);
  EXPECT_EQ(arrow.total.shutter_open, FromSeconds(4.0));
  EXPECT_EQ(arrow.programs.at(1).total.shutter_open, FromSeconds(4.0));
  const RunReport efa = ReportOf(text, {.parameters = {{"LASER", "EFA51"}}});
  EXPECT_EQ(efa.total.shutter_open, FromSeconds(3.0));
  ASSERT_EQ(efa.steps.size(), 5u);
  EXPECT_EQ(efa.steps[2].figures.shutter_open, FromSeconds(3.0));
}

// motion.md 8.2: per job and per program; the sums of the parts are the whole, times to the
// nanosecond.
TEST(ReportFigures, EachProgramHasItsOwn) {
  const RunReport report = ReportOf(
      {{44,
        kContour + "SPEED 8\nMOVE (1000.,1050.,-400.,0.,0.)/FLY\nMOVE (1080.,1050.,-400.,0.,0.)\n"},
       {45, "COORD ABSOL\n"}});
  EXPECT_EQ(report.programs.size(), 1u);
  const RunReport both = ReportOf(
      {{43,
        kContour +
            "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 10\nMOVE (1100.,1000.,-400.,0.,0.)\nCALL 44\n"},
       {44, kContour +
                "SPEED 8\nMOVE (1100.,1050.,-400.,0.,0.)/FLY\nMOVE (1180.,1050.,-400.,0.,0.)\n"}});
  const ScopeFigures& main = both.programs.at(43);
  const ScopeFigures& called = both.programs.at(44);
  EXPECT_NEAR(called.tip_figures.peak_speed, 40.0, 1e-6);
  EXPECT_EQ(called.tip_figures.speed_limit, 500.0);  // of a contour
  EXPECT_GT(main.tip_figures.peak_speed, 100.0);     // of the way from the home position
  EXPECT_NEAR(called.tip.min.x(), 1100.0, 1e-6);
  EXPECT_NEAR(called.tip.max.x(), 1180.0, 1e-6);
  EXPECT_NEAR(called.programmed.max.y(), 1050.0, 1e-9);
  EXPECT_NEAR(called.column.max.z(), -100.0, 1e-6);
  EXPECT_EQ(called.corners.blended, 1u);
  EXPECT_EQ(main.corners.blended, 0u);
  EXPECT_EQ(main.corners.stops + called.corners.stops, both.corners.stops);
  EXPECT_NEAR(Axis(main, "X").travel + Axis(called, "X").travel, Axis(both, "X").travel, 1e-9);
  EXPECT_EQ(main.total.time.total() + called.total.time.total(), both.cycle_time);
  EXPECT_NEAR(main.total.tip_path_mm + called.total.tip_path_mm, both.total.tip_path_mm, 1e-9);
  SimTime steps = both.rest.time.total();
  for (const StepFigures& step : both.steps) steps += step.figures.time.total();
  EXPECT_EQ(steps, both.cycle_time);
}

// motion.md 8.2, OPT-E.7301: the violations of a program, and the outcome of its forecast.
TEST(ReportFigures, Violations) {
  const RunReport report =
      ReportOf("COORD ROBOT\nMOVE (9000.,2201.2,-50.,0.,0.)\nMOVE (0.,2201.2,-50.,13.,0.)\n");
  ASSERT_EQ(report.violations.size(), 2u);
  EXPECT_EQ(report.violations[0].axis, "X");
  EXPECT_NEAR(report.violations[0].excess, 5400.0, 1e-9);
  EXPECT_EQ(report.violations[0].place.step, 2);
  EXPECT_EQ(report.violations[1].axis, "A");
  EXPECT_TRUE(report.violations[1].rotary);
  EXPECT_NEAR(report.violations[1].excess, 0.4, 1e-9);
  EXPECT_EQ(report.outcome.kind, machine::OutcomeKind::kFailed);
  EXPECT_NEAR(Axis(report, "A").maximum, 13.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::simulation
