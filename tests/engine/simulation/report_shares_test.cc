// To whom a report gives what it counts: the way to the step where a run begins, the shutter, a
// halt that is over, programs that do not move.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/simulation/report/contour_log.h"
#include "engine/simulation/report/report_recorder.h"
#include "engine/simulation/report/samples.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

using machine::Signal;
using machine::WaitKind;

// On its way to a step, five seconds after it began.
class RunOnItsWay final : public machine::Run {
 public:
  machine::RunPhase Advance(SimTime) override { return machine::RunPhase::kFinished; }
  void Apply(const machine::InputChange&) override {}
  void End(machine::OutcomeKind, ErrorCode) override {}
  machine::RunState state() const override {
    machine::RunState state;
    state.time = FromSeconds(5.0);
    state.approaching = true;
    return state;
  }
  const machine::Outcome& outcome() const override { return outcome_; }
  std::uint64_t steps_executed() const override { return 4; }
  std::unique_ptr<machine::RunSnapshot> Save() const override { return nullptr; }
  void Restore(const machine::RunSnapshot&) override {}

 private:
  machine::Outcome outcome_;
};

// LIVE-6.09: waits and halts on the way to the step are nobody's; from there on all counts.
TEST(ReportShares, TheWayToTheStepIsNobodys) {
  const RunOnItsWay run;
  const machine::Place place{.program = 1, .step = 2};
  const auto wait = [&](double from, double to) {
    return machine::Wait{.start = FromSeconds(from), .end = FromSeconds(to), .place = place};
  };
  for (const bool comes : {true, false}) {
    ReportRecorder recorder({});
    recorder.Begin(run);
    recorder.OnWait(wait(5.0, 6.0));
    recorder.OnHalt({.at = FromSeconds(6.0), .place = place});
    recorder.OnResume(FromSeconds(7.0), place);
    recorder.OnHalt({.at = FromSeconds(7.5), .place = place});
    if (comes) {
      recorder.OnEntered(FromSeconds(8.0));
      recorder.OnWait(wait(9.0, 10.0));
      recorder.OnHalt({.at = FromSeconds(10.0), .place = place});
      recorder.OnResume(FromSeconds(10.5), place);
      recorder.OnWait(wait(11.0, 12.0));
    }
    recorder.Finish(FromSeconds(12.0));
    const RunReport report = recorder.Report(run);
    EXPECT_EQ(report.halts, comes ? 1U : 0U);
    EXPECT_EQ(report.cycle_time, FromSeconds(comes ? 4.0 : 0.0));
    EXPECT_EQ(report.total.time.dwell, FromSeconds(comes ? 2.0 : 0.0));
    EXPECT_EQ(report.total.time.operator_wait, FromSeconds(comes ? 0.5 : 0.0));
    EXPECT_EQ(report.total.time.standstill, FromSeconds(comes ? 1.5 : 0.0));
    EXPECT_EQ(report.steps_executed, 0U);
  }
}

RunReport ReportOfScript(const Script& script, const machine::MachineShape& shape,
                         const machine::InputScript& inputs = {}) {
  ReportRecorder recorder(shape);
  FakeRun run(script, recorder, inputs);
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  return recorder.Report(run);
}

// OPT-3.14: the shutter is open while a step moves or waits, and each of them has its share
// of that, however late it was opened.
TEST(ReportShares, EachStepHasItsShareOfTheShutter) {
  const motion::PathLimits slow{.speed = 10.0, .acceleration = 10.0};
  Script script;
  script.Step(3, 1).Wait(WaitKind::kDwell, 7.0).Signal(Signal::kShutter, 1);
  script.Step(3, 2).Motion(Planned(LineFrom({}, {10, 0, 0}), slow));  // 2 s
  script.Step(3, 3).Wait(WaitKind::kDwell, 1.0);
  script.Step(3, 4).Signal(Signal::kShutter, 0).Wait(WaitKind::kDwell, 4.0);
  const RunReport report = ReportOfScript(script, Laser());
  ASSERT_EQ(report.steps.size(), 4U);
  const double expected[] = {0.0, 2.0, 1.0, 0.0};
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(report.steps[k].figures.shutter_open, FromSeconds(expected[k])) << k;
  EXPECT_EQ(report.total.shutter_open, FromSeconds(3.0));
}

