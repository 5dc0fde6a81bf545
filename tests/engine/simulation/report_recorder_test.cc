#include "engine/simulation/report/report_recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/engine/motion/standard_machine.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using machine::Signal;
using machine::WaitKind;
using motion::MachineVector;
using motion::PathPiece;

RunReport ReportOf(const Script& script, const machine::MachineShape& shape) {
  ReportRecorder recorder(shape);
  FakeRun run(script, recorder);
  EXPECT_EQ(run.Advance(kForever), machine::RunPhase::kFinished);
  recorder.Finish(run.state().time);
  return recorder.Report(run);
}

// One second of ramp up to 10 mm/s, one of ramp down: 10 mm in 2 s. Times by hand.
constexpr motion::PathLimits kSecondRamps{.speed = 10.0, .acceleration = 10.0};

// motion.md 8.2: the parts of the cycle time, each from what was told; standstill is what is left.
TEST(ReportRecorder, CycleTimeIsTheSumOfItsParts) {
  Script script;
  script.Step(1, 1).Motion(Planned(LineFrom({}, {10, 0, 0}), kSecondRamps, 0.048));
  script.Step(1, 2).Wait(WaitKind::kDwell, 0.5).Wait(WaitKind::kPierce, 0.25);
  script.Wait(WaitKind::kCondition, 1.0)
      .Wait(WaitKind::kOperator, 3.0)
      .Wait(WaitKind::kSpinUp, 2.0);
  script.Step(2, 1).Wait(WaitKind::kLoad, 0.125).Nothing(0.75);
  const RunReport report = ReportOf(script, {});
  EXPECT_EQ(report.total.time.motion, FromSeconds(2.0));
  EXPECT_EQ(report.total.time.settling, FromSeconds(0.048));
  EXPECT_EQ(report.total.time.dwell, FromSeconds(0.5));
  EXPECT_EQ(report.total.time.pierce, FromSeconds(0.25));
  EXPECT_EQ(report.total.time.condition, FromSeconds(1.0));
  EXPECT_EQ(report.total.time.operator_wait, FromSeconds(3.0));
  EXPECT_EQ(report.total.time.spin_up, FromSeconds(2.0));
  EXPECT_EQ(report.total.time.load, FromSeconds(0.125));
  EXPECT_EQ(report.total.time.standstill, FromSeconds(0.75));
  EXPECT_EQ(report.cycle_time, FromSeconds(9.673));
  EXPECT_EQ(report.total.time.total(), report.cycle_time);
  EXPECT_EQ(report.steps_executed, 3u);
  EXPECT_EQ(report.total.steps, 3u);
}

// motion.md 8.2: the sum of the step times equals the cycle time; likewise by program.
TEST(ReportRecorder, StepsAndProgramsAddUp) {
  Script script;
  for (int k = 1; k <= 500; ++k) {
    script.Step(1 + k % 3, k, k + 2);
    script.Motion(Planned(LineFrom({}, {0.37 * k, 0.11 * k, 0}), kSlowLimits, 0.048),
                  {.use = k % 2 == 0 ? MotionUse::kCut : MotionUse::kTravel});
    if (k % 5 == 0) script.Wait(WaitKind::kDwell, 0.001 * k);
  }
  const RunReport report = ReportOf(script, {});
  SimTime steps{0};
  double cut = 0.0;
  double path = 0.0;
  for (const StepFigures& step : report.steps) {
    steps += step.figures.time.total();
    cut += step.figures.cut_mm;
    path += step.figures.tip_path_mm;
  }
  SimTime programs{0};
  for (const auto& [slot, figures] : report.programs) programs += figures.total.time.total();
  EXPECT_EQ(report.steps.size(), 500u);
  EXPECT_EQ(steps, report.cycle_time);
  EXPECT_EQ(programs, report.cycle_time);
  const double unit = std::hypot(0.37, 0.11);
  EXPECT_NEAR(report.total.tip_path_mm, unit * 500 * 501 / 2, 1e-8);
  EXPECT_NEAR(report.total.cut_mm, unit * 2 * (250 * 251 / 2), 1e-8);
  EXPECT_NEAR(cut, report.total.cut_mm, 1e-8);
  EXPECT_NEAR(path, report.total.cut_mm + report.total.travel_mm, 1e-8);
  EXPECT_EQ(report.steps[0].line, report.steps[0].step + 2);
}

