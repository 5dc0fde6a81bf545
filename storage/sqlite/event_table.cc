#include "storage/sqlite/event_table.h"

namespace rmlcell::storage::sqlite {
namespace {

std::string SelectEvent(const std::string& which) {
  return "SELECT position, job, sequence, attempt, at, kind, payload, resource, caller FROM event " +
         which;
}

EventRecord ReadEvent(const Query& row) {
  return EventRecord{.position = row.Integer(0),
                     .job = row.Integer(1),
                     .resource = row.Text(7),
                     .sequence = row.Integer(2),
                     .attempt = row.Small(3),
                     .at = row.Time(4),
                     .caller = row.Text(8),
                     .kind = row.Text(5),
                     .payload = row.Text(6)};
}

EventTable::Removed ReadRemoved(const Query& row) {
  return {.job = row.Integer(0),
          .sequence = row.Integer(1),
          .position = row.Integer(2),
          .count = row.Integer(3)};
}

}  // namespace

EventTable::EventTable(Database& database)
    : add_(database,
           "INSERT INTO event (position, job, sequence, attempt, at, kind, payload, caller)"
           " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)"),
      add_of_record_(
          database,
          "INSERT INTO event (position, job, sequence, attempt, at, kind, payload, resource, caller)"
          " VALUES (?1, 0, ?1, 0, ?2, ?3, ?4, ?5, ?6)"),
      of_job_(database, SelectEvent("WHERE job = ?1 AND sequence > ?2 ORDER BY sequence LIMIT ?3")),
      all_(database, SelectEvent("WHERE position > ?1 ORDER BY position LIMIT ?2")),
      last_(database, "SELECT ifnull(max(position), 0) FROM event"),
      last_until_(database,
                  "SELECT ifnull(max(position), 0) FROM"
                  " (SELECT position FROM event WHERE position <= ?1 ORDER BY position LIMIT ?2)"),
      jobs_until_(
          database,
          "SELECT job, max(sequence), max(position), count(*) FROM event WHERE position <= ?1"
          " GROUP BY job"),
      remove_until_(database, "DELETE FROM event WHERE position <= ?1"),
      last_of_job_(database,
                   "SELECT ?1, max(sequence), max(position), count(*) FROM"
                   " (SELECT sequence, position FROM event WHERE job = ?1 ORDER BY sequence"
                   " LIMIT ?2)"),
      remove_of_job_(database, "DELETE FROM event WHERE job = ?1 AND sequence <= ?2") {}

Status EventTable::Add(const Place& place, const NewEvent& event) {
  return add_
      .With(place.position, place.job, place.sequence, place.attempt, place.at, event.kind,
            Bytes{event.payload}, event.caller)
      .Run();
}

Status EventTable::AddOfRecord(std::int64_t position, WallTime at, std::string_view resource,
                               const NewEvent& event) {
  return add_of_record_.With(position, at, event.kind, Bytes{event.payload}, resource, event.caller)
      .Run();
}

Result<std::vector<EventRecord>> EventTable::OfJob(std::int64_t job, std::int64_t after_sequence,
                                                   int limit) {
  return AllRows<EventRecord>(of_job_.With(job, after_sequence, limit), ReadEvent);
}

Result<std::vector<EventRecord>> EventTable::All(std::int64_t after_position, int limit) {
  return AllRows<EventRecord>(all_.With(after_position, limit), ReadEvent);
}

Result<std::int64_t> EventTable::LastPosition() { return FirstInteger(last_.With()); }

Result<std::vector<EventTable::Removed>> EventTable::RemoveUntil(std::int64_t position,
                                                                 int count_max) {
  const Result<std::int64_t> last = FirstInteger(last_until_.With(position, count_max));
  if (!last) return last.error();
  Result<std::vector<Removed>> removed = AllRows<Removed>(jobs_until_.With(*last), ReadRemoved);
  if (!removed || removed->empty()) return removed;
  if (const Status gone = remove_until_.With(*last).Run(); !gone) return gone.error();
  return removed;
}

Result<std::optional<EventTable::Removed>> EventTable::RemoveOfJob(std::int64_t job,
                                                                   int count_max) {
  Result<std::optional<Removed>> removed =
      FirstRow<Removed>(last_of_job_.With(job, count_max), ReadRemoved);
  if (!removed) return removed.error();
  if (!*removed || (*removed)->count == 0) return std::optional<Removed>();
  if (const Status gone = remove_of_job_.With(job, (*removed)->sequence).Run(); !gone)
    return gone.error();
  return removed;
}

}  // namespace rmlcell::storage::sqlite
