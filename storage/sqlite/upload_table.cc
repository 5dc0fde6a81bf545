#include "storage/sqlite/upload_table.h"

namespace rmlcell::storage::sqlite {

UploadTable::UploadTable(Database& database)
    : until_(database, "SELECT until FROM upload WHERE blob = ?1"),
      put_(database, "INSERT OR REPLACE INTO upload (blob, until) VALUES (?1, ?2)"),
      due_(database, "SELECT blob FROM upload WHERE until <= ?1 ORDER BY until LIMIT 1"),
      remove_(database, "DELETE FROM upload WHERE blob = ?1") {}

Result<std::optional<WallTime>> UploadTable::Until(std::int64_t blob) {
  return FirstRow<WallTime>(until_.With(blob), [](const Query& row) { return row.Time(0); });
}

Status UploadTable::Put(std::int64_t blob, WallTime until) { return put_.With(blob, until).Run(); }

Result<std::optional<std::int64_t>> UploadTable::FirstDue(WallTime now) {
  return FirstRow<std::int64_t>(due_.With(now), [](const Query& row) { return row.Integer(0); });
}

Status UploadTable::Remove(std::int64_t blob) { return remove_.With(blob).Run(); }

}  // namespace rmlcell::storage::sqlite
