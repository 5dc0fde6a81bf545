// What the embedded store says where its file or its disk is not as it should be: the code of each
// refusal, and that nothing else suffers.
#include <gmock/gmock.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <future>

#include "storage/content.h"
#include "storage/sqlite/content_staging.h"
#include "storage/sqlite/migrations.h"
#include "storage/sqlite/store_files.h"
#include "storage/sqlite/tables.h"
#include "storage/sqlite/writer.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage::sqlite {
namespace {

using testing::HasSubstr;

constexpr auto kCorruptFile = ErrorCode::kCellStoreCorrupt;
constexpr auto kFailedFile = ErrorCode::kCellStoreFailed;

// 9104: a record whose bytes are gone is told as such in lists and by itself; others are served.
TEST(SqliteRefusals, RecordsWithoutTheirBytes) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  Must(bed.store().PutMachine({.id = "m"}, 0));
  Must(bed.store().PutPrograms("m", {{.slot = 1, .object = "gone"}, {.slot = 2, .object = "b"}},
                               {}));
  Must(bed.store().SubmitAndWait(
      {.kind = "CHECK",
       .attachments = {{.name = "main", .bytes = "main bytes"},
                       {.name = "lost", .bytes = Noise(kProductInRowMax + 1, 1)}}}));
  bed.Close();
  ExecuteIn(bed.path(),
            "DELETE FROM blob WHERE id = (SELECT object_blob FROM program WHERE slot = 1)"
            " OR id = (SELECT blob FROM artifact WHERE name = 'lost')");
  bed.Reopen();
  const auto program = bed.store().GetProgramSummary("m", 1);
  ASSERT_EQ(CodeOf(program), kCorruptFile);
  EXPECT_THAT(program.error().detail, HasSubstr("slot 1"));
  EXPECT_EQ(CodeOf(bed.store().ListPrograms("m", 0, 10)), kCorruptFile);
  EXPECT_EQ(Must(bed.store().ListPrograms("m", 1, 10)).size(), 1U);
  EXPECT_EQ(Must(bed.store().GetProgramSummary("m", 2)).object_bytes, 1);
  const auto artifact = bed.store().GetArtifact(1, "lost");
  ASSERT_EQ(CodeOf(artifact), kCorruptFile);
  EXPECT_THAT(artifact.error().detail, HasSubstr("artifact lost of job 1"));
  EXPECT_EQ(CodeOf(bed.store().ListArtifacts(1)), kCorruptFile);
  EXPECT_EQ(CodeOf(bed.store().ReadArtifact(1, "lost")), kCorruptFile);
  EXPECT_EQ(CodeOf(bed.store().OpenArtifact(1, "lost")), kCorruptFile);
  EXPECT_EQ(Must(bed.store().GetArtifact(1, "main")).size, 10);
  EXPECT_EQ(Must(bed.store().ReadArtifact(1, "main")), "main bytes");
}

// 9104: a job in a state that there is none of is told as damaged, by lists and by the job that
// waits for it, too.
TEST(SqliteRefusals, AJobInNoState) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  for (int i = 0; i < 2; ++i) Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  Must(bed.store().SubmitAndWait({.kind = "CHECK", .after = {1}}));
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE job SET state = 6 WHERE id = 1");
  bed.Reopen();
  for (const std::int64_t job : {1, 3}) {
    const auto damaged = bed.store().GetJob(job);
    ASSERT_EQ(CodeOf(damaged), kCorruptFile) << job;
    EXPECT_EQ(damaged.error().detail, "job 1 has state 6");
  }
  EXPECT_EQ(CodeOf(bed.store().ListJobs({})), kCorruptFile);
  EXPECT_EQ(Must(bed.store().GetJob(2)).state, JobState::kQueued);
}

