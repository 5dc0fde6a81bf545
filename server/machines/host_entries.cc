#include "server/machines/host_entries.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "rmlcell/v1/cell.pb.h"
#include "server/base/names.h"
#include "server/machines/host_words.h"
#include "server/records/job_messages.h"
#include "storage/jobs/job_rules.h"

namespace rmlcell::server {
namespace {

// The lease by which its machine has the job; nothing: it is over.
Result<std::optional<storage::Lease>> LeaseOf(storage::Store& store, const std::string& job) {
  const Result<std::int64_t> id = ParseJobName(job);
  if (!id) return id.error();
  const auto attempts = store.ListAttempts(*id);
  if (!attempts && attempts.error().code == ErrorCode::kCellNotFound)
    return std::optional<storage::Lease>();
  if (!attempts) return attempts.error();
  if (attempts->empty() || attempts->back().ended_at) return std::optional<storage::Lease>();
  const storage::AttemptRecord& attempt = attempts->back();
  return std::optional(storage::Lease{.job = attempt.job,
                                      .attempt = attempt.number,
                                      .fence = attempt.fence,
                                      .worker = attempt.worker});
}

// As it stands in the log of the job; nothing: it is not told there.
std::optional<v1::JobEvent> JobEventOf(const v1::JournalEntry& entry) {
  v1::JobEvent made;
  switch (entry.what_case()) {
    case v1::JournalEntry::kApplied:
      *made.mutable_input_applied() = entry.applied();
      break;
    case v1::JournalEntry::kRunBegun:
      *made.mutable_run_begun() = entry.run_begun();
      break;
    case v1::JournalEntry::kEvent: {
      const v1::RunEvent& event = entry.event();
      if (event.has_halted()) *made.mutable_halted() = event.halted();
      if (event.has_resumed()) *made.mutable_resumed() = event.resumed();
      if (event.has_signal()) *made.mutable_signal() = event.signal();
      if (event.has_program_loaded()) *made.mutable_program_loaded() = event.program_loaded();
      if (event.has_executable_made()) *made.mutable_executable_made() = event.executable_made();
      if (event.has_message()) *made.mutable_message() = event.message();
      if (event.has_diagnostic()) *made.mutable_diagnostic() = event.diagnostic();
      if (event.has_gathered()) *made.mutable_gathered() = event.gathered();
      break;
    }
    default:
      return std::nullopt;
  }
  made.set_virtual_time_ns(entry.run_time_ns());
  return made;
}

class Entries {
 public:
  Entries(storage::Store& store, const storage::MachineLease& lease)
      : store_(store), lease_(lease) {}

  Status Add(const v1::JournalEntry& entry) {
    const bool ends = entry.has_run_over() && !entry.run_over().job().empty();
    const bool behind_end = end_ && entry.job().empty();  // where that left the machine
    if ((ends && end_) || (entry.job() != job_ && !behind_end)) {
      if (const Status written = Write(); !written) return written.error();
      if (const Status known = FindLease(entry); !known) return known.error();
    }
    if (const auto event = EventOf(entry)) write_.events.push_back(ToRecord(*event));
    if (job_lease_ && !entry.job().empty()) {
      if (const auto event = JobEventOf(entry)) write_.job_events.push_back(ToRecord(*event));
    }
    if (ends && job_lease_) end_ = entry.run_over().outcome();
    for (const v1::LinkedExecutable& made : entry.executables()) {
      made_.push_back({made.slot(), made.object_revision(), made.content()});
    }
    if (entry.has_mark()) SetMark(entry);
    ++added_;
    return {};
  }

  // What was added since the last time.
  Status Write() {
    storage::MachineWrite write = std::exchange(write_, {});
    const std::optional<v1::Outcome> end = std::exchange(end_, std::nullopt);
    if (const Status written = Put(end, std::move(write)); !written) return written.error();
    stored_ = added_;
    return {};
  }

  std::size_t stored() const { return stored_; }

 private:
  Status Put(const std::optional<v1::Outcome>& end, storage::MachineWrite write) {
    if (end) return Finish(*end, std::move(write));
    if (write.events.empty() && write.job_events.empty() && !write.mark) return {};
    if (!write.job_events.empty()) write.job = job_lease_;
    if (const Status written = store_.AppendMachine(lease_, write); !written)
      return written.error();
    // Of a run without a job, which has no end to be written with. One that is not kept is made
    // again by the next run; what was written above must not be written again for it.
    for (const storage::NewExecutable& made : std::exchange(made_, {})) {
      static_cast<void>(
          store_.PutExecutable(lease_.machine, made.slot, made.object_revision, made.bytes));
    }
    return {};
  }

  Status FindLease(const v1::JournalEntry& entry) {
    job_ = entry.job();
    job_lease_.reset();
    if (job_.empty()) return {};
    Result<std::optional<storage::Lease>> lease = LeaseOf(store_, job_);
    if (!lease) return lease.error();
    job_lease_ = *std::move(lease);
    return {};
  }

