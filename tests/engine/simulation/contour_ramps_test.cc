// Contours: the ramps that are left out of what is slow, swings of the head, and how many are kept.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/simulation/report/contour_log.h"
#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

constexpr machine::Place kRampHere{.program = 3, .step = 1};
constexpr machine::Place kRampThere{.program = 3, .step = 2};

RunReport ReportOfContours(const ContourLog& log) {
  RunReport report;
  log.WriteTo(report);
  return report;
}

CoordinateSweep TurnOf(double low, double high) {
  return {.minimum = low, .maximum = high, .travel = high - low};
}

// Of 100 mm at 32 mm/s 60 are slow: what is told of them, with these limits of the tip.
double SlowPercent(double acceleration, double jerk) {
  machine::MachineShape shape = Laser();
  shape.limits->tip_speed_mm_s = 100.0;
  shape.limits->tip_acceleration_mm_s2 = acceleration;
  shape.limits->tip_jerk_mm_s3 = jerk;
  ContourLog log(shape);
  log.BeamOn(SimTime(0), kRampHere);
  const machine::MotionDone done{
      .place = kRampHere, .programmed_mm_s = 32.0, .power = {.constant_percent = 50.0}};
  CutPace* const pace = log.PaceOf(done);
  pace->Add(3.0, 20.0, 50.0);
  pace->Add(1.25, 32.0, 50.0);
  WorkFigures work;
  work.cut_mm = 100.0;
  work.beam_on = FromSeconds(4.25);
  log.Add({.done = done, .work = work, .column = {}, .rotary = {}});
  return ReportOfContours(log).cut_figures.slow_percent.value;
}

// docs/verdict.md: what is slow of the ramp from rest, and as much of that to rest, is left out. It
// is slow up to 25.6 mm/s.
TEST(ContourRamps, WhatIsSlowOfBothRampsIsLeftOut) {
  // By acceleration alone: v * v / 2a.
  EXPECT_NEAR(SlowPercent(64.0, HUGE_VAL), 60.0 - 2.0 * 25.6 * 25.6 / 128.0, 1e-6);
  // By jerk alone: it rises for 1 s and falls for 1 s; 25.6 mm/s are come to sqrt(0.4) s before.
  const double left = std::sqrt(0.4);
  const double slow = 32.0 - (32.0 * left - 32.0 * left * left * left / 6.0);
  EXPECT_NEAR(SlowPercent(1000.0, 32.0), 60.0 - 2.0 * slow, 1e-6);
  // Half a second of jerk to 4 mm/s, and 1.35 s at 16 mm/s2 from there.
  const double begin = 32.0 * 0.125 / 6.0;
  EXPECT_NEAR(SlowPercent(16.0, 32.0), 60.0 - 2.0 * (begin + 4.0 * 1.35 + 0.5 * 16.0 * 1.35 * 1.35),
              1e-6);
  // More than there is.
  EXPECT_EQ(SlowPercent(8.0, HUGE_VAL), 0.0);
}

// motion.md 2.5: a swing goes on from cut to cut within 1 degree of straight down, and has the
// place where it began; a cut with the head elsewhere ends it, also where that stands still.
TEST(ContourRamps, ASwingEndsElsewhere) {
  const double degree = kRadPerDegree;
  ContourLog log(Laser());
  log.BeamOn(SimTime(0), kRampHere);
  const auto cut = [&](const machine::Place& place, double a_rad, double b_low, double b_high) {
    WorkFigures work;
    work.cut_mm = 10.0;
    work.beam_on = FromSeconds(1.0);
    const machine::MotionDone done{.place = place, .power = {.constant_percent = 50.0}};
    log.Add({.done = done,
             .work = work,
             .column = {},
             .rotary = {TurnOf(0.0, a_rad), TurnOf(b_low, b_high)}});
    return ReportOfContours(log).cut_figures.singular_rad;
  };
  EXPECT_EQ(cut(kRampHere, 0.5, -0.5 * degree, 0.5 * degree), (Extreme{0.5, kRampHere}));
  EXPECT_EQ(cut(kRampThere, 0.25, 0.0, 0.0), (Extreme{0.75, kRampHere}));
  EXPECT_EQ(cut(kRampThere, 3.0, 10.0 * degree, 10.0 * degree), (Extreme{0.75, kRampHere}));
  EXPECT_EQ(cut(kRampThere, 0.625, 0.0, 0.0), (Extreme{0.75, kRampHere}));
  EXPECT_EQ(cut(kRampHere, 0.5, 0.0, 0.0), (Extreme{1.125, kRampThere}));
}

