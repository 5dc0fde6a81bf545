// What a host writes down of its machine: marks, what happened before them, and recordings.
#include <utility>

#include "engine/core/hex.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/told.h"
#include "server/base/version.h"
#include "server/host/host_machine.h"
#include "server/host/host_messages.h"
#include "server/host/order_class.h"

namespace rmlcell::server {
namespace {

// A moving machine says so often where it is, so that a crash takes no more of it. LIVE-3.23
constexpr std::chrono::milliseconds kMarkInterval{1'000};
constexpr std::chrono::milliseconds kMarkIntervalOfEvents{100};  // where something waits to be told

}  // namespace

// Where it stands: all that was told before is in it.
void HostMachine::Mark() {
  v1::JournalEntry& entry = Add(machine().time());
  v1::MachineMark mark = MarkNow();
  mark.set_sequence(sequence_);
  *entry.mutable_mark() = std::move(mark);
  mark_due_ = begins_ = false;
  marked_at_ = now_.steady;
}

v1::MachineMark HostMachine::MarkNow() const {
  const machine::MachineStatus status = machine().status();
  v1::MachineMark mark;
  mark.set_fence(setup_.fence);
  mark.set_virtual_time_ns(status.time.count());
  mark.set_control_lease(desk_.number());
  if (driver_->factor() != 1.0) mark.set_factor(driver_->factor());
  if (last_run_) *mark.mutable_last_run() = *last_run_;
  if (inspect_due_ || ended_) {
    mark.set_job(inspect_job_);
    if (cut_off_base_) *mark.mutable_base() = *cut_off_base_;
  }
  if (status.open && !ended_) {
    mark.set_run_time_ns(status.run.time.count());
    mark.set_job(job_);
    *mark.mutable_place() = bridge::ToProto(status.run.place);
    if (auto base = BaseNow()) *mark.mutable_base() = *std::move(base);
  }
  mark.set_state(machine().Save());
  mark.set_state_sha256(BytesOfHex(bridge::Sha256Hex(mark.state())).value_or(""));
  // What is moved by hand is no run that could be cut off (LIVE-5.20); a FUNCTION may cut.
  const bool moved =
      status.open && status.open->by_hand && status.open->hand != machine::HandRun::kFunction;
  mark.set_clean((!status.open || moved) && !inspect_due_ && !ended_);
  return mark;
}

v1::JournalEntry HostMachine::IntentOf(const v1::HostOrder& order, const HostTime& now) {
  now_ = now;
  v1::InputApplied& intent = *Add(machine().time()).mutable_intent();
  intent.set_fence(setup_.fence);
  intent.set_virtual_time_ns(machine().time().count());
  intent.set_caller(order.caller());
  intent.set_request_id(FieldOf(order, "request_id").value_or(""));
  if (const auto inputs = InputsOf(order, machine()); inputs && !inputs->empty())
    *intent.mutable_input() = bridge::AppliedOf(inputs->front());
  if (const v1::WorkerAssignment* assignment = AssignmentOf(order))
    intent.mutable_input()->mutable_start()->set_job(assignment->job().name());
  v1::JournalEntry entry = std::move(entries_.back());
  entries_.pop_back();
  return entry;
}

// From this mark on, with all that it depends on; what stands before `entry` was before it.
void HostMachine::Record(const v1::MachineMark& mark, std::size_t entry) {
  for (; recorded_ < entry; ++recorded_) recorder_.Add(entries_[recorded_]);
  v1::MachineRecording head;
  head.set_engine_version(std::string(kVersion));
  head.set_machine(setup_.name);
  head.set_family(std::string(setup_.family->info().id));
  head.set_profile(setup_.profile);
  for (const auto& [name, value] : setup_.parameters) (*head.mutable_parameters())[name] = value;
  head.set_job(job_);
  head.set_fence(setup_.fence);
  if (brought_.slot() != 0) head.mutable_brought()->Swap(&brought_);
  v1::JournalEntry begin;
  begin.set_fence(setup_.fence);
  begin.set_virtual_time_ns(mark.virtual_time_ns());
  *begin.mutable_mark() = mark;
  recorder_.Begin(std::move(head), machine().memory(), begin);
}

// What happened leaves behind a mark that covers it: the log never tells of more than a crash gives
// back. LIVE-3.22
std::vector<v1::JournalEntry> HostMachine::TakeEntries(const HostTime& now, bool at_once) {
  now_ = now;
  const std::chrono::nanoseconds since = now.steady - marked_at_;
  bool due = at_once || begins_ || mark_due_ || !entries_.empty();
  if (moves() && !begins_ && !at_once)
    due = since >= (entries_.empty() ? kMarkInterval : kMarkIntervalOfEvents);
  if (!due) return {};
  Mark();
  if (moves()) mark_due_ = true;  // it comes to rest elsewhere
  for (; recorded_ < entries_.size(); ++recorded_) recorder_.Add(entries_[recorded_]);
  recorded_ = 0;
  return std::exchange(entries_, {});
}

// Whoever began it: before anything of it is told.
void HostMachine::OnRunBegun(const machine::RunNote& run) {
  for (const machine::RunOver& over : machine().TakeRunsOver()) TellOver(over);
  run_begun_ = run.begun;
  told_of_run_ = 0;
  begins_ = begins_ || !run.by_hand;
  // One that begins at a step began before that, by its own time; nothing is told of the past.
  v1::RunBegun& told = *Add(std::max(run.begun, told_until_)).mutable_run_begun();
  told = recording::BegunOf(run);
  told.set_job(job_);
}

void HostMachine::TellOver(const machine::RunOver& run) {
  v1::JournalEntry& entry = Add(run.run.begun + run.lasted);
  AddMadeExecutables(entry);
  v1::RunOver& told = *entry.mutable_run_over();
  told = recording::OverOf(run);
  told.set_job(std::exchange(job_, {}));
  begin_stored_by_ = 0;
  if (!run.run.by_hand) last_run_ = LastRunOf(told);
  if (!run.run.by_hand && run.outcome.code == ErrorCode::kCellPowerOff) {  // LIVE-5.10
    inspect_due_ = true;
    inspect_job_ = told.job();
  }
  desk_.RunIsOver();
  TellControl();
  held_for_.reset();
  mark_due_ = true;
}

// The store keeps them with the end of the run; what is too much for one entry is made again by the
// next run. LIVE-5.07
void HostMachine::AddMadeExecutables(v1::JournalEntry& entry) {
  constexpr std::size_t kExecutablesMax = std::size_t{1} << 20;
  std::size_t bytes = 0;
  for (machine::MadeExecutable& made : machine().TakeMadeExecutables()) {
    const auto revision = revisions_.find(made.slot);
    bytes += made.bytes.size();
    if (revision == revisions_.end() || bytes > kExecutablesMax) continue;
    v1::LinkedExecutable& executable = *entry.add_executables();
    executable.set_slot(made.slot);
    executable.set_object_revision(revision->second);
    executable.set_content(std::move(made.bytes));
  }
}

void HostMachine::TellControl() {
  const std::optional<v1::ControlChanged> change = desk_.TakeChange();
  if (!change) return;
  v1::InputApplied& applied = *Add(machine().time()).mutable_applied();
  applied.set_fence(setup_.fence);
  applied.set_virtual_time_ns(machine().time().count());
  *applied.mutable_input()->mutable_control() = *change;
  applied.set_caller(change->to().empty() ? change->from() : change->to());
  applied.set_control_lease(change->lease());
}

void HostMachine::OnHalt(const machine::Halt& halt) {
  v1::Halted& halted = *Event(halt.at).mutable_halted();
  halted = recording::HaltedOf(halt);
  if (held_for_) halted.set_reason(*held_for_);
  mark_due_ = true;
}

void HostMachine::OnResume(SimTime at, const machine::Place& place) {
  *Event(at).mutable_resumed() = recording::ResumedOf(place);
}

bool HostMachine::MayTell() { return ++told_of_run_ <= recording::kToldOfRunMax; }

void HostMachine::OnMessage(SimTime at, const machine::Place& place, std::string_view text) {
  if (MayTell()) *Event(at).mutable_message() = recording::MessageOf(place, text);
}

void HostMachine::OnDiagnostic(SimTime at, const Diagnostic& diagnostic) {
  if (!MayTell()) return;
  *Event(at).mutable_diagnostic() = bridge::ToProto(diagnostic);
}

}  // namespace rmlcell::server
