// Every field of what a run tells: places, times, kinds and values.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::Place;
using machine::RunPhase;
using namespace std::chrono_literals;

// Keeps what an observer is told as it was told.
class Told final : public machine::RunObserver {
 public:
  struct Step {
    SimTime at;
    Place place;
    std::string instruction;
  };
  std::vector<Step> steps;
  std::vector<machine::MotionDone> motions;
  std::vector<machine::MoveDone> moves;
  std::vector<machine::SignalChange> signals;
  std::vector<machine::Wait> waits;
  std::vector<machine::Halt> halts;
  std::vector<Step> resumes;
  std::vector<std::pair<SimTime, Diagnostic>> diagnostics;

  void OnStep(SimTime at, const Place& place, std::string_view instruction) override {
    steps.push_back({at, place, std::string(instruction)});
  }
  void OnMotion(const machine::MotionDone& motion) override { motions.push_back(motion); }
  void OnMove(const machine::MoveDone& move) override { moves.push_back(move); }
  void OnSignal(const machine::SignalChange& change) override { signals.push_back(change); }
  void OnWait(const machine::Wait& wait) override { waits.push_back(wait); }
  void OnHalt(const machine::Halt& halt) override { halts.push_back(halt); }
  void OnResume(SimTime at, const Place& place) override { resumes.push_back({at, place, {}}); }
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override {
    diagnostics.emplace_back(at, diagnostic);
  }
};

// In slot 7, so that a program number is no other figure.
struct Seen {
  Told told;
  std::unique_ptr<machine::Run> run;

  Seen(const machine::Parameters& parameters, const std::string& stream,
       machine::InputScript inputs = {}) {
    machine::RunSetup setup = SetupOf(parameters, stream);
    setup.programs[7] = setup.programs[1];
    setup.programs.erase(1);
    setup.main_program = 7;
    setup.inputs = std::move(inputs);
    run = Rml1Family().NewRun(std::move(setup), told).value();
  }
  RunPhase ToEnd() {
    RunPhase phase = RunPhase::kRunning;
    while (phase == RunPhase::kRunning) phase = run->Advance(kForever);
    return phase;
  }
};

machine::Parameters WithSpindleTimes() {
  machine::Parameters parameters = ParametersOf("t1");
  EXPECT_TRUE(parameters.Set("SPIN_UP", 0.5).ok());
  EXPECT_TRUE(parameters.Set("SPIN_DOWN", 0.25).ok());
  return parameters;
}

void ExpectTime(SimTime got, double want_s) { EXPECT_NEAR(ToSeconds(got), want_s, 2e-9); }