// A job of the queue that cannot be leased does not keep the end of another one from the disk.
TEST(SqliteRefusals, AnEndIsStoredThoughTheNextJobIsDamaged) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  for (int i = 0; i < 2; ++i) Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  const Lease lease = (*Must(bed.store().Acquire("w", {"CHECK"}, std::chrono::hours(1), {}))).lease;
  bed.Close();
  ExecuteIn(bed.path(),
            "INSERT INTO attempt (job, number, worker, fence, started_at, how_it_ended)"
            " VALUES (2, 1, 'w', 99, 0, '')");
  bed.Reopen();
  std::promise<Result<FinishedJob>> answer;
  bed.store().SendFinish(lease, std::make_shared<const JobEnd>(),
                         JobRequest{.worker = "w", .kinds = {"CHECK"}},
                         [&](Result<FinishedJob> done) { answer.set_value(std::move(done)); });
  const FinishedJob finished = Must(answer.get_future().get());
  EXPECT_EQ(finished.job.state, JobState::kSucceeded);
  EXPECT_TRUE(finished.next.empty());
  EXPECT_EQ(Must(bed.store().GetJob(1)).state, JobState::kSucceeded);
  EXPECT_EQ(Must(bed.store().GetJob(2)).state, JobState::kQueued);
}

// A job that counts as waiting for another one, and is over, is not touched by the end of that one.
TEST(SqliteRefusals, WhatIsOverFollowsNobody) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  Must(bed.store().SubmitAndWait({.kind = "CHECK", .after = {1}}));
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE job SET state = 3 WHERE id = 2");
  const std::string blocked = "SELECT blocked FROM job WHERE id = 2";
  const std::int64_t before = NumberIn(bed.path(), blocked);
  EXPECT_NE(before, 0);
  bed.Reopen();
  const auto leased = Must(bed.store().Acquire("w", {"CHECK"}, kLease, {}));
  ASSERT_TRUE(leased);
  EXPECT_EQ(Must(bed.store().Finish(leased->lease, {})).state, JobState::kSucceeded);
  EXPECT_EQ(NumberIn(bed.path(), blocked), before);
}

// The program that is kept with its job: other bytes, a part of them, or none.
TEST(SqliteRefusals, AProgramThatIsDamagedInItsJob) {
  for (const char* damage : {"x'6162'", "substr(attachment, 1, 9)", "NULL"}) {
    SqliteBed bed;
    bed.LeaveUnchecked();
    Must(bed.store().SubmitAndWait(
        {.kind = "CHECK", .attachments = {{.name = "main", .bytes = "main bytes"}}}));
    bed.Close();
    ExecuteIn(bed.path(), std::string("UPDATE job_specification SET attachment = ") + damage);
    bed.Reopen();
    const auto read = bed.store().ReadArtifact(1, "main");
    ASSERT_EQ(CodeOf(read), kCorruptFile) << damage;
    EXPECT_THAT(read.error().detail, HasSubstr("main of job 1 are damaged"));
    EXPECT_EQ(CodeOf(bed.store().OpenArtifact(1, "main")), kCorruptFile);
  }
}

// An index that is ordered otherwise than the store compares: a list ends with an error, not in
// circles.
TEST(SqliteRefusals, IndexInAnotherOrder) {
  SqliteBed bed;
  for (const char* kind : {"a", "B"}) Must(bed.store().SubmitAndWait({.kind = kind}));
  EXPECT_EQ(Must(bed.store().ListJobs({.limit = 10})).size(), 2U);
  bed.Close();
  ExecuteIn(bed.path(),
            "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql ="
            " replace(sql, 'kind TEXT NOT NULL', 'kind TEXT COLLATE NOCASE NOT NULL')"
            " WHERE name = 'job'; PRAGMA writable_schema = RESET; REINDEX");
  bed.Reopen();
  const auto jobs = bed.store().ListJobs({.limit = 10});
  ASSERT_EQ(CodeOf(jobs), kCorruptFile);
  EXPECT_THAT(jobs.error().detail, HasSubstr("out of order"));
  EXPECT_EQ(CodeOf(bed.store().ListJobs({.kind = "a", .limit = 10})), kCorruptFile);
}

