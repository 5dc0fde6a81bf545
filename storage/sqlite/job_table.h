#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/sqlite/blob_table.h"
#include "storage/sqlite/machine_tally.h"
#include "storage/store.h"

namespace rmlcell::storage::sqlite {

// A job without its specification.
struct JobRow {
  JobRecord job;
  int attempts_begun = 0;  // handed back ones included: the number of the newest attempt
  int blocked = 0;         // bits of queue_table.h

  bool special() const { return job.priority != 0 || job.place != static_cast<double>(job.id); }
};

class JobTable {
 public:
  JobTable(Database& database, BlobTable& blobs);

  // False, and nothing inserted, when there is a job with this request_id.
  Result<bool> Insert(const JobRecord& job, int blocked);
  Result<std::optional<JobRow>> Get(std::int64_t id);
  Result<std::optional<JobRow>> FindByRequest(std::string_view request_id);
  Result<std::vector<JobRecord>> List(const JobQuery& query);
  Status AddRunning(MachineTally::Machines& machines);
  Result<std::vector<JobStateCount>> CountByState(const JobQuery& query);

  Status Update(const JobRow& row);  // all that changes in the life of a job
  Status SetLastSequence(std::int64_t id, std::int64_t sequence);
  Status SetEventsGoneUntil(std::int64_t id, std::int64_t sequence);

  // An artifact that is kept with the specification of its job.
  struct Attachment {
    const NewArtifact& artifact;
    const PreparedContent& content;
  };
  Status PutSpecification(std::int64_t id, const ContentColumns& specification,
                          const std::optional<Attachment>& attachment);
  Result<std::string> Specification(std::int64_t id);  // empty when there is none

  Result<std::int64_t> LastId();

  // For the bound on finished jobs.
  // By the time it ended. None that was cut off while its machine waits for a decision about it.
  Result<std::optional<std::int64_t>> OldestFinished();
  // Returns the blob of its specification, whose reference is the caller's affair.
  Result<std::optional<std::int64_t>> Remove(std::int64_t id);

 private:
  struct Lane {
    std::string pool;
    std::string kind;
    int blocked = 0;
    int special = 0;
    auto operator<=>(const Lane&) const = default;
  };
  Result<std::vector<JobRecord>> ListLane(const std::string& jobs, const JobQuery& query,
                                          const std::optional<Lane>& lane);
  Result<std::vector<JobRecord>> ListUnfinished(JobState state, const JobQuery& query);
  Result<std::vector<JobRecord>> ListFinished(const JobQuery& query);
  Result<std::vector<JobRecord>> ListQueue(const JobQuery& query);
  Result<std::vector<Lane>> LanesOf(JobState state);

  Database& database_;
  BlobTable& blobs_;
  Statement insert_;
  Statement get_;
  Statement find_by_request_;
  Statement update_;
  Statement set_last_sequence_;
  Statement set_events_gone_;
  Statement put_specification_;
  Statement specification_;
  Statement last_id_;
  Statement running_;
  Statement oldest_finished_;
  Statement remove_;
  Statement remove_specification_;
};

}  // namespace rmlcell::storage::sqlite
