#include "storage/jobs/job_rules.h"

#include <algorithm>
#include <utility>

#include "engine/core/check.h"

namespace rmlcell::storage {

Status CheckNewJob(const NewJob& job) {
  if (job.attempts_max < 1) return InvalidArgument("a job needs at least one attempt");
  if (job.priority < kPriorityMin || job.priority > kPriorityMax)
    return InvalidArgument("priority is " + Told("priority", job.priority) +
                           ", allowed are -100 to 100");
  return {};
}

Status CheckEventSizes(const std::vector<NewEvent>& events) {
  for (const NewEvent& event : events) {
    if (event.payload.size() > kEventPayloadBytesMax) {
      return Error{ErrorCode::kCellTooLarge,
                   "an event of " + Told("bytes", event.payload.size()) + " bytes",
                   {}};
    }
  }
  return {};
}

JobRecord MakeRecord(const NewJob& job, std::int64_t id, std::string request_id, WallTime now) {
  return {.id = id,
          .request_id = std::move(request_id),
          .request_hash = job.request_hash,
          .machine = job.machine,
          .family = job.family,
          .kind = job.kind,
          .pool = job.pool,
          .title = job.title,
          .caller = job.caller,
          .labels = job.labels,
          .specification = {},
          .priority = job.priority,
          .place = static_cast<double>(id),
          .held = job.held,
          .not_before = job.not_before,
          .attempts_max = job.attempts_max,
          .outcome = {},
          .last_sequence = static_cast<std::int64_t>(job.events.size()),
          .created_at = now,
          .started_at = {},
          .finished_at = {}};
}

Status CheckFinal(const JobOutcome& outcome) {
  if (IsFinal(outcome.state)) return {};
  return InvalidArgument("an outcome has to be final");
}

JobOutcome CancelledOutcome() {
  return {.state = JobState::kCancelled, .code = ErrorCode::kCellCancelled, .detail = {}};
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

WallTime LeaseEnd(WallTime now, std::chrono::milliseconds duration) {
  return now + std::clamp<std::chrono::milliseconds>(duration, std::chrono::milliseconds(0),
                                                     std::chrono::days(366));
}

Status CheckHolder(const Lease& lease, const std::optional<Lease>& held) {
  const auto lost = [&](const Detail& why) {
    return Error{ErrorCode::kCellLeaseLost, "job " + Told("job", lease.job) + " " + why, {}};
  };
  if (!held) return lost("is not leased");
  if (held->fence == lease.fence && held->attempt == lease.attempt) return {};
  return lost("is leased to " + Told("worker", held->worker) + " as attempt " +
              Told("attempt", held->attempt));
}

AfterLoss LoseAttempt(JobRecord& job, int begun, const LossPolicy& policy) {
  const int uncounted = begun - job.attempts;
  if (!policy.counts && uncounted < kUncountedAttemptsMax) job.attempts -= 1;
  if (job.kind == kRunKind) return AfterLoss::kInterrupted;
  if (job.cancel_requested && !policy.cancelled.empty()) return AfterLoss::kCancelled;
  return job.attempts < job.attempts_max ? AfterLoss::kQueued : AfterLoss::kEnded;
}

JobOutcome InterruptedOutcome(const LossPolicy& policy) {
  JobOutcome interrupted = policy.outcome;
  interrupted.state = JobState::kInterrupted;
  return interrupted;
}

bool HandBackAttempt(JobRecord& job, const LossPolicy& policy) {
  if (job.kind == kRunKind && !policy.not_begun) return false;
  job.attempts -= 1;
  return true;
}

Status CheckRemoval(const JobRecord& job) {
  if (IsFinal(job.state)) return {};
  return Error{ErrorCode::kCellPrecondition,
               "job " + Told("job", job.id) + " has not ended; cancel it first",
               {}};
}

}  // namespace rmlcell::storage