// V 20 over 20 mm takes 1 + 0.1 s at 200 mm/s2, VS 10 over 10 mm 1 + 0.05 s; the spindle is waited
// for before and behind. RML1-7.05, RML1-9.33, RML1-3C.02
TEST(MillRunFields, OfACut) {
  Seen seen(WithSpindleTimes(), "V20;VS10;\n PD1000,0;!MC0;");
  ASSERT_EQ(seen.ToEnd(), RunPhase::kFinished);
  const Told& told = seen.told;
  const Place first{.program = 7, .step = 1, .line = 1, .byte_offset = 0};
  const Place cut{.program = 7, .step = 3, .line = 2, .byte_offset = 11};
  const Place off{.program = 7, .step = 4, .line = 2, .byte_offset = 20};

  ASSERT_EQ(told.steps.size(), 4u);
  EXPECT_EQ(told.steps[0].place, first);
  EXPECT_EQ(told.steps[0].instruction, "V");
  EXPECT_EQ(told.steps[2].place, cut);
  EXPECT_EQ(told.steps[2].instruction, "PD");
  EXPECT_EQ(told.steps[2].at, 0s);
  EXPECT_EQ(told.steps[3].place, off);
  EXPECT_EQ(told.steps[3].instruction, "!MC");
  ExpectTime(told.steps[3].at, 0.5 + 1.1 + 1.05);

  ASSERT_EQ(told.signals.size(), 2u);
  EXPECT_EQ(told.signals[0].at, 0s);
  EXPECT_EQ(told.signals[0].place, cut);
  EXPECT_EQ(told.signals[0].signal, machine::Signal::kSpindle);
  EXPECT_EQ(told.signals[0].index, 0);
  EXPECT_EQ(told.signals[0].value, 1.0);
  EXPECT_EQ(told.signals[0].detail, 4500.0);
  ExpectTime(told.signals[1].at, 2.65);
  EXPECT_EQ(told.signals[1].place, off);
  EXPECT_EQ(told.signals[1].signal, machine::Signal::kSpindle);
  EXPECT_EQ(told.signals[1].value, 0.0);
  EXPECT_EQ(told.signals[1].detail, 0.0);

  ASSERT_EQ(told.waits.size(), 2u);
  EXPECT_EQ(told.waits[0].start, 0s);
  ExpectTime(told.waits[0].end, 0.5);
  EXPECT_EQ(told.waits[0].place, cut);
  EXPECT_EQ(told.waits[0].kind, machine::WaitKind::kSpinUp);
  ExpectTime(told.waits[1].start, 2.65);
  ExpectTime(told.waits[1].end, 2.9);
  EXPECT_EQ(told.waits[1].place, off);
  EXPECT_EQ(told.waits[1].kind, machine::WaitKind::kSpinUp);

  ASSERT_EQ(told.motions.size(), 2u);
  const double ends[3] = {0.5, 1.6, 2.65}, ways[2] = {20.0, 10.0}, feeds[2] = {20.0, 10.0};
  for (std::size_t k = 0; k < 2; ++k) {
    ExpectTime(told.motions[k].start, ends[k]);
    ExpectTime(told.motions[k].end, ends[k + 1]);
    EXPECT_EQ(told.motions[k].place, cut);
    EXPECT_EQ(told.motions[k].from, 0.0);
    EXPECT_NEAR(told.motions[k].travelled, ways[k], 1e-9);
    EXPECT_EQ(told.motions[k].programmed_mm_s, feeds[k]);
    EXPECT_FALSE(told.motions[k].beam_on);
  }
  EXPECT_EQ(told.motions[0].use, machine::MotionUse::kPlunge);
  EXPECT_EQ(told.motions[1].use, machine::MotionUse::kCut);

  ASSERT_EQ(told.moves.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    const machine::MoveDone& move = told.moves[k];
    ExpectTime(move.at, ends[k + 1]);
    EXPECT_EQ(move.place, cut);
    EXPECT_EQ(move.tip.tip, (motion::MachineVector{k == 0 ? 0.0 : 10.0, 0, -20}));
    EXPECT_EQ(move.axes.column, move.tip.tip);
    EXPECT_EQ(move.program_point, (motion::ProgramPoint{k == 0 ? 0.0 : 1000.0, 0, 0}));
    EXPECT_EQ(move.feed_mm_s, feeds[k]);
    EXPECT_EQ(move.path, "PD");
    EXPECT_TRUE(move.programmed);
  }
}

// Down to Z2, across, down to Z1 and a cut there: only what goes below the surface is in the work,
// and no way of a program leads to where it begins.
TEST(MillRunFields, OfWhatGoesIntoTheWork) {
  Seen seen(ParametersOf("t1"), "@-100,200;PU100,0;PD1000,0;");
  ASSERT_EQ(seen.ToEnd(), RunPhase::kFinished);
  ASSERT_EQ(seen.told.motions.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(seen.told.motions[k].in_work, k >= 2) << k;
    EXPECT_FALSE(seen.told.motions[k].approach) << k;
  }
  Seen on_surface(ParametersOf("t1"), "@0,200;PD1000,0;");
  ASSERT_EQ(on_surface.ToEnd(), RunPhase::kFinished);
  for (const machine::MotionDone& motion : on_surface.told.motions) EXPECT_FALSE(motion.in_work);
}