// RML-1: cutting and air length, plunge count. A plunge is cutting, a retract is not.
TEST(ReportRecorder, LengthsOfAMill) {
  Script script;
  script.Line({0, 0, 2}, {10, 0, 2}).Line({10, 0, 2}, {10, 0, -1}, {.use = MotionUse::kPlunge});
  script.Line({10, 0, -1}, {30, 0, -1}, {.use = MotionUse::kCut});
  script.Line({30, 0, -1}, {30, 0, 2}, {.use = MotionUse::kRetract});
  script.Line({30, 0, 2}, {30, 0, 0}, {.use = MotionUse::kPlunge});
  script.Line({30, 0, 0}, {30, 0, -1}, {.use = MotionUse::kPlunge});  // the same plunge, in two
  const RunReport report = ReportOf(script, {});
  EXPECT_NEAR(report.total.cut_mm, 3 + 20 + 3, 1e-12);
  EXPECT_NEAR(report.total.travel_mm, 10 + 3, 1e-12);
  EXPECT_NEAR(report.total.plunge_mm, 6, 1e-12);
  EXPECT_NEAR(report.total.tip_path_mm, 39, 1e-12);
  EXPECT_EQ(report.total.plunges, 2u);
  EXPECT_EQ(report.cut.min, (MachineVector{10, 0, -1}));
  EXPECT_EQ(report.cut.max, (MachineVector{30, 0, 2}));
  EXPECT_EQ(report.tip.min, (MachineVector{0, 0, -1}));
}

// Case W03 of motion.md 12: one cut of 200 mm at SPEED 8 with WORKDEF 1,0 (8,75,1,50): beam on
// 6.111245553 s, pierce 750 J, cut 5625 J, 28.125 J/mm, T the same as the beam-on time.
TEST(ReportRecorder, LaserCutOfTheReference) {
  const motion::PathLimits limits{.speed = 40.0, .acceleration = 2000.0, .jerk = 40000.0};
  Script script;
  script.Step(45, 1).Signal(Signal::kShutter, 1).Signal(Signal::kBeam, 1, 50);
  script.Wait(WaitKind::kPierce, 1.0, true, 50.0);
  script.Step(45, 2).Motion(Planned(LineFrom({}, {200, 0, 0}), limits, 0.048),
                            {.use = MotionUse::kCut,
                             .beam_on = true,
                             .power = {.percent_per_mm_s = 75.0 / 40.0},
                             .programmed_mm_s = 40.0});
  script.Signal(Signal::kBeam, 0).Step(45, 3).Line({200, 0, 0}, {200, 100, 0});
  script.Signal(Signal::kShutter, 0);
  const RunReport report = ReportOf(script, Laser());
  EXPECT_NEAR(ToSeconds(report.total.beam_on), 6.111245553, 1e-9);
  EXPECT_NEAR(report.total.pierce_energy_j, 750.0, 1e-9);
  EXPECT_NEAR(report.total.cut_energy_j, 5625.0, 1e-9);
  EXPECT_NEAR(report.total.energy_j(), 6375.0, 1e-9);
  EXPECT_NEAR(report.total.energy_j_per_mm(), 28.125, 1e-12);
  EXPECT_NEAR(report.total.energy_j_per_mm_max, 28.125, 1e-12);
  EXPECT_EQ(report.total.pierces, 1u);
  EXPECT_EQ(report.total.beam_switches, 1u);
  EXPECT_NEAR(report.total.cut_mm, 200.0, 1e-12);
  EXPECT_NEAR(report.total.travel_mm, 100.0, 1e-12);
  EXPECT_EQ(report.total.shutter_open, report.cycle_time);
  EXPECT_EQ(report.cut.max, (MachineVector{200, 0, 0}));
  EXPECT_EQ(report.shortfall.moves, 0u);
  // The second step holds the cut, the first the pierce.
  EXPECT_EQ(report.steps[0].figures.pierces, 1u);
  EXPECT_NEAR(report.steps[1].figures.cut_energy_j, 5625.0, 1e-9);
  EXPECT_EQ(report.steps[2].figures.beam_on, SimTime::zero());
}

