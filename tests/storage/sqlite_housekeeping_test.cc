// When the embedded store tidies up, and how much of it at a time.
#include <gmock/gmock.h>

#include <future>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "storage/sqlite/housekeeping.h"
#include "storage/sqlite/writer.h"
#include "tests/storage/failing_statements.h"
#include "tests/storage/quiet_process.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage::sqlite {
namespace {

// housekeeping.h KeepLimits: 0 keeps all. Of events an eighth more may be there for a while, a
// thousand at most.
TEST(SqliteHousekeeping, IsDueBeyondItsLimits) {
  struct Case {
    KeepLimits limits;
    Counters most;
    Counters more;
  };
  const Case cases[] = {
      {{.finished_jobs = 1}, {.finished_jobs = 1}, {.finished_jobs = 2}},
      {{.finished_jobs = 3}, {.finished_jobs = 3}, {.finished_jobs = 4}},
      {{.record_events = 1}, {.record_events = 1}, {.record_events = 2}},
      {{.record_events = 16}, {.record_events = 18}, {.record_events = 19}},
      {{.record_events = 7}, {.record_events = 7}, {.record_events = 8}},
      {{.record_events = 80'000}, {.record_events = 81'000}, {.record_events = 81'001}},
      {{.events = 1}, {.position = 1}, {.position = 2}},
      {{.events = 16}, {.position = 18}, {.position = 19}},
      {{.events = 16},
       {.position = 118, .events_trimmed_until = 100},
       {.position = 119, .events_trimmed_until = 100}},
  };
  for (const Case& one : cases) {
    EXPECT_FALSE(Housekeeping(one.limits).IsDue(one.most));
    EXPECT_TRUE(Housekeeping(one.limits).IsDue(one.more));
    EXPECT_FALSE(Housekeeping({}).IsDue(one.more));
  }
}

// A file of its own, written by hand.
class SqliteSlices : public testing::Test {
 protected:
  void AddFinishedJob(int id) {
    const std::string number = std::to_string(id);
    Must(connection_.database.Execute(
        "INSERT INTO job (id, request_id, request_hash, machine, kind, title, caller, state,"
        " cancel_requested, attempts, attempts_max, attempts_begun, last_sequence,"
        " events_gone_until, created_at, finished_at) VALUES (" +
        number + ", 'r" + number + "', '', 'm', 'CHECK', '', '', 2, 0, 1, 1, 1, 0, 0, 0, " +
        number + ")"));
  }
  // At the next positions.
  void AddEvents(int job, int count) {
    Must(connection_.database.Execute(
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " +
        std::to_string(count) +
        ") INSERT INTO event (position, job, sequence, attempt, at, kind, payload, resource)"
        " SELECT i + (SELECT ifnull(max(position), 0) FROM event), " +
        std::to_string(job) + ", i, 0, 0, 'e', x'', " + (job == 0 ? "'r'" : "''") + " FROM n"));
  }
  std::int64_t Count(const std::string& from) {
    return Must(connection_.database.Number("SELECT count(*) FROM " + from));
  }
  Result<bool> Slice(const KeepLimits& limits) {
    WriteContext context{.tables = connection_.tables,
                         .counters = counters_,
                         .program_memory = no_limit_,
                         .machines = no_machines_,
                         .now = now_};
    Result<bool> more = Housekeeping(limits).RunSlice(context);
    told_ = context.changed;
    return more;
  }

  const TestDirectory directory_;
  const std::string path_ = directory_.File("cell.db");
  std::optional<Connection> opened_;
  Connection& connection_ = [this]() -> Connection& {
    Must(OpenSqliteStore({.path = path_})).reset();
    return opened_.emplace(Must(Database::Open(path_, Database::Access::kReadWrite, {})));
  }();
  const ProgramMemoryOf no_limit_;
  const MachineTally no_machines_{{}};
  Counters counters_;
  WallTime now_{std::chrono::seconds(1'000)};
  bool told_ = false;  // of the newest slice: whether watchers want to know
};

TEST_F(SqliteSlices, TakeSixtyFourJobs) {
  for (int job = 1; job <= 70; ++job) AddFinishedJob(job);
  counters_ = {.job = 70, .finished_jobs = 70};
  EXPECT_TRUE(Must(Slice({.finished_jobs = 2})));
  EXPECT_TRUE(told_);
  EXPECT_EQ(Count("job"), 6);
  EXPECT_EQ(counters_.finished_jobs, 6);
  EXPECT_FALSE(Must(Slice({.finished_jobs = 2})));
  EXPECT_EQ(Count("job WHERE id >= 69"), 2);
  EXPECT_EQ(Count("job"), 2);
  EXPECT_FALSE(Must(Slice({.finished_jobs = 2})));
  EXPECT_FALSE(told_);
}

// What counts as finished and is not to be had, as one that waits for a decision, is not looked for
// without an end.
TEST_F(SqliteSlices, EndWhereNothingIsLeftToTake) {
  counters_ = {.finished_jobs = 5};
  EXPECT_FALSE(Must(Slice({.finished_jobs = 1})));
  AddFinishedJob(1);
  EXPECT_FALSE(Must(Slice({.finished_jobs = 1})));
  EXPECT_EQ(Count("job"), 0);
}

// A job whose events fill a slice goes with the next one, though none of them is left.
TEST_F(SqliteSlices, TakeAThousandEventsOfJobs) {
  AddFinishedJob(1);
  AddFinishedJob(2);
  AddFinishedJob(3);
  AddEvents(1, 999);
  AddEvents(2, 1);
  AddEvents(3, 5);
  counters_ = {.job = 3, .position = 1'005, .finished_jobs = 3};
  EXPECT_TRUE(Must(Slice({.finished_jobs = 1})));
  EXPECT_EQ(Count("job"), 2);
  EXPECT_EQ(Count("event"), 5);
  EXPECT_FALSE(Must(Slice({.finished_jobs = 1})));
  EXPECT_EQ(Count("job"), 1);
  EXPECT_EQ(Count("event WHERE job = 3"), 5);
  EXPECT_EQ(Must(connection_.tables.marks.Get(MarkTable::kEventsGoneUntil)), 1'000);
  EXPECT_EQ(Must(connection_.tables.marks.Get(MarkTable::kPosition)), 1'005);
  EXPECT_EQ(Must(connection_.tables.marks.Get(MarkTable::kJob)), 3);
}

TEST_F(SqliteSlices, TakeAThousandOldEvents) {
  AddFinishedJob(1);
  AddEvents(1, 2'500);
  counters_ = {.job = 1, .position = 2'500, .finished_jobs = 1};
  const KeepLimits limits{.events = 80};
  for (const std::int64_t trimmed : {1'000, 2'000}) {
    EXPECT_TRUE(Must(Slice(limits)));
    EXPECT_EQ(counters_.events_trimmed_until, trimmed);
    EXPECT_EQ(Count("event"), 2'500 - trimmed);
  }
  EXPECT_FALSE(Must(Slice(limits)));
  EXPECT_EQ(counters_.events_trimmed_until, 2'420);
  EXPECT_EQ(Count("event"), 80);
  EXPECT_EQ(Must(connection_.tables.jobs.Get(1))->job.events_gone_until, 2'420);
}

// Fewer than a slice takes: there are no more, also where no event has the number that comes last.
TEST_F(SqliteSlices, TakeFewerThanAThousandUpToTheLimit) {
  AddFinishedJob(1);
  AddEvents(1, 999);
  counters_ = {.job = 1, .position = 2'000, .finished_jobs = 1};
  EXPECT_FALSE(Must(Slice({.events = 80})));
  EXPECT_EQ(counters_.events_trimmed_until, 1'920);
  EXPECT_EQ(Count("event"), 0);
}

// Down to the limit: those beyond it, a thousand at a time.
TEST_F(SqliteSlices, TakeAThousandEventsOfRecords) {
  AddEvents(0, 1'200);
  counters_ = {.position = 1'200, .record_events = 1'200};
  const KeepLimits limits{.record_events = 16};
  EXPECT_TRUE(Must(Slice(limits)));
  EXPECT_TRUE(told_);
  EXPECT_EQ(counters_.record_events, 200);
  EXPECT_EQ(Count("event"), 200);
  EXPECT_FALSE(Must(Slice(limits)));
  EXPECT_EQ(counters_.record_events, 16);
  EXPECT_EQ(Count("event"), 16);
}

// 9104: what counts as removed is there again, or nothing is there of what was counted.
TEST_F(SqliteSlices, EventsThatDoNotAddUp) {
  AddFinishedJob(1);
  AddEvents(1, 1'000);
  counters_ = {.job = 1, .position = 3'000, .events_trimmed_until = 1'000};
  const auto again = Slice({.events = 80});
  ASSERT_EQ(CodeOf(again), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(again.error().detail, "old events cannot be removed");
  counters_ = {.position = 3'000, .record_events = 20};
  const auto none = Slice({.record_events = 16});
  ASSERT_EQ(CodeOf(none), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(none.error().detail, "old events cannot be removed");
}

TEST_F(SqliteSlices, TakeAsManyUploadsAsContents) {
  constexpr int kUploads = 300;
  for (int id = 1; id <= kUploads; ++id) {
    const std::string number = std::to_string(id);
    Must(connection_.database.Execute(
        "INSERT INTO blob (id, sha256, size, refs, holds, content) VALUES (" + number + ", x'" +
        HexOf(Sha256(number)) + "', 1, 1, 0, x'00'); INSERT INTO upload VALUES (" + number + ", " +
        std::to_string(now_.time_since_epoch().count() + (id <= 280 ? 0 : 1)) + ")"));
  }
  EXPECT_TRUE(Must(Slice({})));
  EXPECT_EQ(Count("upload"), kUploads - 256);
  EXPECT_EQ(Count("blob"), kUploads - 256);
  EXPECT_FALSE(Must(Slice({})));
  EXPECT_EQ(Count("upload"), 20);  // those whose time has not come
  EXPECT_EQ(Count("blob"), 20);
}

// Eight chunks of up to 1 MiB each are what one slice removes, and the content with the last one.
TEST_F(SqliteSlices, TakeEightChunks) {
  Must(connection_.database.Execute(
      "INSERT INTO blob (id, sha256, size, refs, holds) VALUES (1, x'01', 1, 0, 0);"
      "WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 19)"
      " INSERT INTO blob_chunk (blob, number, content) SELECT 1, i, x'00' FROM n"));
  for (const std::int64_t left : {12, 4}) {
    EXPECT_TRUE(Must(Slice({})));
    EXPECT_EQ(Count("blob_chunk"), left);
    EXPECT_EQ(Count("blob"), 1);
  }
  EXPECT_FALSE(Must(Slice({})));
  EXPECT_EQ(Count("blob_chunk"), 0);
  EXPECT_EQ(Count("blob"), 0);
}

// RemoveJobWhole: of any number of events, and only its own.
TEST_F(SqliteSlices, AJobGoesWhole) {
  AddFinishedJob(1);
  AddFinishedJob(2);
  AddEvents(1, 2'100);
  AddEvents(2, 3);
  counters_ = {.job = 2, .position = 2'103, .finished_jobs = 2};
  WriteContext context{.tables = connection_.tables,
                       .counters = counters_,
                       .program_memory = no_limit_,
                       .machines = no_machines_,
                       .now = now_};
  Must(RemoveJobWhole(context, 1));
  EXPECT_EQ(Count("event"), 3);
  EXPECT_EQ(Count("job"), 1);
  EXPECT_TRUE(context.changed);
  EXPECT_TRUE(context.garbage);
  EXPECT_EQ(counters_.finished_jobs, 1);
  EXPECT_EQ(Must(connection_.tables.marks.Get(MarkTable::kPosition)), 2'103);
  EXPECT_EQ(Must(connection_.tables.marks.Get(MarkTable::kEventsGoneUntil)), 0);
}

// 9104: what is to be removed is not there.
TEST_F(SqliteSlices, AJobThatIsNotThere) {
  const auto removed = connection_.tables.jobs.Remove(7);
  ASSERT_EQ(CodeOf(removed), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(removed.error().detail, "job 7 is not there");
}

// A job whose number, or the position of whose events, cannot be kept stays: they would come again.
TEST_F(SqliteSlices, NothingGoesWhoseNumbersAreNotKept) {
  for (int job = 1; job <= 2; ++job) AddFinishedJob(job);
  AddEvents(1, 3);
  const Counters before{.job = 2, .position = 3, .finished_jobs = 2};
  for (const std::string_view mark : {MarkTable::kJob, MarkTable::kPosition}) {
    Must(connection_.database.Execute(
        "CREATE TRIGGER refuses BEFORE INSERT ON mark WHEN new.name = '" + std::string(mark) +
        "' BEGIN SELECT RAISE(ABORT, 'not this one'); END"));
    counters_ = before;
    EXPECT_EQ(CodeOf(Slice({.finished_jobs = 1})), ErrorCode::kCellStoreFailed) << mark;
    WriteContext context{.tables = connection_.tables,
                         .counters = counters_,
                         .program_memory = no_limit_,
                         .machines = no_machines_,
                         .now = now_};
    EXPECT_EQ(CodeOf(RemoveJobWhole(context, 1)), ErrorCode::kCellStoreFailed) << mark;
    EXPECT_EQ(Count("job"), 2) << mark;
    EXPECT_EQ(Count("event"), 3) << mark;
    Must(connection_.database.Execute("DROP TRIGGER refuses"));
  }
  EXPECT_FALSE(Must(Slice({.finished_jobs = 1})));
  EXPECT_EQ(Count("job"), 1);
}

class SqliteFailingSlices : public SqliteSlices {
 protected:
  // Before the file is opened: connections of before know nothing of it.
  static void SetUpTestSuite() { failing_statements::Register(); }
  ~SqliteFailingSlices() override { failing_statements::Heal(); }
};

// What a slice cannot read or remove ends it with the reason: it is tried again later.
TEST_F(SqliteFailingSlices, EndWithTheFirstFailure) {
  for (int job = 1; job <= 3; ++job) AddFinishedJob(job);
  AddEvents(1, 20);
  AddEvents(2, 20);
  AddEvents(0, 30);
  Must(connection_.database.Execute(
      "INSERT INTO blob (id, sha256, size, refs, holds, content) VALUES (1, x'" +
      HexOf(Sha256("1")) + "', 1, 1, 0, x'00'); INSERT INTO upload VALUES (1, 0)"));
  const Counters before{.job = 3, .position = 70, .finished_jobs = 3, .record_events = 30};
  const KeepLimits limits{.finished_jobs = 1, .events = 20, .record_events = 16};
  for (int number = 0;; ++number) {
    Must(connection_.database.Execute("BEGIN"));
    counters_ = before;
    failing_statements::Fail(failing_statements::Of::kWriter, number);
    const auto slice = Slice(limits);
    const std::string failed = failing_statements::Heal();
    // SQLite may have ended the transaction itself.
    static_cast<void>(connection_.database.Execute("ROLLBACK"));
    if (failed.empty()) {
      EXPECT_FALSE(CodeOf(slice));
      EXPECT_GE(number, 8);
      break;
    }
    EXPECT_EQ(CodeOf(slice), ErrorCode::kCellStoreFailed) << failed;
    if (slice) break;
  }
}

// What is due of the uploads; then of each content that it is there, that it is found no more, its
// chunks and itself, and that there is no other.
TEST_F(SqliteFailingSlices, EndWithTheFirstFailureOfASweep) {
  Must(connection_.database.Execute(
      "INSERT INTO blob (id, sha256, size, refs, holds) VALUES (1, x'01', 1, 0, 0);"
      "INSERT INTO blob_chunk (blob, number, content) VALUES (1, 0, x'00')"));
  for (int number = 0; number <= 6; ++number) {
    Must(connection_.database.Execute("BEGIN"));
    failing_statements::Fail(failing_statements::Of::kSweeping, number);
    const auto slice = Slice({});
    const std::string failed = failing_statements::Heal();
    EXPECT_EQ(failed.empty(), number == 6) << number << " " << failed;
    EXPECT_EQ(!slice, number < 6) << failed;
    static_cast<void>(connection_.database.Execute(slice ? "COMMIT" : "ROLLBACK"));
    EXPECT_EQ(Count("blob"), number < 6 ? 1 : 0) << failed;
    EXPECT_EQ(Count("blob_chunk"), number < 6 ? 1 : 0) << failed;
  }
}

// Tidying that fails is undone with all that it counted: what stayed goes with the next one.
TEST(SqliteTidying, WhatCouldNotBeRemovedGoesWithTheNext) {
  failing_statements::Register();
  SqliteOptions options;
  options.keep_finished_jobs = 1;
  SqliteBed bed(options);
  const auto end_one = [&] {
    const std::int64_t job = Must(bed.store().SubmitAndWait({.kind = "CHECK"})).job.id;
    bed.clock().Advance(std::chrono::seconds(1));
    Must(bed.store().RequestCancel(job, {}));
    EXPECT_TRUE(ComesToRest());  // what there was to tidy is tidied
  };
  const auto jobs = [&] { return NumberIn(bed.path(), "SELECT count(*) FROM job"); };
  end_one();
  failing_statements::Fail(failing_statements::Of::kSweeping, 0);
  end_one();
  const std::string failed = failing_statements::Heal();
  EXPECT_TRUE(failed.starts_with("SELECT blob FROM upload")) << failed;
  EXPECT_EQ(jobs(), 2);
  end_one();
  EXPECT_EQ(jobs(), 1);
}

// The same where another program has taken the file meanwhile, here with the answer to the write:
// it is committed then, and nothing is tidied yet.
TEST(SqliteTidying, WhatCannotBeginIsDoneByTheNext) {
  SqliteOptions options;
  options.busy_timeout = std::chrono::milliseconds(50);
  options.keep_finished_jobs = 1;
  SqliteBed bed(options);
  Database other = Must(Database::Open(bed.path(), Database::Access::kReadWrite, {}));
  const auto end_one = [&](bool is_taken) {
    const std::int64_t job = Must(bed.store().SubmitAndWait({.kind = "CHECK"})).job.id;
    bed.clock().Advance(std::chrono::seconds(1));
    std::promise<void> answered;
    bed.store().SendRequestCancel(job, {}, [&](const Result<JobRecord>&) {
      if (is_taken) Must(other.Execute("BEGIN IMMEDIATE"));
      answered.set_value();
    });
    answered.get_future().wait();
    EXPECT_TRUE(ComesToRest());
  };
  const auto jobs = [&] { return NumberIn(bed.path(), "SELECT count(*) FROM job"); };
  end_one(false);
  end_one(true);
  EXPECT_EQ(jobs(), 2);
  Must(other.Execute("ROLLBACK"));
  end_one(false);
  EXPECT_EQ(jobs(), 1);
}

// The same where it is counted no less: what was removed is there again.
TEST(SqliteTidying, WhatIsCountedNoLessStays) {
  SqliteOptions options;
  options.keep_finished_jobs = 1;
  SqliteBed bed(options);
  bed.Close();
  ExecuteIn(bed.path(),
            "CREATE TRIGGER refuses BEFORE INSERT ON mark WHEN new.name = 'finished jobs' AND"
            " new.value < (SELECT value FROM mark WHERE name = 'finished jobs')"
            " BEGIN SELECT RAISE(ABORT, 'not less'); END");
  bed.Reopen();
  for (int i = 0; i < 2; ++i) {
    const std::int64_t job = Must(bed.store().SubmitAndWait({.kind = "CHECK"})).job.id;
    bed.clock().Advance(std::chrono::seconds(1));
    Must(bed.store().RequestCancel(job, {}));
    EXPECT_TRUE(ComesToRest());
  }
  EXPECT_EQ(NumberIn(bed.path(), "SELECT count(*) FROM job"), 2);
  EXPECT_EQ(NumberIn(bed.path(), "SELECT value FROM mark WHERE name = 'finished jobs'"), 2);
}

// writer.cc: what could not be removed is tried again by the next write that leaves something to
// remove, and by no other one: the disk is not asked in vain.
TEST(SqliteTidying, AWriteThatLeavesNothingTidiesNothing) {
  failing_statements::Register();
  SqliteBed bed;
  const auto put = [&](const std::string& id, std::uint64_t seed) {
    Must(bed.store().PutProject({.id = id, .body = Noise(kContentInRecordMax + 1, seed)},
                                kAnyRevision));
  };
  put("first", 1);
  put("second", 2);
  EXPECT_TRUE(ComesToRest());
  const auto blobs = [&] { return NumberIn(bed.path(), "SELECT count(*) FROM blob"); };
  EXPECT_EQ(blobs(), 2);
  failing_statements::Fail(failing_statements::Of::kSweeping, 0);
  Must(bed.store().DeleteProject("first", kAnyRevision));
  EXPECT_TRUE(ComesToRest());
  EXPECT_FALSE(failing_statements::Heal().empty());
  EXPECT_EQ(blobs(), 2);
  // By the store's own thread, which is the one that tidies.
  bed.store().Submit({.kind = "CHECK", .more_come = true}, [](const Result<SubmittedJob>&) {});
  EXPECT_TRUE(ComesToRest());
  EXPECT_EQ(NumberIn(bed.path(), "SELECT count(*) FROM job"), 1);
  EXPECT_EQ(blobs(), 2);
  Must(bed.store().DeleteProject("second", kAnyRevision));
  EXPECT_TRUE(ComesToRest());
  EXPECT_EQ(blobs(), 0);
}

}  // namespace
}  // namespace rmlcell::storage::sqlite
