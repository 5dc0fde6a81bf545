// The bounds on what the embedded store keeps of what is over: off by default.
#include <gmock/gmock.h>

#include <thread>

#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SqliteKeep : public testing::Test {
 protected:
  void Open(std::int64_t keep_finished_jobs, std::int64_t keep_events) {
    SqliteOptions options;
    options.keep_finished_jobs = keep_finished_jobs;
    options.keep_events = keep_events;
    bed_.emplace(options);
  }
  Store& store() { return bed_->store(); }

  std::int64_t Submit() {
    return Must(store().SubmitAndWait(
                    {.kind = "SIMULATE",
                     .attachments = {{.name = "main", .bytes = Numbered("program ", ++submitted_)}},
                     .events = {{.kind = "queued", .payload = ""}}}))
        .job.id;
  }
  Lease Acquire() { return Must(store().Acquire("w", {"SIMULATE"}, kLease, {}))->lease; }
  // Queued, leased, ended: two events.
  std::int64_t RunJob() {
    Submit();
    const Lease lease = Acquire();
    Finish(lease);
    return lease.job;
  }
  void Finish(const Lease& lease) {
    bed_->clock().Advance(std::chrono::milliseconds(1));
    Must(store().Finish(lease,
                        {.artifacts = {{.name = "report", .bytes = Numbered("report ", lease.job)}},
                         .events = {{.kind = "ended", .payload = ""}}}));
  }
  std::vector<std::int64_t> Jobs() {
    std::vector<std::int64_t> ids;
    for (const JobRecord& job : Must(store().ListJobs({.limit = 1000}))) ids.push_back(job.id);
    return ids;
  }
  std::int64_t Count(const std::string& from) {
    return NumberIn(bed_->path(), "SELECT count(*) FROM " + from);
  }
  // Removal happens beside the writes.
  void WaitForCount(const std::string& from, std::int64_t count) {
    Eventually([&] { return Count(from) == count; });
    EXPECT_EQ(Count(from), count) << from;
  }

  std::optional<SqliteBed> bed_;

 private:
  int submitted_ = 0;
};

TEST_F(SqliteKeep, EverythingIsKeptByDefault) {
  Open(0, 0);
  for (int i = 0; i < 60; ++i) RunJob();
  bed_->Reopen();
  EXPECT_EQ(Jobs().size(), 60U);
  EXPECT_EQ(Must(store().AllEvents(0, 1000)).size(), 120U);
  EXPECT_EQ(Must(store().EventsGoneUntil()), 0);
}

// Those that ended last stay; the others go with all that belongs to them.
TEST_F(SqliteKeep, OldFinishedJobsGo) {
  Open(3, 0);
  for (int i = 0; i < 10; ++i) RunJob();
  WaitForCount("job", 3);
  EXPECT_THAT(Jobs(), ElementsAre(10, 9, 8));
  EXPECT_EQ(CodeOf(store().GetJob(7)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().JobEvents(7, 0, 10)), ErrorCode::kCellNotFound);
  EXPECT_EQ(Count("event"), 6);
  EXPECT_EQ(Count("attempt"), 3);
  EXPECT_EQ(Count("artifact"), 3);  // reports; programs go with their jobs
  EXPECT_EQ(Count("job_specification"), 3);
  EXPECT_EQ(Must(store().ReadArtifact(8, "report")), "report 8");
}

// By the time of the end, not of the submission; what waits or runs is not counted and does not go.
TEST_F(SqliteKeep, JobThatEndedLastStays) {
  Open(2, 0);
  Submit();
  const Lease longest = Acquire();
  const std::int64_t waiting = Submit();
  ASSERT_EQ(waiting, 2);
  const Lease other = Acquire();  // the waiting one; from here on a third waits
  Submit();
  for (int i = 0; i < 5; ++i) {
    Submit();
    Finish(Acquire());  // the oldest that waits
  }
  Finish(longest);
  WaitForCount("job WHERE state >= 2", 2);
  const std::vector<std::int64_t> jobs = Jobs();
  EXPECT_THAT(jobs, testing::Contains(longest.job));
  EXPECT_THAT(jobs, testing::Contains(other.job));
  EXPECT_EQ(Must(store().GetJob(longest.job)).state, JobState::kSucceeded);
  EXPECT_EQ(Must(store().CountJobs()).running, 1);
  EXPECT_EQ(Must(store().CountJobs()).queued, 1);
}