// OPT-3.14: who tells again that it is open opens nothing, also behind time that nobody told about;
// who tells again that it is closed closes nothing, and an output is no shutter.
TEST(ReportShares, AShutterThatIsToldAgainIsTheSame) {
  Script script;
  script.Step(3, 1).Signal(Signal::kShutter, 1).Nothing(2.0).Signal(Signal::kShutter, 1);
  script.Wait(WaitKind::kDwell, 1.0).Signal(Signal::kShutter, 0);
  script.Signal(Signal::kOutput, 1, 0, 16).Wait(WaitKind::kDwell, 4.0);
  script.Signal(Signal::kShutter, 0).Signal(Signal::kOutput, 0, 0, 16);
  const RunReport report = ReportOfScript(script, Laser());
  EXPECT_EQ(report.total.shutter_open, FromSeconds(3.0));
}

// motion.md 8.1: a beam that is on and gets another power is switched on once, pierces once, and
// cuts one contour; one that is off and is switched off is nothing at all.
TEST(ReportShares, ABeamThatIsToldAgainIsTheSame) {
  Script script;
  script.Step(1, 1).Signal(Signal::kBeam, 0).Signal(Signal::kBeam, 1, 100);
  script.Wait(WaitKind::kPierce, 1.0, true, 100.0).Signal(Signal::kBeam, 1, 50);
  script.Wait(WaitKind::kDwell, 0.5, true, 50.0).Signal(Signal::kBeam, 0).Step(1, 2);
  const RunReport report = ReportOfScript(script, Laser());
  EXPECT_EQ(report.total.beam_switches, 1U);
  EXPECT_EQ(report.total.pierces, 1U);
  EXPECT_NEAR(report.total.pierce_energy_j, 1500.0 * 1.0 + 750.0 * 0.5, 1e-9);
  ASSERT_EQ(report.contours.size(), 1U);
  EXPECT_EQ(report.contours[0].begin, SimTime(0));
  EXPECT_EQ(report.contours[0].time, FromSeconds(1.5));
}

// motion.md 8.2: a laser cuts with its beam, whatever a motion is for; a tool that nowhere takes
// material off neither cuts nor plunges.
TEST(ReportShares, WhatTakesNothingOffIsTravel) {
  const machine::MotionUse uses[] = {machine::MotionUse::kCut, machine::MotionUse::kPlunge};
  const motion::PlannedMotion planned = Planned(LineFrom({}, {10, 0, 0}));
  for (const machine::MotionUse use : uses) {
    const RunReport dark =
        ReportOfScript(Script().Step(1, 1).Line({}, {10, 0, 0}, {.use = use}), Laser());
    Script above;
    above.Step(1, 1).Part(planned, {.use = use, .travelled = 10.0, .in_work = false},
                          FromSeconds(planned.duration_s()));
    const RunReport skimmed = ReportOfScript(above, {});
    for (const RunReport* report : {&dark, &skimmed}) {
      EXPECT_EQ(report->total.cut_mm, 0.0);
      EXPECT_NEAR(report->total.travel_mm, 10.0, 1e-12);
      EXPECT_TRUE(report->cut.empty());
    }
    EXPECT_EQ(skimmed.total.plunges, 0U);
    EXPECT_EQ(skimmed.total.plunge_mm, 0.0);
  }
}

// A report on the way has the shutter up to what was told.
TEST(ReportShares, AnOpenShutterCountsUpToNow) {
  Script script;
  script.Step(3, 1).Wait(WaitKind::kDwell, 7.0).Signal(Signal::kShutter, 1);
  script.Step(3, 2).Wait(WaitKind::kDwell, 1.0).Nothing(0.5).Step(3, 3);
  script.Wait(WaitKind::kDwell, 9.0);
  ReportRecorder recorder(Laser());
  FakeRun run(script, recorder);
  run.Advance(FromSeconds(8.75));
  EXPECT_EQ(recorder.Report(run).total.shutter_open, FromSeconds(1.5));
  run.Advance(kForever);
  EXPECT_EQ(recorder.Report(run).total.shutter_open, FromSeconds(10.5));
  recorder.Finish(run.state().time);
  EXPECT_EQ(recorder.Report(run).total.shutter_open, FromSeconds(10.5));
}

// Opened a second time it is counted anew.
TEST(ReportShares, AShutterThatOpensAgainCountsAnew) {
  Script script;
  script.Step(3, 1).Signal(Signal::kShutter, 1).Wait(WaitKind::kDwell, 4.0);
  script.Signal(Signal::kShutter, 0).Wait(WaitKind::kDwell, 2.0);
  script.Step(3, 2).Signal(Signal::kShutter, 1).Wait(WaitKind::kDwell, 1.0);
  script.Step(3, 3).Signal(Signal::kShutter, 0);
  const RunReport report = ReportOfScript(script, Laser());
  EXPECT_EQ(report.steps.at(0).figures.shutter_open, FromSeconds(4.0));
  EXPECT_EQ(report.steps.at(1).figures.shutter_open, FromSeconds(1.0));
  EXPECT_EQ(report.total.shutter_open, FromSeconds(5.0));
}

