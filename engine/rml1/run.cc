#include "engine/rml1/run.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/rml1/figures.h"
#include "engine/rml1/machine_state.h"
#include "engine/rml1/variables.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::OutcomeKind;
using machine::RunPhase;

}  // namespace

class MillRun::Snapshot final : public machine::RunSnapshot {
 public:
  explicit Snapshot(State kept) : state(std::move(kept)) {}
  State state;
};

// What the device notices becomes steps and diagnostics of the run.
class MillRun::Listener final : public DeviceListener {
 public:
  explicit Listener(MillRun& run) : run_(run) {}

  void OnCommand(const CommandPlace& command) override {
    State& state = run_.state_;
    const SourceSpan where = state.lines.At(run_.stream(), command.offset, 0);
    const machine::Place before = state.place;
    state.place = {.program = run_.setup_.main_program,
                   .step = static_cast<int>(command.number),
                   .line = where.line,
                   .byte_offset = command.offset};
    if (run_.step_watcher_ != nullptr) {
      machine::StepFacts facts = run_.FactsBefore(state.place);
      // Behind a command that was cut off by ESC.K no run can halt.
      facts.inside_command =
          before.step + 1 != state.place.step || before.step != state.command_over;
      run_.step_watcher_->OnStepDue(facts);
    }
    run_.observer_.OnStep(state.now, state.place, RowOf(command.op).name);
  }

  void OnFinding(const Finding& finding) override {
    State& state = run_.state_;
    Diagnostic diagnostic = ToDiagnostic(finding, run_.stream(), state.lines);
    diagnostic.program = run_.setup_.main_program;
    run_.observer_.OnDiagnostic(state.now, diagnostic);
  }

  void OnCounted(const Finding& finding) override {
    State& state = run_.state_;
    Diagnostic diagnostic = PlainDiagnostic(finding, run_.stream(), state.lines);
    diagnostic.program = run_.setup_.main_program;
    run_.observer_.OnCounted(state.now, diagnostic);
  }

  void OnLost(const Carriage::LostLine& line) override {
    const State& state = run_.state_;
    run_.observer_.OnLost({.at = state.now,
                           .place = state.place,
                           .from = PoseOf(run_.profile(), line.from).tip,
                           .to = PoseOf(run_.profile(), line.to).tip});
  }

 private:
  MillRun& run_;
};

Result<std::unique_ptr<MillRun>> MillRun::Make(machine::RunSetup setup,
                                               machine::RunObserver& observer) {
  if (setup.simul && setup.simul->step > 0) {
    return Error{ErrorCode::kCellUnimplemented, "a mill has no dry run up to a step", {}};
  }
  if (setup.mode == machine::Mode::kRepeat) {
    return Error{ErrorCode::kCellUnimplemented, "a mill has no mode REPEAT", {}};
  }
  const Result<Profile> profile = MakeProfile(setup.parameters);
  if (!profile) return profile.error();
  Profile as_set = *profile;
  std::optional<MachineState> kept;
  if (!setup.machine_state.empty()) {
    const Result<MachineState> read = ReadMachineState(setup.machine_state, *profile);
    if (!read) return read.error();
    UseOrigin(read->origin, as_set);
    kept = *read;
  }
  std::unique_ptr<MillRun> run(
      new MillRun(std::move(setup), std::make_shared<const Profile>(as_set), observer));
  if (kept) {
    run->state_.device.Restore(kept->registers, kept->at);
    run->PutTool();
  }
  return run;
}

