#include "storage/sqlite/job_life.h"

#include "storage/content.h"
#include "storage/jobs/job_rules.h"
#include "storage/jobs/queue_rules.h"
#include "storage/sqlite/host_life.h"
#include "storage/sqlite/housekeeping.h"
#include "storage/sqlite/job_changes.h"
#include "storage/sqlite/queue_life.h"

namespace rmlcell::storage::sqlite {
namespace {

Status IsHolder(WriteContext& context, const Lease& lease) {
  const Result<std::optional<Lease>> held = context.tables.leases.Find(lease.job);
  if (!held) return held.error();
  return CheckHolder(lease, *held);
}

Result<JobRow> GetHeldRow(WriteContext& context, const Lease& lease) {
  if (const Status held = IsHolder(context, lease); !held) return held.error();
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

// The holder is gone without an outcome.
Result<JobRecord> LoseJob(WriteContext& context, const Lease& lease, std::string_view how,
                          const LossPolicy& policy) {
  Result<JobRow> row = GetRow(context, lease.job);
  if (!row) return row.error();
  if (const Status ended = EndAttempt(context, lease, how); !ended) return ended.error();
  const std::vector<NewEvent>* events = &policy.ended;
  Status changed;
  switch (LoseAttempt(row->job, row->attempts_begun, policy)) {
    case AfterLoss::kInterrupted:
      changed = EndJob(context, *row, InterruptedOutcome(policy));
      events = &policy.interrupted;
      break;
    case AfterLoss::kCancelled:
      changed = EndJob(context, *row, CancelledOutcome());
      events = &policy.cancelled;
      break;
    case AfterLoss::kQueued:
      SetState(context, *row, JobState::kQueued);
      events = &policy.requeued;
      break;
    case AfterLoss::kEnded:
      changed = EndJob(context, *row, policy.outcome);
      break;
  }
  if (!changed) return changed.error();
  if (const Status written = WriteChange(context, *row, kOutsideAnAttempt, *events); !written)
    return written.error();
  return std::move(row->job);
}

// Whole, and of a size to stand in the row that names it.
bool FitsInRow(const PreparedContent& content, std::size_t bytes_max) {
  return !content.must_exist && content.staged_blob == 0 && content.encoded.size() <= bytes_max;
}

Result<bool> AddArtifact(WriteContext& context, std::int64_t job, const NewArtifact& artifact,
                         const PreparedContent& content) {
  ArtifactTable& table = context.tables.artifacts;
  if (FitsInRow(content, kProductInRowMax) && !table.recent().CameBefore(content.sha256))
    return table.AddWhole(job, artifact, content);
  const Result<std::int64_t> blob = context.tables.blobs.PutBlob(content);
  if (!blob) return blob.error();
  return table.Add(job, artifact, *blob);
}

// But for `with_job`, which stands with the specification already.
Status AddArtifacts(WriteContext& context, std::int64_t job,
                    const std::vector<NewArtifact>& artifacts,
                    const std::vector<const PreparedContent*>& contents,
                    const PreparedContent* with_job) {
  for (std::size_t i = 0; i < artifacts.size(); ++i) {
    if (contents[i] == with_job) continue;
    const Result<bool> added = AddArtifact(context, job, artifacts[i], *contents[i]);
    if (!added) return added.error();
    if (!*added) return InvalidArgument("two artifacts named " + artifacts[i].name);
  }
  return {};
}

// The program of most jobs: a row of its own, with the index of those, would be two more pages to
// write with each of them.
const PreparedContent* KeptWithJob(const JobContents& contents) {
  if (contents.attachments.empty()) return nullptr;
  const PreparedContent& first = *contents.attachments.front();
  return FitsInRow(first, kContentInRowMax) ? &first : nullptr;
}

Status PutWhatItBrings(WriteContext& context, std::int64_t id, const NewJob& job,
                       const JobContents& contents) {
  const PreparedContent* with_job = KeptWithJob(contents);
  if (!job.specification.empty() || with_job != nullptr) {
    const Result<ContentColumns> columns = context.tables.blobs.Put(*contents.specification);
    if (!columns) return columns.error();
    const std::optional<JobTable::Attachment> attachment =
        with_job == nullptr
            ? std::nullopt
            : std::optional(JobTable::Attachment{job.attachments.front(), *with_job});
    if (const Status put = context.tables.jobs.PutSpecification(id, *columns, attachment); !put)
      return put.error();
  }
  return AddArtifacts(context, id, job.attachments, contents.attachments, with_job);
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
  if (const Status good = CheckNewJob(job); !good) return good.error();
  JobRecord record = MakeRecord(job, context.counters.job + 1, contents.request_id, context.now);
  if (job.queued_max > 0 && context.counters.queued_jobs >= job.queued_max) {
    return KnownJobOr({ErrorCode::kCellResourceExhausted,
                       std::to_string(context.counters.queued_jobs) + " jobs wait",
                       {}},
                      context, job, contents);
  }
  Result<std::vector<std::int64_t>> after = StillWanted(context, job);
  if (!after) return KnownJobOr(after.error(), context, job, contents);
  record.after = *std::move(after);
  const int blocked = BlockedAtFirst(job, !record.after.empty(), context.now);
  record.blocked = blocked != 0;
  const Result<bool> inserted = context.tables.jobs.Insert(record, blocked);
  if (!inserted) return inserted.error();
  if (!*inserted) return KnownJob(context, job, contents);
  context.counters.job = record.id;
  context.counters.queued_jobs += 1;
  context.moves.push_back(
      {.machine = record.machine, .job = record.id, .from = {}, .to = JobState::kQueued});
  if (blocked != 0) context.counters.blocked_jobs += 1;
  context.ready = context.ready || blocked == 0;
  for (const std::int64_t other : record.after) {
    if (const Status added = context.tables.queue.AddAfter(record.id, other); !added)
      return added.error();
  }
  if (const Status brought = PutWhatItBrings(context, record.id, job, contents); !brought)
    return brought.error();
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
    if (const Status ended = EndJob(context, *row, CancelledOutcome()); !ended)
      return ended.error();
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
  job.held = false;
  SetState(context, *row, JobState::kRunning);
  job.attempts += 1;
  row->attempts_begun += 1;
  if (!job.started_at) job.started_at = context.now;
  Lease lease{.job = job.id,
              .attempt = row->attempts_begun,
              .fence = ++context.counters.fence,
              .worker = request.worker,
              .until = LeaseEnd(context.now, request.duration),
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
          context.tables.leases.Prolong(lease.job, LeaseEnd(context.now, duration));
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
  if (const Status added = AddArtifacts(context, lease.job, end.artifacts, contents, nullptr);
      !added)
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

Result<JobRecord> AddLateProducts(WriteContext& context, std::int64_t job,
                                  const LateProducts& products,
                                  const std::vector<const PreparedContent*>& contents) {
  Result<JobRow> row = GetRow(context, job);
  if (!row) return row.error();
  if (!IsFinal(row->job.state))
    return Error{ErrorCode::kCellPrecondition, "job " + std::to_string(job) + " has not ended", {}};
  if (const Status added = AddArtifacts(context, job, products.artifacts, contents, nullptr);
      !added)
    return added.error();
  if (!products.verdict.empty() && row->job.outcome) {
    row->job.outcome->judgement = products.judgement;
    row->job.outcome->verdict = products.verdict;
  }
  if (const Status written = WriteChange(context, *row, kOutsideAnAttempt, products.events);
      !written)
    return written.error();
  return std::move(row->job);
}

Result<JobRecord> HandBackJob(WriteContext& context, const Lease& lease, const LossPolicy& policy) {
  if (const Status final_state = CheckFinal(policy.outcome); !final_state)
    return final_state.error();
  Result<JobRow> row = GetHeldRow(context, lease);
  if (!row) return row.error();
  if (const Status ended = EndAttempt(context, lease, "handed back"); !ended) return ended.error();
  const bool waits = HandBackAttempt(row->job, policy);
  // Nobody but its machine would end a RUN whose cancel came meanwhile, and that may never start.
  if (waits && row->job.kind == kRunKind && row->job.cancel_requested) {
    if (const Status over = EndJob(context, *row, CancelledOutcome()); !over) return over.error();
    if (const Status written = WriteChange(context, *row, lease.attempt, policy.cancelled);
        !written)
      return written.error();
    return std::move(row->job);
  }
  if (waits && policy.held) {
    row->job.held = true;
    SetBlocked(context, *row, row->blocked | kBlockedByHold);
  }
  if (waits) {
    SetState(context, *row, JobState::kQueued);
  } else if (const Status cut_off = EndJob(context, *row, InterruptedOutcome(policy)); !cut_off) {
    return cut_off.error();
  }
  if (const Status written =
          WriteChange(context, *row, lease.attempt, waits ? policy.requeued : policy.interrupted);
      !written)
    return written.error();
  return std::move(row->job);
}

Result<JobRecord> AbandonJob(WriteContext& context, const Lease& lease, const LossPolicy& policy) {
  if (const Status final_state = CheckFinal(policy.outcome); !final_state)
    return final_state.error();
  if (const Status held = IsHolder(context, lease); !held) return held.error();
  return LoseJob(context, lease, "abandoned", policy);
}

Result<std::optional<JobRecord>> ExpireLease(WriteContext& context, const Lease& lease,
                                             const LossPolicy& policy) {
  const Result<std::optional<Lease>> held = context.tables.leases.Find(lease.job);
  if (!held) return held.error();
  if (!*held || (*held)->fence != lease.fence || (*held)->until > context.now) {
    return std::optional<JobRecord>();
  }
  Result<JobRecord> job = LoseJob(context, lease, "lease ran out", policy);
  if (!job) return job.error();
  return std::optional(*std::move(job));
}

Status RemoveEndedJob(WriteContext& context, std::int64_t id, std::string_view caller) {
  const Result<JobRow> row = GetRow(context, id);
  if (!row) return row.error();
  if (const Status may = CheckRemoval(row->job); !may) return may.error();
  if (const Status removed = RemoveJobWhole(context, id); !removed) return removed.error();
  return NoteRecord(context, JobName(id), kDeleted, caller);
}

}  // namespace rmlcell::storage::sqlite