// A motion of the way to a step is of no program, and no cut.
TEST(ReportShares, AMotionOfTheWayIsNobodys) {
  const motion::PlannedMotion planned = Planned(LineFrom({}, {100, 0, 0}));
  ReportRecorder recorder({});
  recorder.OnMotion({.end = FromSeconds(2.0),
                     .use = machine::MotionUse::kCut,
                     .motion = &planned,
                     .travelled = 100.0,
                     .approach = true});
  FakeRun run(Script().Step(1, 1), recorder);
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.total.tip_path_mm, 0.0);
  EXPECT_EQ(report.cycle_time, SimTime(0));
  EXPECT_TRUE(report.tip.empty());
}

// What a machine looks ahead is a figure of its family, and where it stands at the end its own.
TEST(ReportShares, TheEndIsThatOfTheRun) {
  Script script;
  script.figures = {{.name = "other", .value = 3.0}, {.name = "lookahead_starved", .value = 17.0}};
  script.Step(1, 1).Line({}, {1, 2, 3});
  ReportRecorder recorder({});
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.lookahead_starved, 17U);
  EXPECT_EQ(report.final_position.tip.tip, (motion::MachinePoint{1, 2, 3}));
  EXPECT_EQ(report.final_position.axes.column, (motion::MachinePoint{1, 2, 3}));
}

// motion.md 8.2: the last point as the program wrote it, its rotary axis in the program's own unit.
TEST(ReportShares, TheLastPointIsAsWritten) {
  ReportRecorder recorder({});
  recorder.OnMove({.place = {.program = 1, .step = 1},
                   .tip = {{1, 2, 3}, 0.25, 0.5},
                   .program_point = {7, 8, 9},
                   .rotary_a = 0.75});
  FakeRun run(Script().Step(1, 1), recorder);
  const FinalPosition last = recorder.Report(run).final_position;
  EXPECT_EQ(last.program_point, (motion::ProgramPoint{7, 8, 9}));
  EXPECT_EQ(last.program_a, 0.75);
  EXPECT_EQ(last.program_b, 0.5);
}

// What has no room in a report is counted.
TEST(ReportShares, WhatHasNoRoomIsCounted) {
  ReportRecorder recorder(Laser());
  motion::PlannedMotion slow;
  slow.path = LineFrom({}, {10, 0, 0});
  slow.ends_move = true;
  slow.speed = motion::SpeedProfile::Steady(10.0, 5.0);
  const int steps = static_cast<int>(kReportedSlowMovesMax) + 3;
  for (int step = 1; step <= steps; ++step) {
    const machine::Place place{.program = 1, .step = step};
    recorder.OnMotion({.start = FromSeconds(2.0 * step),
                       .end = FromSeconds(2.0 * step + 2.0),
                       .place = place,
                       .motion = &slow,
                       .travelled = 10.0,
                       .programmed_mm_s = 50.0});
    recorder.OnViolation({.place = place, .axis = 1, .excess = 2.0});
  }
  FakeRun run(Script().Step(1, 1), recorder);
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.slow_moves.size(), kReportedSlowMovesMax);
  EXPECT_EQ(report.slow_moves_dropped, 3U);
  EXPECT_EQ(report.violations.size(), kReportedViolationsMax);
  EXPECT_EQ(report.violations_dropped, static_cast<std::uint64_t>(steps) - kReportedViolationsMax);
}

// Behind a halt that is over time is the machine's again.
TEST(ReportShares, BehindAHaltItStandsByItself) {
  Script script;
  script.Step(1, 1).Halt("STOP").Step(1, 2).Nothing(0.75);
  const RunReport report =
      ReportOfScript(script, {}, {{FromSeconds(4.0), machine::InputKind::kStart, 0, 1.0}});
  EXPECT_EQ(report.total.time.operator_wait, FromSeconds(4.0));
  EXPECT_EQ(report.total.time.standstill, FromSeconds(0.75));
}

