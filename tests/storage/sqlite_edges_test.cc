// What the embedded store does at the edges of its housekeeping, its files and its hints.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <future>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "storage/sqlite/housekeeping.h"
#include "storage/sqlite/reader_pool.h"
#include "storage/sqlite/statement.h"
#include "storage/sqlite/transaction.h"
#include "storage/sqlite/watchers.h"
#include "storage/sqlite/writer.h"
#include "tests/storage/quiet_process.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage::sqlite {
namespace {

using std::chrono::hours;

std::int64_t FenceMarkIn(const std::string& path) {
  return NumberIn(path, "SELECT ifnull(sum(value), 0) FROM mark WHERE name = 'fence'");
}

// Fences are reserved by the first lease, a thousand at once, and by no other write.
TEST(SqliteEdges, FencesAreReservedWhenOneIsGiven) {
  SqliteBed bed;
  Must(bed.store().PutMachine({.id = "m"}, 0));
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  EXPECT_EQ(FenceMarkIn(bed.path()), 0);
  ASSERT_TRUE(Must(bed.store().Acquire("w", {"CHECK"}, hours(1), {})));
  const std::int64_t mark = FenceMarkIn(bed.path());
  EXPECT_GE(mark, 1'000);
  ASSERT_TRUE(Must(bed.store().Acquire("w", {"CHECK"}, hours(1), {})));
  Must(bed.store().PutMachine({.id = "other"}, 0));
  EXPECT_EQ(FenceMarkIn(bed.path()), mark);
}

// One slice takes 256 uploads whose time is over, and says that there may be more; each has one
// reference less, here of two.
TEST(SqliteEdges, UploadsAreForgottenASliceAtATime) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Connection connection(Must(Database::Open(path, Database::Access::kReadWrite, {})));
  Must(connection.database.Execute(
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 258)"
      " INSERT INTO blob (id, sha256, size, refs, holds, content)"
      " SELECT i, CAST(i AS BLOB), 1, 2, 0, x'00' FROM n"));
  Must(connection.database.Execute("INSERT INTO upload (blob, until) SELECT id, id FROM blob"));
  const auto left = [&] { return Must(connection.database.Number("SELECT count(*) FROM upload")); };
  Counters counters;
  const ProgramMemoryOf no_limit;
  const MachineTally no_machines{{}};
  const auto slice = [&](std::int64_t now_us) {
    WriteContext context{.tables = connection.tables,
                         .counters = counters,
                         .program_memory = no_limit,
                         .machines = no_machines,
                         .now = WallTime(std::chrono::microseconds(now_us))};
    return Must(Housekeeping({}).RunSlice(context));
  };
  EXPECT_FALSE(slice(0));
  EXPECT_EQ(left(), 258);
  EXPECT_TRUE(slice(1'000));
  EXPECT_EQ(left(), 2);
  EXPECT_EQ(Must(connection.database.Number("SELECT count(*) FROM blob WHERE refs = 2")), 2);
  EXPECT_FALSE(slice(1'000));
  EXPECT_EQ(left(), 0);
  EXPECT_EQ(Must(connection.database.Number("SELECT count(*) FROM blob WHERE refs = 1")), 258);
}

// A service has no standard input: the first file that it opens then has the number 0.
TEST(SqliteEdges, ACopyIsMadeWithoutAStandardInput) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  const Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  const int kept = dup(STDIN_FILENO);
  close(STDIN_FILENO);
  const Status copied = database.CopyTo(directory.File("copy.db"));
  if (kept >= 0) {
    dup2(kept, STDIN_FILENO);
    close(kept);
  }
  EXPECT_TRUE(copied);
  EXPECT_EQ(NumberIn(directory.File("copy.db"), "SELECT count(*) FROM log_part"), 1);
}

std::ptrdiff_t OpenFiles() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

// Neither of stores that come and go nor of their copies.
TEST(SqliteEdges, NoFileStaysOpen) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  const auto use = [&] {
    Must(OpenSqliteStore({.path = path})).reset();
    const Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
    Must(database.CopyTo(directory.File("copy.db")));
  };
  use();  // what is opened once for all
  const std::ptrdiff_t before = OpenFiles();
  for (int i = 0; i < 3; ++i) use();
  EXPECT_EQ(OpenFiles(), before);
}

// The system takes longer names than SQLite does: an empty file that it made is no copy.
TEST(SqliteEdges, ACopyThatCannotBeOpenedIsAnError) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  const Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  const std::string part(200, 'd');
  const std::string folder = directory.File(part + "/" + part + "/" + part + "/" + part);
  std::filesystem::create_directories(folder);
  EXPECT_EQ(CodeOf(database.CopyTo(folder + "/copy.db")), ErrorCode::kCellStoreFailed);
}

// Whatever others may do with the file, even to execute it only, is taken from them.
TEST(SqliteEdges, NobodyElseMayDoAnythingWithTheFile) {
  for (const mode_t mode : {mode_t{0601}, mode_t{0610}, mode_t{0640}, mode_t{0604}}) {
    SqliteBed bed;
    bed.Close();
    ASSERT_EQ(chmod(bed.path().c_str(), mode), 0);
    bed.Reopen();
    struct stat facts {};
    ASSERT_EQ(stat(bed.path().c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 0777, mode_t{0600}) << mode;
  }
}

// An order is a hint, too: the server that has the job looks at its orders.
TEST(SqliteEdges, AnOrderIsTold) {
  SqliteBed bed;
  const std::int64_t job = Must(bed.store().SubmitAndWait({.kind = "CHECK"})).job.id;
  Must(bed.store().AcquireJobs(
      {.worker = "w", .server = "a", .kinds = {"CHECK"}, .duration = hours(1)}));
  bed.Reopen();  // hints of what was before are told by now
  std::atomic<int> told{0};
  const auto watch = bed.store().Watch([&] { ++told; });
  ASSERT_FALSE(bed.store().PutOrder(job, "a", "refused"));
  EXPECT_EQ(told, 0);
  ASSERT_TRUE(bed.store().PutOrder(job, "b", "stop"));
  EXPECT_TRUE(Eventually([&] { return told > 0; }));
}

// A job whose time has come is told of.
TEST(SqliteEdges, AJobThatIsDueIsTold) {
  SqliteBed bed;
  Must(bed.store().SubmitAndWait({.kind = "CHECK", .not_before = bed.clock().Now() + hours(1)}));
  bed.clock().Advance(hours(2));
  bed.Reopen();
  std::atomic<int> told{0};
  const auto watch = bed.store().Watch([&] { ++told; });
  Must(bed.store().Expire(PolicyOfTests()));
  EXPECT_TRUE(Eventually([&] { return told > 0; }));
}

// What goes because there is too much of it goes behind the write that made it too much.
TEST(SqliteEdges, WhatTidyingRemovesIsTold) {
  SqliteOptions options;
  options.keep_finished_jobs = 1;
  SqliteBed bed(options);
  const auto end_one = [&] {
    const std::int64_t job = Must(bed.store().SubmitAndWait({.kind = "CHECK"})).job.id;
    bed.clock().Advance(std::chrono::seconds(1));
    Must(bed.store().RequestCancel(job, {}));
    return job;
  };
  const std::int64_t old = end_one();
  std::atomic<bool> told_that_it_is_gone{false};
  const auto watch = bed.store().Watch([&] {
    if (CodeOf(bed.store().GetJob(old)) == ErrorCode::kCellNotFound) told_that_it_is_gone = true;
  });
  end_one();
  EXPECT_TRUE(Eventually([&] { return told_that_it_is_gone.load(); }));
}

// sqlite_store.h busy_timeout: a lock that is held for a moment is waited for.
TEST(SqliteEdges, WhoHoldsTheFileForAMomentIsWaitedFor) {
  SqliteOptions options;
  options.busy_timeout = std::chrono::minutes(1);
  SqliteBed bed(options);
  EXPECT_TRUE(ComesToRest());  // the store itself does not hold it
  Database other = Must(Database::Open(bed.path(), Database::Access::kReadWrite, {}));
  Must(other.Execute("BEGIN IMMEDIATE"));
  const std::jthread holder([&] {
    EXPECT_TRUE(ComesToRest());  // the lock was met
    EXPECT_EQ(CodeOf(other.Execute("ROLLBACK")), std::nullopt);
  });
  EXPECT_EQ(CodeOf(bed.store().PutMachine({.id = "m"}, 0)), std::nullopt);
}

// Who ends his subscription while another one is told hears nothing more.
TEST(SqliteEdges, AWatcherThatLeftMeanwhileIsNotCalled) {
  Watchers watchers;
  std::promise<void> entered;
  std::promise<void> left;
  std::atomic<int> calls{0};
  std::atomic<int> rounds{0};
  const auto first = watchers.Add([&] {
    if (rounds++ > 0) return;
    entered.set_value();
    left.get_future().wait();
  });
  auto second = watchers.Add([&] { ++calls; });
  watchers.Notify();
  entered.get_future().wait();
  second.reset();
  left.set_value();
  watchers.Notify();
  EXPECT_TRUE(Eventually([&] { return rounds > 1; }));
  EXPECT_EQ(calls, 0);
}

// Who ends his subscription while it is called comes back when that call has ended, and not before.
TEST(SqliteEdges, WhoLeavesWaitsForTheCallThatIsUnderWay) {
  std::promise<void> entered;
  std::promise<void> left;
  std::promise<bool> overtaken;
  const std::future<void> has_left = left.get_future();
  Watchers watchers;
  auto watch = watchers.Add([&] {
    entered.set_value();
    EXPECT_TRUE(ComesToRest());  // whoever leaves waits, or has left
    overtaken.set_value(has_left.wait_for(std::chrono::seconds(0)) == std::future_status::ready);
  });
  watchers.Notify();
  entered.get_future().wait();
  watch.reset();
  left.set_value();
  EXPECT_FALSE(overtaken.get_future().get());
}

// What its function holds goes with a subscription, also one that is ended inside the call.
TEST(SqliteEdges, WhatAWatcherHeldGoesWithIt) {
  Watchers watchers;
  auto held = std::make_shared<int>(7);
  const std::weak_ptr<int> seen = held;
  std::promise<void> told;
  std::unique_ptr<Store::Subscription> watch;
  watch = watchers.Add([&watch, &told, held] {
    watch.reset();
    told.set_value();
  });
  held.reset();
  watchers.Notify();
  told.get_future().wait();
  EXPECT_TRUE(Eventually([&] { return seen.expired(); }));
}

// A page of nothing has nothing.
TEST(SqliteEdges, ALimitOfNothingIsNothing) {
  SqliteBed bed;
  Store& store = bed.store();
  Must(store.PutMachine({.id = "m"}, 0));
  Must(store.PutPrograms("m", {{.slot = 1, .object = "o"}}, {}));
  Must(store.PutProject({.id = "p"}, 0));
  Must(store.AddTeachRecord({.machine = "m", .program = 1, .entry = "e"}));
  const std::int64_t job =
      Must(store.SubmitAndWait({.kind = "CHECK", .events = {{.kind = "state"}}})).job.id;
  for (const int limit : {0, -1, -99}) {
    EXPECT_TRUE(Must(store.AllEvents(0, limit)).empty()) << limit;
    EXPECT_TRUE(Must(store.JobEvents(job, 0, limit)).empty()) << limit;
    EXPECT_TRUE(Must(store.ListPrograms("m", 0, limit)).empty()) << limit;
    EXPECT_TRUE(Must(store.ListProjects("", limit)).empty()) << limit;
    EXPECT_TRUE(Must(store.ListTeachRecords("m", 1, 99, limit)).empty()) << limit;
    EXPECT_TRUE(Must(store.ListJobs({.limit = limit})).empty()) << limit;
  }
  EXPECT_EQ(Must(store.AllEvents(0, 1)).size(), 1u);
  EXPECT_EQ(Must(store.JobEvents(job, 0, 1)).size(), 1u);
  EXPECT_EQ(Must(store.ListPrograms("m", 0, 1)).size(), 1u);
  EXPECT_EQ(Must(store.ListProjects("", 1)).size(), 1u);
  EXPECT_EQ(Must(store.ListTeachRecords("m", 1, 99, 1)).size(), 1u);
  EXPECT_EQ(Must(store.ListJobs({.limit = 1})).size(), 1u);
}

// The log grows until it is written back, which is ours to do: SQLite says how long it is, and does
// it not by itself, which it would from 1000 pages on.
TEST(SqliteEdges, TheLengthOfTheLogIsKnown) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  ASSERT_TRUE(database.Execute("CREATE TABLE filling (bytes BLOB)"));
  for (int k = 0; k < 3; ++k) {
    const int before = database.log_pages();
    ASSERT_TRUE(database.Execute("INSERT INTO filling VALUES (zeroblob(4096 * 1000))"));
    EXPECT_GE(database.log_pages(), before + 1000);
  }
}

// A write that nobody commits has never been, and leaves room for the next one; of a part of one
// the same holds within it.
TEST(SqliteEdges, WhatIsNotCommittedIsUndone) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  Must(database.Execute("CREATE TABLE filling (name TEXT)"));
  TransactionStatements statements(database);
  const auto add = [&] { Must(database.Execute("INSERT INTO filling VALUES ('one')")); };
  const auto rows = [&] { return Must(database.Number("SELECT count(*) FROM filling")); };
  for (int time = 0; time < 2; ++time) {
    const Transaction lost = Must(Transaction::Begin(statements, Transaction::Kind::kWrite));
    add();
    EXPECT_EQ(rows(), 1);
    EXPECT_TRUE(lost.alive());
  }
  EXPECT_FALSE(database.in_transaction());
  EXPECT_EQ(rows(), 0);
  Transaction kept = Must(Transaction::Begin(statements, Transaction::Kind::kWrite));
  {
    const Savepoint lost = Must(Savepoint::Begin(statements));
    add();
  }
  EXPECT_EQ(rows(), 0);
  Savepoint part = Must(Savepoint::Begin(statements));
  add();
  Must(part.Keep());
  Must(kept.Commit());
  EXPECT_FALSE(database.in_transaction());
  EXPECT_EQ(rows(), 1);
}