MillRun::MillRun(machine::RunSetup setup, std::shared_ptr<const Profile> profile,
                 machine::RunObserver& observer)
    : setup_(std::move(setup)), observer_(observer), state_(std::move(profile)) {
  if (!std::isnan(setup_.override_percent)) {
    state_.override_percent = std::clamp(setup_.override_percent, kOverrideMin, kOverrideMax);
  }
  state_.halts.after_each = setup_.mode == machine::Mode::kSingle;
  if (setup_.breakpoint && setup_.breakpoint->program == setup_.main_program &&
      setup_.breakpoint->step > 0) {
    state_.halts.breakpoints = {setup_.breakpoint->step};
  }
  PutTool();
  state_.place.program = setup_.main_program;
  const auto found = setup_.programs.find(setup_.main_program);
  if (found != setup_.programs.end()) program_ = found->second.object;
  if (!program_) {
    CloseWith(OutcomeKind::kFailed, ErrorCode::kCellNotFound,
              "no program in slot " + Told("program", setup_.main_program));
  }
}

// Before the first byte: where the device says that the tool stands.
void MillRun::PutTool() {
  state_.tool = state_.device.carriage().physical();
  state_.scout = Scout(state_.device);
  state_.ahead = LookAhead(profile(), state_.tool, state_.override_percent);
}

std::string_view MillRun::stream() const { return *program_; }

SimTime MillRun::NextInputTime() const {
  return state_.next_input < setup_.inputs.size() ? setup_.inputs[state_.next_input].at : kForever;
}

// Things that happen exactly at `until` belong to the next call, so that an input applied by the
// caller then comes first, as a scripted one of that time would.
RunPhase MillRun::Advance(SimTime until) {
  State& s = state_;
  if (s.scout.sent() >= released_ + machine::kReleaseEvery) {
    program_.Release();
    released_ = s.scout.sent();
  }
  const std::size_t known = Await();
  const std::size_t sent_max = std::min(s.sender.sent() + kBytesPerAdvance, known);
  const std::size_t ahead_max = std::min(s.scout.sent() + kBytesPerAdvance, known);
  const std::uint64_t commands_max = s.commands_seen + kCommandsPerAdvance;
  const SimTime limit =
      setup_.budget.virtual_time > SimTime::zero() ? setup_.budget.virtual_time : kForever;
  while (s.phase != RunPhase::kFinished) {
    const bool halted = s.halt != HaltCause::kNone;
    const bool scripted = s.next_input < setup_.inputs.size();
    // A key that was pressed behind a step is not for who comes to it. LIVE-6.01
    if (halted && (!scripted || s.halt == HaltCause::kEntry)) return s.phase = RunPhase::kHalted;
    const SimTime input_at = NextInputTime();
    SimTime next = s.now;  // of what happens next
    if (halted) {
      next = std::max(s.now, input_at);
    } else if (s.busy != Busy::kNothing) {
      next = std::max(s.now, std::min(input_at, s.busy_until));
    }
    if (next > limit && limit < until) {
      s.now = std::max(s.now, limit);
      End(OutcomeKind::kBudgetExceeded, ErrorCode::kCellTimeBudget);
      break;
    }
    if (next >= until) {
      s.now = std::max(s.now, until == kForever ? s.now : until);
      return s.phase = RunPhase::kRunning;
    }
    s.now = next;
    if (scripted && input_at <= s.now && !MayYetHalt()) {
      Handle(setup_.inputs[s.next_input++]);
    } else if (s.busy == Busy::kMotion && s.ride.under_way() == nullptr) {
      if (!PlanLeg(ahead_max)) return s.phase = RunPhase::kRunning;
    } else if (s.busy != Busy::kNothing) {
      EndBusy();
    } else if (s.sender.sent() < sent_max && s.commands_seen < commands_max) {
      Proceed(sent_max);
    } else {
      return s.phase = RunPhase::kRunning;
    }
  }
  return s.phase;
}

// START is for a machine that halts: this one may be about to, at the very instant of the key.
bool MillRun::MayYetHalt() const {
  const State& s = state_;
  if (setup_.inputs[s.next_input].kind != InputKind::kStart || s.halt != HaltCause::kNone)
    return false;
  return s.busy == Busy::kNothing || s.busy_until <= s.now;
}

