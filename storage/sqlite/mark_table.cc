#include "storage/sqlite/mark_table.h"

namespace rmlcell::storage::sqlite {

MarkTable::MarkTable(Database& database)
    : get_(database, "SELECT value FROM mark WHERE name = ?1"),
      set_(database, "INSERT OR REPLACE INTO mark (name, value) VALUES (?1, ?2)") {}

Result<std::int64_t> MarkTable::Get(std::string_view name) { return FirstInteger(get_.With(name)); }

Status MarkTable::Set(std::string_view name, std::int64_t value) {
  return set_.With(name, value).Run();
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