// SQLite leaves a transaction open that cannot be committed: the next write would find it.
TEST(SqliteEdges, ACommitThatIsRefusedIsUndone) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  Must(database.Execute(
      "PRAGMA foreign_keys = ON; CREATE TABLE parent (id INTEGER PRIMARY KEY);"
      "CREATE TABLE child (id INTEGER REFERENCES parent (id) DEFERRABLE INITIALLY DEFERRED)"));
  TransactionStatements statements(database);
  Transaction refused = Must(Transaction::Begin(statements, Transaction::Kind::kWrite));
  Must(database.Execute("INSERT INTO child VALUES (7)"));
  EXPECT_EQ(CodeOf(refused.Commit()), ErrorCode::kCellStoreFailed);
  EXPECT_FALSE(database.in_transaction());
  EXPECT_EQ(Must(database.Number("SELECT count(*) FROM child")), 0);
}

// What could not begin is an error, and has nothing to undo: neither within a transaction nor, for
// a part of one, while a write is read.
TEST(SqliteEdges, WhatCannotBeginIsAnError) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  Must(database.Execute("CREATE TABLE filling (name TEXT)"));
  TransactionStatements statements(database);
  Transaction first = Must(Transaction::Begin(statements, Transaction::Kind::kWrite));
  EXPECT_NE(CodeOf(Transaction::Begin(statements, Transaction::Kind::kWrite)), std::nullopt);
  EXPECT_TRUE(database.in_transaction());
  Statement add(database, "INSERT INTO filling VALUES ('one') RETURNING name");
  {
    Query query = add.With();
    ASSERT_TRUE(Must(query.Step()));
    EXPECT_NE(CodeOf(Savepoint::Begin(statements)), std::nullopt);
  }
  Must(first.Commit());
  EXPECT_EQ(Must(database.Number("SELECT count(*) FROM filling")), 1);
}