// motion.md 8.1: a pierce is WORK 1 with delay, or WORK 0 followed by DELAY. A DELAY after a motion
// is none, a beam that goes on in passing is none, and one that stays on pierces once.
TEST(ReportRecorder, WhatCountsAsAPierce) {
  Script script;
  const auto on = [&] { script.Signal(Signal::kBeam, 1, 100); };
  const auto off = [&] { script.Signal(Signal::kBeam, 0); };
  const auto cut = [&](double from, double to) {
    script.Line({from, 0, 0}, {to, 0, 0}, {.use = MotionUse::kCut, .beam_on = true});
  };
  on();
  script.Wait(WaitKind::kDwell, 0.5, true, 100.0);  // WORK 0, DELAY: a pierce
  cut(0, 10);
  script.Wait(WaitKind::kDwell, 0.5, true, 100.0);  // later: none
  off();
  on();
  cut(10, 20);  // in passing: none
  off();
  on();
  script.Wait(WaitKind::kPierce, 1.0, true, 50.0);  // WORK 1: a pierce
  script.Wait(WaitKind::kDwell, 1.0, true, 0.0);    // the same one
  off();
  script.Wait(WaitKind::kDwell, 1.0);  // without the beam: none
  const RunReport report = ReportOf(script, Laser());
  EXPECT_EQ(report.total.pierces, 2u);
  EXPECT_EQ(report.total.beam_switches, 3u);
  EXPECT_NEAR(report.total.pierce_energy_j, 750.0 + 750.0 + 750.0, 1e-9);
}

// A delay of no time pierces nothing; the one behind it does.
TEST(ReportRecorder, NoTimeIsNoPierce) {
  Script script;
  script.Signal(Signal::kBeam, 1, 100).Wait(WaitKind::kPierce, 0.0, true, 100.0);
  EXPECT_EQ(ReportOf(script, Laser()).total.pierces, 0u);
  script.Wait(WaitKind::kDwell, 0.5, true, 100.0);
  EXPECT_EQ(ReportOf(script, Laser()).total.pierces, 1u);
}

// While halted time is the operator's; OPT-3.52: with the beam off.
TEST(ReportRecorder, HaltsAreTheOperatorsTime) {
  Script script;
  script.Step(1, 1).Halt("STOP").Step(1, 2).Wait(WaitKind::kDwell, 1.0);
  ReportRecorder recorder({});
  FakeRun run(script, recorder, {{FromSeconds(4.0), machine::InputKind::kStart, 0, 1.0}});
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.halts, 1u);
  EXPECT_EQ(report.total.time.operator_wait, FromSeconds(4.0));
  EXPECT_EQ(report.cycle_time, FromSeconds(5.0));
}

// A stopped motion is told in parts: what was run of the profile, then the ramp to rest. Lengths,
// box and times are those of the parts.
TEST(ReportRecorder, MotionInParts) {
  const auto whole = Planned(LineFrom({}, {100, 0, 0}));
  const double stop_at_s = 1.0;
  auto ramp = whole;
  ramp.speed = whole.speed.StopFrom(stop_at_s, whole.limits);
  const double half = whole.speed.At(stop_at_s).s;
  const double rest = ramp.speed.end().s;
  Script script;
  script.Step(1, 1);
  script.Part(whole, {.travelled = half}, FromSeconds(stop_at_s));
  script.Part(ramp, {.from = half, .travelled = rest}, FromSeconds(ramp.speed.duration_s()));
  const RunReport report = ReportOf(script, {});
  // At 50 mm/s from 50 mm/s to rest: sqrt(50/40000) * 2 s over 50/2 mm/s of mean speed.
  const double ramp_s = 2.0 * std::sqrt(50.0 / 40000.0);
  EXPECT_NEAR(ToSeconds(report.cycle_time), 1.0 + ramp_s, 1e-9);
  EXPECT_EQ(report.total.time.settling, SimTime::zero());
  EXPECT_NEAR(report.total.tip_path_mm, half + 25.0 * ramp_s, 1e-9);
  EXPECT_NEAR(report.tip.max.x(), rest, 1e-12);
  EXPECT_EQ(report.shortfall.moves, 0u);
}

