#include "engine/optimo/control/control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/number_text.h"

namespace rmlcell::optimo {
namespace {

constexpr std::uint64_t kUnlimitedSteps = std::numeric_limits<std::uint64_t>::max();

// What a run sets replaces what the machine kept; step 0 switches it off.
void Replace(std::optional<machine::ProgramStep>& kept,
             const std::optional<machine::ProgramStep>& set) {
  if (!set) return;
  kept = set;
  if (set->step == 0) kept.reset();
}

}  // namespace

Loaded Load(Executable executable) {
  auto loaded = std::make_shared<LoadedProgram>();
  loaded->executable = std::move(executable);
  loaded->index.reserve(loaded->executable.modules.size());
  for (const LinkedModule& linked : loaded->executable.modules)
    loaded->index.emplace_back(linked.module);
  return loaded;
}

Control::Control(OptimoParameters parameters, machine::RunSetup setup,
                 machine::RunObserver& observer)
    : parameters_(std::move(parameters)),
      setup_(std::move(setup)),
      observer_(observer),
      s_(parameters_.limits) {
  if (setup_.budget.steps == 0) setup_.budget.steps = kUnlimitedSteps;
  if (setup_.budget.virtual_time <= SimTime(0)) setup_.budget.virtual_time = kForever;
  for (const auto& [slot, program] : setup_.programs) {
    if (IsSlot(slot)) sources_[static_cast<std::size_t>(slot)] = program.source.get();
  }
  s_.machine = NewMachine(parameters_);
  if (!setup_.machine_state.empty()) {
    if (Result<MachineState> state = DecodeMachineState(setup_.machine_state)) s_.machine = *state;
  }
  s_.planned_axes = s_.machine.axes;
  s_.mode = setup_.mode;
  s_.override_percent = setup_.override_percent;
  // What is set for this run replaces what the machine kept, and is kept like it (OPT-6.08, 6.14).
  Replace(s_.machine.breakpoint, setup_.breakpoint);
  s_.breakpoint = s_.machine.breakpoint;
  Replace(s_.machine.simul, setup_.simul);
  if (s_.machine.simul) s_.simulated = {.active = true, .until = *s_.machine.simul};
  s_.machine.simul.reset();
  StartMain();
}

int Control::LineOf(int slot, std::uint32_t step) const {
  const machine::SourceNotes* source = sources_[static_cast<std::size_t>(slot)];
  const bool known = source != nullptr && step >= 1 && step <= source->step_lines.size();
  return known ? source->step_lines[step - 1] : 0;
}

// START: the program begins, in SINGLE with its first step (OPT-6.31).
void Control::StartMain() {
  const std::optional<Loaded> main = Acquire(setup_.main_program, false);
  if (!main) return;
  Begin(*main, {});
  CountExecution(setup_.main_program);
}

// VI[98]: executions of the main program since it was selected. OPT-7.70, OPT-B.63
void Control::CountExecution(int slot) {
  float& count = s_.machine.data.vi[98];
  if (s_.machine.selected != slot) count = 0.0F;
  s_.machine.selected = slot;
  if (count < kIntegerMax) count += 1.0F;
}

// The instant so many seconds from now; far beyond any run when there is no such instant.
SimTime Control::After(double seconds) const {
  constexpr SimTime kFar = kForever / 4;  // a halt may still be added
  return std::min(s_.now, kFar) + std::min(FromSeconds(seconds), kFar);
}

// The first tick of the system cycle, counted from now, at which so many seconds are over. OPT-B.30
SimTime Control::TickAfter(double seconds) const {
  constexpr double kSame = 1e-9;  // of a cycle: a whole number of cycles stays one
  return After(std::ceil(seconds / parameters_.cycle_s - kSame) * parameters_.cycle_s);
}

machine::RunPhase Control::Advance(SimTime until) {
  int carried_out = 0;
  for (;;) {
    if (s_.phase == machine::RunPhase::kFinished) return s_.phase;
    ApplyScripted();
    if (s_.phase == machine::RunPhase::kHalted) {
      // Time stands for the program; the next scripted key may come.
      const bool more =
          s_.next_input < setup_.inputs.size() && setup_.inputs[s_.next_input].at <= until;
      if (!more) {
        if (s_.next_input < setup_.inputs.size()) s_.now = std::max(s_.now, until);
        return s_.phase;
      }
      s_.now = std::max(s_.now, setup_.inputs[s_.next_input].at);
      continue;
    }
    if (s_.phase == machine::RunPhase::kFinished) return s_.phase;
    if (MayFetch()) {
      if (++carried_out > kStepsPerAdvance) return s_.phase;
      Fetch();
      continue;
    }
    const SimTime next = NextEvent(until);
    if (next == kForever && until == kForever) return s_.phase;  // nothing is to come: time stands
    if (next > until) {
      LetTimePass(until);
      return s_.phase;
    }
    LetTimePass(next);
    ApplyScripted();  // an input of this instant is seen by the conditions of this instant
    if (s_.phase != machine::RunPhase::kRunning) continue;
    ActOnTime();
    if (s_.now >= until && !MayFetch() && NextEvent(until) > until) return s_.phase;
  }
}

bool Control::MayFetch() const {
  return s_.phase == machine::RunPhase::kRunning && s_.pending.kind == Pending::Kind::kNone &&
         !s_.halting && (!Busy() || s_.background || (s_.stop_requested && s_.passing));
}

// The next tick of the system cycle after now, counted from `since`. OPT-B.30
SimTime Control::NextTick(SimTime since) const {
  const SimTime cycle = FromSeconds(parameters_.cycle_s);
  return since + ((s_.now - since) / cycle + 1) * cycle;
}

// Nothing outside can change the condition any more, and no motion either.
bool Control::WaitsForEver() const {
  const bool times_out = s_.pending.of_move && s_.time_gosub;
  return s_.pending.kind == Pending::Kind::kCondition && !Busy() && !times_out &&
         s_.next_input >= setup_.inputs.size();
}

SimTime Control::NextEvent(SimTime until) const {
  SimTime next = kForever;
  if (s_.next_input < setup_.inputs.size())
    next = std::max(s_.now, setup_.inputs[s_.next_input].at);
  if (s_.active) {
    next = std::min(next, s_.active->end);
  } else if (!s_.timeline.empty()) {
    next = s_.now;
  }
  const bool last_input = s_.next_input >= setup_.inputs.size();
  if ((Watching() || s_.no_motion) && !s_.deferred) {
    // Where the program stands and no input is to come, ticks would show nothing new.
    const bool settled =
        s_.pending.kind == Pending::Kind::kNoMotion && !Busy() && last_input && !s_.input_changed;
    if (s_.end_condition && !settled) next = std::min(next, NextTick(s_.watched_since));
    if (s_.time_gosub && !s_.time_ran_out) next = std::min(next, std::max(s_.now, s_.time_due));
  }
  const bool times_out = s_.pending.of_move && s_.time_gosub;
  switch (s_.pending.kind) {
    case Pending::Kind::kTime:
      next = std::min(next, s_.pending.until);
      break;
    case Pending::Kind::kCondition:
      if (times_out) next = std::min(next, std::max(s_.now, s_.time_due));
      next = std::min(next, NextTick(s_.pending.since));
      break;
    case Pending::Kind::kTakeOver:
      next = std::min(next, Busy() ? s_.pending.until : s_.now);
      break;
    case Pending::Kind::kStandstill:
      if (!Busy()) next = s_.now;
      break;
    case Pending::Kind::kNoMotion:
    case Pending::Kind::kNone:
      break;
  }
  if (WaitsForEver()) next = kForever;  // ticks would show nothing new
  next = std::min(next, NextTask());
  if (s_.input_changed && s_.pending.kind == Pending::Kind::kCondition) next = s_.now;
  return std::min(next, std::max(setup_.budget.virtual_time, s_.now + SimTime(1)) <= until
                            ? setup_.budget.virtual_time
                            : kForever);
}

void Control::LetTimePass(SimTime to) {
  s_.now = std::max(s_.now, std::min(to, setup_.budget.virtual_time));
}

// Whatever is due now, in a fixed order: motion first, then what waits for it.
void Control::ActOnTime() {
  if (s_.active && s_.now >= s_.active->end) ArriveAtEnd();
  if (s_.phase != machine::RunPhase::kRunning) return;
  if (!s_.active && !s_.timeline.empty()) StartNextItem();
  if (s_.phase != machine::RunPhase::kRunning) return;
  if (s_.halting && !Busy()) return HaltOnPath();
  if (s_.stop_requested && s_.active && BringToHalt() && !Busy()) return HaltOnPath();
  WatchMove();
  RunTasks();
  if (s_.phase != machine::RunPhase::kRunning) return;
  Pending& pending = s_.pending;
  switch (pending.kind) {
    case Pending::Kind::kStandstill:
      if (Busy()) break;
      pending = {};
      if (s_.deferred) {
        const Error error = *s_.deferred;
        s_.deferred.reset();
        s_.place = s_.deferred_place;
        HandleError(error);
      }
      break;
    case Pending::Kind::kTime:
      if (s_.now < pending.until) break;
      TellWait();
      if (pending.wait == machine::WaitKind::kPierce) s_.beam.power = s_.power_before_pierce;
      pending = {};
      break;
    case Pending::Kind::kCondition: {
      s_.input_changed = false;
      const std::optional<bool> met = Truth(pending.expression);
      if (!met || !*met) break;
      TellWait();
      pending = {};
      s_.condition_met = true;
      break;
    }
    case Pending::Kind::kTakeOver:
      if (Busy() && s_.now < pending.until) break;
      s_.background = false;  // from here on it is a motion like any other that is waited for
      pending = {};
      if (!Busy()) break;  // it came to its end before
      pending = {.kind = Pending::Kind::kStandstill};
      if (s_.active) EndMotionHere();
      s_.timeline.clear();
      break;
    case Pending::Kind::kNoMotion:  // WatchMove ends it
    case Pending::Kind::kNone:
      break;
  }
  // What can go on without time may do so: more than the budget is too much, not all of it.
  if (s_.phase == machine::RunPhase::kRunning && s_.now >= setup_.budget.virtual_time &&
      !MayFetch()) {
    std::string detail =
        "the run takes longer than " + TrimmedText(ToSeconds(setup_.budget.virtual_time), 9) + " s";
    if (WaitsForEver()) detail += ": it waits for a condition, and no input is to come";
    BreakOff(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kTimeBudget, std::move(detail));
  }
}

void Control::ApplyScripted() {
  while (s_.next_input < setup_.inputs.size() && setup_.inputs[s_.next_input].at <= s_.now &&
         s_.phase != machine::RunPhase::kFinished) {
    const machine::InputChange input = setup_.inputs[s_.next_input++];
    // Of several overrides of one instant the last one counts (motion.md 10, property 12).
    if (input.kind == machine::InputKind::kOverride && s_.next_input < setup_.inputs.size()) {
      const machine::InputChange& next = setup_.inputs[s_.next_input];
      if (next.kind == input.kind && next.at == input.at) continue;
    }
    Apply(input);
  }
}

void Control::Apply(const machine::InputChange& input) {
  if (s_.phase == machine::RunPhase::kFinished) return;
  s_.input_changed = true;
  s_.tasks_input = true;
  MarkTasks();
  const auto index = static_cast<std::size_t>(std::clamp(input.index, 0, kVariableIndexMax));
  switch (input.kind) {
    case machine::InputKind::kLogical:
      s_.machine.data.il_physical[index] = input.value != 0.0;
      break;
    case machine::InputKind::kAnalogue:
      s_.machine.data.ia_physical[index] = static_cast<float>(input.value);
      break;
    case machine::InputKind::kOverride:
      ChangeOverride(input.value);
      break;
    case machine::InputKind::kDoor:
      s_.machine.door_open = input.value != 0.0;
      if (!s_.machine.door_open) break;
      // An open door acts as STOP, and the shutter closes (OPT-B.34, OPT-3.17).
      if (s_.phase == machine::RunPhase::kRunning)
        Apply({.at = s_.now, .kind = machine::InputKind::kStop});
      CloseBehindDoor();
      break;
    case machine::InputKind::kStart:
      Resume();
      break;
    case machine::InputKind::kHold:
      if (s_.mode == machine::Mode::kRemote) break;
      s_.hold_requested = true;
      if (s_.phase == machine::RunPhase::kRunning) EndAtATarget();
      break;
    case machine::InputKind::kStop:
      if (s_.phase != machine::RunPhase::kRunning) break;
      // A HOLD that is still on its way to the target is overtaken, a STOP is not.
      if (s_.halting && (s_.held.empty() || !s_.interrupted.empty())) break;
      if (!Busy() && !s_.passing) {
        Halt("STOP");
      } else if (s_.active && !s_.active->ended && BringToHalt()) {
        if (!Busy()) HaltOnPath();
      } else {
        s_.stop_requested = true;
      }
      break;
    case machine::InputKind::kEmergencyStop:
      EmergencyStop();
      break;
  }
}

void Control::CloseBehindDoor() {
  const machine::Place in_execution = std::exchange(s_.place, PlaceOfMotion());
  SuspendBeam();
  if (s_.beam.shutter_open) {
    s_.beam.shutter_was_open = true;
    CloseShutter();
  }
  s_.place = in_execution;
}

// Reports what was not yet reported of the wait under way. While a motion goes on (/NEXT) there is
// nothing to report: that time is the motion's.
void Control::TellWait() {
  Pending& pending = s_.pending;
  const bool timed = pending.kind == Pending::Kind::kTime;
  const bool condition =
      pending.kind == Pending::Kind::kCondition || pending.kind == Pending::Kind::kNoMotion;
  if (!timed && !condition) return;
  if (!s_.active && s_.now > pending.told) {
    observer_.OnWait({.start = pending.told,
                      .end = s_.now,
                      .place = pending.place,
                      .kind = timed ? pending.wait : machine::WaitKind::kCondition,
                      .beam_on = s_.beam.on,
                      .power_percent = s_.beam.on ? s_.beam.power.constant_percent : 0.0});
  }
  pending.told = s_.now;
}

// The step that the machine is at: the program runs ahead of /FLY moves, but not of one of /NEXT,
// which goes on beside it.
machine::Place Control::PlaceOfMotion() const {
  return s_.active && !s_.background ? s_.active->note.place : s_.place;
}

// The motions are at rest, and go on at START: the halt belongs to the move that was under way.
void Control::HaltOnPath() {
  s_.halting = false;
  s_.place_ahead = std::exchange(s_.place, s_.halted_behind);
  Halt(s_.held.empty() || !s_.interrupted.empty() ? "STOP" : "HOLD");
}

void Control::Halt(std::string_view why) {
  TellWait();
  s_.phase = machine::RunPhase::kHalted;
  s_.halted_at = s_.now;
  s_.hold_requested = false;
  s_.stop_requested = false;
  SuspendBeam();
  observer_.OnHalt({.at = s_.now, .place = s_.place, .why = why});
}

// The halt up to now: the operator is waited for.
void Control::TellHalt() {
  if (s_.now <= s_.halted_at) return;
  observer_.OnWait({.start = s_.halted_at,
                    .end = s_.now,
                    .place = s_.place,
                    .kind = machine::WaitKind::kOperator});
}

void Control::Resume() {
  if (s_.phase != machine::RunPhase::kHalted) return;
  if (s_.machine.door_open && (s_.beam_returns || s_.beam.shutter_was_open)) {
    // An alarm: no ERR catches it (OPT-B.56).
    constexpr std::string_view kDetail = "START with the operator door open";
    s_.machine.data.vi[99] = static_cast<float>(Lookup(ErrorCode::kShutterInterlock).number);
    Warn(ErrorCode::kShutterInterlock, std::string(kDetail), "OPT-3.17");
    return Finish(machine::OutcomeKind::kFailed, ErrorCode::kShutterInterlock,
                  std::string(kDetail));
  }
  TellHalt();
  // A wait that was under way lasts as long as before: time stood still for it.
  const SimTime stood = s_.now - s_.halted_at;
  if (s_.pending.kind != Pending::Kind::kNone) {
    s_.pending.since = s_.now;
    s_.pending.told = s_.now;
    s_.pending.until += stood;
  }
  for (WorkTask& task : program().work_tasks) {
    task.since += stood;
    task.until += stood;
  }
  s_.phase = machine::RunPhase::kRunning;
  observer_.OnResume(s_.now, s_.place);
  if (s_.beam.shutter_was_open) {
    s_.beam.shutter_was_open = false;
    OpenShutter();
  }
  if (s_.beam_returns) {
    s_.beam_returns = false;
    BeamOn(s_.beam.power);
  }
  const bool interrupted = !s_.interrupted.empty();
  s_.timeline.insert(s_.timeline.begin(), s_.interrupted.begin(), s_.interrupted.end());
  s_.interrupted.clear();
  PlanHeld();
  if (!Busy()) GoesOnInBackground(false);
  const bool overridden = std::exchange(s_.override_while_stopped, false);
  if (interrupted && overridden) {
    StartNextItem();
    AdaptMotions();
  }
  if (s_.place_ahead) s_.place = *std::exchange(s_.place_ahead, std::nullopt);
}

// The state freezes: no motion is modelled after it (motion.md 6).
void Control::EmergencyStop() {
  s_.machine.data.vi[99] = 7610.0F;
  BreakOff(machine::OutcomeKind::kFailed, ErrorCode::kEmergencyStop, {});
}

void Control::End(machine::OutcomeKind kind, ErrorCode code) {
  if (s_.phase != machine::RunPhase::kFinished) BreakOff(kind, code, {});
}

// From outside, wherever the machine is: at its place, not where the program has run ahead to.
void Control::BreakOff(machine::OutcomeKind kind, ErrorCode code, std::string detail) {
  s_.place = PlaceOfMotion();
  Finish(kind, code, std::move(detail));
}

// Beam off, shutter closed, whatever the reason (OPT-3.16, 3.18, B.54). What goes on is told up to
// now.
void Control::Finish(machine::OutcomeKind kind, std::optional<ErrorCode> code, std::string detail) {
  if (s_.phase == machine::RunPhase::kHalted) {
    TellHalt();
  } else {
    TellWait();
  }
  if (s_.active) {
    TellMotion(s_.now);
    s_.machine.axes = AxesNow();
    s_.active.reset();
  }
  // A chain of /FLY moves that never stands is still being planned: the run would have come there.
  if (code == ErrorCode::kStepBudget) {
    for (auto& [tag, note] : s_.notes) TellViolations(note.place, std::exchange(note.beyond, {}));
  }
  s_.timeline.clear();
  s_.held.clear();
  s_.interrupted.clear();
  BeamOff();
  CloseShutter();
  s_.beam_returns = false;
  if (s_.simulated.active && !s_.machine.simul) {
    s_.machine.simul = s_.simulated.until;  // its step was not reached: OPT-6.14
  }
  s_.phase = machine::RunPhase::kFinished;
  s_.outcome = {.kind = kind, .code = code, .detail = std::move(detail), .place = s_.place};
  FailOfViolations();
}

machine::RunState Control::Snapshot() const {
  machine::RunState state;
  state.time = s_.now;
  state.phase = s_.phase;
  state.place = s_.active ? s_.active->note.place : s_.place;
  state.instruction = Describe(s_.op).name;
  state.tip = TipNow();
  state.axes = AxesNow();
  state.tip_speed_mm_s = TipSpeedNow();
  state.override_percent = s_.override_percent;
  state.beam_on = s_.beam.on;
  return state;
}

}  // namespace rmlcell::optimo
