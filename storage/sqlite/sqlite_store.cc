#include "storage/sqlite/sqlite_store.h"

#include <algorithm>
#include <utility>

#include "storage/sqlite/migrations.h"
#include "storage/sqlite/sqlite_store_impl.h"

namespace rmlcell::storage {
namespace sqlite {
namespace {

// The writer touches a random page of the index of request ids with each job; the more of it stays
// in memory, the fewer reads it waits for.
constexpr int kWriterCacheKib = 64 * 1'024;
// A log that grew by a large program is cut back to this when it begins anew.
constexpr std::int64_t kLogBytesKept = std::int64_t{64} << 20;

Status CheckWholeFile(Database& database) {
  const Result<std::string> found = database.Text("PRAGMA quick_check(1)");
  if (!found) return found.error();
  if (*found == "ok") return {};
  return Error{ErrorCode::kCellStoreCorrupt, *found, {}};
}

Status Prepare(Database& database, const SqliteOptions& options, WallTime now) {
  // First of all: a file that is not ours, or newer, must not be touched.
  const Result<int> number = StoreNumber(database, Migrations());
  if (!number) return number.error();
  if (options.check_whole_file) {
    if (const Status whole = CheckWholeFile(database); !whole) return whole.error();
  }
  const Result<std::string> mode = database.Text("PRAGMA journal_mode = WAL");
  if (!mode) return mode.error();
  if (*mode != "wal") {
    return Error{
        ErrorCode::kCellStoreFailed,
        "the file system cannot share memory between processes (journal mode " + *mode + ")",
        {}};
  }
  const Status set = database.Execute("PRAGMA secure_delete = OFF; PRAGMA journal_size_limit = " +
                                      std::to_string(kLogBytesKept));
  if (!set) return set.error();
  return Migrate(database, Migrations(), options.path, now);
}

// Pages that do not fit into the cache go to the log before their transaction ends; when it is
// undone the log forgets them and keeps its length. What goes wrong, such as a full disk, costs the
// speed only.
void PrepareLog(Database& database, std::int64_t bytes) {
  if (bytes <= 0) return;
  static_cast<void>(
      database.Execute("PRAGMA cache_size = -256; BEGIN IMMEDIATE;"
                       "CREATE TABLE scratch (page); INSERT INTO scratch VALUES (zeroblob(" +
                       std::to_string(bytes) + "))"));
  static_cast<void>(database.Execute("ROLLBACK"));
  static_cast<void>(database.Execute("PRAGMA cache_size = -" + std::to_string(kWriterCacheKib)));
}

// The larger of what the rows say and what was noted when the newest rows were removed.
Status Raise(Result<std::int64_t> from_rows, Result<std::int64_t> mark, std::int64_t& counter) {
  if (!from_rows) return from_rows.error();
  if (!mark) return mark.error();
  counter = std::max(*from_rows, *mark);
  return {};
}

Result<Counters> ReadCounters(Tables& tables, const MachineTally::Machines& machines) {
  Counters counters;
  MarkTable& marks = tables.marks;
  if (const Status job = Raise(tables.jobs.LastId(), marks.Get(MarkTable::kJob), counters.job);
      !job)
    return job.error();
  if (const Status position =
          Raise(tables.events.LastPosition(), marks.Get(MarkTable::kPosition), counters.position);
      !position)
    return position.error();
  const Result<std::int64_t> fence = marks.Get(MarkTable::kFence);
  if (!fence) return fence.error();
  counters.fence = *fence;
  const Result<std::int64_t> finished = marks.Get(MarkTable::kFinishedJobs);
  if (!finished) return finished.error();
  counters.finished_jobs = *finished;
  for (const auto& [machine, jobs] : machines) {
    const auto running = static_cast<std::int64_t>(jobs.running.size());
    counters.running_jobs += running;
    counters.queued_jobs += jobs.unfinished - running;
  }
  const Result<std::int64_t> of_records = marks.Get(MarkTable::kRecordEvents);
  if (!of_records) return of_records.error();
  counters.record_events = *of_records;
  const Result<std::int64_t> blocked = marks.Get(MarkTable::kBlockedJobs);
  if (!blocked) return blocked.error();
  counters.blocked_jobs = *blocked;
  return counters;
}

Error Named(Error error, const std::string& path) {
  error.detail = path + ": " + error.detail;
  return error;
}

Result<std::unique_ptr<Store>> Open(const SqliteOptions& options, Clock clock) {
  if (options.path.empty()) {
    return Error{ErrorCode::kCellStoreFailed, "no file is named for the store", {}};
  }
  if (const Status directory = MakeDirectoryOf(options.path); !directory) return directory.error();
  Result<StoreLock> lock = StoreLock::Take(options.path + ".lock");
  if (!lock) return lock.error();
  // Under the lock: closing a file drops the locks that SQLite has on it elsewhere in this process.
  if (const Status file = MakePrivateFile(options.path); !file) return file.error();

  ConnectionOptions for_writer{
      .vfs = options.vfs, .busy_timeout = options.busy_timeout, .cache_kib = kWriterCacheKib};
  Result<Database> database =
      Database::Open(options.path, Database::Access::kReadWrite, for_writer);
  if (!database) return Named(database.error(), options.path);
  const Status prepared = Prepare(*database, options, clock());
  if (!prepared) return Named(prepared.error(), options.path);

  PrepareLog(*database, options.log_bytes_prepared);
  auto connection = std::make_unique<Connection>(*std::move(database));
  const Status released = connection->tables.blobs.ReleaseAll();
  if (!released) return Named(released.error(), options.path);
  // One process at a time has this file: whoever gave these leases is gone, and with it the lines
  // to those who held them.
  const Status ended = connection->tables.leases.EndThoseOfWorkers();
  if (!ended) return Named(ended.error(), options.path);
  Result<MachineTally::Machines> machines = connection->tables.machine_jobs.List();
  if (!machines) return Named(machines.error(), options.path);
  if (const Status running = connection->tables.jobs.AddRunning(*machines); !running)
    return Named(running.error(), options.path);
  const Result<Counters> counters = ReadCounters(connection->tables, *machines);
  if (!counters) return Named(counters.error(), options.path);
  const std::string log_id = RequestIds().Make(clock());
  if (const Status begun = connection->tables.log_parts.Begin(log_id, counters->position); !begun)
    return Named(begun.error(), options.path);
  return std::unique_ptr<Store>(std::make_unique<SqliteStore>(SqliteStore::Parts{
      .lock = *std::move(lock),
      .clock = std::move(clock),
      .connection = std::move(connection),
      .readers = std::make_unique<ReaderPool>(
          options.path, ConnectionOptions{.vfs = options.vfs, .busy_timeout = options.busy_timeout},
          options.readers),
      .counters = *counters,
      .machines = *std::move(machines),
      .log_id = log_id,
      .writer = {.keep = {.finished_jobs = options.keep_finished_jobs,
                          .events = options.keep_events,
                          .record_events = options.keep_record_events},
                 .waiting_operations_max = options.waiting_operations_max,
                 .waiting_bytes_max = options.waiting_bytes_max,
                 .group_window = options.group_window,
                 .program_memory = options.program_memory}}));
}

}  // namespace
}  // namespace sqlite

WallTime SystemTime() {
  return std::chrono::floor<std::chrono::microseconds>(std::chrono::system_clock::now());
}

Result<std::unique_ptr<Store>> OpenSqliteStore(const SqliteOptions& options, Clock clock) {
  return sqlite::Open(options, std::move(clock));
}

}  // namespace rmlcell::storage
