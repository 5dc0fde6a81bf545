#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "storage/records.h"
#include "storage/store.h"

// What keeps a job waiting, and who comes first among those of one pool and kind.
namespace rmlcell::storage {

// Why a queued job has no turn yet, as bits.
enum : int { kBlockedByHold = 1, kBlockedByTime = 2, kBlockedByJobs = 4 };
// `waits`: for other jobs.
int BlockedAtFirst(const NewJob& job, bool waits, WallTime now);
// Of one that is let go. `waits`: for jobs that may still succeed.
int BlockedWhenLetGo(int before, bool waits);

// Whether a job that comes behind one in this state has to wait for it; not for one that succeeded.
// CellPrecondition: it has ended otherwise.
Result<bool> MustAwait(std::int64_t job, JobState state);

// What a queued job with these fields waits for first. kAfterJob stands for kAfterJobFailed, too,
// and kMachineBusy may not be so: that the other jobs say.
WaitReason FirstWait(const JobRecord& job, WallTime now);

// CellPrecondition: it does not wait in the queue.
Status CheckWaits(const JobRecord& job);
// To another priority, or in front of `before`, whose priority it then has; null: behind all.
// Errors: CellInvalidArgument; CellPrecondition for one of another line.
Status CheckMove(const JobRecord& job, const JobRecord* before, std::optional<int> priority);

// A job that waits in a line of one priority, at its place: less is earlier. One that nobody moved
// stands at its own number.
struct PlacedJob {
  std::int64_t job = 0;
  double place = 0.0;
  bool moved = false;
};
// Between two places, nothing: in front of all, or behind all that will ever come with a greater
// number than `newest`; nothing where halving has left no number in between.
std::optional<double> PlaceBetween(std::optional<double> in_front, std::optional<double> behind,
                                   std::int64_t newest);
// New places for those around `at` that were moved, evenly between those that were not, and for one
// more job in front of `at` (the size of the line: behind all), which comes last in the answer.
// There is always room: those that were not moved stand a whole number apart.
std::vector<PlacedJob> Spread(std::span<const PlacedJob> line, std::size_t at, std::int64_t job,
                              std::int64_t newest);

}  // namespace rmlcell::storage