// The next thing that takes no time, or the start of one that does.
void MillRun::Proceed(std::size_t sent_max) {
  State& s = state_;
  if (s.time_stands && !Moves()) {
    Freeze();
    return CloseWith(OutcomeKind::kFailed, ErrorCode::kCellStepBudget,
                     Told("steps", setup_.budget.steps_at_one_instant) +
                         " commands were executed at one instant");
  }
  // STOP alone halts in the middle of a motion.
  const bool ends_motion_first = s.rest_left && s.halt_wanted != HaltCause::kStop;
  if (s.halt_wanted != HaltCause::kNone && !Moves() && !ends_motion_first) {
    BeginHalt(s.halt_wanted);
    return;
  }
  if (s.rest_left) return ResumeMotion();
  if (s.wait_left > SimTime::zero()) {
    BeginWait(s.wait_kind, ToSeconds(s.wait_left));
    s.wait_left = SimTime::zero();
    return;
  }
  if (s.approaching) return GoOnApproaching();
  if (s.halts.entry == 1 && s.sender.sent() == 0 && !s.reached) return HaltAtTarget();
  if (!s.device.actions().empty()) {
    const Action action = s.device.actions().front();
    if (action.kind == Action::Kind::kPause) {
      Listener listener(*this);
      s.sender.FillBuffer(s.device, program_, listener);
      BeginHalt(HaltCause::kPause);
      return;
    }
    s.device.actions().Pop();
    Begin(action);
    return;
  }
  const std::uint64_t done = s.device.commands_done();
  if (done != s.commands_seen) {
    if (s.instant != s.now) {
      s.instant = s.now;
      s.commands_before = s.commands_seen;
    }
    s.commands_seen = done;
    s.command_over = s.place.step;
    if (setup_.budget.steps > 0 && done > setup_.budget.steps) {
      End(OutcomeKind::kBudgetExceeded, ErrorCode::kCellStepBudget);
      return;
    }
    if (TimeStands()) {
      s.time_stands = true;
      return PressStop();
    }
    if (s.halts.EntersAfter(s.place.step)) return HaltAtTarget();
    if (s.halts.After(s.place.step)) {
      const bool breaks = s.halts.BreaksAfter(s.place.step);
      const HaltCause cause = breaks ? HaltCause::kBreakpoint : HaltCause::kSingle;
      // It was set behind a place that had been read ahead: the tool passes here.
      if (Moves()) return HaltBehindMotion(cause);
      return BeginHalt(cause);
    }
  }
  Interpret(sent_max);
}

// LIVE-3.01: so many commands behind one another move nothing and wait for nothing.
bool MillRun::TimeStands() const {
  const std::uint64_t most = setup_.budget.steps_at_one_instant;
  return most > 0 && state_.commands_seen - state_.commands_before >= most;
}

// Bytes, until one of them makes something happen, or so many of them.
void MillRun::Interpret(std::size_t sent_max) {
  State& s = state_;
  Listener listener(*this);
  const auto happened = [&s] {
    return !s.device.actions().empty() || s.device.commands_done() != s.commands_seen;
  };
  for (;;) {
    while (s.device.Step(listener)) {
      if (happened()) return;
    }
    if (s.sender.done(stream())) return Finish();
    if (s.sender.given() >= sent_max) return;
    s.sender.Send(s.device, stream(), sent_max, 1, listener);
    if (happened()) return;
  }
}

void MillRun::Finish() {
  State& s = state_;
  s.device.EndOfData();
  if (s.device.pending()) {
    const ErrorCode code = ErrorCode::kRml1IncompleteCommand;
    Diagnostic diagnostic{.code = code,
                          .severity = Lookup(code).severity,
                          .detail = "incomplete command at end of data",
                          .rule = "RML1-9.42",
                          .file = {},
                          .where = s.lines.At(stream(), s.device.pending_offset(), 1),
                          .program = setup_.main_program,
                          .step = 0,
                          .fixes = {}};
    observer_.OnDiagnostic(s.now, diagnostic);
  }
  CloseWith(OutcomeKind::kCompleted, std::nullopt, {});
}

void MillRun::Apply(const machine::InputChange& input) {
  if (state_.phase != RunPhase::kFinished) Handle(input);
}

