#include "storage/sqlite/taught_table.h"

namespace rmlcell::storage::sqlite {

TaughtTable::TaughtTable(Database& database)
    : last_(database, "SELECT ifnull(max(number), 0) FROM taught WHERE machine = ?1"),
      add_(database,
           "INSERT INTO taught (machine, number, program, entry) VALUES (?1, ?2, ?3, ?4)"),
      list_(database,
            "SELECT machine, number, program, entry FROM taught WHERE machine = ?1"
            " AND (?2 = 0 OR program = ?2) AND (?3 = 0 OR number < ?3)"
            " ORDER BY number DESC LIMIT ?4"),
      remove_up_to_(database, "DELETE FROM taught WHERE machine = ?1 AND number <= ?2"),
      remove_(database, "DELETE FROM taught WHERE machine = ?1") {}

Result<std::int64_t> TaughtTable::Last(std::string_view machine) {
  const auto last =
      FirstRow<std::int64_t>(last_.With(machine), [](const Query& row) { return row.Integer(0); });
  if (!last) return last.error();
  return last->value_or(0);
}

Status TaughtTable::Add(const TeachRecord& record) {
  return add_.With(record.machine, record.number, record.program, record.entry).Run();
}

Result<std::vector<TeachRecord>> TaughtTable::List(std::string_view machine, int program,
                                                   std::int64_t before, int limit) {
  return AllRows<TeachRecord>(list_.With(machine, program, before, limit), [](const Query& row) {
    return TeachRecord{.machine = row.Text(0),
                       .number = row.Integer(1),
                       .program = static_cast<int>(row.Integer(2)),
                       .entry = row.Text(3)};
  });
}

Status TaughtTable::RemoveUpTo(std::string_view machine, std::int64_t number) {
  return remove_up_to_.With(machine, number).Run();
}

Status TaughtTable::Remove(std::string_view machine) { return remove_.With(machine).Run(); }

}  // namespace rmlcell::storage::sqlite
