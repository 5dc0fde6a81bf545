#include "storage/sqlite/order_table.h"

namespace rmlcell::storage::sqlite {

OrderTable::OrderTable(Database& database)
    : any_(database, "SELECT 1 FROM job_order LIMIT 1"),
      add_(database, "INSERT INTO job_order (job, fence, payload) VALUES (?1, ?2, ?3)"),
      of_(database,
          "SELECT lease.job, lease.attempt, lease.fence, lease.worker, lease.until, lease.server,"
          " job_order.payload FROM job_order JOIN lease"
          " ON lease.job = job_order.job AND lease.fence = job_order.fence"
          " WHERE lease.server = ?1 ORDER BY job_order.id"),
      remove_of_(
          database,
          "DELETE FROM job_order WHERE fence IN (SELECT fence FROM lease WHERE server = ?1)"),
      remove_stale_(database,
                    "DELETE FROM job_order WHERE fence NOT IN (SELECT fence FROM lease)") {}

Result<bool> OrderTable::Any() {
  const Result<std::optional<int>> row =
      FirstRow<int>(any_.With(), [](const Query& found) { return found.Small(0); });
  if (!row) return row.error();
  return row->has_value();
}

Status OrderTable::Add(const Lease& lease, std::string_view payload) {
  return add_.With(lease.job, lease.fence, Bytes{payload}).Run();
}

Result<std::vector<TakenOrder>> OrderTable::Of(std::string_view server) {
  return AllRows<TakenOrder>(of_.With(server), [](const Query& row) {
    return TakenOrder{.lease = {.job = row.Integer(0),
                                .attempt = row.Small(1),
                                .fence = row.Integer(2),
                                .worker = row.Text(3),
                                .until = row.Time(4),
                                .server = row.Text(5)},
                      .payload = row.Text(6)};
  });
}

Status OrderTable::RemoveOf(std::string_view server) { return remove_of_.With(server).Run(); }

Status OrderTable::RemoveStale() { return remove_stale_.With().Run(); }

}  // namespace rmlcell::storage::sqlite
