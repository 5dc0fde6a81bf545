#pragma once

#include <optional>
#include <vector>

#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

class EventTable {
 public:
  explicit EventTable(Database& database);

  struct Place {
    std::int64_t position;
    std::int64_t job;
    std::int64_t sequence;
    int attempt;
    WallTime at;
  };
  Status Add(const Place& place, const NewEvent& event);
  // What was done with a record that is no job, and by whom.
  Status AddOfRecord(std::int64_t position, WallTime at, std::string_view resource,
                     const NewEvent& event);
  Result<std::vector<EventRecord>> OfJob(std::int64_t job, std::int64_t after_sequence, int limit);
  Result<std::vector<EventRecord>> All(std::int64_t after_position, int limit);
  Result<std::int64_t> LastPosition();  // of those that are there

  // For the bounds on what is kept: what was removed of one job, its events up to `sequence`.
  struct Removed {
    std::int64_t job;
    std::int64_t sequence;
    std::int64_t position;  // of the newest one that was removed
    std::int64_t count;
  };
  // The oldest `count_max` events of those up to `position`, by job.
  Result<std::vector<Removed>> RemoveUntil(std::int64_t position, int count_max);
  // The oldest `count_max` events of one job; nothing when it has none.
  Result<std::optional<Removed>> RemoveOfJob(std::int64_t job, int count_max);
  // Those that are of no job.
  static constexpr std::int64_t kOfRecords = 0;

 private:
  Statement add_;
  Statement add_of_record_;
  Statement of_job_;
  Statement all_;
  Statement last_;
  Statement last_until_;
  Statement jobs_until_;
  Statement remove_until_;
  Statement last_of_job_;
  Statement remove_of_job_;
};

}  // namespace rmlcell::storage::sqlite
