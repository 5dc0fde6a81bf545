#pragma once

#include <vector>

#include "storage/sqlite/write_context.h"

// The steps that every change of a job is made of.
namespace rmlcell::storage::sqlite {

// In place of the number of an attempt: the event is not of one.
inline constexpr int kOutsideAnAttempt = 0;

// CellNotFound.
Result<JobRow> GetRow(Tables& tables, std::int64_t id);
inline Result<JobRow> GetRow(WriteContext& context, std::int64_t id) {
  return GetRow(context.tables, id);
}

// Numbers and writes events; the job has the new last sequence, its row not yet. CellTooLarge.
Status WriteEvents(WriteContext& context, JobRecord& job, int attempt,
                   const std::vector<NewEvent>& events);
// The end of every change of a job: its events, then its row.
Status WriteChange(WriteContext& context, JobRow& row, int attempt,
                   const std::vector<NewEvent>& events);

void SetState(WriteContext& context, JobRow& row, JobState state);
// Of a queued job: why it is not ready.
void SetBlocked(WriteContext& context, JobRow& row, int blocked);

}  // namespace rmlcell::storage::sqlite
