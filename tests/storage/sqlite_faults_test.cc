// A disk that is full or fails: writes end with CellStoreFailed, what was acknowledged stays, reads
// go on, and so do writes as soon as the cause is gone.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <cerrno>
#include <functional>
#include <future>
#include <thread>

#include "storage/sqlite/database.h"
#include "tests/storage/faulty_disk.h"
#include "tests/storage/quiet_process.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

constexpr auto kFailed = ErrorCode::kCellStoreFailed;

SqliteOptions OnFaultyDisk() {
  faulty_disk::Register();
  faulty_disk::Heal();
  SqliteOptions options;
  options.vfs = faulty_disk::kName;
  return options;
}

class SqliteFaults : public testing::Test {
 protected:
  ~SqliteFaults() override { faulty_disk::Heal(); }
  Store& store() { return bed_.store(); }
  Result<SubmittedJob> Submit(const std::string& request_id) {
    return store().SubmitAndWait({.request_id = request_id, .kind = "SIMULATE"});
  }
  std::size_t JobCount() { return Must(store().ListJobs({.limit = 10'000})).size(); }

  SqliteBed bed_{OnFaultyDisk()};
};

TEST_F(SqliteFaults, FullDiskFailsWritesUntilThereIsRoom) {
  Must(Submit("before"));
  faulty_disk::Fail({.on_write = SQLITE_FULL});
  EXPECT_EQ(CodeOf(Submit("full")), kFailed);
  EXPECT_EQ(CodeOf(store().PutMachine({.id = "m"}, 0)), kFailed);
  EXPECT_EQ(JobCount(), 1U);  // reads go on
  EXPECT_EQ(Must(store().CountJobs()).queued, 1);
  faulty_disk::Heal();
  EXPECT_EQ(Must(Submit("full")).job.id, 2);
  Must(store().PutMachine({.id = "m"}, 0));
  bed_.Reopen();
  EXPECT_EQ(JobCount(), 2U);
}

// Of several writes in a commit each is tried for itself; one alone has had its try.
TEST_F(SqliteFaults, AFailedWriteAloneIsTriedOnce) {
  faulty_disk::Fail({.on_write = SQLITE_FULL});
  EXPECT_EQ(CodeOf(Submit("full")), kFailed);
  EXPECT_EQ(faulty_disk::Operations(), 1);
}

TEST_F(SqliteFaults, FailedSyncIsNotAcknowledged) {
  faulty_disk::Fail({.on_sync = SQLITE_IOERR_FSYNC});
  const auto failed = Submit("r");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, kFailed);
  EXPECT_EQ(JobCount(), 0U);
  faulty_disk::Heal();
  EXPECT_FALSE(Must(Submit("r")).already_there);
  EXPECT_EQ(JobCount(), 1U);
}

// Every single operation of a script fails once, at every operation of the disk that it makes;
// after each failure the store is as before or as after that step, and goes on.
TEST_F(SqliteFaults, EveryStepSurvivesAFailureAtEveryOperation) {
  const std::string body = Noise(1'300'000, 1);
  for (const int code : {SQLITE_FULL, SQLITE_IOERR_WRITE}) {
    int failures = 0;
    for (std::int64_t after = 0;; ++after) {
      SCOPED_TRACE(after);
      const std::string name = Numbered(Numbered("", code) + ".", after);
      bool failed = false;
      faulty_disk::Fail({.on_write = code, .on_sync = code, .after = after});
      // Tries until it works; the disk heals after the first failure.
      const auto insist = [&](const std::function<Status()>& step) {
        Status status = step();
        if (!status) {
          EXPECT_EQ(status.error().code, kFailed) << status.error().detail;
          failed = true;
          faulty_disk::Heal();
          status = step();
        }
        Must(status);
      };
      const auto status_of = [](const auto& result) {
        return result ? Status() : Status(result.error());
      };
      std::int64_t id = 0;
      insist([&] {
        const auto submitted = Submit(name);
        if (submitted) id = submitted->job.id;
        return status_of(submitted);
      });
      std::optional<LeasedJob> leased;
      insist([&] {
        const auto acquired = store().Acquire("w", {"SIMULATE"}, kLease, {{.kind = "running"}});
        if (acquired) leased = *acquired;
        return status_of(acquired);
      });
      ASSERT_TRUE(leased);
      EXPECT_EQ(leased->job.id, id);
      insist([&] { return status_of(store().AppendAndWait(leased->lease, {{.kind = "e"}})); });
      insist(
          [&] { return status_of(store().PutProject({.id = "p", .body = body}, kAnyRevision)); });
      insist([&] {
        return status_of(
            store().Finish(leased->lease, {.artifacts = {{.name = "r", .bytes = name}}}));
      });
      insist([&] { return store().DeleteProject("p", kAnyRevision); });
      const JobRecord job = Must(store().GetJob(id));
      EXPECT_EQ(job.state, JobState::kSucceeded);
      EXPECT_EQ(job.last_sequence, 2);
      if (!failed) break;  // so many operations go well: none is left to fail
      ++failures;
      if (testing::Test::HasFailure()) return;
    }
    EXPECT_GT(failures, 20);
    faulty_disk::Heal();
  }
}

// One write that does not fit must not take those down that share its commit.
class SqliteFullLog : public SqliteFaults, public testing::WithParamInterface<int> {};

TEST_P(SqliteFullLog, OthersInTheSameCommitAreNotTakenDown) {
  Must(store().PutMachine({.id = "m"}, 0));
  Must(store().SubmitAndWait({.kind = "SIMULATE"}));
  const Lease lease = Must(store().Acquire("w", {"SIMULATE"}, kLease, {}))->lease;
  // The disk has room for some pages: small events fit, the large one does not.
  std::atomic<int> good = 0;
  std::atomic<int> bad = 0;
  std::atomic<int> answered = 0;
  std::promise<void> blocked;
  std::promise<void> release;
  const std::jthread holder([&] {
    store().Append(lease, {{.kind = "first"}}, [&](const Result<std::int64_t>&) {
      blocked.set_value();
      release.get_future().wait();  // holds the writer until all the others wait
    });
  });
  blocked.get_future().wait();
  const int small = GetParam();
  const auto answer = [&](const Result<std::int64_t>& last) {
    ++(last ? good : bad);
    ++answered;
  };
  for (int i = 0; i < small; ++i) store().Append(lease, {{.kind = "small"}}, answer);
  store().Append(lease, {{.kind = "large", .payload = Noise(1'000'000, 1)}}, answer);
  faulty_disk::OnlyFilesEndingWith("-wal");
  const auto log = static_cast<std::int64_t>(std::filesystem::file_size(bed_.path() + "-wal"));
  faulty_disk::Fail({.on_write = SQLITE_FULL, .beyond = log + 200'000});
  release.set_value();
  ASSERT_TRUE(Eventually([&] { return answered >= small + 1; }));
  EXPECT_EQ(good, small);
  EXPECT_EQ(bad, 1);
  faulty_disk::Heal();
  EXPECT_EQ(Must(store().GetJob(lease.job)).last_sequence, small + 1);
}

INSTANTIATE_TEST_SUITE_P(Small, SqliteFullLog, testing::Values(1, 5));

// The log cannot be moved into the database: nothing is lost, it is tried again later.
TEST_F(SqliteFaults, FailedCheckpointLosesNothing) {
  Must(store().PutMachine({.id = "m"}, 0));
  faulty_disk::OnlyFilesEndingWith("cell.db");
  faulty_disk::Fail({.on_write = SQLITE_IOERR_WRITE, .on_sync = SQLITE_IOERR_FSYNC});
  const std::string object = Noise(24 << 20, 1);  // more than the log is let grow to
  Must(store().PutPrograms("m", {{.slot = 1, .object = object}}, {}));
  for (int i = 0; i < 10; ++i) Must(store().SubmitAndWait({.kind = "SIMULATE"}));
  faulty_disk::Heal();
  bed_.Reopen();
  EXPECT_TRUE(Must(store().GetProgram("m", 1)).object == object);
  EXPECT_EQ(JobCount(), 10U);
}

// A log that a reader keeps from its end is moved again when it has grown as much once more, and
// not with each write until then.
TEST_F(SqliteFaults, ALogThatAReaderKeepsIsNotMovedWithEachWrite) {
  Must(store().PutMachine({.id = "m"}, 0));
  sqlite::Database reader =
      Must(sqlite::Database::Open(bed_.path(), sqlite::Database::Access::kReadOnly, {}));
  const std::string look = "BEGIN; SELECT count(*) FROM job";
  Must(reader.Execute(look));
  Must(store().PutPrograms("m", {{.slot = 1, .object = Noise(20 << 20, 1)}}, {}));
  EXPECT_TRUE(ComesToRest());
  // From here on it sees all of the log, so that all of it could be moved.
  Must(reader.Execute("COMMIT; " + look));
  const auto size = std::filesystem::file_size(bed_.path());
  EXPECT_LT(size, std::uintmax_t{4} << 20);
  for (int i = 0; i < 3; ++i) Must(store().PutMachine({.id = Numbered("m", i)}, 0));
  EXPECT_TRUE(ComesToRest());
  EXPECT_EQ(std::filesystem::file_size(bed_.path()), size);
  Must(reader.Execute("COMMIT"));
}

// Watchers and counts tell nothing of what was not committed.
TEST_F(SqliteFaults, NothingIsToldOfAFailedCommit) {
  std::atomic<int> hints = 0;
  const auto watch = store().Watch([&] { ++hints; });
  faulty_disk::Fail({.on_sync = SQLITE_IOERR_FSYNC});
  // Hints that come at the same time are told together; of so many at least one would be told
  // alone.
  for (int i = 0; i < 50; ++i) EXPECT_EQ(CodeOf(Submit(Numbered("r", i))), kFailed);
  EXPECT_EQ(Must(store().CountJobs()).queued, 0);
  EXPECT_FALSE(Must(store().Acquire("w", {"SIMULATE"}, kLease, {})));
  faulty_disk::Heal();
  Must(Submit("good"));
  ASSERT_TRUE(Eventually([&] { return hints > 0; }));
  EXPECT_EQ(hints, 1);
  EXPECT_EQ(Must(store().CountJobs()).queued, 1);
}

// store.h AwaitJobs: what was given by a commit that failed was not given; the request stands.
TEST_F(SqliteFaults, AJobGivenByAFailedCommitIsGivenByTheNext) {
  std::vector<Result<std::vector<LeasedJob>>> answers;
  store().AwaitJobs({.worker = "w", .kinds = {"SIMULATE"}, .duration = std::chrono::seconds(10)},
                    [&](auto leased) { answers.push_back(std::move(leased)); });
  for (const auto& failure :
       {faulty_disk::Failure{.on_sync = SQLITE_IOERR_FSYNC}, {.on_write = SQLITE_FULL}}) {
    faulty_disk::Fail(failure);
    EXPECT_EQ(CodeOf(Submit("r")), kFailed);
    faulty_disk::Heal();
    EXPECT_EQ(answers.size(), 0U);
    EXPECT_EQ(JobCount(), 0U);
  }
  const std::int64_t job = Must(Submit("r")).job.id;
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(Must(answers[0]).at(0).lease.job, job);
  EXPECT_EQ(Must(store().GetJob(job)).state, JobState::kRunning);
  EXPECT_EQ(Must(store().CountJobs()).running, 1);
}

// The same of the commit that it brought itself: what it was given there it was not given.
TEST_F(SqliteFaults, ARequestWhoseOwnCommitFailsStands) {
  const std::int64_t job = Must(Submit("waits")).job.id;
  std::vector<Result<std::vector<LeasedJob>>> answers;
  faulty_disk::Fail({.on_sync = SQLITE_IOERR_FSYNC});
  store().AwaitJobs({.worker = "w", .kinds = {"SIMULATE"}, .duration = std::chrono::seconds(10)},
                    [&](auto leased) { answers.push_back(std::move(leased)); });
  Must(store().ActOn({}, QueueAct::kHold, {}));  // it has been tried, whoever did it
  faulty_disk::Heal();
  EXPECT_EQ(answers.size(), 0U);
  EXPECT_EQ(Must(store().GetJob(job)).state, JobState::kQueued);
  Must(Submit("another"));
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(Must(answers[0]).at(0).lease.job, job);
}

// And of one that came with a write that failed. The job that is held back leaves nothing that it
// could be given there.
TEST_F(SqliteFaults, ARequestBesideAWriteThatFailsStands) {
  std::vector<Result<std::vector<LeasedJob>>> answers;
  std::promise<std::optional<ErrorCode>> put;
  store().Submit({.kind = "CHECK", .held = true}, [&](const Result<SubmittedJob>&) {
    faulty_disk::Fail({.on_write = SQLITE_FULL});
    store().AwaitJobs({.worker = "w", .kinds = {"SIMULATE"}, .duration = std::chrono::seconds(10)},
                      [&](auto leased) { answers.push_back(std::move(leased)); });
    // An answer that writes does so in one commit with what was queued before it.
    put.set_value(CodeOf(store().PutMachine({.id = "m"}, 0)));
  });
  EXPECT_EQ(put.get_future().get(), kFailed);
  faulty_disk::Heal();
  Must(store().ActOn({}, QueueAct::kHold, {}));
  EXPECT_EQ(answers.size(), 0U);
  const std::int64_t job = Must(Submit("r")).job.id;
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(Must(answers[0]).at(0).lease.job, job);
}

// Withdrawn behind such a commit it has nothing.
TEST_F(SqliteFaults, ARequestWithdrawnBehindAFailedCommitHasNothing) {
  std::vector<Result<std::vector<LeasedJob>>> answers;
  const std::int64_t number = store().AwaitJobs(
      {.worker = "w", .kinds = {"SIMULATE"}, .duration = std::chrono::seconds(10)},
      [&](auto leased) { answers.push_back(std::move(leased)); });
  faulty_disk::Fail({.on_sync = SQLITE_IOERR_FSYNC});
  EXPECT_EQ(CodeOf(Submit("r")), kFailed);
  faulty_disk::Heal();
  store().Withdraw(number);
  Must(store().ActOn({}, QueueAct::kHold, {}));
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_TRUE(Must(answers[0]).empty());
}

// And where the job could not be given out, which here another attempt of its number keeps from
// being: what was found out in a commit that failed was not found out.
TEST_F(SqliteFaults, ARequestThatFailsInAFailedCommitStands) {
  bed_.Close();
  ExecuteIn(bed_.path(),
            "INSERT INTO attempt (job, number, worker, fence, started_at, how_it_ended)"
            " VALUES (1, 1, 'w', 99, 0, '')");
  bed_.Reopen();
  std::vector<Result<std::vector<LeasedJob>>> answers;
  const auto await = [&] {
    store().AwaitJobs({.worker = "w", .kinds = {"SIMULATE"}, .duration = std::chrono::seconds(10)},
                      [&](auto leased) { answers.push_back(std::move(leased)); });
    Must(store().ActOn({}, QueueAct::kHold, {}));
  };
  await();
  faulty_disk::Fail({.on_sync = SQLITE_IOERR_FSYNC});
  EXPECT_EQ(CodeOf(Submit("r")), kFailed);
  faulty_disk::Heal();
  EXPECT_EQ(answers.size(), 0U);
  const std::int64_t job = Must(Submit("r")).job.id;
  await();  // the same of one that comes when the job is there
  ASSERT_EQ(answers.size(), 2U);
  for (const auto& answer : answers) EXPECT_EQ(CodeOf(answer), kFailed);
  EXPECT_EQ(Must(store().GetJob(job)).state, JobState::kQueued);
  EXPECT_EQ(NumberIn(bed_.path(), "SELECT count(*) FROM lease"), 0);
  EXPECT_EQ(Must(store().CountJobs()).queued, 1);
}

// performance.md Q5: a job that is made and given out, and its end: the disk is waited for twice.
TEST_F(SqliteFaults, ALoneJobIsTwoSyncs) {
  std::vector<Result<std::vector<LeasedJob>>> answers;
  const auto await = [&] {
    store().AwaitJobs({.worker = "w", .kinds = {"SIMULATE"}, .duration = std::chrono::seconds(10)},
                      [&](auto leased) { answers.push_back(std::move(leased)); });
    Must(store().ActOn({}, QueueAct::kHold, {}));
  };
  await();
  Must(Submit("first"));
  Must(store().Finish(Must(answers.at(0)).at(0).lease, {}));
  faulty_disk::Fail({});  // counts from here
  await();
  Must(Submit("second"));
  Must(store().Finish(Must(answers.at(1)).at(0).lease, {}));
  EXPECT_EQ(faulty_disk::Syncs(), 2);
}

TEST_F(SqliteFaults, OpeningOnAFullDiskIsAnError) {
  bed_.Close();
  std::filesystem::remove(bed_.path());
  for (std::int64_t after = 0; after < 1'000; after += 3) {
    faulty_disk::Fail({.on_write = SQLITE_FULL, .on_sync = SQLITE_FULL, .after = after});
    const auto opened = bed_.Open();
    faulty_disk::Heal();
    if (opened) break;
    EXPECT_EQ(opened.error().code, kFailed) << opened.error().detail;
    ASSERT_LT(after, 990);
  }
  bed_.Reopen();  // what a failed start left behind is no obstacle
  Must(Submit("r"));
}

// Tidying whose commit fails is undone with all that it counted: what stayed goes with the next.
TEST(SqliteFullDisk, WhatAFailedCommitRemovedGoesWithTheNext) {
  SqliteOptions options = OnFaultyDisk();
  options.keep_finished_jobs = 1;
  SqliteBed bed(options);
  const auto end_one = [&](const std::function<void()>& answered) {
    const std::int64_t job = Must(bed.store().SubmitAndWait({.kind = "CHECK"})).job.id;
    bed.clock().Advance(std::chrono::seconds(1));
    bed.store().SendRequestCancel(job, {}, [answered](const Result<JobRecord>&) { answered(); });
    EXPECT_TRUE(ComesToRest());  // what there was to tidy is tidied
  };
  const auto jobs = [&] { return NumberIn(bed.path(), "SELECT count(*) FROM job"); };
  end_one([] {});
  // The write is committed when it is answered, and nothing is tidied yet.
  end_one([] { faulty_disk::Fail({.on_sync = SQLITE_IOERR_FSYNC}); });
  faulty_disk::Heal();
  EXPECT_EQ(jobs(), 2);
  end_one([] {});
  EXPECT_EQ(jobs(), 1);
}

// While it lives, whoever names no disk has the faulty one.
class FaultyForAll {
 public:
  FaultyForAll() : system_(sqlite3_vfs_find(nullptr)) {
    faulty_disk::Register();
    faulty_disk::Heal();
    sqlite3_vfs_register(sqlite3_vfs_find(faulty_disk::kName), 1);
  }
  ~FaultyForAll() {
    faulty_disk::Heal();
    sqlite3_vfs_register(system_, 1);
  }
  FaultyForAll(const FaultyForAll&) = delete;
  FaultyForAll& operator=(const FaultyForAll&) = delete;

 private:
  sqlite3_vfs* system_;
};

// An old store is changed when its copy is there: one that does not fit on the disk is none.
TEST(SqliteFullDisk, ACopyThatDoesNotFitIsAnError) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  const std::string copy = directory.File("copy.db");
  Must(OpenSqliteStore({.path = path})).reset();
  const sqlite::Database database =
      Must(sqlite::Database::Open(path, sqlite::Database::Access::kReadWrite, {}));
  {
    const FaultyForAll faulty;
    faulty_disk::OnlyFilesEndingWith("copy.db");
    faulty_disk::Fail({.on_write = SQLITE_FULL});
    const Status copied = database.CopyTo(copy);
    ASSERT_EQ(CodeOf(copied), kFailed);
    EXPECT_TRUE(copied.error().detail.ends_with("(SQLite 13)")) << copied.error().detail;
  }
  Must(database.CopyTo(copy));
  EXPECT_EQ(NumberIn(copy, "SELECT count(*) FROM migration"),
            NumberIn(path, "SELECT count(*) FROM migration"));
}

// Of a copy it is not known which reason the system had: none is made up.
TEST(SqliteFullDisk, ACopyThatTheDiskRefusesHasNoReason) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  const sqlite::Database database =
      Must(sqlite::Database::Open(path, sqlite::Database::Access::kReadWrite, {}));
  const FaultyForAll faulty;
  faulty_disk::OnlyFilesEndingWith("copy.db");
  faulty_disk::Fail({.on_write = SQLITE_IOERR_WRITE});
  const Status copied = database.CopyTo(directory.File("copy.db"));
  ASSERT_EQ(CodeOf(copied), kFailed);
  EXPECT_TRUE(copied.error().detail.ends_with(")")) << copied.error().detail;
}

// Of a write it is: what the system said stands behind the code.
TEST(SqliteFullDisk, AWriteThatTheDiskRefusesHasItsReason) {
  faulty_disk::Register();
  faulty_disk::Heal();
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  sqlite::Database database = Must(sqlite::Database::Open(
      path, sqlite::Database::Access::kReadWrite, {.vfs = faulty_disk::kName}));
  Must(database.Execute("CREATE TABLE filling (bytes BLOB)"));
  faulty_disk::Fail({.on_write = SQLITE_IOERR_WRITE});
  errno = EIO;
  const Status refused = database.Execute("PRAGMA wal_checkpoint(TRUNCATE)");
  faulty_disk::Heal();
  ASSERT_EQ(CodeOf(refused), kFailed);
  EXPECT_NE(refused.error().detail.find("(SQLite 778): "), std::string::npos)
      << refused.error().detail;
}

// database.h Checkpoint: that nothing could be moved is no answer to whether all was.
TEST(SqliteFullDisk, ACheckpointThatTheDiskRefusesIsAnError) {
  faulty_disk::Register();
  faulty_disk::Heal();
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  Must(OpenSqliteStore({.path = path})).reset();
  sqlite::Database database = Must(sqlite::Database::Open(
      path, sqlite::Database::Access::kReadWrite, {.vfs = faulty_disk::kName}));
  Must(database.Execute("CREATE TABLE filling (bytes BLOB)"));
  faulty_disk::Fail({.on_write = SQLITE_IOERR_WRITE});
  const Result<bool> refused = database.Checkpoint();
  faulty_disk::Heal();
  EXPECT_EQ(CodeOf(refused), kFailed);
  EXPECT_TRUE(Must(database.Checkpoint()));
}

}  // namespace
}  // namespace rmlcell::storage
