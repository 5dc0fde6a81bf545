// Figures of a run at their edges: stretches, stands, gaps, ends of the travel. docs/verdict.md.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/simulation/report/contour_log.h"
#include "engine/simulation/report/cut_pace.h"
#include "engine/simulation/report/move_speeds.h"
#include "engine/simulation/report/time_ledger.h"
#include "engine/simulation/report/violation_list.h"
#include "engine/simulation/toolpath/toolpath_writer.h"
#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

constexpr machine::Place kStepOne{.program = 2, .step = 1};
constexpr machine::Place kStepTwo{.program = 2, .step = 2};
// 64 % at 32 mm/s, and 2 % by mm/s at any speed.
constexpr machine::PowerBySpeed kEvenPower{.constant_percent = 64.0};
constexpr machine::PowerBySpeed kSlopedPower{.percent_per_mm_s = 2.0};

// Where no speed is asked for a ramp still asks for its slope, and a constant for nothing.
TEST(PaceEdges, WithoutASpeedARampAsksForItsSlope) {
  CutPace pace;
  pace.Begin(0.0, kSlopedPower, kStepOne);
  EXPECT_EQ(pace.bounds(), (std::array{0.0, 0.0, 100.0 / (kWeakEnergy * 2.0)}));
  pace.Begin(0.0, kEvenPower, kStepOne);
  EXPECT_EQ(pace.bounds(), (std::array{0.0, 0.0, 0.0}));
}

// A speed below 1 mm/s is one as any other: 128 % by mm/s are asked for, hot is above 192.
TEST(PaceEdges, SlowSpeedsAreSpeeds) {
  CutPace pace;
  pace.Begin(0.5, kEvenPower, kStepOne);
  EXPECT_EQ(pace.bounds(), (std::array{kSlowSpeed * 0.5, 64.0 / 192.0, 0.0}));
  pace.Add(4.0, 0.25, 64.0);
  EXPECT_EQ(pace.slow_mm(), 1.0);
  CutFigures figures;
  pace.Close(figures);
  EXPECT_EQ(figures.uncontrolled_mm, Extreme{});
  EXPECT_EQ(figures.hot_mm, (Extreme{.value = 1.0, .place = kStepOne}));
}

// 1.125 % by mm/s are asked for, of which half as much again is less than 1 above the slope.
TEST(PaceEdges, AHotSpeedOfALittleMoreThanTheSlope) {
  CutPace pace;
  pace.Begin(40.0, {.constant_percent = 5.0, .percent_per_mm_s = 1.0}, kStepOne);
  EXPECT_EQ(pace.bounds()[1], 5.0 / (1.5 * 1.125 - 1.0));
}

// A stretch has the place where it began, however short its first part is.
TEST(PaceEdges, AShortBeginGivesThePlace) {
  CutFigures figures;
  CutPace pace;
  const auto pass = [&](double programmed, const machine::PowerBySpeed& power,
                        const machine::Place& place, double mm, double given) {
    pace.Begin(programmed, power, place);
    pace.Add(mm / 16.0, 16.0, given);
  };
  pass(32.0, kEvenPower, kStepOne, 0.5, 64.0);
  pass(32.0, kEvenPower, kStepTwo, 8.0, 64.0);
  pace.Close(figures);
  EXPECT_EQ(figures.hot_mm, (Extreme{.value = 8.5, .place = kStepOne}));
  pass(64.0, kSlopedPower, kStepTwo, 0.5, 16.0);
  pass(64.0, kSlopedPower, kStepOne, 8.0, 16.0);
  pace.Close(figures);
  EXPECT_EQ(figures.weak_mm, (Extreme{.value = 8.5, .place = kStepTwo}));
  pass(0.0, kEvenPower, kStepOne, 0.25, 64.0);
  pass(0.0, kEvenPower, kStepTwo, 0.5, 64.0);
  pace.Close(figures);
  EXPECT_EQ(figures.uncontrolled_mm, (Extreme{.value = 0.75, .place = kStepOne}));
  pass(0.0, kEvenPower, kStepTwo, 4.0, 64.0);
  pace.Close(figures);
  EXPECT_EQ(figures.uncontrolled_mm, (Extreme{.value = 4.75, .place = kStepOne}));
}

CutFigures FiguresOfCuts(const ContourLog& log) {
  RunReport report;
  log.WriteTo(report);
  return report.cut_figures;
}

// What a cut of some millimetres at 32 mm/s adds, `slow_mm` of it below 0.8 of that.
void AddPaced(ContourLog& log, double length_mm, double slow_mm, const PointSweep& column = {}) {
  const machine::MotionDone done{
      .place = kStepOne, .programmed_mm_s = 32.0, .power = {.constant_percent = 50.0}};
  CutPace* const pace = log.PaceOf(done);
  pace->Add(1.0, slow_mm, 50.0);
  WorkFigures work;
  work.cut_mm = length_mm;
  work.time.motion = FromSeconds(1.0);
  work.beam_on = FromSeconds(1.0);
  log.Add({.done = done, .work = work, .column = column, .rotary = {}});
}

