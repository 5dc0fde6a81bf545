#include "storage/sqlite/housekeeping.h"

#include <algorithm>

namespace rmlcell::storage::sqlite {
namespace {

// What one slice removes at most: a few milliseconds of work.
constexpr int kJobsPerSlice = 64;
constexpr int kEventsPerSlice = 1'000;
constexpr int kBlobsPerSlice = 256;
constexpr int kChunksPerSlice = 8;  // of up to 1 MiB each

// Events are removed many at a time, so this many more than the limit may be there for a while.
std::int64_t EventSlack(std::int64_t limit) {
  return std::min<std::int64_t>(limit / 8, kEventsPerSlice);
}

// The rows that the numbers were last given to may go now: the numbers must not come again.
Status KeepCounters(WriteContext& context) {
  MarkTable& marks = context.tables.marks;
  if (const Status job = marks.Set(MarkTable::kJob, context.counters.job); !job) return job.error();
  return marks.Set(MarkTable::kPosition, context.counters.position);
}

// From now on a reader that asks for these events of the job is told that they are gone.
Status NoteGoneOfJob(WriteContext& context, const EventTable::Removed& removed) {
  context.changed = true;
  if (removed.job == EventTable::kOfRecords) context.counters.record_events -= removed.count;
  return context.tables.jobs.SetEventsGoneUntil(removed.job, removed.sequence);
}

// The same of a reader of the whole log.
Status NoteGone(WriteContext& context, const EventTable::Removed& removed) {
  if (const Status job = NoteGoneOfJob(context, removed); !job) return job.error();
  const Result<std::int64_t> before = context.tables.marks.Get(MarkTable::kEventsGoneUntil);
  if (!before) return before.error();
  return context.tables.marks.Set(MarkTable::kEventsGoneUntil, std::max(*before, removed.position));
}

Status RemoveJob(WriteContext& context, std::int64_t job) {
  Tables& tables = context.tables;
  const Result<std::vector<std::int64_t>> artifacts = tables.artifacts.RemoveOf(job);
  if (!artifacts) return artifacts.error();
  for (const std::int64_t blob : *artifacts) {
    if (const Status dropped = tables.blobs.Drop(blob); !dropped) return dropped.error();
  }
  if (const Status attempts = tables.attempts.RemoveOf(job); !attempts) return attempts.error();
  const Result<std::optional<std::int64_t>> specification = tables.jobs.Remove(job);
  if (!specification) return specification.error();
  context.counters.finished_jobs -= 1;
  context.changed = true;
  return tables.blobs.Drop(*specification);
}

}  // namespace

Status RemoveJobWhole(WriteContext& context, std::int64_t job) {
  if (const Status kept = KeepCounters(context); !kept) return kept.error();
  for (;;) {
    const Result<std::optional<EventTable::Removed>> removed =
        context.tables.events.RemoveOfJob(job, kEventsPerSlice);
    if (!removed) return removed.error();
    if (!*removed) break;
    // Readers of the whole log find the event that tells of the removal.
    if (const Status noted = NoteGoneOfJob(context, **removed); !noted) return noted.error();
  }
  context.garbage = true;
  return RemoveJob(context, job);
}

bool Housekeeping::IsDue(const Counters& counters) const {
  return HasOldJobs(counters) || HasOldEvents(counters) || HasOldRecordEvents(counters);
}

bool Housekeeping::HasOldJobs(const Counters& counters) const {
  return limits_.finished_jobs > 0 && counters.finished_jobs > limits_.finished_jobs;
}

bool Housekeeping::HasOldRecordEvents(const Counters& counters) const {
  return limits_.record_events > 0 &&
         counters.record_events > limits_.record_events + EventSlack(limits_.record_events);
}

bool Housekeeping::HasOldEvents(const Counters& counters) const {
  return limits_.events > 0 && counters.position - counters.events_trimmed_until >
                                   limits_.events + EventSlack(limits_.events);
}

Result<bool> Housekeeping::RunSlice(WriteContext& context) const {
  bool more_jobs = false;
  if (IsDue(context.counters)) {
    if (const Status kept = KeepCounters(context); !kept) return kept.error();
    const Result<bool> jobs = RemoveOldJobs(context);
    if (!jobs) return jobs.error();
    more_jobs = *jobs;
    if (const Status events = RemoveOldEvents(context); !events) return events.error();
    if (const Status events = RemoveOldRecordEvents(context); !events) return events.error();
  }
  const Result<bool> more_uploads = ForgetUploads(context);
  if (!more_uploads) return more_uploads.error();
  const Result<bool> swept = context.tables.blobs.Sweep(kBlobsPerSlice, kChunksPerSlice);
  if (!swept) return swept.error();
  return *swept || *more_uploads || more_jobs || HasOldEvents(context.counters) ||
         HasOldRecordEvents(context.counters);
}

Result<bool> Housekeeping::RemoveOldJobs(WriteContext& context) const {
  int events_left = kEventsPerSlice;
  for (int i = 0; i < kJobsPerSlice && HasOldJobs(context.counters); ++i) {
    const Result<std::optional<std::int64_t>> job = context.tables.jobs.OldestFinished();
    if (!job) return job.error();
    if (!*job) return false;
    // Events first: a job with very many takes several slices and is there until the last of them.
    const Result<std::optional<EventTable::Removed>> removed =
        context.tables.events.RemoveOfJob(**job, events_left);
    if (!removed) return removed.error();
    if (*removed) {
      if (const Status noted = NoteGone(context, **removed); !noted) return noted.error();
      events_left -= static_cast<int>((*removed)->count);
      if (events_left <= 0) return true;
    }
    if (const Status gone = RemoveJob(context, **job); !gone) return gone.error();
  }
  return HasOldJobs(context.counters);
}

Status Housekeeping::RemoveOldRecordEvents(WriteContext& context) const {
  if (!HasOldRecordEvents(context.counters)) return {};
  const std::int64_t surplus = context.counters.record_events - limits_.record_events;
  const Result<std::optional<EventTable::Removed>> removed = context.tables.events.RemoveOfJob(
      EventTable::kOfRecords, static_cast<int>(std::min<std::int64_t>(surplus, kEventsPerSlice)));
  if (!removed) return removed.error();
  if (!*removed) return Error{ErrorCode::kCellStoreCorrupt, "old events cannot be removed", {}};
  return NoteGone(context, **removed);
}

// Contents that no record took in time. True: there may be more.
Result<bool> Housekeeping::ForgetUploads(WriteContext& context) const {
  for (int i = 0; i < kBlobsPerSlice; ++i) {
    const auto due = context.tables.uploads.FirstDue(context.now);
    if (!due) return due.error();
    if (!*due) return false;
    if (const Status removed = context.tables.uploads.Remove(**due); !removed)
      return removed.error();
    if (const Status dropped = context.tables.blobs.Drop(**due); !dropped) return dropped.error();
  }
  return true;
}

Status Housekeeping::RemoveOldEvents(WriteContext& context) const {
  if (!HasOldEvents(context.counters)) return {};
  const std::int64_t until = context.counters.position - limits_.events;
  const Result<std::vector<EventTable::Removed>> removed =
      context.tables.events.RemoveUntil(until, kEventsPerSlice);
  if (!removed) return removed.error();
  std::int64_t count = 0;
  std::int64_t newest = 0;
  for (const EventTable::Removed& of_job : *removed) {
    if (const Status noted = NoteGone(context, of_job); !noted) return noted.error();
    count += of_job.count;
    newest = std::max(newest, of_job.position);
  }
  const std::int64_t before = context.counters.events_trimmed_until;
  context.counters.events_trimmed_until = count < kEventsPerSlice ? until : newest;
  if (context.counters.events_trimmed_until <= before) {
    return Error{ErrorCode::kCellStoreCorrupt, "old events cannot be removed", {}};
  }
  return {};
}

}  // namespace rmlcell::storage::sqlite
