#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "storage/store.h"

namespace rmlcell::storage {

// Where leases and records take their time from. Called by any thread.
using Clock = std::function<WallTime()>;
WallTime SystemTime();

struct SqliteOptions {
  // The database file. Its directory is made when missing (mode 0700), the file has mode 0600.
  // Beside it lie its log (-wal, -shm) and the file that locks it (.lock).
  std::string path{};

  // For locks that another program, such as a backup, holds on the file for a moment; after that a
  // write ends with CellStoreBusy and can be tried again.
  std::chrono::milliseconds busy_timeout{5'000};

  // Threads that may read at the same time; more of them wait for each other, never for the writer.
  int readers = 4;

  // While many callers write, the writer waits this long for those it has just answered, so that
  // one sync of the disk serves them all. A lone caller never waits.
  std::chrono::microseconds group_window{200};

  // Submissions and appended events that may wait for the writer; one more is refused with
  // CellResourceExhausted.
  std::size_t waiting_operations_max = 100'000;
  std::size_t waiting_bytes_max = std::size_t{256} << 20;

  // How much is kept of what is over. 0: all of it. Of finished jobs those that ended last stay,
  // with their events, artifacts and request ids; of events the newest, of unfinished jobs as well
  // (a few more than the limit may be there for a while).
  std::int64_t keep_finished_jobs = 0;
  std::int64_t keep_events = 0;
  // Of the events that tell of machines, programs, schedules and projects the newest; those of jobs
  // go with their jobs.
  std::int64_t keep_record_events = 0;

  // The log has this size from the start, as far as the disk has room. A commit that writes over a
  // part of the log waits about half as long for the disk as one that makes it grow, since the file
  // system then has nothing to note down. About 50 ms at the opening for 16 MiB.
  std::int64_t log_bytes_prepared = 0;

  // Of each machine; nothing to ask: all hold as much as comes.
  ProgramMemoryOf program_memory{};

  // Reads every page before the store is opened, and refuses a damaged file as a whole. Without it
  // damage shows when the record is read, and the rest is served. Takes seconds for each GB.
  bool check_whole_file = false;

  // A registered SQLite VFS, by name; empty: that of the system. For tests that let the disk fail.
  std::string vfs{};
};

// The embedded store: one SQLite database, written by this process only.
//
// Errors: CellStoreBusy when another process has it open; CellStoreNewer when a newer version wrote
// it; CellStoreCorrupt when the file is damaged, no database, or another program's; CellStoreFailed
// when it cannot be made, opened or written. A store of an older version is copied beside itself
// and migrated.
//
// Destroying the store runs and answers the writes that wait. A call must not be under way then.
Result<std::unique_ptr<Store>> OpenSqliteStore(const SqliteOptions& options,
                                               Clock clock = SystemTime);

}  // namespace rmlcell::storage