// A group with the rotary axis, from another origin: what is told of A, and points from the origin
// and Z0. RML1-3D.29
TEST(MillRunFields, OfATurn) {
  machine::Parameters parameters = ParametersOf("t1a");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", 50.0).ok());
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", 30.0).ok());
  ASSERT_TRUE(parameters.Set("A_SENSE", "LEFT").ok());
  Seen seen(parameters, "!MC0;!ZE X700Z-300A45;");
  ASSERT_EQ(seen.ToEnd(), RunPhase::kFinished);
  ASSERT_EQ(seen.told.moves.size(), 1u);
  const machine::MoveDone& move = seen.told.moves[0];
  EXPECT_EQ(move.tip.tip, (motion::MachineVector{57, 30, -23}));
  EXPECT_NEAR(move.tip.a_rad, -45.0 * kRadPerDegree, 1e-12);
  EXPECT_EQ(move.tip.b_rad, 0.0);
  EXPECT_EQ(move.axes.column, move.tip.tip);
  EXPECT_EQ(move.axes.a_rad, move.tip.a_rad);
  EXPECT_EQ(move.axes.b_rad, 0.0);
  EXPECT_EQ(move.program_point, (motion::ProgramPoint{700, 0, -300}));
  EXPECT_EQ(move.rotary_a, 45.0);
  EXPECT_EQ(move.path, "!ZE");
  const machine::RunState end = seen.run->state();
  EXPECT_EQ(end.axes.column, end.tip.tip);
  EXPECT_EQ(end.axes.a_rad, end.tip.a_rad);
  EXPECT_EQ(end.axes.b_rad, 0.0);
}

// A pause that a START of the script ends: the halt, the wait of the operator, the resume.
// RML1-3C.08
TEST(MillRunFields, OfAPause) {
  Seen seen(ParametersOf("t1"), "!MC0;\n!NR;PU;", {{.at = 3s, .kind = InputKind::kStart}});
  ASSERT_EQ(seen.ToEnd(), RunPhase::kFinished);
  const Place pause{.program = 7, .step = 2, .line = 2, .byte_offset = 6};
  ASSERT_EQ(seen.told.halts.size(), 1u);
  EXPECT_EQ(seen.told.halts[0].at, 0s);
  EXPECT_EQ(seen.told.halts[0].place, pause);
  ASSERT_EQ(seen.told.waits.size(), 1u);
  EXPECT_EQ(seen.told.waits[0].start, 0s);
  EXPECT_EQ(seen.told.waits[0].end, 3s);
  EXPECT_EQ(seen.told.waits[0].place, pause);
  EXPECT_EQ(seen.told.waits[0].kind, machine::WaitKind::kOperator);
  ASSERT_EQ(seen.told.resumes.size(), 1u);
  EXPECT_EQ(seen.told.resumes[0].at, 3s);
  EXPECT_EQ(seen.told.resumes[0].place, pause);
  EXPECT_TRUE(seen.told.diagnostics.empty());
  ASSERT_EQ(seen.told.moves.size(), 1u);
  ExpectTime(seen.told.moves[0].at, 3.0 + 15.0 / 2.0 + 2.0 / 200.0);
}

// A pause that nobody ends, and a START at the instant of a halt: no wait, for no time passed.
// RML1-3C.08, RML1-9.35
TEST(MillRunFields, OfAPauseForEver) {
  Seen seen(ParametersOf("t1"), "PU;\n !NR;");
  ASSERT_EQ(seen.ToEnd(), RunPhase::kHalted);
  ASSERT_EQ(seen.told.diagnostics.size(), 1u);
  const auto& [at, diagnostic] = seen.told.diagnostics[0];
  EXPECT_EQ(at, seen.told.halts.at(0).at);
  EXPECT_EQ(diagnostic.code, ErrorCode::kRml1PausedAtEnd);
  EXPECT_EQ(diagnostic.severity, Lookup(ErrorCode::kRml1PausedAtEnd).severity);
  EXPECT_EQ(diagnostic.where, (SourceSpan{.line = 2, .column = 2, .length = 3, .byte_offset = 5}));
  EXPECT_EQ(diagnostic.program, 7);
  EXPECT_EQ(diagnostic.step, 2);
  EXPECT_TRUE(diagnostic.file.empty());
  const std::size_t waits = seen.told.waits.size();
  seen.run->Apply({.at = seen.run->state().time, .kind = InputKind::kStart});
  EXPECT_EQ(seen.ToEnd(), RunPhase::kFinished);
  EXPECT_EQ(seen.told.waits.size(), waits);
  EXPECT_EQ(seen.told.resumes.size(), 1u);
}

