#include "engine/optimo/control/control.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/optimo/control/break_condition.h"
#include "engine/optimo/control/modal_values.h"

namespace rmlcell::optimo {
namespace {

using machine::RunPhase;

// What a run sets replaces what the machine kept; step 0 switches it off.
void Replace(std::optional<machine::ProgramStep>& kept,
             const std::optional<machine::ProgramStep>& set) {
  if (!set) return;
  kept = set;
  if (set->step == 0) kept.reset();
}

// What the run begins with. Precondition: the bytes of the setup were looked at.
MachineState KeptOf(const OptimoParameters& parameters, const machine::RunSetup& setup) {
  MachineState kept = NewMachine(parameters);
  if (!setup.machine_state.empty()) {
    if (Result<MachineState> state = DecodeMachineState(setup.machine_state)) kept = *state;
  }
  // What is set for this run replaces what the machine kept, and is kept like it (OPT-6.08, 6.14).
  Replace(kept.breakpoint, setup.breakpoint);
  Replace(kept.simul, setup.simul);
  return kept;
}

machine::RunSetup WithBudget(machine::RunSetup setup) {
  if (setup.budget.steps == 0) setup.budget.steps = std::numeric_limits<std::uint64_t>::max();
  if (setup.budget.virtual_time <= SimTime(0)) setup.budget.virtual_time = kForever;
  return setup;
}

}  // namespace

Control::Control(OptimoParameters parameters, machine::RunSetup setup,
                 machine::RunObserver& observer)
    : parameters_(std::move(parameters)),
      setup_(WithBudget(std::move(setup))),
      cycle_(parameters_.cycle_s),
      s_(parameters_, KeptOf(parameters_, setup_)),
      telling_(now(), setup_, observer),
      travel_(s_.travel, now(), parameters_, telling_, setup_.forecast),
      ride_(s_.ride, now(), s_.actuators.beam, parameters_, travel_, telling_, *this),
      actuators_(s_.actuators, now(), parameters_, setup_, telling_, ride_),
      effects_(s_.effects, actuators_, ride_),
      counter_(s_.counter, now(), parameters_, setup_, telling_),
      data_(s_.data, now(), parameters_, counter_, ride_, effects_, observer),
      plain_(counter_, s_.data, now(), parameters_, telling_),
      waits_(s_.waits, now(), s_.actuators.beam, cycle_, telling_, ride_),
      watch_(s_.watch, now(), cycle_, counter_, ride_, data_, waits_),
      process_watch_(s_.process_watch, s_.actuators),
      works_(s_.works, now(), parameters_, cycle_, telling_, counter_, ride_, actuators_, effects_,
             data_, waits_),
      halts_(s_.halts, now(), telling_, ride_, actuators_, counter_, data_, waits_, watch_, works_),
      moves_(s_.moves, now(), parameters_, telling_, counter_, data_, travel_, ride_, effects_,
             waits_, watch_, halts_),
      flow_(now(), parameters_, cycle_, telling_, counter_, data_, effects_, waits_),
      alarms_(s_.alarms, now(), telling_, counter_, ride_, actuators_, data_, waits_, watch_,
              works_) {
  now().mode = setup_.mode;
  s_.ride.override_percent = setup_.override_percent;
  // START: the program begins, in SINGLE with its first step (OPT-6.31).
  const Result<Loaded> main = counter_.Acquire(setup_.main_program, false);
  if (main) {
    BeginMain(*main, setup_.main_program);
  } else {
    Raise(main.error());
  }
}

RunPhase Control::Advance(SimTime until) {
  int carried_out = 0;
  for (;;) {
    // A key that was pressed behind the step is not for who comes to it. LIVE-6.01
    if (now().phase == RunPhase::kHalted && s_.entry.halted) return now().phase;
    if (ScriptedIsDue()) ApplyScripted();
    if (now().phase == RunPhase::kFinished) return now().phase;
    const bool scripted = s_.next_input < setup_.inputs.size();
    if (now().phase == RunPhase::kHalted) {
      // Time stands for the program; the next scripted key may come.
      if (!scripted) return now().phase;
      const SimTime key = setup_.inputs[s_.next_input].at;
      now().now = std::max(now().now, std::min(key, until));
      if (key > until) return now().phase;
      continue;
    }
    if (MayFetch()) {
      carried_out += FetchPlain(kStepsPerAdvance - carried_out);
      if (++carried_out > kStepsPerAdvance) return now().phase;
      Fetch();
      continue;
    }
    const SimTime next = NextEvent(until);
    if (next == kForever && until == kForever) return now().phase;  // nothing is to come
    const SimTime to = std::min({next, until, setup_.budget.virtual_time});
    now().now = std::max(now().now, to);
    if (next > until) return now().phase;
    if (ScriptedIsDue())
      ApplyScripted();  // an input of this instant is seen by the conditions of this instant
    if (!now().running()) continue;
    ActOnTime();
  }
}

bool Control::MayFetch() const {
  return now().running() && !waits_.waits() && !ride_.protocol().comes_to_rest() &&
         (!ride_.busy() || ride_.beside() || (halts_.stop_waits() && ride_.passing()));
}

bool Control::WaitsForEver() const {
  return waits_.pending().kind == Pending::Kind::kCondition && !ride_.busy() &&
         !watch_.times_out() && s_.next_input >= setup_.inputs.size();
}

SimTime Control::NextEvent(SimTime until) const {
  const SimTime own = NextOwnEvent(until);
  if (s_.next_input >= setup_.inputs.size()) return own;
  return std::min(own, std::max(now().now, setup_.inputs[s_.next_input].at));
}

// That of no key or input.
SimTime Control::NextOwnEvent(SimTime until) const {
  const SimTime time = now().now;
  const bool last_input = s_.next_input >= setup_.inputs.size();
  SimTime next = ride_.NextEvent();
  if (!watch_.idle() && !alarms_.deferred()) next = std::min(next, watch_.NextEvent(last_input));
  const Pending& pending = waits_.pending();
  switch (pending.kind) {
    case Pending::Kind::kTime:
      next = std::min(next, pending.until);
      break;
    case Pending::Kind::kCondition:
      if (watch_.times_out()) next = std::min(next, watch_.time_due());
      next = std::min(next, cycle_.NextTick(time, pending.since));
      break;
    case Pending::Kind::kTakeOver:
      next = std::min(next, ride_.busy() ? pending.until : time);
      break;
    case Pending::Kind::kStandstill:
      if (!ride_.busy()) next = time;
      break;
    case Pending::Kind::kNoMotion:
    case Pending::Kind::kNone:
      break;
  }
  if (WaitsForEver()) next = kForever;  // ticks would show nothing new
  if (!works_.idle() && !alarms_.deferred())
    next = std::min(next, works_.NextEvent(halts_.stops()));
  if (waits_.input_changed() && pending.kind == Pending::Kind::kCondition) next = time;
  const SimTime budget = setup_.budget.virtual_time;
  return std::max(budget, time + SimTime(1)) <= until ? std::min(next, budget) : next;
}

// Motions go on to this instant: what is over is told, and what follows begins. False: the machine
// has come to rest for a key.
bool Control::MoveOn() {
  if (ride_.under_way() != nullptr && now().now >= ride_.under_way()->end) {
    ride_.Arrive();
    waits_.ToldByMotion();
    works_.MarkStale();
  }
  ride_.Start();
  if (ride_.busy() || !ride_.protocol().comes_to_rest()) return true;
  halts_.HaltOnPath();
  return false;
}

// Whatever is due now, in a fixed order: motion first, then what waits for it.
void Control::ActOnTime() {
  if (!MoveOn() || halts_.StopNow()) return;
  if (!watch_.idle() && !alarms_.deferred()) {
    if (const Status looked = watch_.Look(); !looked)
      Raise(looked.error(), Alarms::Where::kBesideTheMotion);
  }
  if (!works_.idle() && now().running() && !alarms_.deferred()) {
    if (const std::optional<Works::Failure> failure = works_.Run(halts_.stops())) {
      const machine::Place in_execution = std::exchange(now().place, failure->place);
      Raise(failure->error, Alarms::Where::kBesideTheMotion);
      if (now().running()) now().place = in_execution;
    }
  }
  works_.InputSeen();
  if (now().running()) ActOnPending();
  // What can go on without time may do so: more than the budget is too much, not all of it.
  const SimTime budget = setup_.budget.virtual_time;
  if (!now().running() || now().now < budget || MayFetch()) return;
  const double limit = ToSeconds(budget);
  Detail detail =
      "the run takes longer than " + Told("limit", limit, "s", TrimmedText(limit, 9) + " s");
  if (WaitsForEver()) detail += ": it waits for a condition, and no input is to come";
  now().place = ride_.place();
  Finish(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kTimeBudget, std::move(detail));
}

void Control::ActOnPending() {
  const Pending& pending = waits_.pending();
  switch (pending.kind) {
    case Pending::Kind::kStandstill:
      if (ride_.busy()) break;
      waits_.End();
      if (const Status handled = alarms_.HandleDeferred(); !handled) {
        Finish(machine::OutcomeKind::kFailed, handled.error().code, handled.error().detail);
      }
      break;
    case Pending::Kind::kTime:
      if (now().now < pending.until) break;
      waits_.Tell();
      if (pending.wait == machine::WaitKind::kPierce) actuators_.ChangePower(pending.after);
      waits_.End();
      break;
    case Pending::Kind::kCondition: {
      waits_.InputSeen();
      const Result<bool> met = data_.Truth(pending.expression);
      if (!met) {
        Raise(met.error());
      } else if (*met) {
        waits_.EndMet();
      }
      break;
    }
    case Pending::Kind::kTakeOver:
      if (ride_.busy() && now().now < pending.until) break;
      waits_.End();
      if (ride_.TakeOver()) waits_.BeginStandstill();
      break;
    case Pending::Kind::kNoMotion:  // the watch ends it
    case Pending::Kind::kNone:
      break;
  }
}

bool Control::ScriptedIsDue() const {
  if (s_.next_input >= setup_.inputs.size()) return false;
  const machine::InputChange& input = setup_.inputs[s_.next_input];
  if (input.at > now().now) return false;
  if (input.kind != machine::InputKind::kStart || !now().running()) return true;
  // START is for a machine that halts: it may be about to, at this very instant.
  return !MayFetch() && NextOwnEvent(kForever) > now().now;
}

void Control::ApplyScripted() {
  while (ScriptedIsDue() && now().phase != RunPhase::kFinished) {
    const machine::InputChange input = setup_.inputs[s_.next_input++];
    // Of several overrides of one instant the last one counts (motion.md 10, property 12).
    const auto later = std::span(setup_.inputs).subspan(s_.next_input);
    if (input.kind == machine::InputKind::kOverride && !later.empty() &&
        later.front().kind == input.kind && later.front().at == input.at) {
      continue;
    }
    Apply(input);
  }
}

// Conditions are looked at again, before the next tick.
void Control::ChangeOutside() {
  waits_.InputChanged();
  works_.InputChanged();
  works_.MarkStale();
}

void Control::Apply(const machine::InputChange& input) {
  if (now().phase == RunPhase::kFinished) return;
  if (now().running()) MoveOn();  // before the key
  works_.MarkStale();
  const auto index = static_cast<std::size_t>(std::clamp(input.index, 0, kVariableIndexMax));
  switch (input.kind) {
    case machine::InputKind::kLogical:
      ChangeOutside();
      data_.SetLogicalInput(index, input.value != 0.0);
      break;
    case machine::InputKind::kAnalogue:
      ChangeOutside();
      data_.SetAnalogueInput(index, static_cast<float>(input.value));
      break;
    case machine::InputKind::kOverride:
      ride_.ChangeOverride(input.value);
      break;
    case machine::InputKind::kDoor:
      // An open door acts as STOP, and the shutter closes. OPT-B.34, OPT-3.17
      if (input.value != 0.0) halts_.Stop();
      actuators_.MoveDoor(input.value != 0.0);
      break;
    case machine::InputKind::kStart:
      PressStart();
      break;
    case machine::InputKind::kHold:
      if (now().mode != machine::Mode::kRemote) halts_.Hold();
      break;
    case machine::InputKind::kStop:
      halts_.Stop();
      break;
    case machine::InputKind::kVariable:
      WriteVariable(input.name, input.value);
      break;
    case machine::InputKind::kEmergencyStop:  // no motion is modelled after it (motion.md 6)
      data_.SetLastError(ErrorCode::kEmergencyStop);
      End(machine::OutcomeKind::kFailed, ErrorCode::kEmergencyStop);
      break;
  }
}

void Control::Stand(SimTime until) {
  if (now().phase == RunPhase::kHalted) now().now = std::max(now().now, until);
}

void Control::MoveTo(const motion::AxisPose& axes) {
  ride_.MoveTo(axes);
  ChangeOutside();
}

void Control::SetMode(machine::Mode mode) {
  if (now().phase != RunPhase::kFinished) halts_.SetMode(mode);
}

void Control::WriteVariable(std::string_view name, double value) {
  if (now().phase == RunPhase::kFinished) return;
  const std::optional<Variable> variable = VariableNamed(name);
  if (!variable) return;
  const Result<float> number = Writable(*variable, value, parameters_);
  if (!number) return;
  ChangeOutside();
  data_.WriteFromOutside(*variable, *number);
}

void Control::SetBreakpoints(const std::vector<machine::Breakpoint>& breakpoints) {
  std::vector<WatchedStep> watched;
  for (const machine::Breakpoint& breakpoint : breakpoints) {
    WatchedStep& step = watched.emplace_back();
    step.breakpoint = breakpoint;
    if (breakpoint.condition.empty()) continue;
    if (Result<Condition> condition = ReadCondition(breakpoint.condition); condition)
      step.condition = *std::move(condition);
  }
  halts_.Watch(std::move(watched));
}

// Each activation stands at the instruction that it carried out last: a call, but for the
// innermost one.
std::vector<machine::Place> Control::Stack() const {
  std::vector<machine::Place> stack;
  for (const ProgramContext& program : counter_.programs()) {
    for (const Frame& frame : program.frames) {
      const LinkedModule& linked =
          program.program->executable.modules[static_cast<std::size_t>(frame.module)];
      const auto add = [&](std::uint32_t next) {
        const std::vector<Instruction>& all = linked.module.instructions;
        const std::size_t at = next > 0 ? next - 1 : 0;
        stack.push_back(telling_.PlaceOf(linked.slot, at < all.size() ? all[at].step : 0));
      };
      for (const std::uint32_t after : frame.returns) add(after);
      add(frame.next);
    }
  }
  if (!stack.empty()) stack.back() = now().place;
  return stack;
}

void Control::PressStart() {
  if (now().phase != RunPhase::kHalted) return;
  if (!actuators_.door_blocks_start()) {
    if (const Status resumed = halts_.Resume(); !resumed) Raise(resumed.error());
    return;
  }
  // An alarm: no ERR catches it (OPT-B.56).
  constexpr ErrorCode kCode = ErrorCode::kShutterInterlock;
  const Detail detail = "START with the operator door open";
  data_.SetLastError(kCode);
  telling_.Warn(kCode, detail, "OPT-3.17");
  Finish(machine::OutcomeKind::kFailed, kCode, detail);
}

void Control::Raise(const Error& error, Alarms::Where where) {
  if (const Status handled = alarms_.Raise(error, where); !handled) {
    Finish(machine::OutcomeKind::kFailed, handled.error().code, handled.error().detail);
  }
}

// From outside, wherever the machine is: at its place, not where the program has run ahead to.
void Control::End(machine::OutcomeKind kind, ErrorCode code) {
  if (now().phase == RunPhase::kFinished) return;
  now().place = ride_.place();
  Finish(kind, code, {});
}

// What goes on is told up to now.
void Control::Finish(machine::OutcomeKind kind, std::optional<ErrorCode> code, Detail detail) {
  if (now().phase == RunPhase::kHalted) {
    halts_.Tell();
  } else {
    waits_.Tell();
  }
  ride_.Freeze();
  // A chain of /FLY moves that never stands is still being planned: the run would have come there.
  if (code == ErrorCode::kStepBudget) ride_.TellViolationsToCome();
  actuators_.ShutDown();
  if (!s_.simul) s_.simul = now().simulated_until;  // its step was not reached: OPT-6.14
  now().phase = RunPhase::kFinished;
  s_.outcome = {.kind = kind, .code = code, .detail = std::move(detail), .place = now().place};
  travel_.Judge(s_.outcome);
}

MachineState Control::Kept() const {
  MachineState kept = s_.Kept();
  kept.axes = ride_.axes();
  if (!kept.simul) kept.simul = now().simulated_until;  // its step was not reached yet: OPT-6.14
  return kept;
}

std::vector<machine::ModalValue> Control::ModalValues() const {
  std::vector<machine::ModalValue> values;
  if (!counter_.empty()) values = ModalValuesOf(counter_.modal());
  for (machine::ModalValue& value : ModalValuesOf(now().tool, s_.moves.work_offset))
    values.push_back(std::move(value));
  return values;
}

std::vector<machine::Figure> Control::figures() const {
  std::vector<machine::Figure> figures = {
      {"lookahead_starved", "", static_cast<double>(s_.ride.planner.lookahead_starved())},
      {"executables_made", "", static_cast<double>(s_.counter.made_executables.size())}};
  for (machine::Figure& figure : process_watch_.figures()) figures.push_back(std::move(figure));
  return figures;
}

machine::MachineOutputs Control::outputs() const {
  machine::MachineOutputs outputs = OutputsOf(s_.actuators.outputs);
  const Beam& beam = s_.actuators.beam;
  if (beam.shutter_open()) outputs.on.push_back({.name = "shutter", .value = 1.0});
  if (beam.on()) outputs.power_percent = beam.power().PercentAt(ride_.tip_speed_mm_s());
  return outputs;
}

machine::RunState Control::Snapshot() const {
  machine::RunState state;
  state.time = now().now;
  state.phase = now().phase;
  state.place = ride_.motion_place();
  state.instruction = Describe(s_.op).name;
  state.tip = ride_.tip();
  state.axes = ride_.axes();
  state.tip_speed_mm_s = ride_.tip_speed_mm_s();
  state.override_percent = s_.ride.override_percent;
  state.beam_on = actuators_.beam_on();
  state.zeroed = s_.actuators.zeroed;
  state.door_open = actuators_.door_open();
  state.dry = now().simulated_until.has_value();
  state.executions = s_.executions;
  state.approaching = s_.entry.arrival.has_value();
  state.approached = s_.entry.approached;
  if (now().phase == RunPhase::kHalted) state.halted_by = s_.halts.halted_by;
  return state;
}

}  // namespace rmlcell::optimo