// S02: 30 mm at 350 mm/s reach 200 only. The worst share and its place are kept.
TEST(ReportRecorder, FeedRatesThatWereNotReached) {
  const motion::PathLimits fast{.speed = 350.0, .acceleration = 2000.0, .jerk = 40000.0};
  Script script;
  const MotionOptions wanted{.programmed_mm_s = 350.0};
  script.Step(1, 1).Motion(Planned(LineFrom({}, {500, 0, 0}), fast), wanted);
  script.Step(1, 2).Motion(Planned(LineFrom({}, {30, 0, 0}), fast), wanted);
  script.Step(1, 3).Motion(Planned(LineFrom({}, {60, 0, 0}), fast), wanted);
  script.Step(1, 4).Motion(Planned(LineFrom({}, {30, 0, 0}), fast));  // as fast as it can
  const RunReport report = ReportOf(script, {});
  EXPECT_EQ(report.shortfall.moves, 2u);
  EXPECT_EQ(report.shortfall.worst.step, 2);
  EXPECT_EQ(report.shortfall.wanted_mm_s, 350.0);
  EXPECT_NEAR(report.shortfall.reached_mm_s, 200.0, 1e-6);
}

// motion.md 8.2: axis travel is the sum of |D|; reversals; range of the rotary axes.
TEST(ReportRecorder, AxisFigures) {
  Script script;
  script.Line({0, 0, 0}, {10, 5, 0}).Line({10, 5, 0}, {4, 9, 0}).Line({4, 9, 0}, {4, 12, 0});
  script.Line({4, 12, 0}, {9, 12, 0});
  const RunReport mill = ReportOf(script, {});
  ASSERT_EQ(mill.axes.size(), 3u);  // a mill whose rotary axis never turned
  EXPECT_EQ(mill.axes[0].name, "X");
  EXPECT_NEAR(mill.axes[0].travel, 10 + 6 + 5, 1e-12);
  EXPECT_EQ(mill.axes[0].reversals, 2u);
  EXPECT_EQ(mill.axes[1].reversals, 0u);
  EXPECT_NEAR(mill.axes[1].maximum, 12.0, 1e-12);

  Script head;
  head.Motion(Planned(PathPiece::Line({{0, 0, 0}, 0.5, 0.0}, {{0, 0, 0}, -1.5, 1.0}),
                      {.speed = 1.0, .acceleration = 10.0}));
  const RunReport laser = ReportOf(head, Laser());
  ASSERT_EQ(laser.axes.size(), 5u);
  EXPECT_EQ(laser.axes[3].name, "A");
  EXPECT_TRUE(laser.axes[3].rotary);
  EXPECT_NEAR(laser.axes[3].travel, 2.0, 1e-12);
  EXPECT_NEAR(laser.axes[3].minimum, -1.5, 1e-12);
  EXPECT_NEAR(laser.axes[4].maximum, 1.0, 1e-12);
  EXPECT_NEAR(laser.axes[4].peak_speed, 1.0, 1e-9);
  EXPECT_NEAR(laser.axes[3].speed_limit, 2.0 * kPi, 1e-12);
  EXPECT_EQ(laser.total.tip_path_mm, 0.0);
  EXPECT_NEAR(laser.column.max.z(), 300.0, 1e-9);  // straight above at B = 0
  EXPECT_TRUE(laser.tip.max == MachineVector{} && laser.tip.min == MachineVector{});
}

