#include "engine/simulation/report/report_recorder.h"

#include <algorithm>

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using machine::Signal;
using machine::WaitKind;

constexpr std::string_view kStarved = "lookahead_starved";  // of every family that looks ahead

double TipSpeedMax(const machine::MachineShape& shape) {
  return shape.limits ? shape.limits->tip_speed_mm_s : 0.0;
}

SimTime& PartOf(TimeParts& parts, WaitKind kind) {
  switch (kind) {
    case WaitKind::kDwell:
      return parts.dwell;
    case WaitKind::kPierce:
      return parts.pierce;
    case WaitKind::kSpinUp:
      return parts.spin_up;
    case WaitKind::kCondition:
      return parts.condition;
    case WaitKind::kOperator:
      return parts.operator_wait;
    case WaitKind::kLoad:
      return parts.load;
  }
  return parts.standstill;
}

}  // namespace

std::string_view OutcomeText(machine::OutcomeKind kind) {
  switch (kind) {
    case machine::OutcomeKind::kCompleted:
      return "completed";
    case machine::OutcomeKind::kStopped:
      return "stopped";
    case machine::OutcomeKind::kFailed:
      return "failed";
    case machine::OutcomeKind::kCancelled:
      return "cancelled";
    case machine::OutcomeKind::kBudgetExceeded:
      return "budget_exceeded";
  }
  return "unknown";
}

ReportRecorder::ReportRecorder(const machine::MachineShape& shape, bool each_step)
    : shape_(shape),
      time_([this](const TimeLedger::Gap& gap) { CountStandstill(gap); }),
      each_step_(each_step),
      job_(shape),
      beam_(shape.laser_watts, TipSpeedMax(shape)),
      contours_(shape),
      speeds_(shape) {}

// Null: one program too many. The next time of the beam counts in what is given here.
FigureLog* ReportRecorder::LogOf(int program) {
  FigureLog* log = nullptr;
  if (work_.HasRoomFor(program)) log = &programs_.try_emplace(program, shape_).first->second;
  beam_.AlsoInto(log != nullptr ? &log->beam() : nullptr);
  return log;
}

// How much of `claimed`, which ends at `end`, the shutter was open; each instant is counted once.
SimTime ReportRecorder::ShutterShare(SimTime end, SimTime claimed) {
  if (!shutter_open_) return SimTime::zero();
  const SimTime left = end - shutter_since_ - shutter_counted_;
  const SimTime share = std::clamp(left, SimTime::zero(), claimed);
  shutter_counted_ += share;
  return share;
}

// What was not counted under anything is counted here.
void ReportRecorder::CloseShutter(SimTime at, const machine::Place& place) {
  WorkFigures work;
  work.shutter_open = at - shutter_since_ - shutter_counted_;
  work_.Add(place, work);
  shutter_open_ = false;
}

void ReportRecorder::CountStandstill(const TimeLedger::Gap& gap) {
  WorkFigures work;
  (gap.halted ? work.time.operator_wait : work.time.standstill) = gap.length();
  work.shutter_open = ShutterShare(gap.end, gap.length());
  if (gap.beam_on) {
    work.beam_on = gap.length();
    LogOf(gap.place.program);
    work.pierce_energy_j = beam_.Standing(ToSeconds(gap.length()), 0.0);
    contours_.Add(work);
  }
  work_.Add(gap.place, work);
}

// The beam cuts, or the tool of a machine without one.
bool ReportRecorder::Cuts(const machine::MotionDone& done) const {
  const bool tool_in = done.use == MotionUse::kCut || done.use == MotionUse::kPlunge;
  return done.beam_on || (shape_.laser_watts <= 0.0 && tool_in && done.in_work);
}

void ReportRecorder::Begin(const machine::Run& run) {
  const machine::RunState state = run.state();
  time_.BeginAt(state.time);
  steps_before_ = run.steps_executed();
  approaching_ = state.approaching;
}

void ReportRecorder::OnEntered(SimTime at) {
  time_.BeginAt(at);
  approaching_ = false;
}

void ReportRecorder::OnStep(SimTime at, const machine::Place& place,
                            std::string_view /*instruction*/) {
  time_.Leave(at, Now());
  place_ = place;
  contours_.Step();
  work_.AddStep(place);
}

void ReportRecorder::OnMotion(const machine::MotionDone& done) {
  PartShape shape({done.motion->path, done.motion->head, done.from, done.travelled});
  Add(done, shape);
}