// A point of 0.01 mm has no speed to keep; anything longer has.
TEST(ContourEdges, APointHasNoSpeed) {
  const auto slow_percent = [](double mm) {
    ContourLog log(Laser());
    AddPaced(log, mm, mm);
    return FiguresOfCuts(log).slow_percent.value;
  };
  EXPECT_EQ(slow_percent(0.01), 0.0);
  EXPECT_NEAR(slow_percent(0.0101), 100.0, 1e-9);
  EXPECT_NEAR(slow_percent(5.0), 100.0, 1e-9);
}

// motion.md section 1: a millionth beyond the end is rounding, and all of the zone is passed.
TEST(ContourEdges, RoundingBeyondTheEndIsTheEnd) {
  const auto near = [](double least) {
    machine::MachineShape shape = Laser();
    for (std::size_t i = 0; i < motion::kAxisCount; ++i) {
      shape.limits->axes.travel_min[i] = -1000.0;
      shape.limits->axes.travel_max[i] = 1000.0;
    }
    shape.limits->axes.travel_min[1] = 0.0;
    ContourLog log(shape);
    PointSweep column{};
    column[1] = {.minimum = least, .maximum = 50.0, .travel = 50.0 - least};
    AddPaced(log, 50.0, 0.0, column);
    return FiguresOfCuts(log).near_end[1].value;
  };
  EXPECT_NEAR(near(-1e-6), kEndZone_mm + 1e-6, 1e-12);
  EXPECT_EQ(near(-1.0001e-6), 0.0);
  EXPECT_EQ(near(kEndZone_mm), 0.0);
}

// Time that the beam is on without a motion or a wait is time of its contour.
TEST(ContourEdges, UntoldTimeBelongsToTheContour) {
  ContourLog log(Laser());
  log.BeamOn(SimTime(3), kStepOne);
  WorkFigures work;
  work.beam_on = FromSeconds(0.5);
  work.pierce_energy_j = 40.0;
  log.Add(work);
  RunReport report;
  log.WriteTo(report);
  ASSERT_EQ(report.contours.size(), 1u);
  EXPECT_EQ(report.contours[0].time, FromSeconds(0.5));
  EXPECT_EQ(report.contours[0].energy_j(), 40.0);
  EXPECT_EQ(report.cut_figures.energy_max_j, 40.0);
}

// Who tells of a cut, or of a wait with the beam on, that nobody switched on begins a contour then.
TEST(ContourEdges, ABeamThatNobodySwitchedOnBeginsAContour) {
  ContourLog log(Laser());
  const machine::MotionDone done{.start = SimTime(7), .place = kStepTwo, .programmed_mm_s = 32.0};
  log.PaceOf(done)->Add(1.0, 32.0, 50.0);
  WorkFigures work;
  work.cut_mm = 32.0;
  work.beam_on = FromSeconds(1.0);
  log.Add({.done = done, .work = work, .column = {}, .rotary = {}});
  log.Travel();
  log.Add({.start = SimTime(9), .place = kStepOne, .beam_on = true, .power_percent = 5.0}, work,
          false);
  RunReport report;
  log.WriteTo(report);
  ASSERT_EQ(report.contours.size(), 2u);
  EXPECT_EQ(report.contours[0].place, kStepTwo);
  EXPECT_EQ(report.contours[0].begin, SimTime(7));
  EXPECT_EQ(report.contours[0].length_mm, 32.0);
  EXPECT_EQ(report.contours[1].place, kStepOne);
  EXPECT_EQ(report.contours[1].begin, SimTime(9));
}

class LedgerEdges : public testing::Test {
 protected:
  static TimeLedger::Gap AtStep(int step) { return {.place = {.program = 1, .step = step}}; }
  SimTime TimeOf(int step) const {
    SimTime sum{0};
    for (const TimeLedger::Gap& gap : told_) {
      if (gap.place.step == step) sum += gap.length();
    }
    return sum;
  }
  std::vector<TimeLedger::Gap> told_;
  TimeLedger ledger_{[this](const TimeLedger::Gap& gap) { told_.push_back(gap); }};
};

// More gaps than are kept open: the oldest are counted, and each once, at its own place.
TEST_F(LedgerEdges, EachOfManyGapsIsCountedOnce) {
  constexpr int kGaps = 40;
  std::int64_t until = 0;
  for (int step = 1; step <= kGaps; ++step) ledger_.Leave(SimTime(until += step), AtStep(step));
  EXPECT_FALSE(told_.empty());
  EXPECT_LT(told_.size(), static_cast<std::size_t>(kGaps));
  ledger_.Close();
  ASSERT_EQ(told_.size(), static_cast<std::size_t>(kGaps));
  for (int step = 1; step <= kGaps; ++step) EXPECT_EQ(TimeOf(step), SimTime(step));
  ledger_.Close();
  EXPECT_EQ(told_.size(), static_cast<std::size_t>(kGaps));
  EXPECT_EQ(ledger_.counted(), SimTime(kGaps * (kGaps + 1) / 2));
}