// The end of the data inside a command. RML1-9.42
TEST(MillRunFields, OfAnIncompleteCommand) {
  Seen seen(ParametersOf("t1"), "PU;\nPD5");
  ASSERT_EQ(seen.ToEnd(), RunPhase::kFinished);
  ASSERT_EQ(seen.told.diagnostics.size(), 1u);
  const auto& [at, diagnostic] = seen.told.diagnostics[0];
  EXPECT_EQ(at, seen.run->state().time);
  EXPECT_EQ(diagnostic.code, ErrorCode::kRml1IncompleteCommand);
  EXPECT_EQ(diagnostic.severity, Lookup(ErrorCode::kRml1IncompleteCommand).severity);
  EXPECT_EQ(diagnostic.where.line, 2);
  EXPECT_EQ(diagnostic.where.length, 1);
  EXPECT_EQ(diagnostic.program, 7);
  EXPECT_EQ(diagnostic.step, 0);
}

// The speed of a turning spindle and a dwell. RML1-3C.12, RML1-9.31
TEST(MillRunFields, OfADwellAndASpindleSpeed) {
  Seen seen(ParametersOf("t1"), "PU;!RC15;W250;PU0,100;");
  ASSERT_EQ(seen.ToEnd(), RunPhase::kFinished);
  const double raised = 15.0 / 2.0 + 2.0 / 200.0;
  ASSERT_EQ(seen.told.signals.size(), 2u);
  EXPECT_EQ(seen.told.signals[1].signal, machine::Signal::kSpindleSpeed);
  EXPECT_EQ(seen.told.signals[1].value, 15000.0);
  EXPECT_EQ(seen.told.signals[1].detail, 0.0);
  EXPECT_EQ(seen.told.signals[1].place.step, 2);
  ExpectTime(seen.told.signals[1].at, raised);
}

// STOP at 10 mm/s, 0.25 mm of braking, 0.03 mm before the end of a line with two lines of 0.1 mm
// behind it: the ends are passed at what is left, v^2 - 2 a s, and the last one not. In the last
// ramp of a chain the end is reached. motion.md 6
TEST(MillRunFields, OfTheEndsThatABrakingToolPasses) {
  TestRun run(ParametersOf("t1"), "!MC0;V20;VS10;PD1000,0,1010,0,1020,0,3000,0;");
  run->Advance(2122ms);  // 1.1 s down, 0.05 s to speed over 0.25 mm, 9.72 mm
  run.Press(InputKind::kStop);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run->state().tip.tip.x(), 10.22, 1e-6);
  const auto& motions = run.seen().motions();
  ASSERT_EQ(motions.size(), 6u);  // down, the way to the STOP, four lines
  const double squares[4] = {100.0 - 12.0, 100.0 - 52.0, 100.0 - 92.0, 0.0};
  for (std::size_t k = 0; k < 4; ++k) {
    const motion::PlannedMotion& ride = motions[2 + k].planned;
    EXPECT_NEAR(ride.speed.end().speed, std::sqrt(squares[k]), 1e-5) << k;
    EXPECT_EQ(ride.ends_move, k < 3) << k;
    if (k == 3) continue;
    EXPECT_EQ(ride.corner.passage, motion::Passage::kThrough) << k;
    EXPECT_NEAR(ride.corner.speed, std::sqrt(squares[k]), 1e-5) << k;
  }
  EXPECT_EQ(motions[5].planned.corner.passage, motion::Passage::kStop);  // it rests on its way
  EXPECT_EQ(motions[5].planned.corner.speed, 0.0);
  TestRun last(ParametersOf("t1"), "!MC0;V20;VS10;PD1000,0;");
  last->Advance(2145ms);  // 5 ms before its end
  last.Press(InputKind::kStop);
  ASSERT_EQ(last.AdvanceToEnd(), RunPhase::kHalted);
  const motion::PlannedMotion& ride = last.seen().motions().back().planned;
  EXPECT_TRUE(ride.ends_move);
  EXPECT_EQ(ride.corner.passage, motion::Passage::kStop);
  EXPECT_EQ(ride.corner.speed, 0.0);
}

