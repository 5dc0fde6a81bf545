#include "engine/machine/machine.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/number_text.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/refusal.h"

namespace rmlcell::machine {
namespace {

// What the machine itself takes, and not what is done to it from outside or to its memory. HOLD,
// STOP and ABORT find nothing to do.
template <class Input>
constexpr bool kNeedsPower =
    std::is_same_v<Input, StartRun> || std::is_same_v<Input, ZeroAxes> ||
    std::is_same_v<Input, ResumeRun> || std::is_same_v<Input, Acknowledge> ||
    std::is_same_v<Input, ChangeMode> || std::is_same_v<Input, ChangeOverride> ||
    std::is_same_v<Input, WriteVariable> || std::is_same_v<Input, SetBreakpoints> ||
    std::is_same_v<Input, SetSimulation> || std::is_same_v<Input, StartAtStep> ||
    std::is_same_v<Input, ClearMessage> || std::is_same_v<Input, PressJog> ||
    std::is_same_v<Input, SetGates> || std::is_same_v<Input, PressGate> ||
    std::is_same_v<Input, PressPanel>;

}  // namespace

Result<std::unique_ptr<Machine>> Machine::Make(const MachineFamily& family, Parameters parameters,
                                               MachineMemory memory, std::string_view state,
                                               RunObserver& observer) {
  std::unique_ptr<Machine> machine(
      new Machine(family, std::move(parameters), std::move(memory), observer));
  MachineNote note;
  if (!state.empty()) {
    Result<MachineNote> kept = ReadMachineNote(state);
    if (!kept) return kept.error();
    note = *std::move(kept);
  }
  if (const Status taken = machine->Take(std::move(note)); !taken) return taken.error();
  return machine;
}

Machine::Machine(const MachineFamily& family, Parameters parameters, MachineMemory memory,
                 RunObserver& observer)
    : family_(family),
      parameters_(std::move(parameters)),
      memory_(std::move(memory)),
      observer_(observer) {}

Status Machine::Take(MachineNote note) {
  for (const Breakpoint& breakpoint : note.breakpoints) {
    if (const Status good = family_.CheckBreakpoint(breakpoint); !good) return good.error();
  }
  Result<std::unique_ptr<Standing>> standing = family_.NewStanding(parameters_, note.family);
  if (!standing) return standing.error();
  Result<std::unique_ptr<Handbox>> handbox = family_.NewHandbox(parameters_, note.handbox);
  if (!handbox) return handbox.error();
  standing_ = *std::move(standing);
  handbox_ = *std::move(handbox);
  now_ = note.time;
  on_ = note.on;
  emergency_ = note.emergency;
  cover_open_ = note.cover_open && family_.info().cover_stops_jog;
  mode_ = note.mode;
  override_percent_ = note.override_percent;
  simulation_ = note.simulation;
  breakpoints_ = std::move(note.breakpoints);
  alarms_ = std::move(note.alarms);
  last_alarm_ = note.last_alarm;
  note_.number = note.last_run;
  shown_ = std::move(note.shown);
  message_ = note.message;
  gates_ = note.gates;
  return {};
}

std::string Machine::Save() const {
  return WriteMachineNote({.time = now_,
                           .on = on_,
                           .emergency = emergency_,
                           .cover_open = cover_open_,
                           .mode = mode_,
                           .override_percent = override_percent_,
                           .simulation = simulation_,
                           .breakpoints = breakpoints_,
                           .alarms = alarms_,
                           .last_alarm = last_alarm_,
                           .last_run = note_.number,
                           .shown = of_a_job_ ? shown_ : status().shown,
                           .message = message_,
                           .gates = gates_,
                           .handbox = handbox_ != nullptr ? handbox_->Save() : std::string(),
                           .family = run_ != nullptr ? run_->SaveMachine() : standing_->Save()});
}

Progress Machine::Advance(SimTime until) {
  RMLCELL_CHECK(until >= now_);
  if (run_ != nullptr) {
    const SimTime of_run = until - note_.begun;
    const std::int64_t number = note_.number;
    run_->Advance(of_run);
    Settle();
    if (run_ != nullptr && note_.number != number) return Progress::kMoreWork;  // behind ZERO
    if (run_ != nullptr) {
      const RunState state = run_->state();
      if (state.phase == RunPhase::kRunning && state.time < of_run) {
        now_ = std::max(now_, note_.begun + state.time);
        return Progress::kMoreWork;
      }
      run_->Stand(of_run);
    }
  }
  AdvanceJog(until);
  now_ = until;
  return Progress::kReached;
}

// A run that halted goes on, or is over, where that was asked for while it came to rest.
void Machine::Settle() {
  if (run_ == nullptr) return;
  const RunState state = run_->state();
  if (state.phase == RunPhase::kFinished) return CloseRun();
  if (state.phase != RunPhase::kHalted) return;
  if (!halted_at_) halted_at_ = state.time;
  now_ = std::max(now_, note_.begun + state.time);
  stopping_ = false;
  if (abort_behind_) {
    run_->End(OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
    return CloseRun();
  }
  const bool by_key = state.halted_by == HaltReason::kHold || state.halted_by == HaltReason::kStop;
  if (std::exchange(resume_behind_, false) && by_key) ToRun(InputKind::kStart);
  if (run_->state().phase == RunPhase::kFinished) CloseRun();
}

// What it made of an object that was replaced meanwhile is of no use.
void Machine::CloseRun() {
  const RunState state = run_->state();
  Outcome outcome = run_->outcome();
  outcome.place = OfMemory(outcome.place);
  now_ = std::max(now_, note_.begun + state.time);
  over_.push_back({.run = note_,
                   .outcome = outcome,
                   .lasted = state.time,
                   .worked = state.approaching ? SimTime(0)
                                               : state.time - state.approached -
                                                     note_.entered.value_or(RunEntry{}).run_time,
                   .steps = run_->steps_executed(),
                   .figures = run_->figures()});
  const bool selects = !std::exchange(selected_, false) && !note_.by_hand && !of_a_job_;
  if (selects) shown_ = status().shown;
  if (outcome.code) Show(*outcome.code);
  if (outcome.code && Lookup(*outcome.code).severity == Severity::kAlarm)
    Raise(*outcome.code, outcome.detail, outcome.place);
  for (auto& [slot, bytes] : run_->made_executables()) {
    const auto program = memory_.programs.find(slot);
    if (program == memory_.programs.end() || changed_.contains(slot)) continue;
    program->second.executable = Bytes::Of(bytes);
    made_.push_back({.slot = slot, .bytes = bytes});
  }
  Result<std::unique_ptr<Standing>> standing =
      family_.NewStanding(parameters_, run_->SaveMachine());
  RMLCELL_CHECK(standing);
  standing_ = *std::move(standing);
  if (std::exchange(selected_program_, false)) standing_->SelectProgram();
  standing_->Rest();
  over_.back().ended = std::move(run_);
  stopping_ = resume_behind_ = abort_behind_ = false;
  held_at_.reset();
  viewed_from_.reset();
  changed_.clear();
  base_.reset();
  halted_at_.reset();
  if (note_.by_hand) EndByHand(outcome);
}

MachineState Machine::state() const {
  if (!on_) return MachineState::kOff;
  if (!alarms_.empty()) return MachineState::kAlarm;
  if (jog_.moves()) return jog_.asks() ? MachineState::kJogging : MachineState::kStopping;
  if (run_ == nullptr)
    return standing_->state().zeroed ? MachineState::kIdle : MachineState::kNotZeroed;
  if (run_->state().phase == RunPhase::kHalted) return MachineState::kHeld;
  if (stopping_) return MachineState::kStopping;
  return note_.by_hand && !Pauses() ? MachineState::kJogging : MachineState::kRunning;
}

MachineStatus Machine::status() const {
  MachineStatus status{.time = now_,
                       .state = state(),
                       .mode = mode_,
                       .override_percent = override_percent_,
                       .run = run_ != nullptr ? run_->state() : standing_->state(),
                       .last_run = note_.number,
                       .alarms = alarms_,
                       .shown = shown_,
                       .message = message_};
  if (jog_.moves()) status.run.tip_speed_mm_s = jog_.tip_speed_mm_s();
  if (jog_.way() != nullptr) status.by_hand = jog_.way()->what();
  status.run.door_open = status.run.door_open || cover_open_;
  if (run_ == nullptr) return status;
  status.open = note_;
  // What lies before was not done again. LIVE-6.09
  if (status.run.approaching && note_.entered) {
    status.run.place.program = note_.entered->at.at.program;
    status.run.place.step = note_.entered->at.at.step;
  }
  if (!status.by_hand && note_.by_hand) status.by_hand = note_.hand;
  status.run.place = OfMemory(status.run.place);
  const RunState& run = status.run;
  if (run.place.step > 0 && !selected_ && !note_.by_hand) {
    status.shown = {.program = run.place.program,
                    .step = run.place.step,
                    .instruction = std::string(run.instruction)};
  }
  return status;
}

std::optional<VariableValue> Machine::ReadVariable(std::string_view name) const {
  return run_ != nullptr ? run_->ReadVariable(name) : standing_->ReadVariable(name);
}

MachineOutputs Machine::outputs() const {
  return run_ != nullptr ? run_->outputs() : standing_->outputs();
}

std::vector<Place> Machine::stack() const {
  return run_ != nullptr ? run_->stack() : std::vector<Place>();
}

std::vector<ModalValue> Machine::modal_values() const {
  return run_ != nullptr ? run_->modal_values() : standing_->modal_values();
}

std::optional<ProgramStep> Machine::simulation_until() const {
  const std::optional<ProgramStep> until = simulation_       ? simulation_
                                           : run_ != nullptr ? run_->simulation_until()
                                                             : standing_->simulation_until();
  return until && until->step > 0 ? until : std::nullopt;
}

Status Machine::Apply(const MachineInput& input) {
  if (!on_ && std::visit([]<class Input>(const Input&) { return kNeedsPower<Input>; }, input))
    return Error{ErrorCode::kCellNotLive, "the machine is OFF", {}};
  Status done = std::visit([this](const auto& one) { return Act(one); }, input);
  Settle();
  return done;
}

void Machine::Raise(ErrorCode code, Detail detail, const Place& place) {
  Show(code);
  if (std::ranges::find(alarms_, code, &Alarm::code) != alarms_.end()) return;
  alarms_.push_back(
      {.id = ++last_alarm_, .code = code, .detail = std::move(detail), .at = now_, .place = place});
}

// What the cell says is not the control's to show, and takes nothing from the display.
void Machine::Show(ErrorCode code) {
  if (Lookup(code).family != ErrorFamily::kCell) message_ = code;
}

void Machine::ToRun(InputKind kind, int index, double value) {
  const InputChange change{.kind = kind, .index = index, .value = value};
  if (kind == InputKind::kStart) selected_ = selected_program_ = false;
  if (run_ != nullptr) {
    KeepForBase(change);
    run_->Apply(change);
  } else {
    standing_->Apply(change);
  }
}

// In REMOTE people at the machine start nothing; in the other modes nobody else does. OPT-4.11
Status Machine::MaySource(StartSource source) const {
  const bool panel = source == StartSource::kPanel;
  if (mode_ != Mode::kManual && panel == (mode_ != Mode::kRemote)) return {};
  return Error{ErrorCode::kCellMode,
               "the mode is " + Told("mode", Name(mode_)) +
                   (mode_ == Mode::kManual ? ": nothing starts in it"
                    : panel                ? ": the keys of the machine start nothing in it"
                            : ": only the keys of the machine start something in it"),
               {}};
}

StateGuards Machine::guards() const {
  return {.zeroed = status().run.zeroed,
          .run_open = run_ != nullptr,
          .aborts = abort_behind_,
          .alarm = alarms_.empty() ? ErrorCode::kCellMachineState : alarms_.front().code,
          .not_zeroed = family_.info().not_zeroed,
          .manual = mode_ == Mode::kManual};
}

// What the table of states refuses, in words.
Error Machine::Refusal(ErrorCode code) const {
  const MachineState now = state();
  if (now == MachineState::kAlarm) return {code, alarms_.front().detail, {}};
  if (now == MachineState::kNotZeroed && code == family_.info().not_zeroed)
    return {code, "START with axes that have no reference", {}};
  return NotNow(now, now == MachineState::kHeld ? "resume or abort the run"
                     : jog_.moves()             ? kReleaseKeys
                     : run_ != nullptr          ? "a run is open; hold or abort it"
                                                : "no run is open; start one");
}

Status Machine::MayStart(const StartRun& input) const {
  StateGuards now = guards();
  now.unzeroed_start = input.unzeroed || simulation_until();
  const Transition next = Next(state(), MachineEvent::kStart, now);
  if (next.code) return Refusal(*next.code);
  if (const Status source = MaySource(input.source); !source) return source.error();
  if (CoverStops()) return Error{ErrorCode::kCellDoorOpen, "the cover is open", {}};
  return MayRun(family_.info(), memory_, input.program, input.brought.has_value());
}

Status Machine::Act(const StartRun& input) {
  if (const Status may = MayStart(input); !may) return may.error();
  return Begin(input, mode_);
}

Status Machine::Begin(const StartRun& input, Mode mode, std::optional<HandRun> hand) {
  RunSetup setup(parameters_);
  setup.programs = memory_.programs;
  if (input.brought) setup.programs[input.program] = *input.brought;
  setup.deleted_programs = memory_.deleted;
  setup.main_program = input.program;
  setup.schedules = memory_.schedules;
  setup.machine_state = standing_->Save();
  setup.mode = mode;
  setup.override_percent = OverrideOf(hand);
  if (!hand) setup.simul = simulation_;
  setup.budget = kLiveBudget;
  StartBase base{.machine_state = setup.machine_state,
                 .inputs = {},
                 .mode = mode,
                 .override_percent = setup.override_percent};
  const RunNote before = std::exchange(note_, {.number = note_.number + 1,
                                               .program = input.program,
                                               .source = input.source,
                                               .begun = now_,
                                               .by_hand = hand.has_value(),
                                               .hand = hand.value_or(HandRun::kZero)});
  observer_.OnRunBegun(note_);
  Result<std::unique_ptr<Run>> run = family_.NewRun(std::move(setup), observer_);
  if (!run) {
    note_ = before;
    return run.error();
  }
  if (!hand) simulation_.reset();
  changed_.clear();
  if (input.brought) changed_.insert(input.program);  // what is made of it is not of the memory
  viewed_from_.reset();
  run_ = *std::move(run);
  comes_along_ = !hand && input.brought.has_value();
  of_a_job_ = !hand && input.source == StartSource::kQueue;
  if (hand) return {};
  base_ = std::move(base);
  not_in_base_ = SimTime(0);
  if (!of_a_job_) shown_ = {.program = input.program};
  run_->SetBreakpoints(breakpoints_);
  return {};
}

// What is on its way to rest stays there, whatever was asked for meanwhile.
void Machine::Hold() {
  resume_behind_ = false;
  if (!stopping_) Halt(HoldKey(family_.info(), mode_));
}

void Machine::Halt(InputKind key) {
  jog_.Brake();
  if (run_ == nullptr || run_->state().phase == RunPhase::kHalted) return;
  resume_behind_ = false;
  // What is moved by hand is over where it comes to rest.
  abort_behind_ = abort_behind_ || (note_.by_hand && !Pauses());
  ToRun(key);
  stopping_ = true;
}

Status Machine::Act(const HoldRun& /*input*/) {
  Hold();
  return {};
}

Status Machine::Act(const StopRun& /*input*/) {
  Halt(InputKind::kStop);
  return {};
}

Status Machine::Act(const AbortRun& /*input*/) {
  if (run_ != nullptr) abort_behind_ = true;
  Halt(InputKind::kStop);
  return {};
}

// It acts in every state. What comes of the run says the family; the machine is in alarm.
Status Machine::Act(const EmergencyStop& input) {
  emergency_ = input.pressed;
  if (!input.pressed || !on_) return {};
  jog_.Freeze();
  const Place place = run_ != nullptr ? OfMemory(run_->state().place) : Place{};
  const bool ends_run = run_ != nullptr;
  const ErrorCode code = family_.info().emergency_stop;
  ToRun(InputKind::kEmergencyStop);
  Settle();
  if (ends_run && run_ == nullptr) {  // of a machine that has no number for it, too: LIVE-5.08
    over_.back().outcome.kind = OutcomeKind::kFailed;
    over_.back().outcome.code = code;
  }
  Raise(code, {}, place);
  return {};
}

bool Machine::MayAcknowledge(const Alarm& alarm) const {
  return !emergency_ || alarm.code != family_.info().emergency_stop;
}

Status Machine::Act(const Acknowledge& input) {
  const auto found = std::ranges::find(alarms_, input.alarm, &Alarm::id);
  if (found == alarms_.end()) {  // somebody else was first, or there never was one
    if (input.alarm > 0 && input.alarm <= last_alarm_) return {};
    return InvalidArgument("no alarm has the number " + Told("alarm", input.alarm));
  }
  if (!MayAcknowledge(*found))
    return NotNow(state(), "the emergency stop is pressed; release it first");
  alarms_.erase(found);
  return {};
}

// Leaving for MANUAL is a HOLD (OPT-4.24).
Status Machine::Act(const ChangeMode& input) {
  if (input.mode == Mode::kRepeat && !family_.info().has_repeat) {
    return Error{
        ErrorCode::kCellMode, Told("machine", family_.info().title) + " has no mode REPEAT", {}};
  }
  if (run_ != nullptr && Pauses())
    return NotNow(state(), "a FUNCTION of the handbox is open; go on with it, or end it");
  if (state() == MachineState::kJogging || (run_ != nullptr && note_.by_hand))
    return NotNow(state(), "it moves by hand; stop it first");
  // A job of the queue goes on in REMOTE alone. LIVE-2.11
  const bool leaves_queue = note_.source == StartSource::kQueue && input.mode != Mode::kRemote;
  if (input.mode == Mode::kManual || (run_ != nullptr && leaves_queue)) {
    Hold();
  } else if (run_ != nullptr) {
    run_->SetMode(input.mode);
  }
  mode_ = input.mode;
  return {};
}

Status Machine::Act(const ChangeOverride& input) {
  const FamilyInfo& info = family_.info();
  if (!(input.percent >= info.override_min_percent && input.percent <= info.override_max_percent)) {
    return Error{
        ErrorCode::kCellInvalidArgument,
        "an override of " + Told("override", input.percent, "%", ShortestText(input.percent)) +
            " %: it is " +
            Told("least", info.override_min_percent, "%", ShortestText(info.override_min_percent)) +
            " to " +
            Told("most", info.override_max_percent, "%",
                 ShortestText(info.override_max_percent) + " %"),
        {}};
  }
  override_percent_ = input.percent;
  if (run_ != nullptr) {
    const auto hand = note_.by_hand ? std::optional(note_.hand) : std::nullopt;
    ToRun(InputKind::kOverride, 0, OverrideOf(hand));
  }
  AskJog();
  return {};
}

Status Machine::Act(const ChangeInput& input) {
  const bool logical = input.kind == InputKind::kLogical;
  const std::string name = (logical ? "IL[" : "IA[") + std::to_string(input.index) + "]";
  if ((!logical && input.kind != InputKind::kAnalogue) || !family_.HasVariable(parameters_, name)) {
    return Error{
        ErrorCode::kCellInvalidArgument, "the machine has no input " + Told("input", name), {}};
  }
  if (!std::isfinite(static_cast<float>(input.value)))
    return Error{
        ErrorCode::kCellInvalidArgument, Told("input", name) + " is a number up to 3.4e38", {}};
  ToRun(input.kind, input.index, input.value);
  return {};
}

// Nothing begins behind it, and nothing goes on.
bool Machine::CoverStops() const { return cover_open_ && standing_->cover() != CoverAct::kNone; }

// An open door acts as STOP, the cover of a mill as its model has it. OPT-B.34, DEV-3.12
Status Machine::Act(const MoveDoor& input) {
  const RunState before = status().run;
  const bool covered = family_.info().cover_stops_jog;
  cover_open_ = input.open && covered;
  if (covered && input.open && !before.door_open && run_ != nullptr) {
    const bool goes_on = before.phase == RunPhase::kRunning;
    if (goes_on && standing_->cover() == CoverAct::kEmergency) {
      const Status stopped = Act(EmergencyStop{});
      emergency_ = false;  // no key is down
      return stopped;
    }
    if (standing_->cover() == CoverAct::kPause) Halt(InputKind::kStop);
  }
  if (input.open) jog_.Brake();
  if (before.door_open == input.open) return {};
  if (input.open) resume_behind_ = false;
  const bool goes_on = run_ != nullptr && before.phase == RunPhase::kRunning;
  ToRun(InputKind::kDoor, 0, input.open ? 1.0 : 0.0);
  if (goes_on && run_->state().door_open) {
    stopping_ = true;
    abort_behind_ = abort_behind_ || (note_.by_hand && !Pauses());
  }
  return {};
}

Status Machine::Act(const SwitchPower& input) {
  if (input.on == on_) return {};
  if (!input.on && run_ != nullptr) {
    run_->End(OutcomeKind::kStopped, ErrorCode::kCellPowerOff);
    CloseRun();
  }
  jog_.Freeze();
  on_ = input.on;
  if (on_) {
    if (emergency_) Raise(family_.info().emergency_stop, {}, {});
    return {};
  }
  alarms_.clear();
  message_.reset();
  shown_ = {};           // OPT-4.03
  breakpoints_.clear();  // OPT-6.08
  simulation_.reset();
  standing_->CyclePower();
  if (handbox_ != nullptr) handbox_->CyclePower();
  return {};
}

Status Machine::Act(const WriteVariable& input) {
  if (const Status good = family_.CheckWrite(parameters_, input.name, input.value); !good)
    return good.error();
  if (run_ != nullptr) {
    KeepForBase({.kind = InputKind::kVariable, .value = input.value, .name = input.name});
    run_->WriteVariable(input.name, input.value);
  } else {
    standing_->WriteVariable(input.name, input.value);
  }
  return {};
}

Status Machine::Act(const SetBreakpoints& input) {
  if (input.breakpoints.size() > kBreakpointsMax) {
    return Error{ErrorCode::kCellInvalidArgument,
                 "at most " + Told("most", kBreakpointsMax) + " breakpoints are set",
                 {}};
  }
  for (const Breakpoint& breakpoint : input.breakpoints) {
    if (breakpoint.condition.size() > kBreakpointConditionMax) {
      return Error{ErrorCode::kCellInvalidArgument,
                   "a condition has at most " + Told("most", kBreakpointConditionMax) + " bytes",
                   {}};
    }
    if (const Status good = family_.CheckBreakpoint(breakpoint); !good) return good.error();
  }
  breakpoints_ = input.breakpoints;
  if (run_ != nullptr) run_->SetBreakpoints(breakpoints_);
  return {};
}

// Step 0 ends also what the machine kept of an earlier run (RunSetup::simul).
Status Machine::Act(const SetSimulation& input) {
  if (!family_.info().has_dry_run && input.until) {
    return Error{ErrorCode::kCellNotLive,
                 Told("machine", family_.info().title) + " has no dry run up to a step",
                 {}};
  }
  if (input.until && (!IsSlot(input.until->program) || input.until->step < 1)) {
    return Error{ErrorCode::kCellInvalidArgument,
                 "a dry run ends at a step from 1 on of a program of 1 to 99",
                 {}};
  }
  simulation_ = input.until.value_or(ProgramStep{});
  return {};
}

Status Machine::Act(const ClearMessage& /*input*/) {
  message_.reset();
  return {};
}

}  // namespace rmlcell::machine
