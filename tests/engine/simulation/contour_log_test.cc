#include "engine/simulation/report/contour_log.h"

#include <gtest/gtest.h>

#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

constexpr machine::Place kHere{.program = 1, .step = 3};

CoordinateSweep SweepOf(double low, double high) {
  return {.minimum = low, .maximum = high, .travel = high - low};
}

// A cut as the recorder tells of it; the column stands far from any end.
struct LaserCut {
  double length_mm = 10.0;
  double seconds = 1.0;
  double settling_s = 0.0;
  PointSweep column{};
  std::array<CoordinateSweep, 2> rotary{};
  machine::Place place = kHere;
};

void AddCut(ContourLog& log, const LaserCut& cut) {
  WorkFigures work;
  work.cut_mm = cut.length_mm;
  work.time.motion = FromSeconds(cut.seconds);
  work.time.settling = FromSeconds(cut.settling_s);
  work.beam_on = FromSeconds(cut.seconds + cut.settling_s);
  const machine::MotionDone done{.place = cut.place, .power = {.constant_percent = 50.0}};
  log.Add({.done = done, .work = work, .column = cut.column, .rotary = cut.rotary});
}

RunReport Written(const ContourLog& log) {
  RunReport report;
  log.WriteTo(report);
  return report;
}

// One axis of the laser with another travel, and a contour in which it goes from `low` to `high`.
Extreme NearEndOf(std::size_t axis, double travel_min, double travel_max, double low, double high) {
  machine::MachineShape shape = Laser();
  for (std::size_t i = 0; i < motion::kAxisCount; ++i) {
    shape.limits->axes.travel_min[i] = -1000.0;
    shape.limits->axes.travel_max[i] = 1000.0;
  }
  shape.limits->axes.travel_min[axis] = travel_min;
  shape.limits->axes.travel_max[axis] = travel_max;
  ContourLog log(shape);
  log.BeamOn(SimTime(0), kHere);
  LaserCut cut;
  (axis < 3 ? cut.column[axis] : cut.rotary[axis - 3]) = SweepOf(low, high);
  AddCut(log, cut);
  const CutFigures figures = Written(log).cut_figures;
  for (std::size_t i = 0; i < motion::kAxisCount; ++i) {
    if (i != axis) {
      EXPECT_EQ(figures.near_end[i], Extreme{}) << i;
    }
  }
  return figures.near_end[axis];
}

// docs/verdict.md: the last 5 mm, or the last degree, at either end; on the end itself all of it,
// and beyond it the travel is told, not the zone.
TEST(ContourLog, EndsOfTheTravel) {
  const Extreme none{};
  for (const std::size_t axis : {0u, 1u, 2u}) {
    EXPECT_EQ(NearEndOf(axis, 0, 100, 5, 95), none);
    EXPECT_EQ(NearEndOf(axis, 0, 100, 3, 95), (Extreme{2.0, kHere}));
    EXPECT_EQ(NearEndOf(axis, 0, 100, 5, 99), (Extreme{4.0, kHere}));
    EXPECT_EQ(NearEndOf(axis, 0, 100, 0, 99), (Extreme{5.0, kHere}));
    EXPECT_EQ(NearEndOf(axis, 0, 100, -0.001, 50), none);
    EXPECT_EQ(NearEndOf(axis, 0, 100, 50, 100.001), none);
  }
  for (const std::size_t axis : {3u, 4u}) {
    EXPECT_EQ(NearEndOf(axis, 0, 2, kEndZone_rad, 1), none);
    EXPECT_EQ(NearEndOf(axis, 0, 2, 0.5 * kEndZone_rad, 1), (Extreme{0.5 * kEndZone_rad, kHere}));
    EXPECT_NEAR(NearEndOf(axis, 0, 2, 1, 1.99).value, kEndZone_rad - 0.01, 1e-12);
    EXPECT_EQ(NearEndOf(axis, 0, 2, -0.001, 1), none);
  }
}

// An axis with no more than four such zones has no middle to keep to.
TEST(ContourLog, AnAxisOfHardlyAnyTravelHasNoEnds) {
  EXPECT_EQ(NearEndOf(0, 0, 20, 1, 10), Extreme{});
  EXPECT_EQ(NearEndOf(0, 0, 20.5, 1, 10), (Extreme{4.0, kHere}));
  EXPECT_EQ(NearEndOf(4, 0, 4 * kEndZone_rad, 0, 0.01), Extreme{});
  EXPECT_EQ(NearEndOf(4, 0, 4.5 * kEndZone_rad, 0, 0.01), (Extreme{kEndZone_rad, kHere}));
}

// A beam that is on for no time is no contour.
TEST(ContourLog, NoTimeIsNoContour) {
  ContourLog log(Laser());
  log.BeamOn(SimTime(5), kHere);
  EXPECT_TRUE(Written(log).contours.empty());
  log.BeamOff();
  log.Step();
  EXPECT_EQ(Written(log).cut_figures, CutFigures{});
  log.BeamOn(SimTime(7), kHere);
  AddCut(log, {});
  const RunReport report = Written(log);
  ASSERT_EQ(report.contours.size(), 1u);
  EXPECT_EQ(report.contours[0].begin, SimTime(7));
  EXPECT_EQ(report.cut_figures.contours, 1u);
}

