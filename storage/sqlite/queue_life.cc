#include "storage/sqlite/queue_life.h"

#include <algorithm>

#include "storage/jobs/queue_rules.h"
#include "storage/sqlite/job_changes.h"
#include "storage/sqlite/job_life.h"

namespace rmlcell::storage::sqlite {
namespace {

// One that waited for a job that has succeeded.
Status LetFollow(WriteContext& context, std::int64_t job, std::int64_t after) {
  QueueTable& queue = context.tables.queue;
  if (const Status removed = queue.RemoveAfter(job, after); !removed) return removed.error();
  const Result<std::vector<std::int64_t>> left = queue.After(job);
  if (!left) return left.error();
  if (!left->empty()) return {};
  Result<std::optional<JobRow>> row = context.tables.jobs.Get(job);
  if (!row) return row.error();
  if (!*row || (*row)->job.state != JobState::kQueued) return {};
  SetBlocked(context, **row, (*row)->blocked & ~kBlockedByJobs);
  return context.tables.jobs.Update(**row);
}

// The job that keeps this one waiting: one that did not succeed before one that may.
Status AddAwaited(Tables& tables, JobRecord& job) {
  for (const std::int64_t id : job.after) {
    const Result<std::optional<JobRow>> other = tables.jobs.Get(id);
    if (!other) return other.error();
    const bool failed = !*other || IsFinal((*other)->job.state);
    if (!failed && job.wait == WaitReason::kAfterJob) continue;
    job.wait = failed ? WaitReason::kAfterJobFailed : WaitReason::kAfterJob;
    job.waits_for = id;
    if (failed) break;
  }
  return {};
}

Status AddBusyMachine(Tables& tables, JobRecord& job) {
  const Result<std::optional<std::int64_t>> running = tables.queue.RunningRun(job.machine);
  if (!running) return running.error();
  if (!*running) return {};
  job.wait = WaitReason::kMachineBusy;
  job.waits_for = **running;
  return {};
}

using Head = QueueTable::Head;

void Take(const std::optional<Head>& other, std::optional<Head>& first) {
  if (other && (!first || other->IsBefore(*first))) first = other;
}

// The one that is asked for, where it waits and its machine runs none.
Result<std::optional<std::int64_t>> ThatOne(WriteContext& context, std::int64_t job) {
  const Result<JobRow> row = GetRow(context, job);
  if (!row) return row.error();
  if (row->job.state != JobState::kQueued) return std::optional<std::int64_t>();
  if ((row->blocked & ~kBlockedByHold) != 0)
    return Error{ErrorCode::kCellPrecondition,
                 "job " + std::to_string(job) + " waits for its time, or for another job",
                 {}};
  if (row->job.kind == kRunKind) {
    const auto running = context.tables.queue.RunningRun(row->job.machine);
    if (!running) return running.error();
    if (*running) return std::optional<std::int64_t>();
  }
  return std::optional(job);
}

// Of machines that run none.
Result<std::optional<Head>> NextRun(WriteContext& context, const JobRequest& request) {
  QueueTable& queue = context.tables.queue;
  Result<std::vector<std::string>> machines = queue.MachinesWithRuns();
  if (!machines) return machines.error();
  std::optional<Head> first;
  for (const std::string& machine : *machines) {
    if (!request.run_machines.empty() &&
        std::ranges::find(request.run_machines, machine) == request.run_machines.end())
      continue;
    const Result<std::optional<std::int64_t>> running = queue.RunningRun(machine);
    if (!running) return running.error();
    if (*running) continue;
    const Result<std::optional<Head>> next = queue.NextRun(machine);
    if (!next) return next.error();
    Take(*next, first);
  }
  return first;
}

}  // namespace

Status AddWait(Tables& tables, JobRecord& job, WallTime now) {
  const WaitReason first = FirstWait(job, now);
  if (first == WaitReason::kAfterJob) return AddAwaited(tables, job);
  if (first == WaitReason::kMachineBusy) return AddBusyMachine(tables, job);
  job.wait = first;
  return {};
}

Result<std::vector<std::int64_t>> StillWanted(WriteContext& context, const NewJob& job) {
  std::vector<std::int64_t> wanted;
  for (const std::int64_t id : job.after) {
    const Result<JobRow> row = GetRow(context, id);
    if (!row) return row.error();
    const Result<bool> awaited = MustAwait(id, row->job.state);
    if (!awaited) return awaited.error();
    if (!*awaited || std::ranges::find(wanted, id) != wanted.end()) continue;
    wanted.push_back(id);
  }
  std::ranges::sort(wanted);
  return wanted;
}

Status LetFollowersGo(WriteContext& context, std::int64_t job) {
  const Result<std::vector<std::int64_t>> followers = context.tables.queue.Dependents(job);
  if (!followers) return followers.error();
  for (const std::int64_t follower : *followers) {
    if (const Status followed = LetFollow(context, follower, job); !followed)
      return followed.error();
  }
  return {};
}

Result<std::optional<std::int64_t>> NextFor(WriteContext& context, const JobRequest& request) {
  if (request.job) return ThatOne(context, *request.job);
  std::optional<Head> first;
  for (const std::string& kind : request.kinds) {
    if (kind == kRunKind) {
      const Result<std::optional<Head>> run = NextRun(context, request);
      if (!run) return run.error();
      Take(*run, first);
      continue;
    }
    for (const std::string& pool : request.pools) {
      const Result<std::optional<Head>> next = context.tables.queue.Next(pool, kind);
      if (!next) return next.error();
      Take(*next, first);
    }
  }
  return first ? std::optional(first->job) : std::nullopt;
}

namespace {

Result<JobRow> GetWaiting(WriteContext& context, std::int64_t id) {
  Result<JobRow> row = GetRow(context, id);
  if (!row) return row;
  if (const Status waits = CheckWaits(row->job); !waits) return waits.error();
  return row;
}

Result<JobRecord> Written(WriteContext& context, Result<JobRow> row,
                          const std::vector<NewEvent>& events) {
  if (const Status written = WriteChange(context, *row, kOutsideAnAttempt, events); !written)
    return written.error();
  return std::move(row->job);
}

// In front of another job of the line that this one is in, or null: behind all.
Result<double> PlaceFor(WriteContext& context, const JobRecord& job, const JobRecord* before) {
  QueueTable& queue = context.tables.queue;
  const Result<std::optional<double>> in_front =
      before != nullptr
          ? queue.PlaceBefore(job.pool, job.kind, {before->id, before->priority, before->place})
          : queue.LastPlace(job.pool, job.kind, job.priority);
  if (!in_front) return in_front.error();
  const std::int64_t newest = context.counters.job;
  const auto between = PlaceBetween(
      *in_front, before != nullptr ? std::optional(before->place) : std::nullopt, newest);
  if (between) return *between;
  Result<std::vector<PlacedJob>> line = queue.InOrder(job.pool, job.kind, job.priority);
  if (!line) return line.error();
  std::erase_if(*line, [&](const PlacedJob& placed) { return placed.job == job.id; });
  const auto at =
      before != nullptr ? std::ranges::find(*line, before->id, &PlacedJob::job) : line->end();
  std::vector<PlacedJob> spread =
      Spread(*line, static_cast<std::size_t>(at - line->begin()), job.id, newest);
  const double place = spread.back().place;
  spread.pop_back();
  for (const PlacedJob& placed : spread) {
    if (const Status set = queue.SetPlace(placed.job, placed.place); !set) return set.error();
  }
  return place;
}

}  // namespace

Result<JobRecord> HoldJobBack(WriteContext& context, std::int64_t id,
                              const std::vector<NewEvent>& events) {
  Result<JobRow> row = GetWaiting(context, id);
  if (!row) return row.error();
  if (row->job.held) return row->job;  // nothing happens, and nothing is told
  row->job.held = true;
  SetBlocked(context, *row, row->blocked | kBlockedByHold);
  return Written(context, std::move(row), events);
}

Result<JobRecord> LetJobGo(WriteContext& context, std::int64_t id,
                           const std::vector<NewEvent>& events) {
  Result<JobRow> row = GetWaiting(context, id);
  if (!row) return row.error();
  const Result<std::vector<std::int64_t>> after = context.tables.queue.After(id);
  if (!after) return after.error();
  bool waits = false;
  for (const std::int64_t other : *after) {
    const Result<std::optional<JobRow>> awaited = context.tables.jobs.Get(other);
    if (!awaited) return awaited.error();
    if (*awaited && !IsFinal((*awaited)->job.state)) {
      waits = true;
    } else if (const Status removed = context.tables.queue.RemoveAfter(id, other); !removed) {
      return removed.error();
    }
  }
  row->job.held = false;
  SetBlocked(context, *row, BlockedWhenLetGo(row->blocked, waits));
  return Written(context, std::move(row), events);
}

Result<JobRecord> MoveJob(WriteContext& context, std::int64_t id, std::int64_t before,
                          std::optional<int> priority, const std::vector<NewEvent>& events) {
  Result<JobRow> row = GetRow(context, id);
  if (!row) return row.error();
  std::optional<JobRow> other;
  if (before != 0) {
    Result<JobRow> found = GetRow(context, before);
    if (!found) return found.error();
    other = *std::move(found);
  }
  const JobRecord* other_job = other ? &other->job : nullptr;
  JobRecord& job = row->job;
  if (const Status may = CheckMove(job, other_job, priority); !may) return may.error();
  job.priority = other_job != nullptr ? other_job->priority : priority.value_or(job.priority);
  const Result<double> place = PlaceFor(context, job, other_job);
  if (!place) return place.error();
  job.place = *place;
  return Written(context, std::move(row), events);
}

namespace {

// Whether LetJobGo() would change it.
Result<bool> WaitsForAPerson(WriteContext& context, const JobRecord& job) {
  if (job.held) return true;
  const Result<std::vector<std::int64_t>> after = context.tables.queue.After(job.id);
  if (!after) return after.error();
  for (const std::int64_t other : *after) {
    const Result<std::optional<JobRow>> awaited = context.tables.jobs.Get(other);
    if (!awaited) return awaited.error();
    if (!*awaited || IsFinal((*awaited)->job.state)) return true;
  }
  return false;
}

Result<bool> Changes(WriteContext& context, const JobRecord& job, QueueAct act) {
  const bool waits = job.state == JobState::kQueued;
  switch (act) {
    case QueueAct::kHold:
      return waits && !job.held;
    case QueueAct::kCancel:
      return waits || (job.state == JobState::kRunning && !job.cancel_requested);
    case QueueAct::kRelease:
      break;
  }
  return waits ? WaitsForAPerson(context, job) : Result<bool>(false);
}

}  // namespace

Result<std::vector<JobRecord>> ActOnJobs(WriteContext& context, std::span<const std::int64_t> jobs,
                                         QueueAct act, const Store::EventOf& event) {
  std::vector<JobRecord> changed;
  for (const std::int64_t id : jobs) {
    const Result<std::optional<JobRow>> row = context.tables.jobs.Get(id);
    if (!row) return row.error();
    if (!*row) continue;
    const JobRecord& job = (*row)->job;
    const Result<bool> changes = Changes(context, job, act);
    if (!changes) return changes.error();
    if (!*changes) continue;
    const std::vector<NewEvent> events = {event(job)};
    Result<JobRecord> done = act == QueueAct::kHold      ? HoldJobBack(context, id, events)
                             : act == QueueAct::kRelease ? LetJobGo(context, id, events)
                                                         : CancelJob(context, id, events);
    if (!done) return done.error();
    changed.push_back(*std::move(done));
  }
  return changed;
}

Result<std::int64_t> CountBefore(Tables& tables, std::int64_t id) {
  const Result<std::optional<JobRow>> row = tables.jobs.Get(id);
  if (!row) return row.error();
  if (!*row) return Error{ErrorCode::kCellNotFound, "job " + std::to_string(id), {}};
  const JobRecord& job = (*row)->job;
  if (const Status waits = CheckWaits(job); !waits) return waits.error();
  return tables.queue.CountBefore(job.pool, job.kind, {id, job.priority, job.place});
}

Status PutJobOrder(WriteContext& context, std::int64_t job, std::string_view from,
                   std::string_view payload) {
  const Result<std::optional<Lease>> lease = context.tables.leases.Find(job);
  if (!lease) return lease.error();
  if (!*lease || (*lease)->server == from) {
    return Error{ErrorCode::kCellPrecondition,
                 "job " + std::to_string(job) + " does not run at another server",
                 {}};
  }
  context.changed = true;
  if (const Status tidy = context.tables.orders.RemoveStale(); !tidy) return tidy.error();
  return context.tables.orders.Add(**lease, payload);
}

Result<std::vector<TakenOrder>> TakeJobOrders(WriteContext& context, std::string_view server) {
  auto orders = context.tables.orders.Of(server);
  if (!orders) return orders.error();
  if (const Status removed = context.tables.orders.RemoveOf(server); !removed)
    return removed.error();
  return orders;
}

Status LetDueJobsGo(WriteContext& context) {
  const Result<std::vector<std::int64_t>> due = context.tables.queue.Due(context.now);
  if (!due) return due.error();
  for (const std::int64_t id : *due) {
    Result<JobRow> row = GetRow(context, id);
    if (!row) return row.error();
    SetBlocked(context, *row, row->blocked & ~kBlockedByTime);
    context.changed = true;
    if (const Status updated = context.tables.jobs.Update(*row); !updated) return updated.error();
  }
  return {};
}

}  // namespace rmlcell::storage::sqlite
