#pragma once

#include <sqlite3.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rmlcell::storage::sqlite {

struct ConnectionOptions {
  std::string vfs;                                // of SQLite, by name; empty: the default one
  std::chrono::milliseconds busy_timeout{5'000};  // for locks that another program holds
  int cache_kib = 8 * 1024;
};

// One connection to the database file, closed by the destructor. Not for two threads at once.
class Database {
 public:
  enum class Access { kReadOnly, kReadWrite };

  // The file must exist. Foreign bytes are found by the first statement, not here.
  static Result<Database> Open(const std::string& path, Access access,
                               const ConnectionOptions& options);

  // One or several statements whose rows, if any, do not matter. Not for hot paths.
  Status Execute(const std::string& sql);

  // The first column of the first row; an error when there is none. Not for hot paths.
  Result<std::int64_t> Number(const std::string& sql);
  Result<std::string> Text(const std::string& sql);

  // Copies the whole database as this connection sees it into a new file of mode 0600.
  Status CopyTo(const std::string& path) const;

  // Moves pages from the write-ahead log into the database file, as far as no reader is in the way.
  // Returns true when the whole log was moved, so that the next commit starts it anew.
  Result<bool> Checkpoint();

  // Size of the write-ahead log after the newest commit of this connection.
  int log_pages() const { return *log_pages_; }

  // Rows inserted, changed and deleted since it was opened, those of undone writes included.
  std::int64_t total_changes() const { return sqlite3_total_changes64(handle_.get()); }

  bool in_transaction() const { return sqlite3_get_autocommit(handle_.get()) == 0; }
  sqlite3* handle() const { return handle_.get(); }

  // The newest failure of this connection as a row of the catalogue: CellStoreCorrupt,
  // CellStoreBusy, CellTooLarge, else CellStoreFailed.
  Error LastError() const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
  };
  explicit Database(sqlite3* handle) : handle_(handle) {}

  std::unique_ptr<sqlite3, Close> handle_;
  std::unique_ptr<int> log_pages_ = std::make_unique<int>(0);  // its address is known to SQLite
};

}  // namespace rmlcell::storage::sqlite
