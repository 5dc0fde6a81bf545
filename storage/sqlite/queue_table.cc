#include "storage/sqlite/queue_table.h"

#include <algorithm>

namespace rmlcell::storage::sqlite {
namespace {

QueueTable::Head ReadHead(const Query& row) {
  return {.job = row.Integer(0), .priority = row.Small(1), .place = row.Real(2)};
}

}  // namespace

// Constants stand as numbers: SQLite sees only then that a partial index fits.
QueueTable::QueueTable(Database& database)
    : next_(database,
            "SELECT id, 0, CAST(id AS REAL) FROM job INDEXED BY job_unfinished WHERE state < 2"
            " AND state = 0 AND pool = ?1 AND kind = ?2 AND blocked = 0 AND special = 0"
            " ORDER BY id LIMIT 1"),
      next_special_(database,
                    "SELECT id, priority, place FROM job INDEXED BY job_special"
                    " WHERE state = 0 AND blocked = 0 AND special = 1 AND pool = ?1 AND kind = ?2"
                    " ORDER BY priority DESC, place LIMIT 1"),
      next_run_(database,
                "SELECT id, priority, place FROM job INDEXED BY job_run_queue"
                " WHERE state = 0 AND blocked = 0 AND kind = 'RUN' AND machine = ?1"
                " ORDER BY priority DESC, place LIMIT 1"),
      first_run_machine_(database,
                         "SELECT machine FROM job INDEXED BY job_run_queue"
                         " WHERE state = 0 AND blocked = 0 AND kind = 'RUN'"
                         " ORDER BY machine LIMIT 1"),
      next_run_machine_(database,
                        "SELECT machine FROM job INDEXED BY job_run_queue"
                        " WHERE state = 0 AND blocked = 0 AND kind = 'RUN' AND machine > ?1"
                        " ORDER BY machine LIMIT 1"),
      running_run_(database,
                   "SELECT id FROM job INDEXED BY job_run"
                   " WHERE state = 1 AND kind = 'RUN' AND machine = ?1 LIMIT 1"),
      place_before_(database,
                    "SELECT max(place) FROM job INDEXED BY job_unfinished WHERE state < 2"
                    " AND state = 0 AND pool = ?1 AND kind = ?2 AND priority = ?3 AND place < ?4"),
      last_place_(database,
                  "SELECT max(place) FROM job INDEXED BY job_unfinished WHERE state < 2"
                  " AND state = 0 AND pool = ?1 AND kind = ?2 AND priority = ?3"),
      in_order_(database,
                "SELECT id, place, special FROM job INDEXED BY job_unfinished WHERE state < 2"
                " AND state = 0 AND pool = ?1 AND kind = ?2 AND priority = ?3"
                " ORDER BY place, id"),
      set_place_(database, "UPDATE job SET place = ?2, special = 1 WHERE id = ?1"),
      count_before_(database,
                    "SELECT count(*) FROM job INDEXED BY job_unfinished WHERE state < 2"
                    " AND state = 0 AND pool = ?1 AND kind = ?2 AND blocked = 0"
                    " AND (priority > ?3 OR (priority = ?3 AND place < ?4))"),
      due_(database,
           "SELECT id FROM job INDEXED BY job_not_before"
           " WHERE state = 0 AND not_before IS NOT NULL AND not_before <= ?1 AND blocked & 2 <> 0"
           " ORDER BY not_before, id"),
      add_after_(database, "INSERT INTO job_after (job, after) VALUES (?1, ?2)"),
      remove_after_(database, "DELETE FROM job_after WHERE job = ?1 AND after = ?2"),
      remove_all_after_(database, "DELETE FROM job_after WHERE job = ?1"),
      after_(database, "SELECT after FROM job_after WHERE job = ?1 ORDER BY after"),
      dependents_(database, "SELECT job FROM job_after WHERE after = ?1 ORDER BY job") {}

Result<std::optional<QueueTable::Head>> QueueTable::Next(std::string_view pool,
                                                         std::string_view kind) {
  Result<std::optional<Head>> special = FirstRow<Head>(next_special_.With(pool, kind), ReadHead);
  if (!special) return special;
  Result<std::optional<Head>> oldest = FirstRow<Head>(next_.With(pool, kind), ReadHead);
  if (!oldest || !*special || !*oldest) return *special && oldest ? special : oldest;
  return (*special)->IsBefore(**oldest) ? special : oldest;
}

Result<std::optional<QueueTable::Head>> QueueTable::NextRun(std::string_view machine) {
  return FirstRow<Head>(next_run_.With(machine), ReadHead);
}

Result<std::vector<std::string>> QueueTable::MachinesWithRuns() {
  // Each step jumps to the next machine in the index: the cost is that of the machines.
  const auto text = [](const Query& row) { return row.Text(0); };
  std::vector<std::string> machines;
  Result<std::optional<std::string>> machine =
      FirstRow<std::string>(first_run_machine_.With(), text);
  while (machine && *machine) {
    if (!machines.empty() && **machine <= machines.back())
      return Error{ErrorCode::kCellStoreCorrupt, "the index of runs is out of order", {}};
    machines.push_back(**std::move(machine));
    machine = FirstRow<std::string>(next_run_machine_.With(machines.back()), text);
  }
  if (!machine) return machine.error();
  return machines;
}

Result<std::optional<std::int64_t>> QueueTable::RunningRun(std::string_view machine) {
  return FirstRow<std::int64_t>(running_run_.With(machine),
                                [](const Query& row) { return row.Integer(0); });
}

namespace {

Result<std::optional<double>> PlaceIn(Query query) {
  const Result<bool> row = query.Step();
  if (!row) return row.error();
  if (!*row || query.IsNull(0)) return std::optional<double>();
  return std::optional(query.Real(0));
}

Result<std::vector<std::int64_t>> Numbers(Query query) {
  return AllRows<std::int64_t>(std::move(query), [](const Query& row) { return row.Integer(0); });
}

}  // namespace

Result<std::int64_t> QueueTable::CountBefore(std::string_view pool, std::string_view kind,
                                             const Head& head) {
  const Result<std::optional<std::int64_t>> count =
      FirstRow<std::int64_t>(count_before_.With(pool, kind, head.priority, head.place),
                             [](const Query& row) { return row.Integer(0); });
  if (!count) return count.error();
  return count->value_or(0);
}

Result<std::optional<double>> QueueTable::PlaceBefore(std::string_view pool, std::string_view kind,
                                                      const Head& head) {
  return PlaceIn(place_before_.With(pool, kind, head.priority, head.place));
}

Result<std::optional<double>> QueueTable::LastPlace(std::string_view pool, std::string_view kind,
                                                    int priority) {
  return PlaceIn(last_place_.With(pool, kind, priority));
}

Result<std::vector<PlacedJob>> QueueTable::InOrder(std::string_view pool, std::string_view kind,
                                                   int priority) {
  return AllRows<PlacedJob>(in_order_.With(pool, kind, priority), [](const Query& row) {
    return PlacedJob{.job = row.Integer(0), .place = row.Real(1), .moved = row.Small(2) != 0};
  });
}

Status QueueTable::SetPlace(std::int64_t job, double place) {
  return set_place_.With(job, place).Run();
}

Result<std::vector<std::int64_t>> QueueTable::Due(WallTime now) { return Numbers(due_.With(now)); }

Status QueueTable::AddAfter(std::int64_t job, std::int64_t after) {
  return add_after_.With(job, after).Run();
}

Status QueueTable::RemoveAfter(std::int64_t job, std::int64_t after) {
  return remove_after_.With(job, after).Run();
}

Status QueueTable::RemoveAllAfter(std::int64_t job) { return remove_all_after_.With(job).Run(); }

Result<std::vector<std::int64_t>> QueueTable::After(std::int64_t job) {
  return Numbers(after_.With(job));
}

Result<std::vector<std::int64_t>> QueueTable::Dependents(std::int64_t after) {
  return Numbers(dependents_.With(after));
}

}  // namespace rmlcell::storage::sqlite