// motion.md 8.1: the contour that a halt interrupts goes on; a step, a way without beam, or the
// beam that goes on elsewhere ends it.
TEST(ContourLog, AHaltAloneDoesNotEndAContour) {
  const auto contours = [](auto between) {
    ContourLog log(Laser());
    log.BeamOn(SimTime(0), kHere);
    AddCut(log, {});
    log.BeamOff();
    between(log);
    log.BeamOn(SimTime(9), kHere);
    AddCut(log, {});
    return Written(log).contours.size();
  };
  EXPECT_EQ(contours([](ContourLog& log) { log.Halt(); }), 1u);
  EXPECT_EQ(contours([](ContourLog& log) { log.Halt(), log.Step(); }), 1u);
  EXPECT_EQ(contours([](ContourLog&) {}), 2u);
  EXPECT_EQ(contours([](ContourLog& log) { log.Step(), log.Halt(); }), 2u);
  EXPECT_EQ(contours([](ContourLog& log) { log.Travel(); }), 2u);
  EXPECT_EQ(contours([](ContourLog& log) { log.Halt(), log.Travel(); }), 2u);
}

// A halt while the beam is on takes nothing away.
TEST(ContourLog, AHaltOrAStepWithTheBeamOnEndsNothing) {
  ContourLog log(Laser());
  log.BeamOn(SimTime(0), kHere);
  AddCut(log, {});
  log.Halt();
  log.Step();
  AddCut(log, {});
  ASSERT_EQ(Written(log).contours.size(), 1u);
  EXPECT_EQ(Written(log).contours[0].length_mm, 20.0);
  EXPECT_EQ(Written(log).contours[0].time, FromSeconds(2.0));
}

// One stand: a tip about which the head turns, what it settles, and a dwell. A way ends it, and so
// does the beam; the first place counts.
TEST(ContourLog, AStandHasAllThatStands) {
  const machine::Place second{.program = 1, .step = 4};
  ContourLog log(Laser());
  log.BeamOn(SimTime(0), kHere);
  AddCut(log, {.length_mm = 10.0, .seconds = 1.0, .settling_s = 0.25, .place = kHere});
  AddCut(log, {.length_mm = 0.0, .seconds = 1.0, .settling_s = 0.25, .place = second});
  WorkFigures work;
  work.beam_on = FromSeconds(0.5);
  log.Add({.place = second, .beam_on = true, .power_percent = 50.0}, work, false);
  EXPECT_EQ(Written(log).cut_figures.standing_s, (Extreme{2.0, kHere}));
  // No power, no stand; a piercing is none.
  log.Add({.place = second, .beam_on = true, .power_percent = 0.0}, work, false);
  log.Add({.place = second, .beam_on = true, .power_percent = 50.0}, work, true);
  EXPECT_EQ(Written(log).cut_figures.standing_s, (Extreme{2.0, kHere}));
  AddCut(log, {.length_mm = 10.0, .settling_s = 1.75, .place = second});
  EXPECT_EQ(Written(log).cut_figures.standing_s, (Extreme{2.0, kHere}));
  log.BeamOff();
  log.Halt();
  log.BeamOn(SimTime(9), kHere);
  log.Add({.place = second, .beam_on = true, .power_percent = 50.0}, work, false);
  EXPECT_EQ(Written(log).cut_figures.standing_s, (Extreme{2.0, kHere}));
  EXPECT_EQ(Written(log).contours.size(), 1u);
}

// motion.md 2.5: of a range of B from -1 to 3 degrees half lies within 1 degree of straight down,
// and so half of what A turns meanwhile.
TEST(ContourLog, TurningNearStraightDown) {
  const double degree = kRadPerDegree;
  const auto swing = [](double b_low, double b_high) {
    ContourLog log(Laser());
    log.BeamOn(SimTime(0), kHere);
    AddCut(log, {.rotary = {SweepOf(0.0, 0.5), SweepOf(b_low, b_high)}});
    return Written(log).cut_figures.singular_rad.value;
  };
  EXPECT_NEAR(swing(-degree, 3.0 * degree), 0.25, 1e-12);
  EXPECT_NEAR(swing(-3.0 * degree, degree), 0.25, 1e-12);
  EXPECT_NEAR(swing(-4.0 * degree, 4.0 * degree), 0.125, 1e-12);
  EXPECT_NEAR(swing(-0.5 * degree, 0.5 * degree), 0.5, 1e-12);
  EXPECT_EQ(swing(degree, degree), 0.5);
  EXPECT_EQ(swing(-degree, -degree), 0.5);
  EXPECT_EQ(swing(1.001 * degree, 2.0 * degree), 0.0);
  EXPECT_EQ(swing(-2.0 * degree, -1.001 * degree), 0.0);
}

}  // namespace
}  // namespace rmlcell::simulation
