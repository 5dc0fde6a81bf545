#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/sqlite/write_context.h"
#include "storage/store.h"

// What happens to a job from its submission to its end: each function is the content of one write,
// and the contract of each is that of the method of Store with this name. Jobs are returned without
// their specification.
namespace rmlcell::storage::sqlite {

// What a job brings along, made ready outside of the writer.
struct JobContents {
  std::string request_id;  // that of the job; one of our own when the client gave none
  const PreparedContent* specification;
  std::vector<const PreparedContent*> attachments;  // those of the job, one by one
};

Error RequestIdReused(std::int64_t job);

// What does not stand in its row: its specification, and of a queued job what it waits for.
Status CompleteJob(Tables& tables, JobRecord& job, WallTime now);

Result<SubmittedJob> SubmitJob(WriteContext& context, const NewJob& job,
                               const JobContents& contents);

Result<JobRecord> CancelJob(WriteContext& context, std::int64_t id,
                            const std::vector<NewEvent>& events);

Result<std::vector<LeasedJob>> LeaseJobs(WriteContext& context, const JobRequest& request);

Result<JobRecord> RenewLease(WriteContext& context, const Lease& lease,
                             std::chrono::milliseconds duration);

// The last sequence number written.
Result<std::int64_t> AppendEvents(WriteContext& context, const Lease& lease,
                                  const std::vector<NewEvent>& events);

// `contents` belong to `artifacts`, one by one.
Result<JobRecord> FinishJob(WriteContext& context, const Lease& lease, const JobEnd& end,
                            const std::vector<const PreparedContent*>& contents);

Result<JobRecord> AddLateProducts(WriteContext& context, std::int64_t job,
                                  const LateProducts& products,
                                  const std::vector<const PreparedContent*>& contents);

Result<JobRecord> HandBackJob(WriteContext& context, const Lease& lease, const LossPolicy& policy);

Result<JobRecord> AbandonJob(WriteContext& context, const Lease& lease, const LossPolicy& policy);

// Store::Expire() for one job. Nothing when its lease is no longer this one, or has time again.
Result<std::optional<JobRecord>> ExpireLease(WriteContext& context, const Lease& lease,
                                             const LossPolicy& policy);

// As Store::DeleteJob.
Status RemoveEndedJob(WriteContext& context, std::int64_t id, std::string_view caller);

}  // namespace rmlcell::storage::sqlite