// Also the opening of a connection looks at the file, and says when another one keeps it.
TEST(SqliteEdges, AFileThatIsKeptFromAllIsNotOpened) {
  const TestDirectory directory;
  const std::string path = directory.File("x.db");
  ExecuteIn(path, "CREATE TABLE something (it)");
  Database other = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  Must(other.Execute("BEGIN EXCLUSIVE"));
  const ConnectionOptions soon{.vfs = {}, .busy_timeout = std::chrono::milliseconds(10)};
  EXPECT_EQ(CodeOf(Database::Open(path, Database::Access::kReadWrite, soon)),
            ErrorCode::kCellStoreBusy);
  Must(other.Execute("ROLLBACK"));
  EXPECT_FALSE(CodeOf(Database::Open(path, Database::Access::kReadWrite, soon)));
}

// What the system said of one failure is no reason of the next one.
TEST(SqliteEdges, TheSystemIsNamedForItsOwnFailuresOnly) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  const Status unopened = database.Execute("ATTACH '/proc/no/such/file' AS other");
  ASSERT_FALSE(unopened);
  EXPECT_NE(unopened.error().detail.find("(SQLite 14): "), std::string::npos)
      << unopened.error().detail;
  const Status refused = database.Execute(
      "CREATE TABLE filling (id INTEGER PRIMARY KEY); INSERT INTO filling VALUES (1), (1)");
  ASSERT_FALSE(refused);
  EXPECT_TRUE(refused.error().detail.ends_with(")")) << refused.error().detail;
}