void ReportRecorder::Add(const machine::MotionDone& done, PartShape& shape) {
  if (done.approach) return;
  const motion::PlannedMotion& motion = *done.motion;
  const SimTime claimed = time_.Claim(done.start, done.end, Now());

  WorkFigures work;
  const double profile_left_s = std::max(0.0, motion.speed.duration_s() - done.profile_start_s);
  work.time.motion = std::min(FromSeconds(profile_left_s), claimed);
  work.time.settling = claimed - work.time.motion;

  const double profile_end_s =
      done.profile_start_s + std::min(profile_left_s, ToSeconds(done.end - done.start));
  const double length = TipLength(shape);
  AddLengths(done, length, work);
  work.shutter_open = ShutterShare(done.end, claimed);
  if (done.beam_on) {
    LogOf(done.place.program);
    work.beam_on = claimed;
    const double way = done.travelled - done.from;
    work.cut_energy_j =
        beam_.Moving(motion.speed, done.profile_start_s, profile_end_s,
                     way > 0.0 ? length / way : 0.0, done.power, contours_.PaceOf(done));
    work.cut_energy_j += beam_.Standing(ToSeconds(work.time.settling), done.power.constant_percent);
  }
  AddShape(done, shape, profile_end_s, work);
  stands_since_beam_on_ = false;
  work_.Add(done.place, work);
}

void ReportRecorder::AddLengths(const machine::MotionDone& done, double length, WorkFigures& work) {
  work.tip_path_mm = length;
  (Cuts(done) ? work.cut_mm : work.travel_mm) = length;
  const bool plunge = done.use == MotionUse::kPlunge && done.in_work;
  if (plunge) work.plunge_mm = length;
  if (plunge && !plunging_) work.plunges = 1;
  plunging_ = plunge;
}

void ReportRecorder::AddShape(const machine::MotionDone& done, PartShape& shape,
                              double profile_end_s, const WorkFigures& work) {
  const PointSweep& tip = shape.tip();
  const PointSweep column = shape_.five_axis ? ColumnSweep(shape) : tip;
  const std::array<CoordinateSweep, 2> rotary = RotarySweep(shape);
  FigureLog* log = LogOf(done.place.program);
  if (!HasItsOwn(done.place.program)) log = nullptr;
  const bool tip_limited = !shape_.five_axis || done.programmed_mm_s > 0.0;
  // What a program has reached the job has, too.
  const MotionPeaks peaks =
      PeaksBeyond((log != nullptr ? *log : job_).Known(tip_limited), *done.motion, shape,
                  shape_.five_axis, done.profile_start_s, profile_end_s);
  const AxisLog::Motion axes{.xyz = column,
                             .ab = rotary,
                             .peaks = peaks,
                             .tip_path_mm = work.tip_path_mm,
                             .tip_limited = tip_limited};
  if (done.beam_on) {
    contours_.Add({.done = done, .work = work, .column = column, .rotary = rotary});
  } else {
    contours_.Travel();
  }
  const machine::Box tip_box = BoxOf(tip);
  const machine::Box column_box = BoxOf(column);
  const std::optional<SlowMove> slow = speeds_.Add(done);
  if (slow) slow_moves_.Add(*slow);
  const FigureLog::Motion figures{.done = done,
                                  .axes = axes,
                                  .tip = tip_box,
                                  .column = column_box,
                                  .cuts = Cuts(done),
                                  .slow = slow};
  job_.Add(figures);
  if (log != nullptr) log->Add(figures);
}

// Whether the figures of a program are other than those of the job: not as long as no other one has
// any. To be asked before the job is told of what belongs to that program.
bool ReportRecorder::HasItsOwn(int program) {
  if (!only_program_ && !several_programs_) only_program_ = program;
  if (only_program_ == program) return false;
  if (only_program_) {
    if (const auto first = programs_.find(*only_program_); first != programs_.end())
      first->second.TakeFigures(job_);
    several_programs_ = true;
    only_program_.reset();
  }
  return true;
}

void ReportRecorder::OnMove(const machine::MoveDone& move) {
  if (!move.programmed) return;  // where it ends is asked of the run
  FigureLog* log = LogOf(move.place.program);
  if (HasItsOwn(move.place.program) && log != nullptr) log->AddProgrammed(move.program_point);
  job_.AddProgrammed(move.program_point);
  last_ = {.tip = move.tip,
           .axes = move.axes,
           .program_point = move.program_point,
           .program_a = move.rotary_a,
           .program_b = move.tip.b_rad};
}