// Cases C01 and C03 of motion.md 12: a corner of 90 degrees between legs of 100 mm at SPEED 10. The
// steps share the curve at half of its arc length.
TEST(ReportRecorder, CornerOfTheReference) {
  Script script;
  const auto motions = PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}});
  ASSERT_EQ(motions.size(), 4u);
  for (const motion::PlannedMotion& planned : motions) {
    script.Step(1, static_cast<int>(planned.tag));
    script.Motion(planned, {.use = MotionUse::kCut, .beam_on = true, .programmed_mm_s = 50.0});
  }
  const RunReport report = ReportOf(script, Laser());
  EXPECT_NEAR(ToSeconds(report.cycle_time), 4.089999848, 1e-6);
  EXPECT_NEAR(report.total.tip_path_mm, 198.564458478, 1e-6);
  EXPECT_EQ(report.corners.blended, 1u);
  EXPECT_EQ(report.corners.stops, 1u);  // the end
  EXPECT_NEAR(report.corners.deviation_mm_max, 1.358847515, 1e-6);
  EXPECT_EQ(report.corners.deviation_place.step, 1);
  const double off = 1.358847515 / std::sqrt(2.0);
  EXPECT_NEAR(report.corners.deviation_point.x(), 100.0 - off, 1e-6);
  EXPECT_NEAR(report.corners.deviation_point.y(), off, 1e-6);
  EXPECT_NEAR(report.steps[0].figures.tip_path_mm, 0.5 * 198.564458478, 1e-6);
  EXPECT_EQ(report.shortfall.moves, 0u);
  EXPECT_NEAR(report.tip.max.x(), 100.0, 1e-9);
  EXPECT_NEAR(report.tip.min.y(), 0.0, 1e-9);
}

// A head that turns to a corner and back again has the same angle at both ends of the curve; it
// does not get as far as programmed, and the range says how far it got.
TEST(ReportRecorder, HeadTurnsBackOnACurve) {
  Script script;
  for (const motion::PlannedMotion& planned :
       PlannedCorner({{0, 0, 0}, 0.0, 0.0}, {{100, 0, 0}, 0.5, 0.0}, {{200, 0, 0}, 0.0, 0.0})) {
    script.Motion(planned);
  }
  const RunReport report = ReportOf(script, Laser());
  EXPECT_EQ(report.corners.blended + report.corners.capped, 1u);
  const AxisFigures& a = report.axes[3];
  EXPECT_LT(a.maximum, 0.5);
  EXPECT_GT(a.maximum, 0.45);
  EXPECT_EQ(a.reversals, 1u);
  EXPECT_NEAR(a.travel, 2.0 * a.maximum, 1e-9);
}

// A circle makes the box of the tip as large as it is, though it ends where it began.
TEST(ReportRecorder, BoxOfACircle) {
  Script script;
  const PathPiece circle =
      PathPiece::Circle({{112, 50, 0}}, {100, 50, 0}, {0, 0, 1}, kTurn, 0.0, 0.0);
  script.Motion(Planned(circle), {.use = MotionUse::kCut});
  const RunReport report = ReportOf(script, {});
  EXPECT_NEAR(report.cut.min.x(), 88.0, 1e-9);
  EXPECT_NEAR(report.cut.max.x(), 112.0, 1e-9);
  EXPECT_NEAR(report.cut.min.y(), 38.0, 1e-9);
  EXPECT_NEAR(report.cut.max.y(), 62.0, 1e-9);
  EXPECT_NEAR(report.total.cut_mm, 24.0 * kPi, 1e-9);
}

