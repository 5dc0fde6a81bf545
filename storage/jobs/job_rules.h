#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/records.h"
#include "storage/store.h"

// What may happen to a job from its submission to its end. A RUN moves its machine: it is never
// begun again by itself, whatever its end was.
namespace rmlcell::storage {

// CellInvalidArgument.
Status CheckNewJob(const NewJob& job);
// CellTooLarge.
Status CheckEventSizes(const std::vector<NewEvent>& events);
// As it is queued, before it is known which jobs it waits for.
JobRecord MakeRecord(const NewJob& job, std::int64_t id, std::string request_id, WallTime now);

// CellInvalidArgument.
Status CheckFinal(const JobOutcome& outcome);
JobOutcome CancelledOutcome();
// Of an attempt that came to an outcome. Precondition: a final state.
std::string_view HowItEnded(JobState state);

// When a lease runs out that is taken or renewed now; never beyond what a WallTime can say.
WallTime LeaseEnd(WallTime now, std::chrono::milliseconds duration);
// Whether the lease of the job that the store has is this one. CellLeaseLost.
Status CheckHolder(const Lease& lease, const std::optional<Lease>& held);

// What becomes of a job whose holder is gone without an outcome.
enum class AfterLoss {
  kQueued,       // it is tried again
  kCancelled,    // that was wanted anyway
  kInterrupted,  // its machine may have moved: a person decides, also when a cancel was wanted
  kEnded,        // it had its attempts
};
// `begun`: all attempts, those that did not count, too. An attempt that does not count is taken off
// job.attempts, but not for ever.
AfterLoss LoseAttempt(JobRecord& job, int begun, const LossPolicy& policy);
// The outcome of a job that is interrupted.
JobOutcome InterruptedOutcome(const LossPolicy& policy);
// Given back before it came to anything: true, it waits again, and the attempt did not count;
// false: it is interrupted.
bool HandBackAttempt(JobRecord& job, const LossPolicy& policy);

// CellPrecondition: it has not ended.
Status CheckRemoval(const JobRecord& job);

}  // namespace rmlcell::storage