  void SetMark(const v1::JournalEntry& entry) {
    v1::MachineMark note = entry.mark();
    note.clear_state();
    write_.mark = storage::MachineMark{.sequence = entry.sequence(),
                                       .state = entry.mark().state(),
                                       .note = note.SerializeAsString(),
                                       .clean = entry.mark().clean()};
  }

  Status Finish(const v1::Outcome& outcome, storage::MachineWrite write) {
    storage::JobEnd end{.outcome = OutcomeOf(outcome), .machine_lease = lease_};
    end.events = std::exchange(write.job_events, {});
    end.events.push_back(EndedEvent(outcome));
    end.machine = std::move(write);
    end.executables = std::exchange(made_, {});
    const storage::Lease job = *std::exchange(job_lease_, std::nullopt);
    job_.clear();
    const auto finished = store_.Finish(job, end);
    return finished ? Status() : Status(finished.error());
  }

  storage::Store& store_;
  const storage::MachineLease& lease_;
  storage::MachineWrite write_{};
  std::string job_{};
  std::optional<storage::Lease> job_lease_{};
  std::optional<v1::Outcome> end_{};
  std::vector<storage::NewExecutable> made_{};  // by runs that are over
  std::size_t added_ = 0;
  std::size_t stored_ = 0;
};

}  // namespace

StoredEntries StoreEntries(storage::Store& store, const storage::MachineLease& lease,
                           std::span<const v1::JournalEntry> entries) {
  Entries all(store, lease);
  for (const v1::JournalEntry& entry : entries) {
    if (const Status added = all.Add(entry); !added)
      return {.count = all.stored(), .how = added.error()};
  }
  const Status written = all.Write();
  return {.count = all.stored(), .how = written};
}

namespace {

// One that goes on where another was cut off is over: a person decides that again.
Status GiveBackUnbegun(storage::Store& store, const storage::Lease& lease, bool held) {
  const auto job = store.GetJob(lease.job);
  if (!job) return job.error();
  v1::Job asked;
  if (!asked.ParseFromString(job->specification) || asked.continues().empty())
    return GiveBack(store, lease, "the host of the machine ended before it began", held);
  const auto ended =
      store.Finish(lease, {.outcome = storage::CancelledOutcome(), .events = {CancelledEvent()}});
  return ended ? Status() : Status(ended.error());
}

}  // namespace

Status GiveBack(storage::Store& store, const storage::Lease& lease, const std::string& why,
                bool held) {
  storage::LossPolicy policy = LossOf(StoppedOutcome(), {}, why);
  policy.not_begun = true;
  policy.held = held;
  const auto back = store.HandBack(lease, policy);
  return back ? Status() : Status(back.error());
}

Status EndWithoutHost(storage::Store& store, const std::string& machine) {
  const auto running = store.ListJobs({.machine = machine,
                                       .state = storage::JobState::kRunning,
                                       .kind = std::string(storage::kRunKind)});
  if (!running) return running.error();
  const auto mark = store.GetMachineMark(machine);
  if (!mark) return mark.error();
  v1::MachineMark note;
  if (*mark) static_cast<void>(note.ParseFromString((*mark)->note));
  for (const storage::JobRecord& job : *running) {
    const auto lease = LeaseOf(store, JobName(job.id));
    if (!lease) return lease.error();
    if (!*lease) continue;
    v1::Outcome outcome;
    outcome.set_kind(v1::Outcome::KIND_INTERRUPTED);
    outcome.set_code(CodeText(ErrorCode::kCellHostDied));
    if (note.job() == JobName(job.id)) {
      *outcome.mutable_place() = note.place();
      outcome.set_cycle_time_ns(note.run_time_ns());
    }
    const auto ended =
        store.Finish(**lease, {.outcome = OutcomeOf(outcome), .events = {EndedEvent(outcome)}});
    if (!ended && ended.error().code != ErrorCode::kCellLeaseLost) return ended.error();
  }
  return {};
}

Status GiveBackUnbegun(storage::Store& store, const std::string& machine, const std::string& host,
                       const std::string& begun) {
  const auto running = store.ListJobs({.machine = machine,
                                       .state = storage::JobState::kRunning,
                                       .kind = std::string(storage::kRunKind)});
  if (!running) return running.error();
  for (const storage::JobRecord& job : *running) {
    const auto lease = LeaseOf(store, JobName(job.id));
    if (!lease) return lease.error();
    if (!*lease || (*lease)->worker == host) continue;
    const Status back = GiveBackUnbegun(store, **lease, JobName(job.id) == begun);
    if (!back && back.error().code != ErrorCode::kCellLeaseLost) return back.error();
  }
  return {};
}

}  // namespace rmlcell::server