// A program that neither moves nor has the beam has its steps and times, and figures of nothing.
TEST(ReportShares, AProgramThatDoesNotMoveHasNoFigures) {
  Script script;
  script.Step(1, 1).Line({}, {100, 0, 0}, {.use = machine::MotionUse::kCut, .beam_on = true});
  script.Step(2, 1).Wait(WaitKind::kDwell, 3.0);
  script.Step(1, 2).Line({100, 0, 0}, {0, 0, 0});
  const RunReport report = ReportOfScript(script, Laser());
  const ScopeFigures& still = report.programs.at(2);
  EXPECT_EQ(still.total.time.dwell, FromSeconds(3.0));
  EXPECT_EQ(still.total.steps, 1U);
  EXPECT_TRUE(still.axes.empty());
  EXPECT_TRUE(still.tip.empty());
  EXPECT_EQ(still.corners, CornerFigures{});
  EXPECT_EQ(still.beam, BeamHistogram{});
  EXPECT_EQ(report.programs.at(1).axes.size(), 5U);
}

// motion.md 8.1: between what burnt and what burns again the beam is off.
TEST(ReportShares, BetweenTwoPiercingsItIsDark) {
  std::string text;
  SampleRecorder recorder({}, 2.0, [&](std::string_view lines) {
    text += lines;
    return true;
  });
  recorder.StandsAt({{1, 2, 3}, 0.0, 0.0}, {});
  Script script;
  script.Step(1, 1).Wait(WaitKind::kPierce, 1.0, true, 50.0);
  script.Step(1, 2).Nothing(1.0);
  script.Step(1, 3).Wait(WaitKind::kPierce, 1.0, true, 25.0);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  std::string powers;
  for (std::size_t at = text.find('\n') + 1; at < text.size(); at = text.find('\n', at) + 1) {
    std::size_t column = at;
    for (int k = 0; k < 10; ++k) column = text.find(',', column) + 1;
    powers += text.substr(column, text.find(',', column) - column) + ' ';
  }
  EXPECT_EQ(powers, "50.0000 50.0000 0.0000 0.0000 25.0000 25.0000 0.0000 ");
}

// docs/verdict.md: what is slow of both ramps is left out, also of a tip that hardly accelerates:
// at 0.5 mm/s2 the way to 0.8 of 1 mm/s is 0.64 mm.
TEST(ReportShares, RampsThatHardlyAccelerateAreLeftOut) {
  machine::MachineShape shape = Laser();
  shape.limits->tip_speed_mm_s = 100.0;
  shape.limits->tip_acceleration_mm_s2 = 0.5;
  shape.limits->tip_jerk_mm_s3 = HUGE_VAL;
  ContourLog log(shape);
  const machine::Place place{.program = 3, .step = 1};
  log.BeamOn(SimTime(0), place);
  const machine::MotionDone done{
      .place = place, .programmed_mm_s = 1.0, .power = {.constant_percent = 50.0}};
  CutPace* const pace = log.PaceOf(done);
  pace->Add(10.0, 0.5, 50.0);
  pace->Add(5.0, 1.0, 50.0);
  WorkFigures work;
  work.cut_mm = 10.0;
  work.beam_on = FromSeconds(15.0);
  log.Add({.done = done, .work = work, .column = {}, .rotary = {}});
  RunReport report;
  log.WriteTo(report);
  EXPECT_NEAR(report.cut_figures.slow_percent.value, 10.0 * (5.0 - 2.0 * 0.64), 1e-9);
}

// A wait with the beam that nobody switched on begins a contour, too; and a machine that tells no
// limits has no ends of travel to be near to.
TEST(ReportShares, AWaitBeginsAContour) {
  ContourLog log(machine::MachineShape{});
  const machine::Place place{.program = 3, .step = 7};
  WorkFigures work;
  work.beam_on = FromSeconds(2.0);
  work.pierce_energy_j = 1500.0;
  log.Add({.start = FromSeconds(3.0),
           .end = FromSeconds(5.0),
           .place = place,
           .kind = WaitKind::kPierce,
           .beam_on = true,
           .power_percent = 50.0},
          work, true);
  WorkFigures cut;
  cut.cut_mm = 10.0;
  cut.beam_on = FromSeconds(1.0);
  const machine::MotionDone done{.place = place, .power = {.constant_percent = 50.0}};
  log.Add({.done = done, .work = cut, .column = {}, .rotary = {}});
  RunReport report;
  log.WriteTo(report);
  ASSERT_EQ(report.contours.size(), 1U);
  EXPECT_EQ(report.contours[0].place, place);
  EXPECT_EQ(report.contours[0].begin, FromSeconds(3.0));
  EXPECT_EQ(report.contours[0].time, FromSeconds(3.0));
  EXPECT_EQ(report.contours[0].pierce_energy_j, 1500.0);
  EXPECT_EQ(report.contours[0].length_mm, 10.0);
  for (const Extreme& near : report.cut_figures.near_end) EXPECT_EQ(near, Extreme{});
}

}  // namespace
}  // namespace rmlcell::simulation
