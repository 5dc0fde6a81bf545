#include "storage/sqlite/lease_table.h"

namespace rmlcell::storage::sqlite {
namespace {

Lease ReadLease(const Query& row) {
  return Lease{.job = row.Integer(0),
               .attempt = row.Small(1),
               .fence = row.Integer(2),
               .worker = row.Text(3),
               .until = row.Time(4),
               .server = row.Text(5)};
}

AttemptRecord ReadAttempt(const Query& row) {
  return AttemptRecord{.job = row.Integer(0),
                       .number = row.Small(1),
                       .worker = row.Text(2),
                       .fence = row.Integer(3),
                       .started_at = row.Time(4),
                       .ended_at = row.OptionalTime(5),
                       .how_it_ended = row.Text(6)};
}

}  // namespace

LeaseTable::LeaseTable(Database& database)
    : add_(database,
           "INSERT INTO lease (job, attempt, fence, worker, until, server)"
           " VALUES (?1, ?2, ?3, ?4, ?5, ?6)"),
      end_of_workers_(database,
                      "UPDATE lease SET until = 0"
                      " WHERE (SELECT kind FROM job WHERE id = lease.job) <> 'RUN'"),
      find_(database,
            "SELECT job, attempt, fence, worker, until, server FROM lease WHERE job = ?1"),
      // No index: there are no more leases than workers, and each renewal would have to keep it.
      run_out_(database,
               "SELECT job, attempt, fence, worker, until, server FROM lease WHERE until <= ?1"
               " ORDER BY job"),
      prolong_(database, "UPDATE lease SET until = ?2 WHERE job = ?1"),
      remove_(database, "DELETE FROM lease WHERE job = ?1") {}

Status LeaseTable::Add(const Lease& lease) {
  return add_.With(lease.job, lease.attempt, lease.fence, lease.worker, lease.until, lease.server)
      .Run();
}

Result<std::optional<Lease>> LeaseTable::Find(std::int64_t job) {
  return FirstRow<Lease>(find_.With(job), ReadLease);
}

Result<std::vector<Lease>> LeaseTable::RunOut(WallTime now) {
  return AllRows<Lease>(run_out_.With(now), ReadLease);
}

Status LeaseTable::Prolong(std::int64_t job, WallTime until) {
  return prolong_.With(job, until).Run();
}

Status LeaseTable::Remove(std::int64_t job) { return remove_.With(job).Run(); }

Status LeaseTable::EndThoseOfWorkers() { return end_of_workers_.With().Run(); }

AttemptTable::AttemptTable(Database& database)
    : add_(database,
           "INSERT INTO attempt (job, number, worker, fence, started_at, how_it_ended)"
           " VALUES (?1, ?2, ?3, ?4, ?5, '')"),
      end_(database,
           "UPDATE attempt SET ended_at = ?3, how_it_ended = ?4 WHERE job = ?1 AND number = ?2"),
      list_(database,
            "SELECT job, number, worker, fence, started_at, ended_at, how_it_ended FROM attempt"
            " WHERE job = ?1 ORDER BY number"),
      remove_(database, "DELETE FROM attempt WHERE job = ?1") {}

Status AttemptTable::Add(const AttemptRecord& attempt) {
  return add_.With(attempt.job, attempt.number, attempt.worker, attempt.fence, attempt.started_at)
      .Run();
}

Status AttemptTable::End(std::int64_t job, int number, WallTime at, std::string_view how) {
  return end_.With(job, number, at, how).Run();
}

Result<std::vector<AttemptRecord>> AttemptTable::List(std::int64_t job) {
  return AllRows<AttemptRecord>(list_.With(job), ReadAttempt);
}

Status AttemptTable::RemoveOf(std::int64_t job) { return remove_.With(job).Run(); }

}  // namespace rmlcell::storage::sqlite
