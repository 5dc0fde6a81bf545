#include "storage/sqlite/mark_table.h"

namespace rmlcell::storage::sqlite {

MarkTable::MarkTable(Database& database)
    : get_(database, "SELECT value FROM mark WHERE name = ?1"),
      set_(database, "INSERT OR REPLACE INTO mark (name, value) VALUES (?1, ?2)") {}

Result<std::int64_t> MarkTable::Get(std::string_view name) { return FirstInteger(get_.With(name)); }

Status MarkTable::Set(std::string_view name, std::int64_t value) {
  return set_.With(name, value).Run();
}

MachineJobsTable::MachineJobsTable(Database& database)
    : set_(database, "INSERT OR REPLACE INTO machine_jobs (machine, unfinished) VALUES (?1, ?2)"),
      remove_(database, "DELETE FROM machine_jobs WHERE machine = ?1"),
      list_(database, "SELECT machine, unfinished FROM machine_jobs") {}

Status MachineJobsTable::Set(std::string_view machine, std::int64_t unfinished) {
  if (unfinished == 0) return remove_.With(machine).Run();
  return set_.With(machine, unfinished).Run();
}

Result<MachineTally::Machines> MachineJobsTable::List() {
  MachineTally::Machines machines;
  Query rows = list_.With();
  Result<bool> row = rows.Step();
  for (; row && *row; row = rows.Step()) machines[rows.Text(0)].unfinished = rows.Integer(1);
  if (!row) return row.error();
  return machines;
}

LogPartTable::LogPartTable(Database& database)
    : begin_(database, "INSERT INTO log_part (id, after_position) VALUES (?1, ?2)"),
      trim_(database,
            "DELETE FROM log_part WHERE number <= (SELECT max(number) FROM log_part) - ?1"),
      end_(database,
           "SELECT ifnull((SELECT after_position FROM log_part AS next"
           " WHERE next.number > part.number ORDER BY next.number LIMIT 1),"
           " 9223372036854775807) FROM log_part AS part WHERE id = ?1") {}

Status LogPartTable::Begin(std::string_view id, std::int64_t after_position) {
  if (const Status begun = begin_.With(id, after_position).Run(); !begun) return begun.error();
  return trim_.With(kPartsKept).Run();
}

Result<std::optional<std::int64_t>> LogPartTable::EndOf(std::string_view id) {
  return FirstRow<std::int64_t>(end_.With(id), [](const Query& row) { return row.Integer(0); });
}

BuriedTable::BuriedTable(Database& database)
    : bury_(database,
            "INSERT OR REPLACE INTO buried (kind, owner, name, revision) VALUES (?1, ?2, ?3, ?4)"),
      dig_up_(database,
              "DELETE FROM buried WHERE kind = ?1 AND owner = ?2 AND name = ?3"
              " RETURNING revision"),
      numbers_(database,
               "SELECT CAST(name AS INTEGER) FROM buried WHERE kind = ?1 AND owner = ?2"
               " ORDER BY 1") {}

Status BuriedTable::Bury(Kind kind, std::string_view owner, std::string_view name,
                         Revision revision) {
  return bury_.With(static_cast<int>(kind), owner, name, revision).Run();
}

Result<Revision> BuriedTable::DigUp(Kind kind, std::string_view owner, std::string_view name) {
  return FirstInteger(dig_up_.With(static_cast<int>(kind), owner, name));
}

Result<std::vector<int>> BuriedTable::Numbers(Kind kind, std::string_view owner) {
  return AllRows<int>(numbers_.With(static_cast<int>(kind), owner),
                      [](const Query& row) { return row.Small(0); });
}

}  // namespace rmlcell::storage::sqlite