// What the machine found, merged; outcome and position of the run; points as programmed.
TEST(ReportRecorder, OutcomeFindingsAndPosition) {
  Script script;
  script.Step(7, 3, 12)
      .Find(ErrorCode::kSpeedLimited, "120 %")
      .Find(ErrorCode::kSpeedLimited, "130 %");
  script.Line({}, {3, 4, 0}).Move({3, 4, 0}, 50.0, "LIN");
  script.Ends(machine::OutcomeKind::kFailed, ErrorCode::kHoleRadiusZero, "radius is 0");
  script.figures = {{"steps", "", 19.0}};
  const RunReport report = ReportOf(script, {});
  EXPECT_TRUE(report.finished);
  EXPECT_EQ(report.outcome.code, ErrorCode::kHoleRadiusZero);
  EXPECT_EQ(report.outcome.place.step, 3);
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_EQ(report.findings[0].count, 2u);
  EXPECT_EQ(report.final_position.tip.tip, (MachineVector{3, 4, 0}));
  EXPECT_EQ(report.final_position.program_point, (motion::ProgramPoint{3, 4, 0}));
  EXPECT_EQ(report.programmed.max, (motion::ProgramPoint{3, 4, 0}));
  EXPECT_EQ(report.figures.size(), 1u);
}

// motion.md 8.2: the box of programmed points holds those of the program, not the machine's own.
TEST(ReportRecorder, AMoveOfTheMachineIsNotProgrammed) {
  Script script;
  script.Step(1, 1).Line({}, {3, 4, 0}).Move({3, 4, 0}, 50.0, "LIN");
  script.Step(1, 2).Line({3, 4, 0}, {9, 9, 9}).Move({9, 9, 9}, 0.0, "ZERO_Z", false);
  const RunReport report = ReportOf(script, {});
  EXPECT_EQ(report.programmed.max, (motion::ProgramPoint{3, 4, 0}));
  EXPECT_EQ(report.final_position.program_point, (motion::ProgramPoint{3, 4, 0}));
  EXPECT_EQ(report.final_position.tip.tip, (MachineVector{9, 9, 9}));
}

// motion.md 8.2: what the beam does counts in the program that does it, and in no other: moving,
// waiting and standing. 50 % are class 10 of power, 80 % class 16; 10 mm/s of 500 class 1 of speed.
TEST(ReportRecorder, TheBeamCountsInItsProgram) {
  const MotionOptions cut{
      .use = MotionUse::kCut, .beam_on = true, .power = {.constant_percent = 80.0}};
  Script script;
  script.Step(1, 1).Line({}, {5, 0, 0}).Signal(Signal::kBeam, 1, 50);
  script.Wait(WaitKind::kDwell, 1.0, true, 50.0);
  script.Step(2, 1).Motion(Planned(LineFrom({}, {10, 0, 0}), kSecondRamps), cut);
  script.Step(1, 2).Line({10, 0, 0}, {5, 0, 0}).Step(2, 2).Wait(WaitKind::kPierce, 0.5, true, 50.0);
  script.Step(1, 3).Line({5, 0, 0}, {0, 0, 0}).Step(2, 3).Nothing(0.25).Step(2, 4);
  const RunReport report = ReportOf(script, Laser());
  const BeamHistogram& first = report.programs.at(1).beam;
  const BeamHistogram& second = report.programs.at(2).beam;
  EXPECT_EQ(first.by_power[10], FromSeconds(1.0));
  EXPECT_EQ(first.by_power[0], SimTime::zero());
  EXPECT_EQ(first.by_speed[0], FromSeconds(1.0));
  EXPECT_EQ(second.by_power[16], FromSeconds(2.0));
  EXPECT_EQ(second.by_power[10], FromSeconds(0.5));
  EXPECT_EQ(second.by_power[0], FromSeconds(0.25));
  EXPECT_EQ(second.by_speed[1], FromSeconds(2.0));
  EXPECT_EQ(second.by_speed[0], FromSeconds(0.75));
  EXPECT_EQ(report.beam.by_power[10], FromSeconds(1.5));
  // A second and a half at 50 % of 1500 W; a quarter of one of which nobody tells a power has none.
  EXPECT_NEAR(report.total.pierce_energy_j, 1125.0, 1e-9);
}

