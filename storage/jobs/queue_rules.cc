#include "storage/jobs/queue_rules.h"

#include <algorithm>

namespace rmlcell::storage {

int BlockedAtFirst(const NewJob& job, bool waits, WallTime now) {
  return (job.held ? kBlockedByHold : 0) |
         (job.not_before && *job.not_before > now ? kBlockedByTime : 0) |
         (waits ? kBlockedByJobs : 0);
}

int BlockedWhenLetGo(int before, bool waits) {
  return (before & kBlockedByTime) | (waits ? kBlockedByJobs : 0);
}

Result<bool> MustAwait(std::int64_t job, JobState state) {
  if (state == JobState::kSucceeded) return false;
  if (!IsFinal(state)) return true;
  return Error{ErrorCode::kCellPrecondition,
               "job " + Told("job", job) + " has ended, and did not succeed",
               {}};
}

WaitReason FirstWait(const JobRecord& job, WallTime now) {
  if (job.held) return WaitReason::kHeld;
  if (!job.after.empty()) return WaitReason::kAfterJob;
  if (job.not_before && *job.not_before > now) return WaitReason::kNotBefore;
  return job.kind == kRunKind ? WaitReason::kMachineBusy : WaitReason::kNone;
}

Status CheckWaits(const JobRecord& job) {
  if (job.state == JobState::kQueued) return {};
  return Error{ErrorCode::kCellPrecondition,
               "job " + Told("job", job.id) + " does not wait in the queue",
               {}};
}

Status CheckMove(const JobRecord& job, const JobRecord* before, std::optional<int> priority) {
  if (priority && (*priority < kPriorityMin || *priority > kPriorityMax))
    return InvalidArgument("priority is " + Told("priority", *priority) +
                           ", allowed are -100 to 100");
  if (const Status waits = CheckWaits(job); !waits) return waits.error();
  if (before == nullptr) return {};
  if (before->id == job.id) return InvalidArgument("a job cannot stand in front of itself");
  if (const Status waits = CheckWaits(*before); !waits) return waits.error();
  if (before->pool != job.pool || before->kind != job.kind) {
    return Error{ErrorCode::kCellPrecondition,
                 "job " + Told("job", before->id) + " waits for another kind of worker",
                 {}};
  }
  if (priority && *priority != before->priority)
    return InvalidArgument("in front of a job another one has its priority");
  return {};
}

std::optional<double> PlaceBetween(std::optional<double> in_front, std::optional<double> behind,
                                   std::int64_t newest) {
  const auto last = static_cast<double>(newest);
  if (!behind) {
    in_front = std::max(in_front.value_or(last), last);
    behind = last + 1.0;
  }
  const double place = in_front ? (*in_front + *behind) / 2.0 : *behind - 1.0;
  if (place >= *behind || (in_front && place <= *in_front)) return {};
  return place;
}

std::vector<PlacedJob> Spread(std::span<const PlacedJob> line, std::size_t at, std::int64_t job,
                              std::int64_t newest) {
  std::size_t first = at;
  while (first > 0 && line[first - 1].moved) --first;
  std::size_t last = at;
  while (last < line.size() && line[last].moved) ++last;
  const double count = static_cast<double>(last - first) + 1.0;  // with the new one
  const double above = last < line.size() ? line[last].place : static_cast<double>(newest) + 1.0;
  double below = above - count;
  if (first > 0) {
    below = line[first - 1].place;
  } else if (first < last) {
    below = std::min(line[first].place, above) - count;
  }
  const double step = (above - below) / (count + 1.0);
  std::vector<PlacedJob> spread;
  double place = below;
  double found = above - step;
  for (std::size_t i = first; i < last; ++i) {
    place += step;
    if (i == at) {
      found = place;
      place += step;
    }
    spread.push_back({.job = line[i].job, .place = place, .moved = true});
  }
  spread.push_back({.job = job, .place = found, .moved = true});
  return spread;
}

}  // namespace rmlcell::storage
