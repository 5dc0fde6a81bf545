#include "storage/sqlite/database.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstring>

#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {
namespace {

ErrorCode CodeOf(int sqlite_code) {
  switch (sqlite_code & 0xFF) {  // the low byte is the primary code
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return ErrorCode::kCellStoreCorrupt;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return ErrorCode::kCellStoreBusy;
    case SQLITE_TOOBIG:
      return ErrorCode::kCellTooLarge;
    default:
      return ErrorCode::kCellStoreFailed;
  }
}

Error ErrorOf(sqlite3* handle, int sqlite_code) {
  std::string detail = handle != nullptr ? sqlite3_errmsg(handle) : sqlite3_errstr(sqlite_code);
  detail += " (SQLite " + std::to_string(sqlite_code) + ")";
  const int system_error = handle != nullptr ? sqlite3_system_errno(handle) : 0;
  const int primary = sqlite_code & 0xFF;
  // Of no other one does SQLite keep the reason: what stands there is that of an earlier failure.
  const bool from_system =
      (primary == SQLITE_IOERR && sqlite_code != SQLITE_IOERR_NOMEM) || primary == SQLITE_CANTOPEN;
  if (system_error != 0 && from_system) {
    detail += std::string(": ") + std::strerror(system_error);  // NOLINT(concurrency-mt-unsafe)
  }
  return Error{CodeOf(sqlite_code), std::move(detail), {}};
}

int NoteLogPages(void* pages, sqlite3*, const char*, int count) {
  *static_cast<int*>(pages) = count;
  return SQLITE_OK;
}

}  // namespace

Result<Database> Database::Open(const std::string& path, Access access,
                                const ConnectionOptions& options) {
  // No mutex of SQLite's: a connection is used by one thread at a time, our own locks see to that.
  int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  flags |= access == Access::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE;
  sqlite3* handle = nullptr;
  const int opened = sqlite3_open_v2(path.c_str(), &handle, flags,
                                     options.vfs.empty() ? nullptr : options.vfs.c_str());
  Database database(handle);  // also a failed open has to be closed
  if (opened != SQLITE_OK) return ErrorOf(handle, opened);

  sqlite3_busy_timeout(handle, static_cast<int>(options.busy_timeout.count()));
  sqlite3_wal_hook(handle, NoteLogPages, database.log_pages_.get());  // and no automatic checkpoint
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  // A damaged or hostile file must give an error, not undefined results.
  const Status set = database.Execute(
      "PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA temp_store = MEMORY;"
      "PRAGMA synchronous = FULL; PRAGMA cache_size = -" +
      std::to_string(options.cache_kib));
  if (!set) return set.error();
  return database;
}

Status Database::Execute(const std::string& sql) {
  if (sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    return LastError();
  }
  return {};
}

Result<std::int64_t> Database::Number(const std::string& sql) {
  Statement statement(*this, sql);
  Query query = statement.With();
  const Result<bool> row = query.Step();
  if (!row) return row.error();
  if (!*row) return Error{ErrorCode::kCellStoreCorrupt, "no row for: " + sql, {}};
  return query.Integer(0);
}

Result<std::string> Database::Text(const std::string& sql) {
  Statement statement(*this, sql);
  Query query = statement.With();
  const Result<bool> row = query.Step();
  if (!row) return row.error();
  if (!*row) return Error{ErrorCode::kCellStoreCorrupt, "no row for: " + sql, {}};
  return query.Text(0);
}

Status Database::CopyTo(const std::string& path) const {
  // Made first, so that nobody else can ever read it.
  const int file = open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0) {
    return Error{
        ErrorCode::kCellStoreFailed,
        "cannot make " + path + ": " + std::strerror(errno),  // NOLINT(concurrency-mt-unsafe)
        {}};
  }
  close(file);
  Result<Database> target = Open(path, Access::kReadWrite, {});
  if (!target) return target.error();
  sqlite3_backup* backup = sqlite3_backup_init(target->handle(), "main", handle(), "main");
  if (backup == nullptr) return target->LastError();
  const int copied = sqlite3_backup_step(backup, -1);
  const int finished = sqlite3_backup_finish(backup);
  if (copied != SQLITE_DONE) return ErrorOf(nullptr, copied);
  if (finished != SQLITE_OK) return ErrorOf(nullptr, finished);
  return {};
}

Result<bool> Database::Checkpoint() {
  int in_log = 0;
  int moved = 0;
  const int done =
      sqlite3_wal_checkpoint_v2(handle_.get(), nullptr, SQLITE_CHECKPOINT_PASSIVE, &in_log, &moved);
  if ((done & 0xFF) == SQLITE_BUSY) return false;
  if (done != SQLITE_OK) return LastError();
  return in_log == moved;
}

Error Database::LastError() const {
  return ErrorOf(handle_.get(), sqlite3_extended_errcode(handle_.get()));
}

}  // namespace rmlcell::storage::sqlite
