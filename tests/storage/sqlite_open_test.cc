// Opening an embedded store: files and modes, one process only, newer, foreign and damaged files.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <random>
#include <sstream>

#include "storage/sqlite/store_files.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

using testing::HasSubstr;

Result<std::unique_ptr<Store>> OpenAt(const std::string& path) {
  return OpenSqliteStore({.path = path});
}

unsigned ModeOf(const std::string& path) {
  struct stat facts {};
  return stat(path.c_str(), &facts) == 0 ? facts.st_mode & 0777U : 0;
}

// A store with a little of everything, closed, as bytes of its one file.
std::string SmallStore() {
  SqliteBed bed;
  Must(bed.store().PutMachine({.id = "m", .parameters = {{"a", "b"}}}, 0));
  Must(bed.store().PutPrograms("m", {{.slot = 1, .object = Noise(5'000, 1)}}, {{.number = 1}}));
  for (int i = 0; i < 30; ++i) {
    Must(bed.store().SubmitAndWait({.kind = "CHECK",
                                    .title = std::string(300, 't'),
                                    .attachments = {{.name = "main", .bytes = Noise(3'000, 2)}},
                                    .events = {{.kind = "e", .payload = Noise(200, 3)}}}));
  }
  bed.Close();
  return ReadFile(bed.path());
}

// Everything can be asked of a store, whatever its file looks like; nothing crashes.
void AskForEverything(Store& store) {
  static_cast<void>(store.ListMachines());
  static_cast<void>(store.GetMachine("m"));
  static_cast<void>(store.ListPrograms("m", 0, 100));
  static_cast<void>(store.GetMachineMemory("m", [](const MachineRecord&) { return true; }));
  static_cast<void>(store.ListSchedules("m"));
  static_cast<void>(store.ListProjects("", 100));
  static_cast<void>(store.ListJobs({.limit = 100}));
  static_cast<void>(store.ListJobs({.finished = false}));
  static_cast<void>(store.AllEvents(0, 1000));
  for (std::int64_t job = 1; job <= 30; ++job) {
    static_cast<void>(store.GetJob(job));
    static_cast<void>(store.JobEvents(job, 0, 100));
    static_cast<void>(store.ListAttempts(job));
    static_cast<void>(store.ReadArtifact(job, "main"));
    static_cast<void>(store.OpenArtifact(job, "main"));
  }
  if (const auto leased = store.Acquire("w", {"CHECK"}, kLease, {}); leased && *leased) {
    static_cast<void>(store.Finish((*leased)->lease, {.artifacts = {{.name = "r", .bytes = "x"}}}));
  }
  static_cast<void>(store.PutMachine({.id = "n"}, kAnyRevision));
  static_cast<void>(store.PutPrograms("m", {{.slot = 1, .object = "x"}}, {}));
  static_cast<void>(store.SubmitAndWait({.kind = "CHECK"}));
}

// Brief of the store: directories are made with mode 0700, files with 0600.
TEST(SqliteOpen, FilesArePrivate) {
  const TestDirectory directory;
  const std::string path = directory.File("a/b/cell.db");
  const std::unique_ptr<Store> store = Must(OpenAt(path));
  Must(store->PutMachine({.id = "m"}, 0));
  EXPECT_EQ(ModeOf(directory.File("a")), 0700U);
  EXPECT_EQ(ModeOf(directory.File("a/b")), 0700U);
  for (const char* end : {"", "-wal", "-shm", ".lock"}) EXPECT_EQ(ModeOf(path + end), 0600U) << end;
}

TEST(SqliteOpen, ModeOfAnExistingFileIsSet) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenAt(path)).reset();
  ASSERT_EQ(chmod(path.c_str(), 0644), 0);
  Must(OpenAt(path)).reset();
  EXPECT_EQ(ModeOf(path), 0600U);
}

TEST(SqliteOpen, EmptyFileBecomesAStore) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  WriteFile(path, "");
  EXPECT_TRUE(OpenAt(path).has_value());
}

TEST(SqliteOpen, PathsThatCannotBeAreRefused) {
  const TestDirectory directory;
  WriteFile(directory.File("file"), "x");
  constexpr auto kRefused = ErrorCode::kCellStoreFailed;
  EXPECT_EQ(CodeOf(OpenAt("/proc/no/such/cell.db")), kRefused);
  EXPECT_EQ(CodeOf(OpenAt(directory.File("file/cell.db"))), kRefused);
  EXPECT_EQ(CodeOf(OpenAt(directory.File(""))), kRefused);  // the directory itself
  EXPECT_EQ(CodeOf(OpenAt("")), kRefused);
  const auto refused = OpenAt(directory.File("file/cell.db"));
  EXPECT_THAT(refused.error().detail, HasSubstr("cannot make directory " + directory.File("file")));
  EXPECT_THAT(OpenAt(directory.File("")).error().detail,
              HasSubstr("cannot open " + directory.File("")));
  ASSERT_EQ(mkdir(directory.File("held.db.lock").c_str(), 0700), 0);
  const auto unlocked = OpenAt(directory.File("held.db"));
  EXPECT_EQ(CodeOf(unlocked), kRefused);
  EXPECT_THAT(unlocked.error().detail, HasSubstr("cannot open lock file"));
  const std::string path = directory.File("cell.db");
  const auto unknown = OpenSqliteStore({.path = path, .vfs = "no such disk"});
  ASSERT_EQ(CodeOf(unknown), kRefused);
  EXPECT_THAT(unknown.error().detail, HasSubstr(path + ": "));
}

// Issue 2: a second store on the same file is refused, in this process and from another.
TEST(SqliteOpen, StoreInUseIsRefused) {
  SqliteBed bed;
  const auto second = bed.Open();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kCellStoreBusy);
  EXPECT_THAT(second.error().detail, HasSubstr(Numbered("process ", getpid())));
  Must(bed.store().PutMachine({.id = "m"}, 0));  // the first one goes on

  const pid_t child = fork();
  if (child == 0) {
    // Only what is safe after a fork: the parent has threads, but this one is alone now.
    execl(RMLCELL_CRASH_CHILD, RMLCELL_CRASH_CHILD, bed.path().c_str(), "run", "0", "1", nullptr);
    _exit(99);
  }
  int ended = 0;
  ASSERT_EQ(waitpid(child, &ended, 0), child);
  ASSERT_TRUE(WIFEXITED(ended));
  EXPECT_EQ(WEXITSTATUS(ended), 9);  // crash_child: the store could not be opened
}

// Who had no room to tell his number is "another process", and not the one that held it before.
TEST(SqliteOpen, AHolderWithoutANumberIsNotTheOneBefore) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db.lock");
  WriteFile(path, "1\n");
  struct rlimit limit {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  struct rlimit no_room = limit;
  no_room.rlim_cur = 0;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &no_room), 0);
  const Result<sqlite::StoreLock> held = sqlite::StoreLock::Take(path);
  EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  static_cast<void>(std::signal(SIGXFSZ, handler));
  ASSERT_TRUE(held);
  const Result<sqlite::StoreLock> second = sqlite::StoreLock::Take(path);
  ASSERT_EQ(CodeOf(second), ErrorCode::kCellStoreBusy);
  EXPECT_EQ(second.error().detail, path + " is held by another process");
}

TEST(SqliteOpen, LockIsFreeAfterTheStoreIsClosed) {
  SqliteBed bed;
  for (int i = 0; i < 5; ++i) bed.Reopen();
  bed.Close();
  EXPECT_TRUE(bed.Open().has_value());
}

// Issue 2: a store written by a newer version is refused with a clear message, and not touched.
TEST(SqliteOpen, NewerStoreIsRefused) {
  SqliteBed bed;
  bed.Close();
  ExecuteIn(bed.path(), "PRAGMA user_version = 16");
  const std::string before = ReadFile(bed.path());
  const auto refused = bed.Open();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellStoreNewer);
  EXPECT_THAT(refused.error().detail, HasSubstr("version 16"));
  EXPECT_THAT(refused.error().detail, HasSubstr(bed.path()));
  EXPECT_TRUE(ReadFile(bed.path()) == before);
  ExecuteIn(bed.path(), "PRAGMA user_version = 1");
}

TEST(SqliteOpen, ForeignFilesAreRefusedAndNotTouched) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  ExecuteIn(path, "CREATE TABLE other (x)");
  const std::string database = ReadFile(path);
  for (const std::string& foreign :
       {database,
        std::string("<html>not a database, but long enough to be read as one</html>") +
            std::string(2'000, ' '),
        std::string("xy"), Noise(10'000, 9), std::string(8'192, '\0')}) {
    WriteFile(path, foreign);
    const auto refused = OpenAt(path);
    ASSERT_FALSE(refused) << foreign.substr(0, 20);
    EXPECT_EQ(refused.error().code, ErrorCode::kCellStoreCorrupt) << refused.error().detail;
    EXPECT_TRUE(ReadFile(path) == foreign);
    EXPECT_FALSE(std::filesystem::exists(path + "-wal"));
  }
}

// A file that is cut anywhere: refused as damaged, or opened and served as far as it goes. Never a
// crash.
TEST(SqliteOpen, CutFilesDoNotCrash) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  const std::string whole = SmallStore();
  ASSERT_GT(whole.size(), 20'000U);
  int refused = 0;
  for (std::size_t size = 1; size < whole.size(); size += size < 200 ? 37 : 4'099) {
    WriteFile(path, whole.substr(0, size));
    const auto store = OpenAt(path);
    if (store) {
      AskForEverything(**store);
    } else {
      EXPECT_EQ(store.error().code, ErrorCode::kCellStoreCorrupt) << store.error().detail;
      ++refused;
    }
    for (const char* end : {"-wal", "-shm"}) std::filesystem::remove(path + end);
  }
  EXPECT_GT(refused, 0);
}

// Bytes that are turned anywhere: every question has an answer, good or an error. Never a crash.
TEST(SqliteOpen, DamagedFilesDoNotCrash) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  const std::string whole = SmallStore();
  std::mt19937 random(5);
  for (int round = 0; round < 150; ++round) {
    std::string damaged = whole;
    // One byte, or a whole stretch.
    const std::size_t at = random() % damaged.size();
    const std::size_t length =
        round % 3 == 0 ? 1 : std::min<std::size_t>(random() % 600, damaged.size() - at);
    for (std::size_t i = at; i < at + length; ++i) damaged[i] = static_cast<char>(random());
    WriteFile(path, damaged);
    if (const auto store = OpenAt(path)) AskForEverything(**store);
    for (const char* end : {"-wal", "-shm"}) std::filesystem::remove(path + end);
  }
}

