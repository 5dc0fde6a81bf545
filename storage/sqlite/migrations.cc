#include "storage/sqlite/migrations.h"

#include "engine/core/check.h"
#include "storage/sqlite/schema.h"
#include "storage/sqlite/transaction.h"

namespace rmlcell::storage::sqlite {
namespace {

constexpr Migration kMigrations[] = {
    {1, "machines, programs, schedules, projects, jobs, events, artifacts", kFirstSchema},
    {2, "what was judged of a job",
     "ALTER TABLE job ADD COLUMN outcome_judgement BLOB NOT NULL DEFAULT x'';"},
    {3, "marks that spare the opening a look at every job",
     "INSERT OR REPLACE INTO mark SELECT 'finished jobs', count(*) FROM job WHERE state >= 2;"
     "INSERT OR REPLACE INTO mark SELECT 'fence', max(ifnull(max(fence), 0),"
     " ifnull((SELECT value FROM mark WHERE name = 'fence'), 0)) FROM attempt;"},
    {4, "jobs wait in pools",
     "ALTER TABLE job ADD COLUMN pool TEXT NOT NULL DEFAULT '';"
     "DROP INDEX job_unfinished;"
     "CREATE INDEX job_unfinished ON job (state, pool, kind) WHERE state < 2;"},
    // Events of what is no job have job 0 and their position as sequence.
    {5, "one log for all resources, and by which name it is known",
     "ALTER TABLE event ADD COLUMN resource TEXT NOT NULL DEFAULT '';"
     "ALTER TABLE event ADD COLUMN caller TEXT NOT NULL DEFAULT '';"
     "CREATE TABLE log_part (number INTEGER PRIMARY KEY, id TEXT NOT NULL UNIQUE,"
     " after_position INTEGER NOT NULL);"},
    // A job that is special has another priority or place than most; queue_table.h.
    {6, "the order of the queue, and what jobs wait for",
     "ALTER TABLE job ADD COLUMN priority INTEGER NOT NULL DEFAULT 0;"
     "ALTER TABLE job ADD COLUMN place REAL NOT NULL DEFAULT 0;"
     "ALTER TABLE job ADD COLUMN special INTEGER NOT NULL DEFAULT 0;"
     "ALTER TABLE job ADD COLUMN held INTEGER NOT NULL DEFAULT 0;"
     "ALTER TABLE job ADD COLUMN not_before INTEGER;"
     "ALTER TABLE job ADD COLUMN blocked INTEGER NOT NULL DEFAULT 0;"
     "UPDATE job SET place = id WHERE state < 2;"
     "DROP INDEX job_unfinished;"
     "CREATE INDEX job_unfinished ON job (state, pool, kind, blocked, special) WHERE state < 2;"
     "CREATE INDEX job_special ON job (pool, kind, priority DESC, place)"
     " WHERE state = 0 AND blocked = 0 AND special = 1;"
     "CREATE INDEX job_run_queue ON job (machine, priority DESC, place)"
     " WHERE state = 0 AND blocked = 0 AND kind = 'RUN';"
     "CREATE INDEX job_run ON job (machine) WHERE state = 1 AND kind = 'RUN';"
     "CREATE INDEX job_not_before ON job (not_before) WHERE state = 0 AND not_before IS NOT NULL;"
     "CREATE TABLE job_after (job INTEGER NOT NULL, after INTEGER NOT NULL,"
     " PRIMARY KEY (job, after)) WITHOUT ROWID;"
     "CREATE INDEX job_after_by ON job_after (after);"},
    {7, "orders for jobs of another server",
     "ALTER TABLE lease ADD COLUMN server TEXT NOT NULL DEFAULT '';"
     "CREATE TABLE job_order (id INTEGER PRIMARY KEY, job INTEGER NOT NULL,"
     " fence INTEGER NOT NULL, payload BLOB NOT NULL);"},
    {8, "family and verdict of jobs",
     "ALTER TABLE job ADD COLUMN family TEXT NOT NULL DEFAULT '';"
     "ALTER TABLE job ADD COLUMN outcome_verdict TEXT NOT NULL DEFAULT '';"
     "UPDATE job SET family = ifnull((SELECT machine.family FROM machine"
     " WHERE machine.id = job.machine), '');"},
    {9, "hosts of machines, and where machines stand",
     "CREATE TABLE machine_lock (machine TEXT PRIMARY KEY, host TEXT NOT NULL, server TEXT NOT NULL,"
     " fence INTEGER NOT NULL, renewals INTEGER NOT NULL, duration_ms INTEGER NOT NULL,"
     " pinned INTEGER NOT NULL) WITHOUT ROWID;"
     "CREATE TABLE machine_mark (machine TEXT PRIMARY KEY, fence INTEGER NOT NULL,"
     " sequence INTEGER NOT NULL, state BLOB NOT NULL, note BLOB NOT NULL, clean INTEGER NOT NULL,"
     " at INTEGER NOT NULL);"
     "ALTER TABLE machine DROP COLUMN state; ALTER TABLE machine DROP COLUMN state_blob;"},
    {10, "contents that no record names yet",
     "CREATE TABLE upload (blob INTEGER PRIMARY KEY, until INTEGER NOT NULL);"
     "CREATE INDEX upload_until ON upload (until);"},
    // An artifact with blob 0 has its bytes there.
    {11, "a small program is kept with its job",
     "ALTER TABLE artifact ADD COLUMN sha256 BLOB;"
     "ALTER TABLE artifact ADD COLUMN size INTEGER NOT NULL DEFAULT 0;"
     "ALTER TABLE job_specification ADD COLUMN attachment BLOB;"},
    // A blank around each: looked for in a text.
    {12, "labels of jobs", "ALTER TABLE job ADD COLUMN labels TEXT NOT NULL DEFAULT '';"},
    // Whoever opens a store looks at no job for them.
    {13, "counts that are kept",
     "CREATE TABLE machine_jobs (machine TEXT PRIMARY KEY, unfinished INTEGER NOT NULL)"
     " WITHOUT ROWID;"
     "INSERT INTO machine_jobs SELECT machine, count(*) FROM job INDEXED BY job_unfinished"
     " WHERE state < 2 GROUP BY machine;"
     "INSERT INTO mark SELECT 'blocked jobs', count(*) FROM job INDEXED BY job_unfinished"
     " WHERE state < 2 AND state = 0 AND blocked <> 0;"
     "INSERT INTO mark SELECT 'record events', count(*) FROM event WHERE job = 0;"},
    {14, "how machines live, and what was taught at them",
     "ALTER TABLE machine ADD COLUMN options BLOB NOT NULL DEFAULT '';"
     "CREATE TABLE taught (machine TEXT NOT NULL, number INTEGER NOT NULL,"
     " program INTEGER NOT NULL, entry BLOB NOT NULL, PRIMARY KEY (machine, number))"
     " WITHOUT ROWID;"},
    // An artifact without a blob has its bytes in its row. That of a small program has no row: all
    // of it stands with the specification.
    {15, "small products in the rows of their artifacts",
     "ALTER TABLE artifact RENAME TO artifact_before;"
     "CREATE TABLE artifact (id INTEGER PRIMARY KEY, job INTEGER NOT NULL, name TEXT NOT NULL,"
     " media_type TEXT NOT NULL, blob INTEGER, sha256 BLOB, size INTEGER, content BLOB);"
     "INSERT INTO artifact (job, name, media_type, blob)"
     " SELECT job, name, media_type, blob FROM artifact_before WHERE blob <> 0;"
     "CREATE UNIQUE INDEX artifact_by_job ON artifact (job, name);"
     "ALTER TABLE job_specification ADD COLUMN attachment_name TEXT;"
     "ALTER TABLE job_specification ADD COLUMN attachment_media_type TEXT;"
     "ALTER TABLE job_specification ADD COLUMN attachment_sha256 BLOB;"
     "ALTER TABLE job_specification ADD COLUMN attachment_size INTEGER;"
     "UPDATE job_specification SET (attachment_name, attachment_media_type, attachment_sha256,"
     " attachment_size) = (SELECT name, media_type, sha256, size FROM artifact_before"
     " WHERE artifact_before.job = job_specification.job AND artifact_before.blob = 0)"
     " WHERE attachment IS NOT NULL;"
     "DROP TABLE artifact_before;"},
};

// In the transaction of the first step, so that a file is either empty or known as ours.
std::string FoundingSql() {
  return "PRAGMA application_id = " + std::to_string(kApplicationId) +
         "; CREATE TABLE migration"
         " (number INTEGER PRIMARY KEY, what TEXT NOT NULL, at INTEGER NOT NULL);";
}

Status Apply(Database& database, TransactionStatements& statements, const Migration& migration,
             WallTime now) {
  Result<Transaction> transaction = Transaction::Begin(statements, Transaction::Kind::kWrite);
  if (!transaction) return transaction.error();
  const std::string founding = migration.number == 1 ? FoundingSql() : std::string();
  if (const Status done = database.Execute(founding + std::string(migration.sql)); !done)
    return done.error();
  Statement note(database, "INSERT INTO migration (number, what, at) VALUES (?1, ?2, ?3)");
  if (const Status noted = note.With(migration.number, migration.what, now).Run(); !noted)
    return noted.error();
  if (const Status numbered =
          database.Execute("PRAGMA user_version = " + std::to_string(migration.number));
      !numbered)
    return numbered.error();
  return transaction->Commit();
}

}  // namespace

std::span<const Migration> Migrations() { return kMigrations; }

Result<int> StoreNumber(Database& database, std::span<const Migration> migrations) {
  const Result<std::int64_t> number = database.Number("PRAGMA user_version");
  if (!number) return number.error();
  const Result<std::int64_t> application = database.Number("PRAGMA application_id");
  if (!application) return application.error();
  const Result<std::int64_t> tables = database.Number("SELECT count(*) FROM sqlite_master");
  if (!tables) return tables.error();
  const bool empty = *tables == 0 && *number == 0 && *application == 0;
  if (!empty && (*application != kApplicationId || *number < 1)) {
    return Error{ErrorCode::kCellStoreCorrupt, "the file is a database of another program", {}};
  }
  const auto newest = static_cast<std::int64_t>(migrations.size());
  if (*number > newest) {
    return Error{ErrorCode::kCellStoreNewer,
                 "the store has version " + std::to_string(*number) +
                     ", this program knows up to " + std::to_string(newest),
                 {}};
  }
  return static_cast<int>(*number);
}

Status Migrate(Database& database, std::span<const Migration> migrations, const std::string& path,
               WallTime now) {
  const Result<int> number = StoreNumber(database, migrations);
  if (!number) return number.error();
  const auto done = static_cast<std::size_t>(*number);
  if (done == migrations.size()) return {};
  if (done > 0) {
    if (const Status copied = database.CopyTo(path + ".version-" + std::to_string(done)); !copied)
      return copied.error();
  }
  TransactionStatements statements(database);
  for (std::size_t i = done; i < migrations.size(); ++i) {
    RMLCELL_CHECK(migrations[i].number == static_cast<int>(i) + 1);
    if (const Status applied = Apply(database, statements, migrations[i], now); !applied)
      return applied.error();
  }
  return {};
}

}  // namespace rmlcell::storage::sqlite
