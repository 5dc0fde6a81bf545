#pragma once

#include <string>

#include "engine/core/result.h"
#include "rmlcell/v1/job.pb.h"
#include "storage/store.h"

namespace rmlcell::server {

class JobBook;
class MemoryTools;

// What clients ask about jobs that have ended, made of their products. Thread-safe; blocks on the
// store, and Compare() on trial runs.
//
// Errors everywhere: CellInvalidArgument for a name that is none, CellNotFound, CellPrecondition
// for a job that has not ended, CellStoreCorrupt.
class JobResults {
 public:
  JobResults(storage::Store& store, JobBook& book, MemoryTools& tools)
      : store_(store), book_(book), tools_(tools) {}

  Result<v1::RunReport> Report(const std::string& job);

  // Errors: CellBadFilter, CellBadPageToken.
  Result<v1::ListJobFindingsResponse> Findings(const v1::ListJobFindingsRequest& request);

  // Lines of what the job did not bring as text are those of the source that is kept in the slot,
  // while that is of the same object.
  Result<v1::GetStepMapResponse> StepMap(const v1::GetStepMapRequest& request);

  // Errors: CellInvalidArgument for a signal that the job does not have, and a span or a number of
  // parts that makes no sense.
  Result<v1::GetJobSeriesResponse> Series(const v1::GetJobSeriesRequest& request);

  // Error: CellPrecondition for jobs of different machine families.
  Result<v1::CompareJobsResponse> Compare(const v1::CompareJobsRequest& request);

 private:
  struct Compared;
  Result<Compared> ReadCompared(const std::string& job);
  void ComparePrograms(const Compared& before, const Compared& after,
                       v1::CompareJobsResponse& response);

  storage::Store& store_;
  JobBook& book_;
  MemoryTools& tools_;
};

}  // namespace rmlcell::server