void MillRun::Stand(SimTime until) {
  if (state_.halt != HaltCause::kNone && state_.phase != RunPhase::kFinished)
    state_.now = std::max(state_.now, until);
}

// A mill knows SINGLE; all else is one mode to it.
void MillRun::SetMode(machine::Mode mode) {
  state_.halts.after_each = mode == machine::Mode::kSingle;
}

void MillRun::SetBreakpoints(const std::vector<machine::Breakpoint>& breakpoints) {
  std::vector<int> commands;
  for (const machine::Breakpoint& breakpoint : breakpoints) {
    if (breakpoint.at.program == setup_.main_program) commands.push_back(breakpoint.at.step);
  }
  std::ranges::sort(commands);
  state_.halts.breakpoints = std::move(commands);
}

std::vector<machine::ModalValue> MillRun::modal_values() const {
  return ModalRegisters(state_.device, profile(),
                        {.at = ToolAt(TipNow()), .spindle_turns = SpindleTurns()});
}

void MillRun::Handle(const machine::InputChange& input) {
  switch (input.kind) {
    case InputKind::kStart:
      PressStart(input.value != 0.0);
      break;
    case InputKind::kHold:
      PressHold();
      break;
    case InputKind::kStop:
      PressStop();
      break;
    case InputKind::kOverride:
      ChangeOverride(input.value);
      break;
    case InputKind::kEmergencyStop:
      Freeze();
      CloseWith(OutcomeKind::kStopped, std::nullopt, "emergency stop");  // it has no number
      break;
    case InputKind::kDoor:
      MoveCover(input.value != 0.0);
      break;
    case InputKind::kLogical:
    case InputKind::kAnalogue:
    case InputKind::kVariable:
      break;  // a mill has no inputs, and no variable that is written
  }
}

// Also takes back a HOLD or STOP that has not halted it yet; the tool that brakes for a STOP comes
// to rest first.
void MillRun::PressStart(bool spindle) {
  State& s = state_;
  if (s.halt != HaltCause::kNone) return EndHalt(spindle);
  s.halt_wanted = HaltCause::kNone;
  if (!Moves() || !s.ride.protocol().may_resume()) return;
  s.ride.protocol().Resume();
  PlanAnew();
}

void MillRun::PressHold() { HaltBehindMotion(HaltCause::kHold); }

void MillRun::HaltBehindMotion(HaltCause cause) {
  State& s = state_;
  if (s.halt != HaltCause::kNone || s.halt_wanted != HaltCause::kNone) return;
  s.halt_wanted = cause;
  if (!Moves() || !s.ride.protocol().may_hold()) return;
  s.ride.protocol().Hold();
  PlanAnew();
}

// Brakes on the path, or stops the clock of a wait; standing still it is a HOLD.
void MillRun::PressStop() {
  State& s = state_;
  if (s.halt != HaltCause::kNone) return;
  s.halt_wanted = HaltCause::kStop;
  if (Moves()) {
    if (!s.ride.protocol().may_stop()) return;
    s.ride.protocol().Stop();
    PlanAnew();
  } else if (s.busy == Busy::kWait) {
    s.wait_left = s.busy_until - s.now;
    EndWait();
    s.clock.Set(s.now);
  }
}

// A ramp to rest stays what it is, and so does travel, of which no chain is but a part.
void MillRun::ChangeOverride(double percent) {
  State& s = state_;
  if (std::isnan(percent)) return;
  const double before = s.override_percent;
  s.override_percent = std::clamp(percent, kOverrideMin, kOverrideMax);
  if (s.override_percent == before) return;
  if (!s.ride.protocol().Override() || !Moves() || s.motion.action.rapid) {
    s.ahead.SetOverride(s.override_percent);
  } else {
    PlanAnew();
  }
}

machine::HaltReason MillRun::ReasonOf(HaltCause cause) {
  using enum machine::HaltReason;
  static constexpr std::array<machine::HaltReason, 7> kReason = {
      kHold, kProgram, kHold, kStop, kSingle, kBreakpoint, kBreakpoint};
  return kReason[static_cast<std::size_t>(cause)];
}