// motion.md 7: the axes of a mill are where its tip is, also where A turns, and on the ramp of a
// STOP.
TEST(MillRunFields, OfTheHead) {
  TestRun run(ParametersOf("t1a"), "!MC0;V20;VS10;PD1000,0;!ZE X2000A90;",
              {{.at = 2s, .kind = InputKind::kStop}, {.at = 3s, .kind = InputKind::kStart}});
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  ASSERT_EQ(run.seen().Events().back(), "move 2000.0,0.0,0.0,90.0");
  EXPECT_EQ(run.seen().moves().size(), 3U);
  EXPECT_EQ(run.seen().motions().size(), 5U);  // down, the cut in three parts, the turn
  for (const RunRecord::Motion& part : run.seen().motions())
    EXPECT_TRUE(part.planned.head == motion::Head(motion::MillHead{}));
}

// What a watcher sees: halfway through a cut, standing, and when all is over.
TEST(MillRunFields, OfTheState) {
  const std::string stream = "V20;VS10;PD1000,0;";
  Seen seen(ParametersOf("t1"), stream);
  machine::RunState state = seen.run->state();
  EXPECT_EQ(state.time, 0s);
  EXPECT_EQ(state.phase, RunPhase::kRunning);
  EXPECT_EQ(state.place.program, 7);
  EXPECT_EQ(state.place.step, 0);
  EXPECT_EQ(state.instruction, "");
  EXPECT_EQ(state.tip_speed_mm_s, 0.0);
  EXPECT_EQ(state.override_percent, 100.0);
  EXPECT_FALSE(state.spindle_on);
  EXPECT_EQ(state.progress, 0.0);
  Seen first(ParametersOf("t1"), "PU1000,0;");
  first.run->Advance(100ms);
  EXPECT_EQ(first.run->state().place.step, 1);
  EXPECT_EQ(first.run->state().instruction, "PU");
  EXPECT_EQ(first.run->state().axes.b_rad, 0.0);
  // 1.1 s down; 0.05 s and 0.25 mm to speed, 0.4 s at 10 mm/s.
  EXPECT_EQ(seen.run->Advance(1550ms), RunPhase::kRunning);
  state = seen.run->state();
  EXPECT_EQ(state.time, 1550ms);
  EXPECT_EQ(state.place.step, 3);
  EXPECT_EQ(state.instruction, "PD");
  EXPECT_NEAR(state.tip.tip.x(), 4.25, 1e-6);
  EXPECT_EQ(state.tip.tip.z(), -20.0);
  EXPECT_EQ(state.axes.column, state.tip.tip);
  EXPECT_NEAR(state.tip_speed_mm_s, 10.0, 1e-9);
  EXPECT_TRUE(state.spindle_on);
  EXPECT_FALSE(state.beam_on);
  EXPECT_EQ(seen.ToEnd(), RunPhase::kFinished);
  state = seen.run->state();
  EXPECT_EQ(state.phase, RunPhase::kFinished);
  EXPECT_EQ(state.instruction, "PD");
  EXPECT_EQ(state.tip_speed_mm_s, 0.0);
  EXPECT_EQ(state.progress, 1.0);
  EXPECT_EQ(seen.run->outcome().kind, machine::OutcomeKind::kCompleted);
  EXPECT_EQ(seen.run->outcome().place.step, 3);
  EXPECT_EQ(seen.run->outcome().detail, "");
  EXPECT_EQ(seen.run->steps_executed(), 3u);
}

