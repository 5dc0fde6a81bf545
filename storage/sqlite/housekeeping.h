#pragma once

#include <cstdint>

#include "storage/sqlite/write_context.h"

namespace rmlcell::storage::sqlite {

// How much is kept of what is over. 0: all of it.
struct KeepLimits {
  std::int64_t finished_jobs = 0;
  std::int64_t events = 0;  // by position, those of unfinished jobs as well
  std::int64_t record_events = 0;
};

// A finished job with all that belongs to it; its events are gone from then on.
Status RemoveJobWhole(WriteContext& context, std::int64_t job);

// Removes what is no longer wanted: blobs that nobody names, finished jobs and events beyond the
// limits. In slices, so that no write waits long behind it.
class Housekeeping {
 public:
  explicit Housekeeping(const KeepLimits& limits) : limits_(limits) {}

  // Whether a slice would find jobs or events to remove; blobs are told by WriteContext::garbage.
  bool IsDue(const Counters& counters) const;

  // One slice, inside a transaction of the writer. Returns whether there is more to do.
  Result<bool> RunSlice(WriteContext& context) const;

 private:
  bool HasOldJobs(const Counters& counters) const;
  bool HasOldEvents(const Counters& counters) const;
  Result<bool> RemoveOldJobs(WriteContext& context) const;  // whether more of them may go
  Status RemoveOldEvents(WriteContext& context) const;
  bool HasOldRecordEvents(const Counters& counters) const;
  Status RemoveOldRecordEvents(WriteContext& context) const;
  Result<bool> ForgetUploads(WriteContext& context) const;

  KeepLimits limits_;
};

}  // namespace rmlcell::storage::sqlite