// 9104: a record that cannot be read is told as such, and the rest is still served.
TEST(SqliteOpen, DamagedRecordsAreToldAndTheRestIsServed) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  Must(bed.store().PutMachine({.id = "m"}, 0));
  for (int slot = 1; slot <= 4; ++slot) {
    Must(bed.store().PutPrograms(
        "m", {{.slot = slot, .object = PlotText(static_cast<std::size_t>(slot) * 900'000)}}, {}));
  }
  for (int i = 0; i < 3; ++i) Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE job SET state = 77 WHERE id = 2");
  ExecuteIn(bed.path(),
            "UPDATE blob_chunk SET content = zeroblob(100) WHERE blob ="
            " (SELECT object_blob FROM program WHERE slot = 1)");
  ExecuteIn(bed.path(),
            "DELETE FROM blob_chunk WHERE number = 1 AND blob ="
            " (SELECT object_blob FROM program WHERE slot = 2)");
  ExecuteIn(bed.path(),
            "UPDATE blob SET size = size + 1 WHERE id ="
            " (SELECT object_blob FROM program WHERE slot = 3)");
  bed.Reopen();
  constexpr auto kCorrupt = ErrorCode::kCellStoreCorrupt;
  EXPECT_EQ(CodeOf(bed.store().GetJob(2)), kCorrupt);
  EXPECT_EQ(CodeOf(bed.store().GetJob(3)), std::nullopt);
  const auto undecoded = bed.store().GetProgram("m", 1);
  ASSERT_EQ(CodeOf(undecoded), kCorrupt);
  // The reason is that of the part, not that the whole is another one.
  EXPECT_THAT(undecoded.error().detail, testing::Not(HasSubstr("SHA-256")));
  EXPECT_EQ(CodeOf(bed.store().GetProgram("m", 2)), kCorrupt);
  EXPECT_EQ(CodeOf(bed.store().GetProgram("m", 3)), kCorrupt);
  EXPECT_TRUE(Must(bed.store().GetProgram("m", 4)).object == PlotText(3'600'000));
  EXPECT_EQ(CodeOf(bed.store().SubmitAndWait({.kind = "CHECK"})), std::nullopt);
}

// A page of the queue reads no more of those that are over than it shows, so that an old one that
// cannot be read does not spoil it.
TEST(SqliteOpen, DamageBehindAPageOfTheQueueDoesNotSpoilIt) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  for (int i = 0; i < 4; ++i) {
    Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
    Must(bed.store().RequestCancel(i + 1, {}));
  }
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE job SET state = 77 WHERE id = 1");
  bed.Reopen();
  const auto page = Must(bed.store().ListJobs({.order = JobOrder::kQueue, .limit = 2}));
  ASSERT_EQ(page.size(), 2U);
  EXPECT_EQ(page[0].id, 4);
  EXPECT_EQ(page[1].id, 3);
}

// A job that cannot be read does not keep the leases of others from running out.
TEST(SqliteOpen, DamagedJobDoesNotStopTheExpiryOfOthers) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  for (int i = 0; i < 3; ++i) {
    Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
    Must(bed.store().Acquire("w", {"CHECK"}, kLease, {}));
  }
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE job SET state = 77 WHERE id = 2");
  bed.Reopen();
  bed.clock().Advance(2 * kLease);
  const auto changed = Must(bed.store().Expire(PolicyOfTests()));
  ASSERT_EQ(changed.size(), 2U);
  EXPECT_EQ(changed[0].id, 1);
  EXPECT_EQ(changed[1].id, 3);
  EXPECT_EQ(CodeOf(bed.store().Expire(PolicyOfTests())), ErrorCode::kCellStoreCorrupt);
}

// Whoever leased a job through this file is gone when it is opened again, since one process at a
// time has it: the job does not wait for the end of its lease.
TEST(SqliteOpen, LeasesOfBeforeHaveRunOut) {
  SqliteBed bed;
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  const Lease held = Must(bed.store().Acquire("w", {"CHECK"}, kLease, {}))->lease;
  EXPECT_TRUE(Must(bed.store().Expire(PolicyOfTests())).empty());
  bed.Reopen();
  EXPECT_EQ(CodeOf(bed.store().Renew(held, kLease)), std::nullopt);  // until somebody takes it
  bed.Reopen();
  const auto expired = Must(bed.store().Expire(PolicyOfTests()));
  ASSERT_EQ(expired.size(), 1U);
  EXPECT_EQ(expired[0].state, JobState::kQueued);
  EXPECT_EQ(CodeOf(bed.store().Renew(held, kLease)), ErrorCode::kCellLeaseLost);
}

// A code that another version has invented must not hide the job that ended with it.
TEST(SqliteOpen, UnknownErrorCodeIsKeptAsText) {
  SqliteBed bed;
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  const auto leased = Must(bed.store().Acquire("w", {"CHECK"}, kLease, {}));
  Must(bed.store().Finish(leased->lease, {.outcome = {.state = JobState::kFailed,
                                                      .code = ErrorCode::kCellWorkerDied,
                                                      .detail = "why"}}));
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE job SET outcome_code = 'CELL-E9999'");
  bed.Reopen();
  const JobRecord job = Must(bed.store().GetJob(1));
  EXPECT_EQ(job.outcome->code, ErrorCode::kCellInternal);
  EXPECT_THAT(job.outcome->detail, HasSubstr("CELL-E9999"));
  EXPECT_THAT(job.outcome->detail, HasSubstr("why"));
}

TEST(SqliteOpen, WholeFileIsCheckedOnRequest) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  for (int i = 0; i < 50; ++i) {
    Must(bed.store().SubmitAndWait({.kind = "CHECK", .title = std::string(500, 'x')}));
  }
  bed.Close();
  const std::int64_t root =
      NumberIn(bed.path(), "SELECT rootpage FROM sqlite_master WHERE name = 'attempt'");
  std::string bytes = ReadFile(bed.path());
  const auto at = static_cast<std::size_t>(root - 1) * 4'096;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), 100, '\x55');
  WriteFile(bed.path(), bytes);
  bed.options().check_whole_file = true;
  EXPECT_EQ(CodeOf(bed.Open()), ErrorCode::kCellStoreCorrupt);
}

// What a killed process leaves: the log is read again, and nothing is missing.
TEST(SqliteOpen, LogOfAKilledProcessIsRead) {
  SqliteBed bed;
  const TestDirectory directory;
  Must(bed.store().PutMachine({.id = "m", .title = "in the log only"}, 0));
  // A copy of the files while the store is open is what a kill at this instant would leave.
  for (const char* end : {"", "-wal"}) {
    std::filesystem::copy_file(bed.path() + end, directory.File(std::string("cell.db") + end));
  }
  const std::unique_ptr<Store> store = Must(OpenAt(directory.File("cell.db")));
  EXPECT_EQ(Must(store->GetMachine("m")).title, "in the log only");
}

// sqlite_store.h log_bytes_prepared: the log is long, the store as small as ever, and what a kill
// leaves in the log behind the last commit, which was never committed, is no part of it.
TEST(SqliteOpen, PreparedLogHoldsNothing) {
  constexpr std::int64_t kBytes = 4 << 20;
  const TestDirectory directory;
  const TestDirectory copies;
  const std::string path = directory.File("cell.db");
  {
    const std::unique_ptr<Store> store =
        Must(OpenSqliteStore({.path = path, .log_bytes_prepared = kBytes}));
    EXPECT_GE(std::filesystem::file_size(path + "-wal"), kBytes - (1 << 20));
    Must(store->PutMachine({.id = "m", .title = "after it"}, 0));
    for (const char* end : {"", "-wal"}) {
      std::filesystem::copy_file(path + end, copies.File(std::string("cell.db") + end));
    }
  }
  EXPECT_LT(std::filesystem::file_size(path), 1U << 20);
  for (const std::string& file : {path, copies.File("cell.db")}) {
    const std::unique_ptr<Store> store =
        Must(OpenSqliteStore({.path = file, .check_whole_file = true}));
    EXPECT_EQ(Must(store->GetMachine("m")).title, "after it");
  }
}

// A log that was damaged after a crash ends where the damage begins; what was before is there.
TEST(SqliteOpen, DamagedLogIsReadUpToTheDamage) {
  SqliteBed bed;
  const TestDirectory directory;
  const std::string copy = directory.File("cell.db");
  Must(bed.store().PutMachine({.id = "first"}, 0));
  const auto size = std::filesystem::file_size(bed.path() + "-wal");
  Must(bed.store().PutMachine({.id = "second"}, 0));
  std::string log = ReadFile(bed.path() + "-wal");
  log[size + 100] = static_cast<char>(log[size + 100] ^ 0x40);
  std::filesystem::copy_file(bed.path(), copy);
  WriteFile(copy + "-wal", log);
  const std::unique_ptr<Store> store = Must(OpenAt(copy));
  EXPECT_EQ(CodeOf(store->GetMachine("first")), std::nullopt);
  EXPECT_EQ(CodeOf(store->GetMachine("second")), ErrorCode::kCellUnknownMachine);
}

}  // namespace
}  // namespace rmlcell::storage