// STOP at 1 mm/s, 0.001 mm before the end of a line with another one straight on behind it: 0.0025
// mm of braking, so that it passes there at sqrt(1 - 0.4) mm/s and rests 0.0015 mm further.
// motion.md 6
TEST(MillRunFields, OfACrawlingToolThatBrakes) {
  TestRun run(ParametersOf("t1"), "!MC0;V20;VS1;PD100,0,200,0;");
  run->Advance(2101500us);  // 1.1 s down, 0.005 s to speed over 0.0025 mm, 0.9965 mm
  run.Press(InputKind::kStop);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run->state().tip.tip.x(), 1.0015, 1e-6);
  EXPECT_NEAR(run.time_s(), 2.1065, 1e-6);
  const auto& motions = run.seen().motions();
  ASSERT_EQ(motions.size(), 4u);  // down, the way to the STOP, the end of that line, the next one
  const motion::PlannedMotion& passing = motions[2].planned;
  EXPECT_TRUE(passing.ends_move);
  EXPECT_EQ(passing.corner.passage, motion::Passage::kThrough);
  EXPECT_NEAR(passing.corner.speed, std::sqrt(0.6), 1e-5);
  for (const std::size_t k : {2u, 3u}) {  // the limits in force are those of the line
    EXPECT_EQ(motions[k].planned.limits.speed, 1.0) << k;
    EXPECT_EQ(motions[k].planned.limits.acceleration, 200.0) << k;
  }
}

// DEV-3.12: in a halt an open cover stops a spindle that turns, and what it stopped goes on with
// the run, behind its run-up. One that the program has not started is neither stopped nor started.
TEST(MillRunFields, OfASpindleThatTheCoverStops) {
  const auto open_and_close = [](machine::Run& run) {
    for (const double open : {1.0, 0.0}) {
      run.Apply({.at = run.state().time, .kind = InputKind::kDoor, .index = 0, .value = open});
    }
  };
  Seen seen(WithSpindleTimes(), "PU100,0;!NR;PU200,0;");
  ASSERT_EQ(seen.ToEnd(), RunPhase::kHalted);
  const SimTime halted_at = seen.run->state().time;
  open_and_close(*seen.run);
  const auto& signals = seen.told.signals;
  ASSERT_EQ(signals.size(), 2u);
  EXPECT_EQ(signals[1].at, halted_at);
  EXPECT_EQ(signals[1].signal, machine::Signal::kSpindle);
  EXPECT_EQ(signals[1].value, 0.0);
  EXPECT_EQ(signals[1].detail, 0.0);
  seen.run->Apply({.at = halted_at, .kind = InputKind::kStart});
  ASSERT_EQ(seen.ToEnd(), RunPhase::kFinished);
  ASSERT_EQ(signals.size(), 3u);
  EXPECT_EQ(signals[2].at, halted_at);
  EXPECT_EQ(signals[2].signal, machine::Signal::kSpindle);
  EXPECT_EQ(signals[2].value, 1.0);
  EXPECT_EQ(signals[2].detail, 4500.0);
  ASSERT_EQ(seen.told.waits.size(), 2u);
  EXPECT_EQ(seen.told.waits[1].kind, machine::WaitKind::kSpinUp);
  EXPECT_EQ(seen.told.waits[1].end - seen.told.waits[1].start, 500ms);

  Seen off(WithSpindleTimes(), "!MC0;PU100,0;!NR;PU200,0;");
  ASSERT_EQ(off.ToEnd(), RunPhase::kHalted);
  open_and_close(*off.run);
  off.run->Apply({.at = off.run->state().time, .kind = InputKind::kStart});
  ASSERT_EQ(off.ToEnd(), RunPhase::kFinished);
  EXPECT_TRUE(off.told.signals.empty());
}

// RML1-7.05: a command is told before what comes of it, also of a group of axes, and of one that is
// wrong.
TEST(MillRunFields, ACommandComesBeforeWhatItDoes) {
  const auto events = [](const std::string& stream) {
    TestRun run(ParametersOf("t1"), stream);
    EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    return run.seen().Events();
  };
  using Events = std::vector<std::string>;
  EXPECT_EQ(events("!MC0;!ZE X100;"),
            (Events{"step 1 !MC", "step 2 !ZE", "move 100.0,0.0,2000.0"}));
  EXPECT_EQ(events("!ZE X;"), (Events{"step 1 !ZE", "diagnostic RML1-E3"}));
  EXPECT_EQ(events("PU99999999,1;"), (Events{"step 1 PU", "diagnostic RML1-E3"}));
}

}  // namespace
}  // namespace rmlcell::rml1