// A contour that goes on behind a halt ends as any other.
TEST(ContourRamps, BehindAHaltAContourIsOpen) {
  ContourLog log(Laser());
  const auto cut = [&] {
    WorkFigures work;
    work.cut_mm = 10.0;
    work.beam_on = FromSeconds(1.0);
    work.cut_energy_j = 30.0;
    work.pierce_energy_j = 12.0;
    const machine::MotionDone done{.place = kRampHere, .power = {.constant_percent = 50.0}};
    log.Add({.done = done, .work = work, .column = {}, .rotary = {}});
  };
  log.BeamOn(SimTime(0), kRampHere);
  cut();
  log.BeamOff();
  log.Halt();
  log.BeamOn(SimTime(5), kRampHere);
  cut();
  log.BeamOff();
  log.Step();
  log.BeamOn(SimTime(9), kRampThere);
  cut();
  const RunReport report = ReportOfContours(log);
  ASSERT_EQ(report.contours.size(), 2u);
  EXPECT_EQ(report.contours[0].length_mm, 20.0);
  EXPECT_EQ(report.contours[0].cut_energy_j, 60.0);
  EXPECT_EQ(report.contours[0].pierce_energy_j, 24.0);
  EXPECT_EQ(report.contours[1].length_mm, 10.0);
  EXPECT_EQ(report.cut_figures.energy_max_j, 84.0);
  EXPECT_EQ(report.cut_figures.longest, FromSeconds(2.0));
}

// So many are told one by one; of all of them the figures tell.
TEST(ContourRamps, MoreContoursAreCountedThanKept) {
  ContourLog log(Laser());
  WorkFigures work;
  const auto most = static_cast<int>(kReportedContoursMax);
  for (int k = 1; k <= most + 3; ++k) {
    log.BeamOn(SimTime(k), kRampHere);
    work.beam_on = SimTime(k);
    log.Add(work);
    if (k == most) {
      EXPECT_EQ(ReportOfContours(log).contours.size(), kReportedContoursMax);
      EXPECT_EQ(ReportOfContours(log).contours_dropped, 0u);
    }
  }
  const RunReport report = ReportOfContours(log);
  EXPECT_EQ(report.contours.size(), kReportedContoursMax);
  EXPECT_EQ(report.contours.back().begin, SimTime(most));
  EXPECT_EQ(report.contours_dropped, 3u);
  EXPECT_EQ(report.cut_figures.contours, kReportedContoursMax + 3);
  EXPECT_EQ(report.cut_figures.longest, SimTime(most + 3));
}

// A stand of a quarter of a second at half a percent counts; half a millimetre of way ends it. A
// ramp gives no power to a tip that stands.
TEST(ContourRamps, ShortStandsAndShortWays) {
  ContourLog log(Laser());
  const auto pass = [&](double length_mm, double moving_s, double settling_s,
                        const machine::PowerBySpeed& power) {
    const machine::MotionDone done{.place = kRampThere, .programmed_mm_s = 32.0, .power = power};
    CutPace* const pace = log.PaceOf(done);
    if (length_mm > 0.0) pace->Add(length_mm / 8.0, 8.0, power.PercentAt(8.0));
    WorkFigures work;
    work.cut_mm = length_mm;
    work.time.motion = FromSeconds(moving_s);
    work.time.settling = FromSeconds(settling_s);
    work.beam_on = FromSeconds(moving_s + settling_s);
    log.Add({.done = done, .work = work, .column = {}, .rotary = {}});
    return ReportOfContours(log).cut_figures.standing_s;
  };
  constexpr machine::PowerBySpeed kSlope{.percent_per_mm_s = 50.0};
  EXPECT_EQ(pass(0.0, 2.0, 3.0, kSlope), Extreme{});
  EXPECT_EQ(pass(0.0, 0.25, 0.0, {.constant_percent = 0.5}), (Extreme{0.25, kRampThere}));
  EXPECT_EQ(pass(0.5, 1.0, 0.0, {.constant_percent = 64.0}), (Extreme{0.25, kRampThere}));
  EXPECT_EQ(pass(0.0, 0.0, 0.375, {.constant_percent = 64.0}), (Extreme{0.375, kRampThere}));
  EXPECT_EQ(pass(4.0, 1.0, 0.0, {.constant_percent = 64.0}), (Extreme{0.375, kRampThere}));
  log.BeamOff();
  log.Step();
  EXPECT_EQ(ReportOfContours(log).cut_figures.hot_mm, (Extreme{4.5, kRampThere}));  // of both
}

// The ends of a travel that reaches to both sides of zero.
TEST(ContourRamps, EndsOnBothSidesOfZero) {
  machine::MachineShape shape = Laser();
  for (std::size_t i = 0; i < motion::kAxisCount; ++i) {
    shape.limits->axes.travel_min[i] = -100.0;
    shape.limits->axes.travel_max[i] = 90.0;
  }
  const auto near = [&](double low, double high) {
    ContourLog log(shape);
    log.BeamOn(SimTime(0), kRampHere);
    WorkFigures work;
    work.cut_mm = 10.0;
    work.beam_on = FromSeconds(1.0);
    PointSweep column{};
    column[2] = TurnOf(low, high);
    const machine::MotionDone done{.place = kRampHere, .power = {.constant_percent = 50.0}};
    log.Add({.done = done, .work = work, .column = column, .rotary = {}});
    return ReportOfContours(log).cut_figures.near_end[2].value;
  };
  EXPECT_EQ(near(-98.0, 0.0), 3.0);
  EXPECT_EQ(near(0.0, 87.0), 2.0);
  EXPECT_EQ(near(-95.0, 85.0), 0.0);
}

}  // namespace
}  // namespace rmlcell::simulation
