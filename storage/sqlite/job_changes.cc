#include "storage/sqlite/job_changes.h"

#include "storage/jobs/job_rules.h"

namespace rmlcell::storage::sqlite {

Status WriteEvents(WriteContext& context, JobRecord& job, int attempt,
                   const std::vector<NewEvent>& events) {
  if (const Status small_enough = CheckEventSizes(events); !small_enough)
    return small_enough.error();
  for (const NewEvent& event : events) {
    const EventTable::Place place{.position = ++context.counters.position,
                                  .job = job.id,
                                  .sequence = ++job.last_sequence,
                                  .attempt = attempt,
                                  .at = context.now};
    if (const Status added = context.tables.events.Add(place, event); !added) return added.error();
  }
  context.changed = true;
  return {};
}

Status WriteChange(WriteContext& context, JobRow& row, int attempt,
                   const std::vector<NewEvent>& events) {
  if (const Status written = WriteEvents(context, row.job, attempt, events); !written)
    return written.error();
  context.changed = true;
  return context.tables.jobs.Update(row);
}

Result<JobRow> GetRow(Tables& tables, std::int64_t id) {
  Result<std::optional<JobRow>> row = tables.jobs.Get(id);
  if (!row) return row.error();
  if (!*row) return Error{ErrorCode::kCellNotFound, "job " + std::to_string(id), {}};
  return **std::move(row);
}

void SetState(WriteContext& context, JobRow& row, JobState state) {
  JobRecord& job = row.job;
  if (job.state == JobState::kQueued && row.blocked != 0) context.counters.blocked_jobs -= 1;
  context.counters.JobsIn(job.state) -= 1;
  context.counters.JobsIn(state) += 1;
  context.moves.push_back({.machine = job.machine, .job = job.id, .from = job.state, .to = state});
  // A RUN that is over lets the next one of its machine begin.
  context.ready =
      context.ready || state == JobState::kQueued || (IsFinal(state) && job.kind == kRunKind);
  job.state = state;
  // Whoever comes back to the queue waited for all that it had to wait for.
  if (state != JobState::kQueued) row.blocked = 0;
}

void SetBlocked(WriteContext& context, JobRow& row, int blocked) {
  context.counters.blocked_jobs += (blocked != 0 ? 1 : 0) - (row.blocked != 0 ? 1 : 0);
  row.blocked = blocked;
  context.ready = context.ready || blocked == 0;
}

}  // namespace rmlcell::storage::sqlite