// A claim may begin behind a gap, end before one, lie over several or over none.
TEST_F(LedgerEdges, AClaimTakesWhatLiesUnderIt) {
  ledger_.Leave(SimTime(10), AtStep(1));
  ledger_.Leave(SimTime(20), AtStep(2));
  ledger_.Leave(SimTime(30), AtStep(3));
  EXPECT_EQ(ledger_.Claim(SimTime(15), SimTime(24), AtStep(3)), SimTime(9));
  EXPECT_EQ(ledger_.Claim(SimTime(15), SimTime(24), AtStep(3)), SimTime(0));
  EXPECT_EQ(ledger_.Claim(SimTime(2), SimTime(5), AtStep(3)), SimTime(3));
  EXPECT_EQ(ledger_.Claim(SimTime(26), SimTime(41), AtStep(3)), SimTime(15));
  EXPECT_EQ(ledger_.Claim(SimTime(44), SimTime(50), AtStep(4)), SimTime(6));
  ledger_.Close();
  EXPECT_EQ(TimeOf(1), SimTime(7));
  EXPECT_EQ(TimeOf(2), SimTime(5));
  EXPECT_EQ(TimeOf(3), SimTime(2));
  EXPECT_EQ(TimeOf(4), SimTime(3));
  EXPECT_EQ(ledger_.counted(), SimTime(50));
}

// A motion without a way ends its move; what only goes on standing at its end does not end it
// again.
TEST(MoveEdges, AMotionWithoutAWayEndsItsMove) {
  motion::PlannedMotion motion;
  motion.path = motion::PathPiece::Line({{3, 4, 5}}, {{3, 4, 5}});
  motion.ends_move = true;
  EXPECT_TRUE(EndsMove({.motion = &motion, .from = 0.0, .travelled = 0.0}));
  motion.path = motion::PathPiece::Line({{3, 4, 5}}, {{3, 4, 15}});
  EXPECT_TRUE(EndsMove({.motion = &motion, .from = 4.0, .travelled = 10.0}));
  EXPECT_FALSE(EndsMove({.motion = &motion, .from = 10.0, .travelled = 10.0}));
  EXPECT_FALSE(EndsMove({.motion = &motion, .from = 0.0, .travelled = 9.0}));
  motion.ends_move = false;
  EXPECT_FALSE(EndsMove({.motion = &motion, .from = 4.0, .travelled = 10.0}));
}

// Of two as far beyond the travel the first one is kept with its time.
TEST(ViolationEdges, TheFirstOfTheWorstStays) {
  ViolationList list;
  const auto add = [&](double excess, int at_s) {
    list.Add({.at = FromSeconds(at_s),
              .place = kStepOne,
              .axis = 1,
              .excess = excess,
              .tip = {{1.0 * at_s, 0, 0}}});
  };
  add(2.0, 1);
  add(2.0, 5);
  add(1.0, 6);
  ASSERT_EQ(list.violations().size(), 1u);
  EXPECT_EQ(list.violations()[0].count, 3u);
  EXPECT_EQ(list.violations()[0].tip.x(), 1.0);
  add(3.0, 8);
  EXPECT_EQ(list.violations()[0].tip.x(), 8.0);
  EXPECT_EQ(list.violations()[0].first_at, FromSeconds(1));
  EXPECT_EQ(list.violations()[0].excess, 3.0);
}

// A run that is opened and ended at once takes no time from the one whose last point it shares.
TEST(WriterEdges, AnEmptyRunLeavesTheTimesOfTheOneBefore) {
  std::vector<ToolpathBlock> blocks;
  ToolpathWriter writer(1 << 20, [&](std::string_view bytes) {
    auto block = DecodeToolpathBlock(bytes);
    EXPECT_TRUE(block);
    if (block) blocks.push_back(*std::move(block));
    return true;
  });
  writer.Open({.step = 1}, {0, 0, 0});
  writer.Add({10, 0, 0}, 90'000);
  writer.Add({20, 0, 0}, 100'000);
  writer.EndAt(100'000);
  writer.Open({.step = 2, .start_us = 100'000}, {20, 0, 0});
  writer.EndAt(700'000);
  writer.Finish();
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(blocks[0].reached_us, (std::vector<std::int64_t>{0, 90'000, 100'000}));
}

// A tip that stands while the head turns reaches its points evenly, by their number: such times
// need not be written.
TEST(WriterEdges, PointsOfAStandingTipAreEven) {
  ToolpathBlock block;
  for (const int urad : {0, 100, 200, 300}) block.points.push_back({5, 6, 7, urad, 0});
  block.reached_us = {0, 30'000, 60'000, 90'000};
  block.runs.push_back({.step = 1, .start_us = 0, .end_us = 90'000, .point_count = 4});
  const std::string even = EncodeToolpathBlock(block);
  const auto back = DecodeToolpathBlock(even);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->reached_us, block.reached_us);
  block.reached_us = {0, 10'000, 20'000, 90'000};
  const std::string uneven = EncodeToolpathBlock(block);
  EXPECT_LT(even.size(), uneven.size());
  EXPECT_EQ(DecodeToolpathBlock(uneven)->reached_us, block.reached_us);
}

}  // namespace
}  // namespace rmlcell::simulation
