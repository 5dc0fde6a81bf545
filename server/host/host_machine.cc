#include "server/host/host_machine.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>
#include <utility>

#include "engine/machine/machine_states.h"
#include "engine/machine/parameters.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/standard_words.h"
#include "proto/recording/told.h"
#include "server/host/host_messages.h"
#include "server/host/host_options.h"
#include "server/host/order_class.h"

namespace rmlcell::server {
namespace {

// A key that begins a motion, or says YES to one.
bool MayMove(const machine::PressedKey& key) {
  constexpr std::array<std::string_view, 5> kKeys = {"START", "HOME", "ZERO", "1", "ENT"};
  return key.action != machine::KeyAction::kRelease &&
         (bridge::JogKeyOf(key.key) || std::ranges::find(kKeys, key.key) != kKeys.end());
}

bool MovesByHand(machine::PanelKey key) {
  return key == machine::PanelKey::kView || key == machine::PanelKey::kHome ||
         key == machine::PanelKey::kSpindle;
}

}  // namespace

Result<std::unique_ptr<HostMachine>> HostMachine::Make(Setup setup, const HostTime& now,
                                                       std::function<std::string()> make_token) {
  auto parameters = machine::MakeParameters(*setup.family, setup.profile, setup.parameters);
  if (!parameters) return parameters.error();
  std::unique_ptr<HostMachine> host(new HostMachine(std::move(setup), std::move(make_token)));
  Setup& made = host->setup_;
  host->parameters_.emplace(*std::move(parameters));
  auto machine = machine::Machine::Make(*made.family, *host->parameters_, std::move(made.memory),
                                        made.state, *host);
  if (!machine) return machine.error();
  host->driver_ = std::make_unique<machine::VirtualDriver>(*std::move(machine), now.steady);
  host->now_ = now;
  host->inspect_due_ = made.cut_off;
  host->desk_.CountFrom(made.control_lease);
  host->last_run_ = std::exchange(made.last_run, {});
  if (made.factor > 0.0) static_cast<void>(host->driver_->SetFactor(now.steady, made.factor));
  for (const v1::JournalEntry& untold : made.untold) {
    if (untold.has_mark() || untold.has_intent()) continue;
    v1::JournalEntry& entry = host->Add(SimTime(0));
    const std::int64_t sequence = entry.sequence();
    entry = untold;
    entry.set_sequence(sequence);
    entry.set_fence(made.fence);  // known by the number that it has now
  }
  made.untold.clear();
  host->recorded_ = host->entries_.size();  // by the earlier host
  if (made.recording) host->recorder_.Recover(*std::exchange(made.recording, {}));
  host->inspect_job_ = made.inspect_job;
  if (made.cut_off) host->cut_off_base_ = made.cut_off_base;
  if (made.open_run) host->TellCutOff(*made.open_run, ErrorCode::kCellHostDied);
  host->answered_.Recover(std::exchange(made.answered, {}), host->StatusAt(now), now);
  return host;
}

HostMachine::HostMachine(Setup setup, std::function<std::string()> make_token)
    : setup_(std::move(setup)),
      desk_(make_token),
      starts_(make_token),
      arms_(std::move(make_token)) {}

v1::HostOrderAnswer HostMachine::Do(const v1::HostOrder& order, const HostTime& now) {
  GoOnTo(now);
  const auto refuse = [&](const Error& error) {
    v1::HostOrderAnswer refused = Refuse(error);
    refused.set_number(order.number());
    return refused;
  };
  constexpr std::size_t kRequestIdMax = 64;
  // What brings it to rest acts, whatever is wrong with its id.
  const bool halts = ClassOf(order) == OrderClass::kActsFirst;
  halts_ += halts ? 1 : 0;
  if (!halts && FieldOf(order, "request_id").value_or("").size() > kRequestIdMax)
    return refuse(InvalidArgument("request_id is longer than 64 characters"));
  const std::string request = AnsweredRequests::KeyOf(order);
  const std::string digest = request.empty() ? "" : AnsweredRequests::DigestOf(order);
  const v1::HostOrderAnswer* known = answered_.Find(request);
  const bool another = known != nullptr && answered_.IsAnother(request, digest);
  if (known != nullptr && !(halts && another)) {
    if (another) return refuse({ErrorCode::kCellRequestIdReused, {}, {}});
    v1::HostOrderAnswer again = *known;
    again.set_number(order.number());
    return again;
  }
  if (auto again = AnsweredKey(order); again && CheckControl(order, now)) return *std::move(again);
  key_taken_.reset();
  v1::HostOrderAnswer answer = Carry(order, now);
  answer.set_number(order.number());
  *answer.mutable_acted_at() = Stamp(now.wall);
  if (key_taken_) keys_.Take(*key_taken_, answer);
  answered_.Keep(request, digest, answer, now);
  if (auto entry = AnsweredRequests::EntryOf(order, answer))
    *Add(machine().time()).mutable_answered() = *std::move(entry);
  return answer;
}

v1::HostOrderAnswer HostMachine::Carry(const v1::HostOrder& order, const HostTime& now) {
  Result<v1::HostOrderAnswer> answer = CarryOut(order, now);
  Notice();
  if (!answer) {
    v1::HostOrderAnswer refused = Refuse(answer.error());
    AddBlockers(order, refused);
    return refused;
  }
  if (answer->result_case() != v1::HostOrderAnswer::RESULT_NOT_SET) return *std::move(answer);
  if (IsHalt(order)) {
    v1::HaltResponse& halt = *answer->mutable_halt();
    *halt.mutable_status() = StatusAt(now);
    *halt.mutable_acted_at() = Stamp(now.wall);
  } else {
    *answer->mutable_status() = StatusAt(now);
  }
  return *std::move(answer);
}

Status HostMachine::CheckControl(const v1::HostOrder& order, const HostTime& now) const {
  const std::optional<std::string> token = FieldOf(order, "control_token");
  if (!token || (!order.for_job().empty() && desk_.IsOfQueue())) return {};
  return desk_.Check(*token, now);
}

// Without a result: the status of the machine is the answer.
Result<v1::HostOrderAnswer> HostMachine::CarryOut(const v1::HostOrder& order, const HostTime& now) {
  v1::HostOrderAnswer answer;
  if (const Status its_own = CheckJob(order); !its_own) return its_own.error();
  switch (order.request_case()) {
    case v1::HostOrder::kAcquireControl:
    case v1::HostOrder::kRenewControl:
    case v1::HostOrder::kReleaseControl:
      return Control(order, now);
    case v1::HostOrder::kReadVariables: {
      auto values = ReadVariables(machine(), order.read_variables());
      if (!values) return values.error();
      values->set_fence(setup_.fence);
      *answer.mutable_variables() = *std::move(values);
      return answer;
    }
    case v1::HostOrder::kRecording: {
      auto part = recorder_.Part(order.recording());
      if (!part) return part.error();
      *answer.mutable_recording() = *std::move(part);
      return answer;
    }
    case v1::HostOrder::kRunState:
      *answer.mutable_run_state() = RunStateOf(machine());
      answer.mutable_run_state()->set_fence(setup_.fence);
      return answer;
    default:
      break;
  }
  if (const Status control = CheckControl(order, now); !control) return control.error();
  switch (order.request_case()) {
    case v1::HostOrder::kStartAtStep:
      if (const Status begun = StartAt(order, now); !begun) return begun.error();
      return answer;
    case v1::HostOrder::kPanelKey:
    case v1::HostOrder::kPanelHeartbeat:
    case v1::HostOrder::kCreateSession:
    case v1::HostOrder::kKey:
    case v1::HostOrder::kHandboxHeartbeat:
    case v1::HostOrder::kDeleteSession:
    case v1::HostOrder::kUndoTeaching:
      return CarryOutKeys(order, now);
    case v1::HostOrder::kFactor:
      if (const Status set = driver_->SetFactor(now.steady, order.factor().factor()); !set)
        return set.error();
      Add(machine().time()).mutable_applied()->mutable_input()->set_factor(order.factor().factor());
      return answer;
    case v1::HostOrder::kConfirm:
      if (const Status confirmed = Confirm(order); !confirmed) return confirmed.error();
      return answer;
    case v1::HostOrder::kWriteVariables:
      return Write(order);
    case v1::HostOrder::kArm:
    case v1::HostOrder::kDisarm:
      return Arm(order, now);
    case v1::HostOrder::kRunJob:
      if (const Status begun = RunJob(order, now); !begun) return begun.error();
      return answer;
    case v1::HostOrder::kContinueJob:
      if (const Status begun = BeginJobAtStep(order, now); !begun) return begun.error();
      return answer;
    default:
      break;
  }
  if (const Status acted = Act(order); !acted) return acted.error();
  if (order.has_breakpoints() || order.has_simulation()) {
    *answer.mutable_run_state() = RunStateOf(machine());
    answer.mutable_run_state()->set_fence(setup_.fence);
  }
  return answer;
}

Result<v1::HostOrderAnswer> HostMachine::Control(const v1::HostOrder& order, const HostTime& now) {
  v1::HostOrderAnswer answer;
  if (order.has_acquire_control()) {
    const bool taken_over = desk_.lease().has_value();
    auto acquired = desk_.Acquire(order.acquire_control(), order.caller(), now);
    if (!acquired) return acquired.error();
    *answer.mutable_control() = *std::move(acquired);
    // What the earlier holder was about to enter is nobody's, nor what he moved by hand. LIVE-4.03
    if (taken_over) DropMask();
    if (taken_over && machine().state() == machine::MachineState::kJogging)
      Hold(v1::HOLD_REASON_CONTROL, now);
  } else if (order.has_renew_control()) {
    const auto renewed = desk_.Renew(order.renew_control().control_token(), now);
    if (!renewed) return renewed.error();
    *answer.mutable_control_kept()->mutable_lease() = *renewed;
  } else {
    const auto on_loss = desk_.Release(order.release_control().control_token(), now);
    if (!on_loss) return on_loss.error();
    LoseControl(*on_loss, now);
    return answer;
  }
  TellControl();
  return answer;
}

// Whoever moves it by hand is gone; a run does what he wanted for that case. LIVE-4.02
void HostMachine::LoseControl(v1::ControlLease::OnLoss on_loss, const HostTime& now) {
  TellControl();
  if (on_loss == v1::ControlLease::ON_LOSS_HOLD ||
      machine().state() == machine::MachineState::kJogging)
    Hold(v1::HOLD_REASON_CONTROL, now);
  // Nobody has it: the run of a job is the queue's again. LIVE-4.05
  if (job_.empty() || !run_open() || ended_) return;
  desk_.GiveToQueue(job_, on_loss, now);
  TellControl();
}

// All of them or none, each with what is wrong with it.
Result<v1::HostOrderAnswer> HostMachine::Write(const v1::HostOrder& order) {
  v1::HostOrderAnswer answer;
  v1::WriteVariablesResponse& written = *answer.mutable_written();
  *written.mutable_variables() = order.write_variables().variables();
  const auto inputs = InputsOf(order, machine());
  if (!inputs) return inputs.error();
  bool all = true;
  for (std::size_t i = 0; i < inputs->size(); ++i) {
    const auto& write = std::get<machine::WriteVariable>((*inputs)[i]);
    const Status may = machine().MayWrite(write.name, write.value);
    if (may) continue;
    all = false;
    *written.mutable_variables(static_cast<int>(i))->mutable_error() =
        bridge::ToProto(Diagnostic{.code = may.error().code,
                                   .severity = Lookup(may.error().code).severity,
                                   .detail = may.error().detail});
  }
  for (std::size_t i = 0; all && i < inputs->size(); ++i) {
    if (const Status done = Apply((*inputs)[i], &order); !done) return done.error();
  }
  return answer;
}

Status HostMachine::MayApply(const machine::MachineInput& input) const {
  // What was paused at the panel goes on there alone. LIVE-2.13, RML1-3C.09
  const bool paused = held_for_ == v1::HOLD_REASON_PANEL && machine().status().open.has_value();
  if (paused && !by_panel_ && std::holds_alternative<machine::ResumeRun>(input))
    return Error{ErrorCode::kCellMachineState, "it was paused at its panel: press CONTINUE", {}};
  const bool pauses = machine().status().run.halted_by == machine::HaltReason::kProgram;
  if (pauses && !by_panel_ && std::holds_alternative<machine::ResumeRun>(input))
    return Error{ErrorCode::kCellMachineState,
                 "its program has paused it for whoever stands there: press CONTINUE",
                 {}};
  if (!inspect_due_ || !machine().status().alarms.empty()) return {};
  const bool starts = machine::BeginsRun(input);
  const bool resumes = std::holds_alternative<machine::ResumeRun>(input);
  const bool aborts = std::holds_alternative<machine::AbortRun>(input);
  const auto* key = std::get_if<machine::PressedKey>(&input);
  const auto* panel = std::get_if<machine::PressPanel>(&input);
  const bool by_hand = std::holds_alternative<machine::ZeroAxes>(input) ||
                       std::holds_alternative<machine::PressJog>(input) ||
                       (panel != nullptr && MovesByHand(panel->key)) ||
                       (key != nullptr && MayMove(*key));
  if (!starts && !resumes && !aborts && !by_hand) return {};
  const machine::Transition next = machine::Next(machine::MachineState::kInspect,
                                                 starts    ? machine::MachineEvent::kStart
                                                 : resumes ? machine::MachineEvent::kResume
                                                 : by_hand ? machine::MachineEvent::kMoveByHand
                                                           : machine::MachineEvent::kAbort,
                                                 {});
  if (!next.code) return {};
  return Error{*next.code, "confirm that it was inspected", {}};
}

Status HostMachine::Act(const v1::HostOrder& order) {
  const auto inputs = InputsOf(order, machine());
  if (!inputs) return inputs.error();
  if (inputs->empty() && order.has_panel_key()) return {};
  if (inputs->empty())
    return Error{ErrorCode::kCellUnimplemented, "the host knows no such order", {}};
  for (const machine::MachineInput& input : *inputs) {
    const auto* change = std::get_if<machine::ChangeInput>(&input);
    if (change != nullptr && !machine().has_inputs())
      return Error{ErrorCode::kCellNotLive, "the machine has no inputs", {}};
  }
  for (const machine::MachineInput& input : *inputs) {
    if (const Status may = MayApply(input); !may) return may.error();
    if (const Status done = Apply(input, &order); !done) return done.error();
  }
  return {};
}

// Why a run that goes on will stand, where this brings it to rest. LIVE-2.01
void HostMachine::NoteHold(const machine::MachineInput& input) {
  if (!moves() || MovesInHold() || held_for_ == v1::HOLD_REASON_PANEL) return;
  const auto* key = std::get_if<machine::PressedKey>(&input);
  if (std::holds_alternative<machine::StopRun>(input) || (key != nullptr && key->key == "STOP"))
    held_for_ = v1::HOLD_REASON_STOP;
  if (key != nullptr && key->key == "HOLD") held_for_ = v1::HOLD_REASON_HOLD;
  if (std::holds_alternative<machine::HoldRun>(input))
    held_for_ = by_panel_ ? v1::HOLD_REASON_PANEL : v1::HOLD_REASON_HOLD;
  const auto* mode = std::get_if<machine::ChangeMode>(&input);
  const bool leaves = mode != nullptr && (mode->mode == machine::Mode::kManual ||
                                          (mode->mode != machine::Mode::kRemote && !job_.empty()));
  if (leaves) held_for_ = v1::HOLD_REASON_MODE;
  const auto* door = std::get_if<machine::MoveDoor>(&input);
  if (door != nullptr && door->open && machine().DoorStops()) held_for_ = v1::HOLD_REASON_DOOR;
}

// It stands before what it leads to; of what is refused nothing does.
Status HostMachine::Apply(const machine::MachineInput& input, const v1::HostOrder* order) {
  const auto before = std::tuple(run_begun_, told_of_run_, held_for_);
  const bool starts = machine::BeginsRun(input);
  program_changes_ += std::holds_alternative<machine::StoreProgram>(input) ||
                      std::holds_alternative<machine::DeleteProgram>(input);
  schedule_changes_ += std::holds_alternative<machine::SetSchedules>(input);
  const auto* key = std::get_if<machine::PressedKey>(&input);
  // Of a key nobody knows before what it begins; while a run is held neither it nor ZERO begins
  // one.
  const bool by_hand = key != nullptr || std::holds_alternative<machine::ZeroAxes>(input);
  const bool begins = starts || (by_hand && !machine().status().open);
  // What is half entered stands in no mark: then the recording goes on, with the keys that did it.
  const auto stands =
      begins && !machine().has_open_mask() ? std::optional(MarkNow()) : std::nullopt;
  if (begins) run_begun_ = machine().time();
  const auto* power = std::get_if<machine::SwitchPower>(&input);
  if (power != nullptr && !power->on && !inspect_due_) cut_off_base_ = BaseNow();
  if (starts) arms_.Disarm();
  if (starts || std::holds_alternative<machine::ResumeRun>(input)) held_for_.reset();
  NoteHold(input);
  const std::size_t place = entries_.size();
  const std::int64_t sequence = sequence_;
  v1::InputApplied& applied = *Add(machine().time()).mutable_applied();
  applied.set_fence(setup_.fence);
  applied.set_virtual_time_ns(machine().time().count());
  *applied.mutable_input() = bridge::AppliedOf(input);
  if (!job_.empty() && applied.input().has_start())
    applied.mutable_input()->mutable_start()->set_job(job_);
  const bool of_queue =
      order != nullptr && (AssignmentOf(*order) != nullptr || !order->for_job().empty());
  applied.set_source(of_queue    ? v1::START_SOURCE_QUEUE
                     : by_panel_ ? v1::START_SOURCE_PANEL
                                 : v1::START_SOURCE_CONSOLE);
  if (order != nullptr) {
    applied.set_caller(order->caller());
    applied.set_request_id(FieldOf(*order, "request_id").value_or(""));
    if (FieldOf(*order, "control_token") && desk_.lease()) {
      applied.set_control_lease(desk_.lease()->number());
      applied.set_client(desk_.lease()->client());
    }
  }
  const std::int64_t runs = machine().status().last_run;
  const bool moved = moves();
  const bool stopping = machine().state() == machine::MachineState::kStopping;
  const machine::Mode mode = machine().status().mode;
  const Status done = key != nullptr ? Press(*key, order) : machine().Apply(input);
  if (!done) {
    entries_.resize(place);
    sequence_ = sequence;
    std::tie(run_begun_, told_of_run_, held_for_) = before;
    return done.error();
  }
  if (stands && machine().status().last_run != runs) Record(*stands, place);
  // START let it go on; keys that move the machine in a hold do not, and of those that would halt
  // it the control may take none.
  const bool goes_on = machine().status().run.phase == machine::RunPhase::kRunning &&
                       machine().state() != machine::MachineState::kStopping;
  if (key != nullptr && goes_on)
    held_for_ = moved && !stopping ? std::get<2>(before) : std::nullopt;
  const bool left = mode == machine::Mode::kRemote && machine().status().mode != mode;
  if (key != nullptr && left && !job_.empty()) held_for_ = v1::HOLD_REASON_MODE;
  mark_due_ = true;
  // A crash from here on finds a run that was cut off, however soon it comes; one of a job where
  // the store knows of it.
  begins_ = begins_ || starts;
  return {};
}

v1::HostOrderAnswer HostMachine::Refuse(const Error& error) const {
  v1::HostOrderAnswer answer;
  *answer.mutable_refusal() = bridge::ToErrorDetail(error);
  v1::MachineRefusal& refusal = *answer.mutable_machine_refusal();
  refusal.set_machine(setup_.name);
  refusal.set_state(State());
  if (desk_.lease()) refusal.set_control_holder(desk_.lease()->holder());
  return answer;
}

// What halts it is not put off by the store; it has not moved then. LIVE-5.04
machine::Progress HostMachine::Pump(const HostTime& now) {
  now_ = now;
  driver_->Wait(waits_for_store() && machine().state() == machine::MachineState::kRunning,
                now.steady);
  return driver_->Pump(now.steady);
}

void HostMachine::GoOnTo(const HostTime& now) {
  static_cast<void>(Pump(now));
  LetKeysGo(now);
  if (const auto on_loss = desk_.Expire(now)) LoseControl(*on_loss, now);
  arms_.Expire(desk_.lease() ? desk_.lease()->number() : 0, memory_changes(), now);
  Notice();
  if (std::exchange(late_, false)) Hold(v1::HOLD_REASON_LATE, now);
}

bool HostMachine::GoOn(const HostTime& now) {
  const machine::Progress progress = Pump(now);
  GoOnTo(now);
  return progress == machine::Progress::kReached;
}

void HostMachine::Hold(v1::HoldReason reason, const HostTime& now) {
  now_ = now;
  const machine::MachineState state = machine().state();
  if (state != machine::MachineState::kRunning && state != machine::MachineState::kJogging) return;
  const bool held_before = MovesInHold();
  // Who only lost control gets the part as HOLD leaves it. LIVE-4.02
  const bool after_instruction =
      reason == v1::HOLD_REASON_CONTROL && state == machine::MachineState::kRunning;
  const Status done =
      after_instruction ? Apply(machine::HoldRun{}, nullptr) : Apply(machine::StopRun{}, nullptr);
  if (done && !held_before) held_for_ = reason;
  if (done) TellWhyHeld(reason);
  Notice();
}

// Where no person held it the log says what is to be done. LIVE-3.14, LIVE-3.21, LIVE-3.31
void HostMachine::TellWhyHeld(v1::HoldReason reason) {
  std::optional<ErrorCode> code;
  if (reason == v1::HOLD_REASON_LATE)
    code = disk_is_late_ ? ErrorCode::kCellJournal : ErrorCode::kCellHostLate;
  if (reason == v1::HOLD_REASON_SERVER_LOST) code = ErrorCode::kCellServerLost;
  if (!code) return;
  Add(machine().time())
      .mutable_event()
      ->mutable_message()
      ->set_text("held: " + bridge::ErrorText(Error{*code, {}, {}}));
}

// A held run is held for what it was, whatever stops the keys that move its machine. LIVE-2.13
bool HostMachine::MovesInHold() const {
  const machine::MachineStatus status = machine().status();
  return status.state == machine::MachineState::kJogging && status.open && !status.open->by_hand;
}

void HostMachine::Change(const v1::HostMemory& memory, const HostTime& now) {
  now_ = now;
  const std::size_t told = entries_.size();
  TakeMemory(memory);
  // An entry does not hold what was stored: a recording begins with it.
  if (entries_.size() > told && !run_open()) Record(MarkNow(), entries_.size());
}

void HostMachine::TakeMemory(const v1::HostMemory& memory) {
  const auto apply = [this](const machine::MachineInput& input) {
    static_cast<void>(Apply(input, nullptr));
  };
  if (memory.whole()) {
    for (const auto& [slot, program] : std::map(machine().memory().programs)) {
      const auto named = [slot = slot](const v1::AssignedProgram& one) {
        return one.slot() == slot;
      };
      if (std::ranges::none_of(memory.programs(), named))
        apply(machine::DeleteProgram{.slot = slot});
    }
  }
  if (memory.whole()) revisions_.clear();
  for (const v1::AssignedProgram& program : memory.programs()) {
    revisions_[program.slot()] = program.object_revision();
    const auto there = machine().memory().programs.find(program.slot());
    if (there != machine().memory().programs.end() && *there->second.object == program.content() &&
        *there->second.executable == program.executable())
      continue;
    machine::StoredProgram stored{.name = program.title(),
                                  .object = machine::Bytes::Of(program.content())};
    if (!program.executable().empty()) stored.executable = machine::Bytes::Of(program.executable());
    apply(machine::StoreProgram{.slot = program.slot(), .program = std::move(stored)});
  }
  for (const int slot : memory.deleted_programs()) {
    if (machine().memory().programs.contains(slot)) apply(machine::DeleteProgram{.slot = slot});
  }
  machine::SetSchedules set;
  for (const v1::AssignedSchedule& schedule : memory.schedules())
    set.schedules.push_back(bridge::FromProto(schedule));
  if (memory.schedules_changed() && set.schedules != machine().memory().schedules) apply(set);
}

void HostMachine::Begin(const v1::HostMemory& memory, const HostTime& now) {
  now_ = now;
  const std::size_t told = entries_.size();
  const std::int64_t sequence = sequence_;
  for (; recorded_ < told; ++recorded_) recorder_.Add(entries_[recorded_]);
  TakeMemory(memory);
  entries_.resize(told);
  sequence_ = sequence;
  Record(MarkNow(), told);
  mark_due_ = true;
}

// What the machine did by itself.
void HostMachine::Notice() {
  const machine::MachineStatus status = machine().status();
  for (const machine::RunOver& over : machine().TakeRunsOver()) TellOver(over);
  for (const machine::Alarm& alarm : status.alarms) alarms_since_.try_emplace(alarm.id, now_.wall);
  if (status.alarms.empty()) alarms_since_.clear();
  const SimTime lost = driver_->TakeLost();
  late_ = late_ || lost > LateHold(setup_.options);
  if (lost > SimTime(0) && (status.open || moves())) {
    v1::ClockSlipped& slipped = *Add(status.time).mutable_clock_slipped();
    slipped.set_fence(setup_.fence);
    slipped.set_virtual_time_ns(status.time.count());
    slipped.set_lost_ns(lost.count());
  }
}

v1::MachineState HostMachine::State() const {
  const machine::MachineState state = machine().state();
  const bool stands =
      state == machine::MachineState::kIdle || state == machine::MachineState::kNotZeroed;
  return bridge::ToProto(inspect_due_ && stands ? machine::MachineState::kInspect : state);
}

v1::MachineStatus HostMachine::StatusAt(const HostTime& now) const {
  v1::MachineStatus status = ToProto(machine());
  status.set_machine(setup_.name);
  status.set_fence(setup_.fence);
  status.set_state(State());
  *status.mutable_send_time() = Stamp(now.wall);
  status.set_factor(driver_->factor());
  status.set_host(setup_.host);
  for (v1::Alarm& alarm : *status.mutable_alarms()) {
    if (const auto since = alarms_since_.find(alarm.id()); since != alarms_since_.end())
      *alarm.mutable_time() = Stamp(since->second);
  }
  if (desk_.lease()) *status.mutable_control() = *desk_.lease();
  const bool halts =
      status.state() == v1::MACHINE_STATE_HELD || status.state() == v1::MACHINE_STATE_STOPPING;
  if (halts && held_for_) status.set_hold_reason(*held_for_);
  if (inspect_due_) {
    status.add_confirmations_due(v1::CONFIRMATION_INSPECTED);
    status.set_cut_off_job(inspect_job_);
    if (cut_off_base_) *status.mutable_cut_off_at() = cut_off_base_->place();
  }
  if (status.has_run()) status.mutable_run()->set_job(job_);
  if (last_run_) *status.mutable_last_run() = *last_run_;
  arms_.AddTo(status);
  AddBlockers(status);
  *status.mutable_words() = bridge::StandardWordsOf(status);
  return status;
}

bool HostMachine::moves() const { return machine::MovesAxes(machine().state()); }

bool HostMachine::run_open() const { return machine().status().open.has_value(); }

v1::JournalEntry& HostMachine::Add(SimTime at) {
  v1::JournalEntry& entry = entries_.emplace_back();
  entry.set_sequence(++sequence_);
  entry.set_fence(setup_.fence);
  entry.set_virtual_time_ns(at.count());
  told_until_ = std::max(told_until_, at);
  *entry.mutable_time() = Stamp(now_.wall);
  if (!job_.empty()) {
    entry.set_job(job_);
    entry.set_run_time_ns((at - run_begun_).count());
  }
  return entry;
}

}  // namespace rmlcell::server