// One that tells the same lane or machine again and again, as it stands between two that it knows.
TEST(SqliteRefusals, IndexThatGoesInCircles) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  Must(bed.store().SubmitAndWait({.machine = "m", .kind = "RUN"}));
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE job SET special = 0.5");  // read as 0
  bed.Reopen();
  const auto jobs = bed.store().ListJobs({.limit = 10});
  ASSERT_EQ(CodeOf(jobs), kCorruptFile);
  EXPECT_EQ(jobs.error().detail, "the index of unfinished jobs is out of order");
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE job SET special = 0, machine = x'6d'");  // bytes are behind text
  bed.Reopen();
  const auto leased =
      bed.store().AcquireJobs({.worker = "w", .kinds = {"RUN"}, .duration = kLease});
  ASSERT_EQ(CodeOf(leased), kCorruptFile);
  EXPECT_EQ(leased.error().detail, "the index of runs is out of order");
}

TEST(SqliteRefusals, PathThatIsNoRegularFile) {
  const TestDirectory directory;
  const std::string path = directory.File("pipe");
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const Status refused = MakePrivateFile(path);
  ASSERT_EQ(CodeOf(refused), kFailedFile);
  EXPECT_THAT(refused.error().detail, HasSubstr("not a regular file"));
}

// A write whose last step the file refuses fails as a whole: the job is still held by who had it.
TEST(SqliteRefusals, HandingBackWithoutItsEvent) {
  SqliteBed bed;
  bed.Close();
  ExecuteIn(bed.path(),
            "CREATE TRIGGER refuses BEFORE INSERT ON event WHEN new.kind = 'requeued'"
            " BEGIN SELECT RAISE(ABORT, 'not this one'); END");
  bed.Reopen();
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  const auto leased = Must(bed.store().Acquire("w", {"CHECK"}, std::chrono::minutes(1), {}));
  ASSERT_TRUE(leased);
  const LossPolicy policy{.outcome = {.state = JobState::kFailed},
                          .requeued = {{.kind = "requeued"}}};
  const auto refused = bed.store().HandBack(leased->lease, policy);
  ASSERT_EQ(CodeOf(refused), kFailedFile);
  EXPECT_THAT(refused.error().detail, HasSubstr("not this one"));
  EXPECT_EQ(Must(bed.store().GetJob(1)).state, JobState::kRunning);
  EXPECT_EQ(Must(bed.store().GetJob(1)).attempts, 1);
  EXPECT_TRUE(bed.store().Renew(leased->lease, std::chrono::minutes(1)));
}