// Numbers of jobs, fences and positions go on, also when the rows that had the highest are gone.
TEST_F(SqliteKeep, NumbersAreNotGivenAgain) {
  Open(1, 0);
  Submit();
  const Lease first = Acquire();
  Submit();
  const Lease second = Acquire();
  Finish(second);  // ends first, so that it goes although it has the highest numbers
  Finish(first);
  WaitForCount("job", 1);
  const std::int64_t position = Must(store().LastPosition());
  EXPECT_EQ(position, 4);
  bed_->Reopen();
  EXPECT_EQ(Must(store().LastPosition()), position);
  EXPECT_EQ(Submit(), 3);
  EXPECT_GT(Acquire().fence, second.fence);
  EXPECT_EQ(Must(store().LastPosition()), position + 1);
}

// Opening counts no finished job and looks at no attempt: there may be a million of them.
TEST_F(SqliteKeep, OpeningTakesItsCountersFromMarks) {
  Open(0, 0);
  for (int i = 0; i < 5; ++i) RunJob();
  bed_->Close();
  EXPECT_EQ(NumberIn(bed_->path(), "SELECT value FROM mark WHERE name = 'finished jobs'"), 5);
  // As if there were fewer, and as if a higher fence had been given out.
  ExecuteIn(bed_->path(),
            "UPDATE mark SET value = 2 WHERE name = 'finished jobs';"
            "UPDATE mark SET value = 70000 WHERE name = 'fence'");
  bed_->options().keep_finished_jobs = 4;
  bed_->Reopen();
  RunJob();
  EXPECT_EQ(RunJob(), 7);
  EXPECT_EQ(Jobs().size(), 7U);
  RunJob();  // the fifth by the mark
  WaitForCount("job", 7);
  Submit();
  EXPECT_EQ(Acquire().fence, 70'004);
}

// A thousand fences are reserved with the first that is given, and with the first behind them; a
// write that gives none reserves none.
TEST_F(SqliteKeep, FencesAreReservedManyAtATime) {
  Open(0, 0);
  const auto mark = [&] {
    return NumberIn(bed_->path(), "SELECT ifnull(max(value), 0) FROM mark WHERE name = 'fence'");
  };
  Submit();
  EXPECT_EQ(mark(), 0);
  Lease lease = Acquire();
  EXPECT_EQ(lease.fence, 1);
  EXPECT_EQ(mark(), 1'001);
  Must(store().HandBack(lease, PolicyOfTests()));
  EXPECT_EQ(Acquire().fence, 2);
  EXPECT_EQ(mark(), 1'001);
  bed_->Reopen();
  Submit();
  EXPECT_EQ(mark(), 1'001);
  EXPECT_EQ(Acquire().fence, 1'002);
  EXPECT_EQ(mark(), 2'002);
}

// LIVE-5.10: of a run that was cut off a person decides by what is known of it: it stays, whatever
// else ends meanwhile, until its machine stands as if no run was open.
TEST_F(SqliteKeep, WhatWaitsForADecisionStays) {
  Open(0, 0);
  for (int i = 0; i < 2; ++i) RunJob();
  bed_->Close();
  const std::string mark = "INSERT OR REPLACE INTO machine_mark VALUES ('mill-1', 1, 1, x'', x'', ";
  ExecuteIn(bed_->path(),
            "UPDATE job SET state = 5, machine = 'mill-1' WHERE id = 1;" + mark + "0, 0)");
  bed_->options().keep_finished_jobs = 1;
  bed_->Reopen();
  EXPECT_EQ(RunJob(), 3);
  Eventually([&] { return Jobs() == std::vector<std::int64_t>{1}; });
  RunJob();  // and another: nothing else is left to go
  Eventually([&] { return Jobs() == std::vector<std::int64_t>{1}; });
  EXPECT_EQ(Jobs(), std::vector<std::int64_t>{1});
  bed_->Close();
  ExecuteIn(bed_->path(), mark + "1, 0)");
  bed_->Reopen();
  EXPECT_EQ(RunJob(), 5);
  Eventually([&] { return Jobs() == std::vector<std::int64_t>{5}; });
  EXPECT_EQ(Jobs(), std::vector<std::int64_t>{5});
}

// LIVE-5.10: where all that are left wait for a decision, none goes, though they are more than are
// kept; what ends behind them does.
TEST_F(SqliteKeep, NoneGoesWhereAllWaitForADecision) {
  Open(0, 0);
  for (int i = 0; i < 2; ++i) RunJob();
  bed_->Close();
  ExecuteIn(bed_->path(),
            "UPDATE job SET state = 5, machine = 'mill-1';"
            "INSERT INTO machine_mark VALUES ('mill-1', 1, 1, x'', x'', 0, 0)");
  bed_->options().keep_finished_jobs = 1;
  bed_->Reopen();
  for (const std::int64_t job : {3, 4}) {
    EXPECT_EQ(RunJob(), job);
    WaitForCount("job", 2);
    EXPECT_THAT(Jobs(), ElementsAre(2, 1));
  }
}

// A write that is undone changes no mark.
TEST_F(SqliteKeep, MarksFollowWhatIsCommitted) {
  Open(0, 0);
  Submit();
  const Lease lease = Acquire();
  const std::string finished =
      "SELECT ifnull(max(value), 0) FROM mark WHERE name = 'finished jobs'";
  EXPECT_EQ(CodeOf(store().Finish(
                lease, {.artifacts = {{.name = "r", .existing_sha256 = std::string(64, 'a')}}})),
            ErrorCode::kCellNotFound);
  Submit();
  EXPECT_EQ(NumberIn(bed_->path(), finished), 0);
  Finish(lease);
  EXPECT_EQ(NumberIn(bed_->path(), finished), 1);
}

// A store of version 2 has no such marks: they are made from its rows.
TEST_F(SqliteKeep, OldStoreGetsItsMarks) {
  Open(0, 0);
  for (int i = 0; i < 5; ++i) RunJob();
  const std::int64_t last = Must(store().ListAttempts(5)).front().fence;
  bed_->Close();
  ExecuteIn(
      bed_->path(),
      "DELETE FROM mark; DROP TABLE machine_jobs;DELETE FROM migration WHERE number >= 3; DROP INDEX job_unfinished;"
      "DROP INDEX job_special; DROP INDEX job_run_queue; DROP INDEX job_run;"
      "DROP INDEX job_not_before; DROP TABLE job_after; DROP TABLE log_part; DROP TABLE job_order;"
      "ALTER TABLE lease DROP COLUMN server; ALTER TABLE event DROP COLUMN resource; ALTER TABLE event DROP COLUMN caller;"
      "ALTER TABLE job DROP COLUMN pool; ALTER TABLE job DROP COLUMN priority;"
      "ALTER TABLE job DROP COLUMN place; ALTER TABLE job DROP COLUMN special;"
      "ALTER TABLE job DROP COLUMN held; ALTER TABLE job DROP COLUMN not_before;"
      "ALTER TABLE job DROP COLUMN blocked; ALTER TABLE job DROP COLUMN family;"
      "ALTER TABLE job DROP COLUMN outcome_verdict; DROP TABLE machine_lock;"
      "DROP TABLE machine_mark; DROP TABLE upload; DROP TABLE taught; ALTER TABLE machine DROP COLUMN options; ALTER TABLE machine ADD COLUMN state BLOB;"
      "ALTER TABLE machine ADD COLUMN state_blob INTEGER;"
      "ALTER TABLE job DROP COLUMN labels; DROP TABLE artifact; DELETE FROM job_specification;"
      "CREATE TABLE artifact (job INTEGER NOT NULL, name TEXT NOT NULL, media_type TEXT NOT NULL,"
      " blob INTEGER NOT NULL, PRIMARY KEY (job, name)) WITHOUT ROWID;"
      "ALTER TABLE job_specification DROP COLUMN attachment;"
      "ALTER TABLE job_specification DROP COLUMN attachment_name;"
      "ALTER TABLE job_specification DROP COLUMN attachment_media_type;"
      "ALTER TABLE job_specification DROP COLUMN attachment_sha256;"
      "ALTER TABLE job_specification DROP COLUMN attachment_size;"
      "CREATE INDEX job_unfinished ON job (state, kind) WHERE state < 2;"
      "PRAGMA user_version = 2");
  bed_->options().keep_finished_jobs = 3;
  bed_->Reopen();
  WaitForCount("job", 3);
  Submit();
  EXPECT_EQ(Acquire().fence, last + 1);
}

// 9021: who asks for events that are gone is told so, with the number to go on from; nothing is
// skipped silently (conventions.md, streams).
TEST_F(SqliteKeep, ReaderOfRemovedEventsIsTold) {
  Open(2, 0);
  for (int i = 0; i < 5; ++i) RunJob();
  WaitForCount("job", 2);
  const auto refused = store().AllEvents(0, 100);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellEventsGone);
  EXPECT_THAT(refused.error().detail, HasSubstr("watch from 6"));
  const std::int64_t gone = Must(store().EventsGoneUntil());
  EXPECT_EQ(gone, 6);  // three jobs of two events each
  EXPECT_EQ(CodeOf(store().AllEvents(gone - 1, 100)), ErrorCode::kCellEventsGone);
  EXPECT_EQ(Must(store().AllEvents(gone, 100)).size(), 4U);
}

TEST_F(SqliteKeep, OldEventsGo) {
  Open(0, 80);
  RunJob();  // two events: a position is no sequence
  Submit();
  const Lease lease = Acquire();
  for (int i = 2; i <= 500; ++i) {
    Must(store().AppendAndWait(lease, {{.kind = "e", .payload = std::to_string(i)}}));
  }
  Eventually([&] { return Count("event") <= 90; });
  const std::int64_t kept = Count("event");
  EXPECT_GE(kept, 80);
  EXPECT_LE(kept, 90);  // an eighth more than the limit at most
  const JobRecord job = Must(store().GetJob(lease.job));
  EXPECT_EQ(job.last_sequence, 500);
  EXPECT_EQ(job.events_gone_until, 500 - kept);
  EXPECT_EQ(Must(store().EventsGoneUntil()), 2 + 500 - kept);
  EXPECT_EQ(CodeOf(store().JobEvents(lease.job, 0, 1000)), ErrorCode::kCellEventsGone);
  EXPECT_EQ(CodeOf(store().JobEvents(lease.job, job.events_gone_until - 1, 10)),
            ErrorCode::kCellEventsGone);
  const auto events = Must(store().JobEvents(lease.job, job.events_gone_until, 1000));
  ASSERT_EQ(events.size(), static_cast<std::size_t>(kept));
  EXPECT_EQ(events.front().sequence, job.events_gone_until + 1);
  EXPECT_EQ(events.back().payload, "500");
  Finish(lease);
}

// A bound that is set later reduces what is there, in many slices.
TEST_F(SqliteKeep, BoundAppliesToWhatIsThere) {
  Open(0, 0);
  Submit();
  const Lease lease = Acquire();
  std::vector<NewEvent> many(2'500, NewEvent{.kind = "e", .payload = ""});
  Must(store().AppendAndWait(lease, many));
  Finish(lease);
  for (int i = 0; i < 200; ++i) RunJob();
  bed_->options().keep_finished_jobs = 5;
  bed_->Reopen();
  WaitForCount("job", 5);
  WaitForCount("event", 10);
  WaitForCount("artifact", 5);
  EXPECT_THAT(Jobs(), ElementsAre(201, 200, 199, 198, 197));
}

// A request id goes with its job: then it makes a new one.
TEST_F(SqliteKeep, RequestIdGoesWithItsJob) {
  Open(1, 0);
  const NewJob job{.request_id = "r", .request_hash = "h", .kind = "SIMULATE"};
  Must(store().SubmitAndWait(job));
  Finish(Acquire());
  RunJob();
  WaitForCount("job", 1);
  EXPECT_FALSE(Must(store().SubmitAndWait(job)).already_there);
}

// Those of jobs go with their jobs, the others when there are too many.
TEST_F(SqliteKeep, OldEventsOfRecordsGo) {
  SqliteOptions options;
  options.keep_record_events = 16;
  bed_.emplace(options);
  RunJob();
  for (int i = 0; i < 100; ++i) Must(store().PutProject({.id = Numbered("p", i)}, 0));
  // A few more may be there for a while.
  EXPECT_TRUE(Eventually([&] { return Count("event WHERE job = 0") <= 18; }));
  EXPECT_GE(Count("event WHERE job = 0"), 16);
  EXPECT_EQ(Count("event WHERE job > 0"), 2);
  const std::int64_t gone = Must(store().EventsGoneUntil());
  EXPECT_GT(gone, 2);
  EXPECT_EQ(CodeOf(store().AllEvents(0, 10)), ErrorCode::kCellEventsGone);
  const auto left = Must(store().AllEvents(gone, 1000));
  EXPECT_EQ(left.back().resource, "projects/p99");
  // As many as before, also after it was opened again.
  bed_->Reopen();
  for (int i = 0; i < 10; ++i) Must(store().PutProject({.id = Numbered("q", i)}, 0));
  EXPECT_TRUE(Eventually([&] { return Count("event WHERE job = 0") <= 18; }));
}

}  // namespace
}  // namespace rmlcell::storage