void ReportRecorder::OnSignal(const machine::SignalChange& change) {
  const bool on = change.value != 0.0;
  if (change.signal == Signal::kBeam) {
    time_.Leave(change.at, Now());  // before the beam changes
    if (on && !beam_on_) {
      WorkFigures work;
      work.beam_switches = 1;
      work_.Add(change.place, work);
      stands_since_beam_on_ = true;
      pierce_counted_ = false;
      contours_.BeamOn(change.at, change.place);
    }
    if (!on) contours_.BeamOff();
    beam_on_ = on;
  }
  if (change.signal == Signal::kShutter && on != shutter_open_) {
    if (on) {
      shutter_since_ = change.at;
      shutter_counted_ = SimTime::zero();
      shutter_open_ = true;
    } else {
      CloseShutter(change.at, change.place);
    }
  }
}

void ReportRecorder::OnWait(const machine::Wait& wait) {
  if (approaching_) return;
  const SimTime claimed = time_.Claim(wait.start, wait.end, Now());
  WorkFigures work;
  PartOf(work.time, wait.kind) = claimed;
  work.shutter_open = ShutterShare(wait.end, claimed);
  if (wait.beam_on) {
    LogOf(wait.place.program);
    work.beam_on = claimed;
    work.pierce_energy_j = beam_.Standing(ToSeconds(claimed), wait.power_percent);
    const bool pierces =
        wait.kind == WaitKind::kPierce || (wait.kind == WaitKind::kDwell && stands_since_beam_on_);
    if (pierces && !pierce_counted_ && wait.end > wait.start) {
      work.pierces = 1;
      pierce_counted_ = true;
    }
    contours_.Add(wait, work, pierces);
  }
  work_.Add(wait.place, work);
}

void ReportRecorder::OnHalt(const machine::Halt& halt) {
  if (approaching_) return;
  time_.Leave(halt.at, Now());
  contours_.Halt();
  halted_ = true;
  ++halts_;
}

void ReportRecorder::OnResume(SimTime at, const machine::Place& /*place*/) {
  if (approaching_) return;
  time_.Leave(at, Now());
  halted_ = false;
}

void ReportRecorder::OnViolation(const machine::TravelViolation& violation) {
  violations_.Add(violation);
}

void ReportRecorder::OnDiagnostic(SimTime at, const Diagnostic& diagnostic) {
  findings_.Add(at, diagnostic);
}

void ReportRecorder::OnCounted(SimTime at, const Diagnostic& diagnostic) {
  findings_.Count(at, diagnostic);
}

void ReportRecorder::Finish(SimTime at) {
  if (approaching_) OnEntered(at);  // it never came there
  time_.Leave(at, Now());
  time_.Close();
  if (shutter_open_) CloseShutter(at, place_);
}

RunReport ReportRecorder::Report(const machine::Run& run) const {
  const machine::RunState state = run.state();
  RunReport report;
  report.finished = state.phase == machine::RunPhase::kFinished;
  if (report.finished) report.outcome = run.outcome();
  report.cycle_time = time_.counted();
  report.steps_executed = run.steps_executed() - steps_before_;
  report.halts = halts_;
  report.final_position = last_;
  report.final_position.tip = state.tip;
  report.final_position.axes = state.axes;
  report.work_origin = state.work_origin;
  work_.WriteTo(report, each_step_);
  if (shutter_open_) {
    report.total.shutter_open += time_.reached() - shutter_since_ - shutter_counted_;
  }
  job_.WriteTo(report, report.total.beam_on);
  report.beam = beam_.Histogram(report.total.beam_on);
  for (auto& [program, figures] : report.programs) {
    const auto log = programs_.find(program);
    if (log == programs_.end()) continue;
    (only_program_ == program ? job_ : log->second).WriteTo(figures, figures.total.beam_on);
    figures.beam = log->second.beam().Histogram(figures.total.beam_on);
  }
  report.slow_moves = slow_moves_.moves();
  report.slow_moves_dropped = slow_moves_.dropped();
  report.findings = findings_.findings();
  report.findings_dropped = findings_.dropped();
  contours_.WriteTo(report);
  report.violations = violations_.violations();
  report.violations_dropped = violations_.dropped();
  report.figures = run.figures();
  for (const machine::Figure& figure : report.figures) {
    if (figure.name == kStarved)
      report.lookahead_starved = static_cast<std::uint64_t>(figure.value);
  }
  return report;
}

}  // namespace rmlcell::simulation
