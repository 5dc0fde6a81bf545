#pragma once

#include <optional>

#include "storage/sqlite/machine_tally.h"
#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

// Counters that must not fall back when the rows they came from are removed, or that would be dear
// to count.
class MarkTable {
 public:
  static constexpr std::string_view kFinishedJobs = "finished jobs";
  static constexpr std::string_view kBlockedJobs = "blocked jobs";
  static constexpr std::string_view kRecordEvents = "record events";
  static constexpr std::string_view kJob = "job";
  static constexpr std::string_view kPosition = "position";
  static constexpr std::string_view kFence = "fence";  // none beyond it was given out
  static constexpr std::string_view kEventsGoneUntil = "events gone until";

  explicit MarkTable(Database& database);
  Result<std::int64_t> Get(std::string_view name);  // 0: never set
  Status Set(std::string_view name, std::int64_t value);

 private:
  Statement get_;
  Statement set_;
};

// How many jobs of each machine wait or run; of those without jobs there is no row.
class MachineJobsTable {
 public:
  explicit MachineJobsTable(Database& database);
  Status Set(std::string_view machine, std::int64_t unfinished);
  Result<MachineTally::Machines> List();  // without those that run

 private:
  Statement set_;
  Statement remove_;
  Statement list_;
};

// Parts of the log, one for each opening of the store: a position belongs to the log while it is no
// newer than the part that it was seen in.
class LogPartTable {
 public:
  static constexpr int kPartsKept = 1'000;

  explicit LogPartTable(Database& database);
  Status Begin(std::string_view id, std::int64_t after_position);
  // Where the part behind that of this id begins; nothing: none is known by this id. The newest
  // part has no end: the greatest number.
  Result<std::optional<std::int64_t>> EndOf(std::string_view id);

 private:
  Statement begin_;
  Statement trim_;
  Statement end_;
};

// The last revisions of deleted records.
class BuriedTable {
 public:
  enum class Kind { kProgram = 1, kSchedule = 2, kProject = 3, kMachine = 4 };

  explicit BuriedTable(Database& database);
  Status Bury(Kind kind, std::string_view owner, std::string_view name, Revision revision);
  // The revision that a new record counts on from, 0 when there was none; forgets it.
  Result<Revision> DigUp(Kind kind, std::string_view owner, std::string_view name);
  // Those of one owner whose names are numbers, in order.
  Result<std::vector<int>> Numbers(Kind kind, std::string_view owner);

 private:
  Statement bury_;
  Statement dig_up_;
  Statement numbers_;
};

}  // namespace rmlcell::storage::sqlite