// A statement is executed once at a time: another query of it would take the row from the first.
TEST(SqliteEdges, AStatementHasOneQuery) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  Statement statement(database, "SELECT 1");
  {
    Query query = statement.With();
    EXPECT_TRUE(Must(query.Step()));
    EXPECT_DEATH((void)statement.With(), "check failed");
  }
  Statement of_two(database, "SELECT ?1, ?2");
  EXPECT_DEATH((void)of_two.With(1), "check failed");  // each parameter has its value
  Query again = statement.With();
  EXPECT_TRUE(Must(again.Step()));
}

// What one execution could not bind, or could not be prepared for, is no failure of the next one.
TEST(SqliteEdges, AFailureIsOfItsExecutionAlone) {
  const TestDirectory directory;
  const std::string path = directory.File("x.db");
  ExecuteIn(path, "CREATE TABLE t (a INTEGER PRIMARY KEY, b BLOB NOT NULL)");
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  sqlite3_limit(database.handle(), SQLITE_LIMIT_LENGTH, 1'000);
  const std::string large(2'000, 'x');
  Statement insert(database, "INSERT INTO t (a, b) VALUES (?1, ?2)");
  EXPECT_EQ(CodeOf(insert.With(1, large).Run()), ErrorCode::kCellTooLarge);
  EXPECT_EQ(CodeOf(insert.With(1, "small").Run()), std::nullopt);
  EXPECT_EQ(Must(database.Number("SELECT count(*) FROM t")), 1);
  Statement later(database, "SELECT c FROM u");
  EXPECT_EQ(CodeOf(later.With().Run()), ErrorCode::kCellStoreFailed);
  Must(database.Execute("CREATE TABLE u (c)"));
  EXPECT_EQ(CodeOf(later.With().Run()), std::nullopt);
}

// database.h Checkpoint: a reader keeps what it sees in the log, and whoever moves the log already
// does so alone: neither is an error, and all was moved only when nothing is left.
TEST(SqliteEdges, ACheckpointSaysWhetherAllWasMoved) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  Must(database.Execute("CREATE TABLE filling (bytes BLOB)"));
  Database reader = Must(Database::Open(path, Database::Access::kReadOnly, {}));
  Must(reader.Execute("BEGIN; SELECT count(*) FROM filling"));
  Must(database.Execute("INSERT INTO filling VALUES (zeroblob(40000))"));
  EXPECT_FALSE(Must(database.Checkpoint()));

  // Another one moves it, waits for the reader, and gives up.
  struct Meanwhile {
    Database& database;
    int calls = 0;
    std::optional<bool> all_moved{};
  };
  Meanwhile meanwhile{.database = database};
  Database other = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  EXPECT_EQ(Must(other.Number("SELECT count(*) FROM filling")), 1);
  sqlite3_busy_handler(
      other.handle(),
      [](void* state, int) {
        Meanwhile& now = *static_cast<Meanwhile*>(state);
        ++now.calls;
        if (const Result<bool> moved = now.database.Checkpoint(); moved) now.all_moved = *moved;
        return 0;
      },
      &meanwhile);
  EXPECT_EQ(
      sqlite3_wal_checkpoint_v2(other.handle(), nullptr, SQLITE_CHECKPOINT_FULL, nullptr, nullptr),
      SQLITE_BUSY);
  EXPECT_GT(meanwhile.calls, 0);
  EXPECT_EQ(meanwhile.all_moved, std::optional(false));

  Must(reader.Execute("ROLLBACK"));
  EXPECT_TRUE(Must(database.Checkpoint()));
}

// reader_pool.h: who reads waits while all connections are in use; there is one at least.
TEST(SqliteEdges, OneReaderIsOneAtATime) {
  for (const int asked : {0, 1}) {
    SqliteBed bed;
    ReaderPool pool(bed.path(), {}, asked);
    std::atomic<bool> second_reads{false};
    std::jthread second;
    const Result<int> first = pool.Read([&](Tables&) -> Result<int> {
      second = std::jthread([&] {
        const Result<int> after = pool.Read([&](Tables&) -> Result<int> {
          second_reads = true;
          return 0;
        });
        EXPECT_TRUE(after);
      });
      EXPECT_TRUE(ComesToRest());
      EXPECT_FALSE(second_reads) << asked;
      return 0;
    });
    EXPECT_TRUE(first);
    second.join();
    EXPECT_TRUE(second_reads) << asked;
  }
}

// A transaction that is over undoes nothing when it goes, also not the one that has begun since.
TEST(SqliteEdges, ACommittedTransactionUndoesNothing) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  Database database = Must(Database::Open(path, Database::Access::kReadWrite, {}));
  Must(database.Execute("CREATE TABLE filling (name TEXT)"));
  TransactionStatements statements(database);
  const auto add = [&] { Must(database.Execute("INSERT INTO filling VALUES ('one')")); };
  std::optional<Transaction> first(Must(Transaction::Begin(statements, Transaction::Kind::kWrite)));
  add();
  Must(first->Commit());
  Transaction second = Must(Transaction::Begin(statements, Transaction::Kind::kWrite));
  add();
  first.reset();
  EXPECT_TRUE(database.in_transaction());
  Must(second.Commit());
  EXPECT_EQ(Must(database.Number("SELECT count(*) FROM filling")), 2);
}

}  // namespace
}  // namespace rmlcell::storage::sqlite