// Without the bytes of its specification there is no job.
TEST(SqliteRefusals, SpecificationThatIsNotTaken) {
  SqliteBed bed;
  bed.Close();
  ExecuteIn(bed.path(),
            "CREATE TRIGGER refuses BEFORE INSERT ON blob"
            " BEGIN SELECT RAISE(ABORT, 'no blobs'); END");
  bed.Reopen();
  const auto refused =
      bed.store().SubmitAndWait({.kind = "CHECK", .specification = std::string(100'000, 's')});
  ASSERT_EQ(CodeOf(refused), kFailedFile);
  EXPECT_THAT(refused.error().detail, HasSubstr("no blobs"));
  EXPECT_TRUE(Must(bed.store().ListJobs({.limit = 10})).empty());
  EXPECT_EQ(Must(bed.store().SubmitAndWait({.kind = "CHECK", .specification = "s"})).job.id, 1);
}

// A write-ahead log needs memory that processes share; file systems without it are refused.
TEST(SqliteRefusals, FileSystemWithoutSharedMemory) {
  const TestDirectory directory;
  const auto refused = OpenSqliteStore({.path = directory.File("cell.db"), .vfs = "unix-none"});
  ASSERT_EQ(CodeOf(refused), kFailedFile);
  EXPECT_THAT(refused.error().detail, HasSubstr("journal mode"));
}

// A connection to the file of a store that is closed.
class SqliteAlone : public testing::Test {
 protected:
  SqliteAlone() { Must(OpenSqliteStore({.path = path_})).reset(); }
  Database Open() { return Must(Database::Open(path_, Database::Access::kReadWrite, {})); }

  const TestDirectory directory_;
  const std::string path_ = directory_.File("cell.db");
};

// database.h: the first column of the first row; an error when there is none.
TEST_F(SqliteAlone, QuestionWithoutAnAnswer) {
  Database database = Open();
  EXPECT_EQ(Must(database.Number("SELECT 7")), 7);
  EXPECT_EQ(Must(database.Text("SELECT 'seven'")), "seven");
  EXPECT_EQ(CodeOf(database.Number("SELECT id FROM job")), kCorruptFile);
  EXPECT_EQ(CodeOf(database.Text("SELECT kind FROM job")), kCorruptFile);
  EXPECT_EQ(CodeOf(database.Number("SELECT none FROM job")), kFailedFile);
  EXPECT_EQ(CodeOf(database.Text("SELECT none FROM job")), kFailedFile);
}

// database.h: not even we change the schema by its text.
TEST_F(SqliteAlone, SchemaThatIsNotWritten) {
  const Status refused =
      Open().Execute("PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = sql");
  ASSERT_EQ(CodeOf(refused), kFailedFile);
  EXPECT_THAT(refused.error().detail, HasSubstr("may not be modified"));
}

TEST_F(SqliteAlone, CopyThatCannotBeMade) {
  const Database database = Open();
  const Status refused = database.CopyTo(directory_.File("none/copy"));
  ASSERT_EQ(CodeOf(refused), kFailedFile);
  EXPECT_THAT(refused.error().detail, HasSubstr("none/copy"));
  EXPECT_FALSE(std::filesystem::exists(directory_.File("none")));
}

class SqliteOwnWriter : public SqliteAlone {
 protected:
  SqliteOwnWriter() {
    sqlite3_commit_hook(
        connection_.database.handle(),
        [](void* test) {
          static_cast<SqliteOwnWriter*>(test)->NoteCommit();
          return 0;
        },
        this);
  }
  // Commits that changed something.
  void NoteCommit() {
    const std::int64_t changes = connection_.database.total_changes();
    if (changes != changes_) ++commits_;
    changes_ = changes;
  }

  Connection connection_{Open()};
  std::int64_t changes_ = 0;
  std::atomic<int> commits_ = 0;
};

const Writer::Options kRoomy{.keep = {},
                             .waiting_operations_max = 100,
                             .waiting_bytes_max = std::size_t{100} << 20,
                             .group_window = {},
                             .program_memory = {}};

// A write that runs out of memory, or meets another mistake, fails alone, and nothing of it stays.
TEST_F(SqliteOwnWriter, WriteThatThrows) {
  Writer writer(connection_, {}, {}, kRoomy, SystemTime, [] {});
  const Status failed = writer.Do([](WriteContext& context) -> Status {
    context.counters.queued_jobs += 1;
    Must(context.tables.marks.Set(MarkTable::kJob, 99));
    throw std::runtime_error("no room for it");
  });
  ASSERT_EQ(CodeOf(failed), ErrorCode::kCellInternal);
  EXPECT_EQ(failed.error().detail, "no room for it");
  EXPECT_EQ(writer.job_counts().queued, 0);
  EXPECT_EQ(Must(writer.Do(
                [](WriteContext& context) { return context.tables.marks.Get(MarkTable::kJob); })),
            0);
}

// writer.h: almost every write is good or fails before it has written, and is run once; one that
// fails later is run again, so that it is undone alone.
TEST_F(SqliteOwnWriter, AWriteIsRunOnceUnlessItFailsLate) {
  Writer writer(connection_, {}, {}, kRoomy, SystemTime, [] {});
  const auto runs_of = [&](bool writes, bool fails) {
    int runs = 0;
    const Status done = writer.Do([&](WriteContext& context) -> Status {
      ++runs;
      if (writes) Must(context.tables.marks.Set(MarkTable::kJob, 99));
      return fails ? Status(InvalidArgument("not this one")) : Status();
    });
    EXPECT_EQ(done.ok(), !fails);
    return runs;
  };
  EXPECT_EQ(runs_of(true, false), 1);
  EXPECT_EQ(runs_of(false, false), 1);
  EXPECT_EQ(runs_of(false, true), 1);
  EXPECT_EQ(runs_of(true, true), 2);
}

// content_staging.cc: a large content goes ahead in writes of 4 MiB, so that others get their turn
// between them, and the disk is not asked for each chunk. Noise does not shrink: 9 MiB are three
// writes, behind the one that makes the blob.
TEST_F(SqliteOwnWriter, LargeContentGoesAheadInWritesOf4MiB) {
  Writer writer(connection_, {}, {}, kRoomy, SystemTime, [] {});
  const std::string content = Noise(std::size_t{9} << 20, 1);
  const StagedContent staged =
      Must(StagedContent::Make(writer, content, StagedContent::Place::kBlob));
  EXPECT_EQ(commits_, 4);
  // It is held as long as it is on its way.
  EXPECT_EQ(Must(writer.Do([&](WriteContext&) {
              return connection_.database.Number("SELECT holds FROM blob");
            })),
            1);
}

// An operation that holds so many bytes: it is good, or it was refused.
class NoWrite final : public WriteOperation {
 public:
  explicit NoWrite(std::vector<std::optional<ErrorCode>>& answers) : answers_(answers) {}
  Status Run(WriteContext&) override { return {}; }
  void Answer(const Status& status) override { answers_.push_back(CodeOf(status)); }

 private:
  std::vector<std::optional<ErrorCode>>& answers_;
};

// sqlite_store.h waiting_bytes_max: what waits may have all of it, and what holds nothing waits
// beside it. Inside a write nothing is done of what is posted.
TEST_F(SqliteOwnWriter, AsManyBytesWaitAsMay) {
  Writer::Options options = kRoomy;
  options.waiting_bytes_max = 1'000;
  std::vector<std::optional<ErrorCode>> answers;
  {
    Writer writer(connection_, {}, {}, options, SystemTime, [] {});
    const auto post = [&](std::size_t bytes) {
      writer.Post(std::make_unique<NoWrite>(answers), bytes);
    };
    Must(writer.Do([&](WriteContext&) -> Status {
      post(600);
      post(401);
      EXPECT_EQ(answers.size(), 1U);
      post(400);
      post(0);
      EXPECT_EQ(answers.size(), 1U);
      post(1);
      EXPECT_EQ(answers.size(), 2U);
      return {};
    }));
  }
  const std::optional<ErrorCode> refused = ErrorCode::kCellResourceExhausted;
  EXPECT_THAT(answers,
              testing::ElementsAre(refused, refused, std::nullopt, std::nullopt, std::nullopt));
}

// change_counts.h: the rows of a commit may be seen before it is told, so that what it changes has
// no count until then.
TEST_F(SqliteOwnWriter, AJobCountsAsBeingChangedWhileItIsCommitted) {
  struct CommitWatch {
    const ChangeCounts* counts = nullptr;
    bool being_changed = false;
  };
  CommitWatch watch;
  sqlite3* const handle = connection_.database.handle();
  {
    Writer writer(connection_, {}, {}, kRoomy, SystemTime, [] {});
    watch.counts = &writer.changes();
    const std::uint64_t before = watch.counts->OfJob(7);
    EXPECT_NE(before, 0U);
    Must(writer.Do([&](WriteContext&) -> Status {
      sqlite3_commit_hook(
          handle,
          [](void* state) {
            CommitWatch& now = *static_cast<CommitWatch*>(state);
            now.being_changed = now.being_changed || now.counts->OfJob(7) == 0;
            return 0;
          },
          &watch);
      return connection_.database.Execute(
          "INSERT INTO job (id, request_id, request_hash, machine, kind, title, caller, state,"
          " cancel_requested, attempts, attempts_max, attempts_begun, last_sequence,"
          " events_gone_until, created_at, finished_at)"
          " VALUES (7, 'r7', '', 'm', 'CHECK', '', '', 2, 0, 1, 1, 1, 0, 0, 0, 7)");
    }));
    EXPECT_GT(watch.counts->OfJob(7), before);
  }
  sqlite3_commit_hook(handle, nullptr, nullptr);
  EXPECT_TRUE(watch.being_changed);
  // Who counted is gone, and SQLite tells it nothing more.
  EXPECT_EQ(sqlite3_update_hook(handle, nullptr, nullptr), nullptr);
}

// 9104: all bytes of a content are there, and it is another one than its name says.
TEST(SqliteRefusals, AContentWithAnotherDigest) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  const std::string content = Noise(kChunkBytes + 1, 1);
  Must(bed.store().SubmitAndWait(
      {.kind = "CHECK", .attachments = {{.name = "large", .bytes = content}}}));
  bed.Close();
  const std::string other(64, 'a');
  ExecuteIn(bed.path(), "UPDATE blob SET sha256 = x'" + other + "'");
  bed.Reopen();
  const auto reader = Must(bed.store().OpenBlob(other));
  std::string read;
  Result<std::string> part = reader->Next();
  for (; part && !part->empty(); part = reader->Next()) read += *part;
  EXPECT_TRUE(read == content);
  ASSERT_EQ(CodeOf(part), kCorruptFile);
  EXPECT_EQ(part.error().detail, "content " + other + " does not have its SHA-256");
}

// 9104: a part that is damaged ends the reading with an error, not as if it were the end.
TEST(SqliteRefusals, AContentWithADamagedPart) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  const std::string content = Noise(kChunkBytes + 1'000, 1);
  Must(bed.store().SubmitAndWait(
      {.kind = "CHECK", .attachments = {{.name = "large", .bytes = content}}}));
  bed.Close();
  const std::string name =
      TextIn(bed.path(), "SELECT lower(hex(sha256)) FROM blob WHERE size > 1000000");
  ExecuteIn(bed.path(), "UPDATE blob_chunk SET content = zeroblob(100) WHERE number = 1");
  bed.Reopen();
  for (const bool by_name : {false, true}) {
    const auto reader =
        Must(by_name ? bed.store().OpenBlob(name) : bed.store().OpenArtifact(1, "large"));
    EXPECT_TRUE(Must(reader->Next()) == content.substr(0, kChunkBytes)) << by_name;
    EXPECT_EQ(CodeOf(reader->Next()), kCorruptFile) << by_name;
  }
}

// 9104: a content that is not whole has no name, and neither has the artifact that is one; those
// beside it are served.
TEST(SqliteRefusals, AnArtifactWhoseContentIsNotWhole) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  Must(bed.store().SubmitAndWait(
      {.kind = "CHECK",
       .attachments = {{.name = "main", .bytes = "main bytes"},
                       {.name = "part", .bytes = Noise(kProductInRowMax + 1, 1)}}}));
  bed.Close();
  ExecuteIn(bed.path(), "UPDATE blob SET sha256 = NULL");
  bed.Reopen();
  const auto artifact = bed.store().GetArtifact(1, "part");
  ASSERT_EQ(CodeOf(artifact), kCorruptFile);
  EXPECT_THAT(artifact.error().detail, HasSubstr("artifact part of job 1 are not there"));
  EXPECT_EQ(CodeOf(bed.store().ListArtifacts(1)), kCorruptFile);
  EXPECT_EQ(Must(bed.store().GetArtifact(1, "main")).size, 10);
}

// 9104: what is told of an artifact stands before its bytes, and is told though those that did not
// fit on the page of its row are lost.
TEST(SqliteRefusals, AnArtifactIsToldWithoutTheRestOfItsBytes) {
  SqliteBed bed;
  bed.LeaveUnchecked();
  // A page holds a row of up to 4061 bytes whole, and 489 bytes of a longer one: some of these.
  const std::string media_type(434, 'm');
  const std::string bytes = Noise(kProductInRowMax, 1);
  Must(bed.store().SubmitAndWait(
      {.kind = "CHECK",
       .attachments = {{.name = "part", .media_type = media_type, .bytes = bytes}}}));
  bed.Close();
  std::string file = ReadFile(bed.path());
  const std::string before = media_type + Sha256(bytes);
  const std::size_t found = file.find(before);
  ASSERT_NE(found, std::string::npos);
  const std::size_t begin = found + before.size() + 2;  // their size stands between
  std::size_t on_page = 0;
  while (on_page < bytes.size() && file.at(begin + on_page) == bytes[on_page]) ++on_page;
  ASSERT_GT(on_page, 0U);
  ASSERT_LT(on_page, bytes.size());
  file.replace(begin + on_page, 4, "\xFF\xFF\xFF\xFF");  // the number of the page of the rest
  WriteFile(bed.path(), file);
  bed.Reopen();
  EXPECT_EQ(CodeOf(bed.store().ReadArtifact(1, "part")), kCorruptFile);
  EXPECT_EQ(Must(bed.store().GetArtifact(1, "part")).media_type, media_type);
  EXPECT_EQ(Must(bed.store().ListArtifacts(1)).size(), 1U);
}

// 9104: a request that counts as known, by an index that is none of ours, and has no job.
TEST(SqliteRefusals, ARequestIdWithoutItsJob) {
  SqliteBed bed;
  Must(bed.store().SubmitAndWait({.request_id = "r", .kind = "CHECK"}));
  bed.Close();
  ExecuteIn(bed.path(), "CREATE UNIQUE INDEX folded ON job (request_id COLLATE NOCASE)");
  bed.Reopen();
  const auto refused = bed.store().SubmitAndWait({.request_id = "R", .kind = "CHECK"});
  ASSERT_EQ(CodeOf(refused), kCorruptFile);
  EXPECT_EQ(refused.error().detail, "a request id without its job");
  EXPECT_EQ(Must(bed.store().ListJobs({})).size(), 1U);
  EXPECT_EQ(Must(bed.store().CountJobs()).queued, 1);
}

// However much waits: a content that nobody named would stay on the disk until the next start.
TEST_F(SqliteOwnWriter, WhoLetsAContentGoIsNeverRefused) {
  Writer::Options options = kRoomy;
  options.waiting_operations_max = 1;
  std::vector<std::optional<ErrorCode>> answers;
  const std::string content = Noise(kChunkBytes + 1, 1);
  Writer writer(connection_, {}, {}, options, SystemTime, [] {});
  std::optional<StagedContent> staged(
      Must(StagedContent::Make(writer, content, StagedContent::Place::kBlob)));
  const auto holds = [&] {
    return Must(writer.Do([&](WriteContext&) {
      return connection_.database.Number("SELECT ifnull(sum(holds), 0) FROM blob");
    }));
  };
  EXPECT_EQ(holds(), 1);
  Must(writer.Do([&](WriteContext&) -> Status {
    for (int i = 0; i < 2; ++i) writer.Post(std::make_unique<NoWrite>(answers), 1);
    EXPECT_EQ(answers.size(), 1U);  // the second was refused
    staged.reset();
    return {};
  }));
  EXPECT_EQ(holds(), 0);
}

}  // namespace
}  // namespace rmlcell::storage::sqlite
