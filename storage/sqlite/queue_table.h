#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/jobs/queue_rules.h"
#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

// The order of the queue, and which jobs wait for which.
//
// Submitting is the hot path: a job of priority 0 that nobody moved stands in the index of
// unfinished jobs by its number and in no other; the few that are special have an index of their
// own. Jobs that are not ready are in neither order.
class QueueTable {
 public:
  explicit QueueTable(Database& database);

  struct Head {
    std::int64_t job = 0;
    int priority = 0;
    double place = 0.0;  // less is earlier

    bool IsBefore(const Head& other) const {
      return priority != other.priority ? priority > other.priority : place < other.place;
    }
  };
  // The next one that is ready; of RUN by machine.
  Result<std::optional<Head>> Next(std::string_view pool, std::string_view kind);
  Result<std::optional<Head>> NextRun(std::string_view machine);
  Result<std::vector<std::string>> MachinesWithRuns();  // ready ones, by id
  // The RUN that a machine runs; nothing: none.
  Result<std::optional<std::int64_t>> RunningRun(std::string_view machine);

  // The place of the one in front of it, of the same priority; nothing: it is the first.
  Result<std::optional<double>> PlaceBefore(std::string_view pool, std::string_view kind,
                                            const Head& head);
  // The last place of this priority; nothing: there is none.
  Result<std::optional<double>> LastPlace(std::string_view pool, std::string_view kind,
                                          int priority);
  // All that wait with this priority, ready or not, in their order.
  Result<std::vector<PlacedJob>> InOrder(std::string_view pool, std::string_view kind,
                                         int priority);
  Status SetPlace(std::int64_t job, double place);
  // How many that are ready come before this one.
  Result<std::int64_t> CountBefore(std::string_view pool, std::string_view kind, const Head& head);
  // Jobs that are blocked by their time, up to this one.
  Result<std::vector<std::int64_t>> Due(WallTime now);

  Status AddAfter(std::int64_t job, std::int64_t after);
  Status RemoveAfter(std::int64_t job, std::int64_t after);
  Status RemoveAllAfter(std::int64_t job);
  Result<std::vector<std::int64_t>> After(std::int64_t job);
  Result<std::vector<std::int64_t>> Dependents(std::int64_t after);

 private:
  Statement next_;
  Statement next_special_;
  Statement next_run_;
  Statement first_run_machine_;
  Statement next_run_machine_;
  Statement running_run_;
  Statement place_before_;
  Statement last_place_;
  Statement in_order_;
  Statement set_place_;
  Statement count_before_;
  Statement due_;
  Statement add_after_;
  Statement remove_after_;
  Statement remove_all_after_;
  Statement after_;
  Statement dependents_;
};

}  // namespace rmlcell::storage::sqlite