void MillRun::BeginHalt(HaltCause cause) {
  State& s = state_;
  static constexpr std::array<std::string_view, 7> kWhy = {"",       "!NR",        "HOLD", "STOP",
                                                           "SINGLE", "BREAKPOINT", "ENTRY"};
  std::string_view why = kWhy[static_cast<std::size_t>(cause)];
  if (cause == HaltCause::kPause && s.device.actions().front().outside) why = "OVER_AREA";
  s.halt = cause;
  s.halt_wanted = HaltCause::kNone;
  s.halted_at = s.now;
  if (s.ride.protocol().comes_to_rest()) s.ride.protocol().Rest();
  if (s.cover_open) StopBehindCover();
  observer_.OnHalt({.at = s.now, .place = s.place, .reason = ReasonOf(cause), .why = why});
  const bool for_ever = cause == HaltCause::kPause && s.next_input == setup_.inputs.size();
  if (!for_ever) return;
  const ErrorCode code = ErrorCode::kRml1PausedAtEnd;
  Diagnostic diagnostic{.code = code,
                        .severity = Lookup(code).severity,
                        .detail = "the machine waits for its resume key",
                        .rule = "RML1-3C.08",
                        .file = {},
                        .where = s.lines.At(stream(), s.place.byte_offset, 3),
                        .program = setup_.main_program,
                        .step = s.place.step,
                        .fixes = {}};
  observer_.OnDiagnostic(s.now, diagnostic);
}

void MillRun::EndHalt(bool spindle) {
  State& s = state_;
  s.away.reset();
  if (s.halt == HaltCause::kPause) s.device.actions().Pop();
  if (s.now > s.halted_at) {
    observer_.OnWait({.start = s.halted_at,
                      .end = s.now,
                      .place = s.place,
                      .kind = machine::WaitKind::kOperator});
    if (!s.approaching) s.physical.OnHalt(ToSeconds(s.now - s.halted_at));
  }
  s.halt = HaltCause::kNone;
  s.phase = RunPhase::kRunning;
  s.clock.Set(s.now);
  observer_.OnResume(s.now, s.place);
  const bool by_cover = std::exchange(s.stopped_by_cover, false);
  if (!(spindle || by_cover) || !s.spindle_stopped) return;
  TurnSpindle();
  // What is left of a wait that STOP interrupted goes on meanwhile.
  const double spin_up_s = profile().spin_up_s;
  if (s.wait_left > FromSeconds(spin_up_s)) return;
  s.wait_left = SimTime::zero();
  BeginWait(machine::WaitKind::kSpinUp, spin_up_s);
}

// Whoever closes it starts nothing; what it has stopped goes on with the run. DEV-3.12
void MillRun::MoveCover(bool open) {
  State& s = state_;
  s.cover_open = open && profile().cover != machine::CoverAct::kNone;
  if (s.cover_open && s.halt != HaltCause::kNone) StopBehindCover();
}

void MillRun::StopBehindCover() {
  if (!SpindleTurns()) return;
  EmitSignal(machine::Signal::kSpindle, 0.0, 0.0);
  state_.spindle_stopped = state_.stopped_by_cover = true;
}

// VIEW moves it out of the way and back: it goes on where it was halted.
void MillRun::MoveTo(const motion::AxisPose& axes) {
  constexpr double kSame_mm = 1e-6;
  const motion::TipPose here{.tip = axes.column, .a_rad = axes.a_rad, .b_rad = axes.b_rad};
  state_.away.reset();
  if ((axes.column - TipNow().tip).norm() > kSame_mm) state_.away = ToolAt(here);
}

void MillRun::End(OutcomeKind kind, ErrorCode code) {
  State& s = state_;
  if (s.phase == RunPhase::kFinished) return;
  Freeze();
  CloseWith(kind, code, {});
}

