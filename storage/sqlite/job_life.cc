#include "storage/sqlite/job_life.h"

#include <algorithm>

#include "engine/core/check.h"
#include "storage/sqlite/host_life.h"
#include "storage/sqlite/housekeeping.h"
#include "storage/sqlite/job_changes.h"
#include "storage/sqlite/queue_life.h"

namespace rmlcell::storage::sqlite {
namespace {

Error LeaseLost(const Lease& lease, const std::string& why) {
  return Error{ErrorCode::kCellLeaseLost, "job " + std::to_string(lease.job) + " " + why, {}};
}

Status CheckFinal(const JobOutcome& outcome) {
  if (IsFinal(outcome.state)) return {};
  return InvalidArgument("an outcome has to be final");
}

// Never beyond what a WallTime can say.
WallTime After(WallTime now, std::chrono::milliseconds duration) {
  return now + std::clamp<std::chrono::milliseconds>(duration, std::chrono::milliseconds(0),
                                                     std::chrono::days(366));
}

// The lease as the store has it, when it is still this one.
Status CheckHolder(WriteContext& context, const Lease& lease) {
  const Result<std::optional<Lease>> held = context.tables.leases.Find(lease.job);
  if (!held) return held.error();
  if (!*held) return LeaseLost(lease, "is not leased");
  const Lease& now = **held;
  if (now.fence != lease.fence || now.attempt != lease.attempt) {
    return LeaseLost(lease,
                     "is leased to " + now.worker + " as attempt " + std::to_string(now.attempt));
  }
  return {};
}

Result<JobRow> GetHeldRow(WriteContext& context, const Lease& lease) {
  if (const Status held = CheckHolder(context, lease); !held) return held.error();
  return GetRow(context, lease.job);
}

Status EndAttempt(WriteContext& context, const Lease& lease, std::string_view how) {
  if (const Status ended = context.tables.attempts.End(lease.job, lease.attempt, context.now, how);
      !ended)
    return ended.error();
  return context.tables.leases.Remove(lease.job);
}

Status EndJob(WriteContext& context, JobRow& row, const JobOutcome& outcome) {
  SetState(context, row, outcome.state);
  row.job.outcome = outcome;
  row.job.finished_at = context.now;
  if (const Status waits = context.tables.queue.RemoveAllAfter(row.job.id); !waits)
    return waits.error();
  if (outcome.state != JobState::kSucceeded) return {};  // those that wait for it go on waiting
  return LetFollowersGo(context, row.job.id);
}

JobOutcome Cancelled() {
  return JobOutcome{.state = JobState::kCancelled, .code = ErrorCode::kCellCancelled, .detail = {}};
}

std::string_view HowItEnded(JobState state) {
  switch (state) {
    case JobState::kSucceeded:
      return "succeeded";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      return "cancelled";
    case JobState::kInterrupted:
      return "interrupted";
    case JobState::kQueued:
    case JobState::kRunning:
      break;
  }
  RMLCELL_CHECK(false);  // CheckFinal() was asked
  return {};
}

// The machine may have moved: a person decides, also when a cancel was wanted.
Status Interrupt(WriteContext& context, JobRow& row, const LossPolicy& policy) {
  JobOutcome interrupted = policy.outcome;
  interrupted.state = JobState::kInterrupted;
  return EndJob(context, row, interrupted);
}

// The holder is gone without an outcome.
Result<JobRecord> LoseAttempt(WriteContext& context, const Lease& lease, std::string_view how,
                              const LossPolicy& policy) {
  Result<JobRow> row = GetRow(context, lease.job);
  if (!row) return row.error();
  if (const Status ended = EndAttempt(context, lease, how); !ended) return ended.error();
  JobRecord& job = row->job;
  const int uncounted = row->attempts_begun - job.attempts;
  if (!policy.counts && uncounted < kUncountedAttemptsMax) job.attempts -= 1;
  const std::vector<NewEvent>* events = &policy.ended;
  Status changed;
  if (job.kind == kRunKind) {
    changed = Interrupt(context, *row, policy);
    events = &policy.interrupted;
  } else if (job.cancel_requested && !policy.cancelled.empty()) {
    changed = EndJob(context, *row, Cancelled());
    events = &policy.cancelled;
  } else if (job.attempts < job.attempts_max) {
    SetState(context, *row, JobState::kQueued);
    events = &policy.requeued;
  } else {
    changed = EndJob(context, *row, policy.outcome);
  }
  if (!changed) return changed.error();
  if (const Status written = WriteChange(context, *row, kOutsideAnAttempt, *events); !written)
    return written.error();
  return std::move(job);
}

// The bytes first, then the rows that name them.
Status AddArtifacts(WriteContext& context, std::int64_t job,
                    const std::vector<NewArtifact>& artifacts,
                    const std::vector<const PreparedContent*>& contents) {
  for (std::size_t i = 0; i < artifacts.size(); ++i) {
    const Result<std::int64_t> blob = context.tables.blobs.PutBlob(*contents[i]);
    if (!blob) return blob.error();
    const Result<bool> added = context.tables.artifacts.Add(job, artifacts[i], *blob);
    if (!added) return added.error();
    if (!*added) return InvalidArgument("two artifacts named " + artifacts[i].name);
  }
  return {};
}

// The first job, as it is by now; for the same request only.
Result<SubmittedJob> KnownJob(WriteContext& context, const NewJob& job,
                              const JobContents& contents) {
  Result<std::optional<JobRow>> known = context.tables.jobs.FindByRequest(contents.request_id);
  if (!known) return known.error();
  if (!*known) return Error{ErrorCode::kCellStoreCorrupt, "a request id without its job", {}};
  JobRecord& first = (*known)->job;
  if (first.request_hash != job.request_hash) {
    return RequestIdReused(first.id);
  }
  if (const Status whole = CompleteJob(context.tables, first, context.now); !whole)
    return whole.error();
  return SubmittedJob{.job = std::move(first), .already_there = true};
}

// The first job, or why there cannot be a new one. Asked before anything is written: a refusal in
// the middle of a batch would undo the batch.
Result<SubmittedJob> KnownJobOr(Error refusal, WriteContext& context, const NewJob& job,
                                const JobContents& contents) {
  const auto known = context.tables.jobs.FindByRequest(contents.request_id);
  if (!known) return known.error();
  if (*known) return KnownJob(context, job, contents);
  return refusal;
}

}  // namespace

Error RequestIdReused(std::int64_t job) {
  return Error{ErrorCode::kCellRequestIdReused, "it made job " + std::to_string(job), {}};
}

Status CompleteJob(Tables& tables, JobRecord& job, WallTime now) {
  Result<std::string> specification = tables.jobs.Specification(job.id);
  if (!specification) return specification.error();
  job.specification = *std::move(specification);
  if (job.state != JobState::kQueued) return {};
  Result<std::vector<std::int64_t>> after = tables.queue.After(job.id);
  if (!after) return after.error();
  job.after = *std::move(after);
  return AddWait(tables, job, now);
}

Result<SubmittedJob> SubmitJob(WriteContext& context, const NewJob& job,
                               const JobContents& contents) {
  if (job.attempts_max < 1) return InvalidArgument("a job needs at least one attempt");
  if (job.priority < kPriorityMin || job.priority > kPriorityMax)
    return InvalidArgument("priority is " + std::to_string(job.priority) +
                           ", allowed are -100 to 100");
  JobRecord record{.id = context.counters.job + 1,
                   .request_id = contents.request_id,
                   .request_hash = job.request_hash,
                   .machine = job.machine,
                   .family = job.family,
                   .kind = job.kind,
                   .pool = job.pool,
                   .title = job.title,
                   .caller = job.caller,
                   .specification = {},
                   .priority = job.priority,
                   .place = static_cast<double>(context.counters.job + 1),
                   .held = job.held,
                   .not_before = job.not_before,
                   .attempts_max = job.attempts_max,
                   .outcome = {},
                   .last_sequence = static_cast<std::int64_t>(job.events.size()),
                   .created_at = context.now,
                   .started_at = {},
                   .finished_at = {}};
  if (job.queued_max > 0 && context.counters.queued_jobs >= job.queued_max) {
    return KnownJobOr({ErrorCode::kCellResourceExhausted,
                       std::to_string(context.counters.queued_jobs) + " jobs wait",
                       {}},
                      context, job, contents);
  }
  Result<std::vector<std::int64_t>> after = StillWanted(context, job);
  if (!after) return KnownJobOr(after.error(), context, job, contents);
  record.after = *std::move(after);
  const int blocked = (job.held ? kBlockedByHold : 0) |
                      (job.not_before && *job.not_before > context.now ? kBlockedByTime : 0) |
                      (record.after.empty() ? 0 : kBlockedByJobs);
  record.blocked = blocked != 0;
  const Result<bool> inserted = context.tables.jobs.Insert(record, blocked);
  if (!inserted) return inserted.error();
  if (!*inserted) return KnownJob(context, job, contents);
  context.counters.job = record.id;
  context.counters.queued_jobs += 1;
  if (blocked != 0) context.counters.blocked_jobs += 1;
  for (const std::int64_t other : record.after) {
    if (const Status added = context.tables.queue.AddAfter(record.id, other); !added)
      return added.error();
  }
  if (!job.specification.empty()) {
    const Result<ContentColumns> columns = context.tables.blobs.Put(*contents.specification);
    if (!columns) return columns.error();
    if (const Status put = context.tables.jobs.PutSpecification(record.id, *columns); !put)
      return put.error();
  }
  if (const Status attached =
          AddArtifacts(context, record.id, job.attachments, contents.attachments);
      !attached)
    return attached.error();
  record.last_sequence = 0;
  if (const Status written = WriteEvents(context, record, kOutsideAnAttempt, job.events); !written)
    return written.error();
  if (const Status waits = AddWait(context.tables, record, context.now); !waits)
    return waits.error();
  return SubmittedJob{.job = std::move(record), .already_there = false};
}

Result<JobRecord> CancelJob(WriteContext& context, std::int64_t id,
                            const std::vector<NewEvent>& events) {
  Result<JobRow> row = GetRow(context, id);
  if (!row) return row.error();
  JobRecord& job = row->job;
  if (IsFinal(job.state)) return std::move(job);
  if (job.state == JobState::kQueued) {
    job.cancel_requested = true;
    if (const Status ended = EndJob(context, *row, Cancelled()); !ended) return ended.error();
    if (const Status written = WriteChange(context, *row, kOutsideAnAttempt, events); !written)
      return written.error();
  } else if (!job.cancel_requested) {
    job.cancel_requested = true;
    if (const Status written = WriteChange(context, *row, kOutsideAnAttempt, {}); !written)
      return written.error();
  }
  return std::move(job);
}

namespace {

Result<LeasedJob> LeaseJob(WriteContext& context, std::int64_t id, const JobRequest& request) {
  Result<JobRow> row = GetRow(context, id);
  if (!row) return row.error();
  JobRecord& job = row->job;
  SetState(context, *row, JobState::kRunning);
  job.attempts += 1;
  row->attempts_begun += 1;
  if (!job.started_at) job.started_at = context.now;
  Lease lease{.job = job.id,
              .attempt = row->attempts_begun,
              .fence = ++context.counters.fence,
              .worker = request.worker,
              .until = After(context.now, request.duration),
              .server = request.server};
  if (const Status leased = context.tables.leases.Add(lease); !leased) return leased.error();
  if (const Status begun = context.tables.attempts.Add({.job = job.id,
                                                        .number = lease.attempt,
                                                        .worker = lease.worker,
                                                        .fence = lease.fence,
                                                        .started_at = context.now,
                                                        .ended_at = {},
                                                        .how_it_ended = {}});
      !begun)
    return begun.error();
  if (const Status written = WriteChange(context, *row, lease.attempt, request.events); !written)
    return written.error();
  return LeasedJob{.lease = std::move(lease), .job = std::move(job)};
}

}  // namespace

Result<std::vector<LeasedJob>> LeaseJobs(WriteContext& context, const JobRequest& request) {
  std::vector<LeasedJob> leased;
  while (static_cast<int>(leased.size()) < request.count) {
    const Result<std::optional<std::int64_t>> next = NextFor(context, request);
    if (!next) return next.error();
    if (!*next) break;
    Result<LeasedJob> one = LeaseJob(context, **next, request);
    if (!one) return one.error();
    leased.push_back(*std::move(one));
  }
  return leased;
}

Result<JobRecord> RenewLease(WriteContext& context, const Lease& lease,
                             std::chrono::milliseconds duration) {
  Result<JobRow> row = GetHeldRow(context, lease);
  if (!row) return row.error();
  if (const Status prolonged =
          context.tables.leases.Prolong(lease.job, After(context.now, duration));
      !prolonged)
    return prolonged.error();
  return std::move(row->job);
}

Result<std::int64_t> AppendEvents(WriteContext& context, const Lease& lease,
                                  const std::vector<NewEvent>& events) {
  Result<JobRow> row = GetHeldRow(context, lease);
  if (!row) return row.error();
  if (const Status written = WriteEvents(context, row->job, lease.attempt, events); !written)
    return written.error();
  if (const Status noted = context.tables.jobs.SetLastSequence(row->job.id, row->job.last_sequence);
      !noted)
    return noted.error();
  return row->job.last_sequence;
}

Result<JobRecord> FinishJob(WriteContext& context, const Lease& lease, const JobEnd& end,
                            const std::vector<const PreparedContent*>& contents) {
  if (const Status final_state = CheckFinal(end.outcome); !final_state) return final_state.error();
  Result<JobRow> row = GetHeldRow(context, lease);
  if (!row) return row.error();
  if (const Status added = AddArtifacts(context, lease.job, end.artifacts, contents); !added)
    return added.error();
  if (const Status ended = EndAttempt(context, lease, HowItEnded(end.outcome.state)); !ended)
    return ended.error();
  if (const Status over = EndJob(context, *row, end.outcome); !over) return over.error();
  if (end.machine_lease) {
    if (const Status left = WriteMachine(context, *end.machine_lease, end.machine); !left)
      return left.error();
  }
  if (const Status written = WriteChange(context, *row, lease.attempt, end.events); !written)
    return written.error();
  return std::move(row->job);
}

Result<JobRecord> HandBackJob(WriteContext& context, const Lease& lease, const LossPolicy& policy) {
  if (const Status final_state = CheckFinal(policy.outcome); !final_state)
    return final_state.error();
  Result<JobRow> row = GetHeldRow(context, lease);
  if (!row) return row.error();
  if (const Status ended = EndAttempt(context, lease, "handed back"); !ended) return ended.error();
  JobRecord& job = row->job;
  const bool moved = job.kind == kRunKind;
  if (moved) {
    if (const Status cut_off = Interrupt(context, *row, policy); !cut_off) return cut_off.error();
  } else {
    job.attempts -= 1;
    SetState(context, *row, JobState::kQueued);
  }
  if (const Status written =
          WriteChange(context, *row, lease.attempt, moved ? policy.interrupted : policy.requeued);
      !written)
    return written.error();
  return std::move(job);
}

Result<JobRecord> AbandonJob(WriteContext& context, const Lease& lease, const LossPolicy& policy) {
  if (const Status final_state = CheckFinal(policy.outcome); !final_state)
    return final_state.error();
  if (const Status held = CheckHolder(context, lease); !held) return held.error();
  return LoseAttempt(context, lease, "abandoned", policy);
}

Result<std::optional<JobRecord>> ExpireLease(WriteContext& context, const Lease& lease,
                                             const LossPolicy& policy) {
  const Result<std::optional<Lease>> held = context.tables.leases.Find(lease.job);
  if (!held) return held.error();
  if (!*held || (*held)->fence != lease.fence || (*held)->until > context.now) {
    return std::optional<JobRecord>();
  }
  Result<JobRecord> job = LoseAttempt(context, lease, "lease ran out", policy);
  if (!job) return job.error();
  return std::optional(*std::move(job));
}

Status RemoveEndedJob(WriteContext& context, std::int64_t id, std::string_view caller) {
  const Result<JobRow> row = GetRow(context, id);
  if (!row) return row.error();
  if (!IsFinal(row->job.state)) {
    return Error{ErrorCode::kCellPrecondition,
                 "job " + std::to_string(id) + " has not ended; cancel it first",
                 {}};
  }
  if (const Status removed = RemoveJobWhole(context, id); !removed) return removed.error();
  return NoteRecord(context, JobName(id), kDeleted, caller);
}

}  // namespace rmlcell::storage::sqlite