// motion.md 8.2: peaks are those of the program that reaches them, also behind higher ones of
// another program: 100 mm at 50 mm/s along (3,4,0)/5, then a corner from X to Y with a start from
// rest.
TEST(ReportRecorder, PeaksCountInTheirProgram) {
  const auto corner = PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}});
  ASSERT_EQ(corner.size(), 4u);
  MotionPeaks bend;
  for (const std::size_t half : {1u, 2u})
    bend.Raise(PeaksBetween(corner[half], true, 0.0, corner[half].speed.duration_s()));
  const motion::PathLimits fast{.speed = 300.0, .acceleration = 5000.0};
  Script script;
  script.Step(1, 1).Motion(Planned(LineFrom({}, {300, 400, 0}), fast));
  script.Step(2, 1).Motion(corner[1]).Motion(corner[2]);
  script.Step(1, 2).Motion(Planned(LineFrom({300, 400, 0}, {}), fast));
  const RunReport report = ReportOf(script, Laser());
  const ScopeFigures& first = report.programs.at(1);
  const ScopeFigures& second = report.programs.at(2);
  EXPECT_NEAR(first.tip_figures.peak_speed, 300.0, 1e-9);
  EXPECT_NEAR(first.axes[1].peak_acceleration, 4000.0, 1e-6);
  EXPECT_NEAR(second.tip_figures.peak_speed, 50.0, 1e-6);
  EXPECT_EQ(second.tip_figures.peak_acceleration, bend.tip_acceleration);
  EXPECT_EQ(second.axes[0].peak_acceleration, bend.axis_acceleration[0]);
  EXPECT_EQ(second.axes[1].peak_jerk, bend.axis_jerk[1]);
  EXPECT_EQ(report.axes[0].peak_speed, first.axes[0].peak_speed);
  EXPECT_NEAR(first.axes[0].travel, 600.0, 1e-9);
  EXPECT_NEAR(report.axes[0].travel, 600.0 + second.axes[0].travel, 1e-9);
}

// A report has room for 128 programs; each of those has all of its figures, whenever it first
// moved.
TEST(ReportRecorder, ProgramsOfTheReportHaveAllTheirFigures) {
  Script script;
  script.Step(0, 1);
  for (int program = 1; program <= 128; ++program) {
    script.Step(program, 1).Line({0, 0, 0}, {1.0 * program, 0, 0}, {.use = MotionUse::kCut});
  }
  script.Step(0, 2).Line({0, 0, 0}, {0, 7, 0}, {.use = MotionUse::kCut});
  const RunReport report = ReportOf(script, {});
  ASSERT_EQ(report.programs.size(), 128u);
  for (int program = 1; program < 128; ++program) {
    EXPECT_EQ(report.programs.at(program).tip.max.x(), 1.0 * program);
    EXPECT_EQ(report.programs.at(program).total.cut_mm, 1.0 * program);
  }
  EXPECT_EQ(report.programs.at(0).tip.max.y(), 7.0);
  EXPECT_EQ(report.programs.at(0).total.cut_mm, 7.0);
  EXPECT_EQ(report.tip.max.x(), 128.0);  // of the job, whatever its programs have
}

// A report on the way holds what was told so far and changes nothing of the end.
TEST(ReportRecorder, ReportOnTheWay) {
  Script script;
  script.Step(1, 1).Motion(Planned(LineFrom({}, {10, 0, 0}), kSecondRamps));
  script.Step(1, 2).Motion(Planned(LineFrom({10, 0, 0}, {0, 0, 0}), kSecondRamps));
  ReportRecorder recorder({});
  FakeRun run(script, recorder);
  EXPECT_EQ(run.Advance(FromSeconds(3.0)), machine::RunPhase::kRunning);
  const RunReport halfway = recorder.Report(run);
  EXPECT_FALSE(halfway.finished);
  EXPECT_EQ(halfway.cycle_time, FromSeconds(2.0));
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  const RunReport whole = recorder.Report(run);
  EXPECT_EQ(whole.cycle_time, FromSeconds(4.0));
  EXPECT_EQ(whole.total.time.motion, FromSeconds(4.0));
}

}  // namespace
}  // namespace rmlcell::simulation