// The tool stands where it is, and the spindle stops.
void MillRun::Freeze() {
  State& s = state_;
  if (s.away) s.tool = *std::exchange(s.away, std::nullopt);
  if (const motion::MotionUnderWay* leg = s.ride.under_way()) {
    const Point stopped_at = ToolAt(TipNow());
    ReportLeg(leg->At(s.now).s);
    s.tool = stopped_at;
  } else if (s.busy == Busy::kWait) {
    EndWait();
  }
  s.busy = Busy::kNothing;
  s.ride.Finish();
  if (SpindleTurns()) EmitSignal(machine::Signal::kSpindle, 0.0, 0.0);
}

bool MillRun::SpindleTurns() const {
  return state_.device.spindle_turns() && !state_.spindle_to_come && !state_.spindle_stopped &&
         state_.outcome.kind == OutcomeKind::kCompleted;
}

void MillRun::CloseWith(OutcomeKind kind, std::optional<ErrorCode> code, Detail detail) {
  state_.phase = RunPhase::kFinished;
  state_.outcome = {.kind = kind, .code = code, .detail = std::move(detail), .place = state_.place};
}

machine::RunState MillRun::state() const {
  const State& s = state_;
  machine::RunState state;
  state.time = s.now;
  state.phase = s.phase;
  state.place = s.place;
  if (s.place.step > 0) state.instruction = RowOf(s.device.command().op).name;
  state.tip = TipNow();
  state.axes = {.column = state.tip.tip, .a_rad = state.tip.a_rad, .b_rad = 0.0};
  if (const motion::MotionUnderWay* leg = s.ride.under_way()) {
    state.tip_speed_mm_s = leg->TipSpeedAt(s.now);
  } else if (s.phase != RunPhase::kFinished) {
    state.tip_speed_mm_s = s.ahead.speed();
  }
  state.override_percent = s.override_percent;
  state.spindle_on = SpindleTurns();
  state.approaching = s.approaching;
  state.approached = s.approached;
  if (s.halt != HaltCause::kNone) state.halted_by = ReasonOf(s.halt);
  state.work_origin =
      motion::MachinePoint(profile().origin_x, profile().origin_y, s.device.registers().surface_z) /
      profile().units_per_mm;
  const double size = static_cast<double>(stream().size());
  if (program_.whole()) {
    state.progress =
        size > 0.0 ? static_cast<double>(s.sender.given() - s.device.waiting()) / size : 1.0;
  }
  return state;
}

std::optional<machine::VariableValue> MillRun::ReadVariable(std::string_view name) const {
  return ReadRegister(state_.device, profile(),
                      {.at = ToolAt(TipNow()), .spindle_turns = SpindleTurns()}, name);
}

std::vector<machine::Figure> MillRun::figures() const {
  std::vector<machine::Figure> figures = FiguresOf(
      state_.device, state_.physical,
      state_.phase == RunPhase::kFinished && state_.outcome.kind == OutcomeKind::kCompleted,
      state_.ahead.starved());
  machine::Bytes whole = program_;  // of a run that was ended before its stream had come
  whole.ReadAll();
  PlaceFigures(*whole, whole.keeper(), setup_.main_program, figures);
  return figures;
}

// A run that is cut short, here or later, leaves the tool where it stands, and the spindle off.
std::string MillRun::SaveMachine() const {
  MachineState kept{.registers = state_.device.registers(),
                    .at = state_.away.value_or(ToolAt(TipNow())),
                    .origin = OriginOf(profile())};
  kept.registers.spindle_on = state_.phase == RunPhase::kFinished && SpindleTurns();
  return WriteMachineState(kept);
}

std::unique_ptr<machine::RunSnapshot> MillRun::Save() const {
  return std::make_unique<Snapshot>(state_);
}

void MillRun::Restore(const machine::RunSnapshot& snapshot) {
  state_ = static_cast<const Snapshot&>(snapshot).state;
  released_ = state_.scout.sent();
}

}  // namespace rmlcell::rml1
