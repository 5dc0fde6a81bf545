#pragma once

#include <optional>
#include <vector>

#include "storage/sqlite/statement.h"
#include "storage/store.h"

namespace rmlcell::storage::sqlite {

// The leases that are held: one for each running job, so that a second one is not possible.
class LeaseTable {
 public:
  explicit LeaseTable(Database& database);
  Status Add(const Lease& lease);
  Result<std::optional<Lease>> Find(std::int64_t job);
  Result<std::vector<Lease>> RunOut(WallTime now);  // by job
  Status Prolong(std::int64_t job, WallTime until);
  Status Remove(std::int64_t job);
  // Every lease of a worker has run out; a RUN is leased to the host of its machine, which lives
  // on.
  Status EndThoseOfWorkers();

 private:
  Statement add_;
  Statement end_of_workers_;
  Statement find_;
  Statement run_out_;
  Statement prolong_;
  Statement remove_;
};

// Who tried which job, and how that ended.
class AttemptTable {
 public:
  explicit AttemptTable(Database& database);
  Status Add(const AttemptRecord& attempt);
  Status End(std::int64_t job, int number, WallTime at, std::string_view how);
  Result<std::vector<AttemptRecord>> List(std::int64_t job);  // by number
  Status RemoveOf(std::int64_t job);

 private:
  Statement add_;
  Statement end_;
  Statement list_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
