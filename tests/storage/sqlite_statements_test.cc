// Each statement of a read or write fails once: what was asked for fails with its reason, and of a
// write nothing is there.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <future>
#include <memory>
#include <set>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"
#include "tests/storage/failing_statements.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

using failing_statements::Of;
using std::chrono::hours;
using testing::HasSubstr;

// All rows but those of contents: what was staged for a write that failed is swept later.
std::string RowsIn(const std::string& path) {
  sqlite3* handle = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &handle), SQLITE_OK);
  const auto select = [handle](const std::string& sql) {
    std::vector<std::string> rows;
    const auto take = [](void* to, int count, char** values, char**) {
      std::string row;
      for (int i = 0; i < count; ++i) row += std::string(values[i] ? values[i] : "-") + "|";
      static_cast<std::vector<std::string>*>(to)->push_back(row);
      return 0;
    };
    EXPECT_EQ(sqlite3_exec(handle, sql.c_str(), take, &rows, nullptr), SQLITE_OK) << sql;
    return rows;
  };
  std::string all;
  for (const std::string& table :
       select("SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'blob%'")) {
    const std::string name = table.substr(0, table.size() - 1);
    all += "\n" + name + ":";
    for (const std::string& row : select("SELECT * FROM " + name)) all += "\n" + row;
  }
  sqlite3_close(handle);
  return all;
}

std::optional<ProgramMemoryLimit> Roomy(const MachineRecord&) {
  return ProgramMemoryLimit{.bytes = 1'000'000, .full = ErrorCode::kCmosFull};
}

class SqliteStatements : public testing::Test {
 protected:
  SqliteStatements() { Settle(); }
  ~SqliteStatements() override { failing_statements::Heal(); }
  Store& store() { return bed_.store(); }

  // Until what was dropped before is swept: the sweeping has statements of its own.
  void Settle() {
    for (int i = 0; i < 3; ++i) Must(store().ActOn({}, QueueAct::kHold, {}));
  }
  // What `step` gives once nothing fails. `repeats`: it changes nothing any more, and a statement
  // that it asks for one row alone has given that before it fails.
  template <class Step>
  auto InSpiteOfAll(const std::string& what, Of of, Step step, bool repeats = false)
      -> decltype(step()) {
    for (int number = 0;; ++number) {
      const std::string before = of == Of::kWriter ? RowsIn(bed_.path()) : "";
      failing_statements::Fail(of, number);
      auto done = step();
      const std::string failed = failing_statements::Heal();
      if (failed.empty()) {
        EXPECT_GT(number, 0) << what << " has no statement";
        Settle();
        return done;
      }
      if (done && repeats) continue;
      EXPECT_EQ(CodeOf(done), ErrorCode::kCellStoreFailed) << what << ": " << failed;
      if (done) return done;
      EXPECT_THAT(done.error().detail, HasSubstr("interrupted")) << what << ": " << failed;
      if (of == Of::kWriter) {
        EXPECT_EQ(RowsIn(bed_.path()), before) << what << ": " << failed;
      }
    }
  }
  template <class Step>
  auto Writes(const std::string& what, Step step, bool repeats = false) {
    return Must(InSpiteOfAll(what, Of::kWriter, step, repeats));
  }
  template <class Step>
  auto Reads(const std::string& what, Step step, bool repeats = false) {
    return Must(InSpiteOfAll(what, Of::kReaders, step, repeats));
  }
  std::int64_t Submit(const NewJob& job) { return Must(store().SubmitAndWait(job)).job.id; }
  Lease LeaseOf(std::int64_t job) {
    return Must(store().AcquireJobs({.worker = "w", .server = "s", .job = job, .duration = kLease}))
        .at(0)
        .lease;
  }

  // A statement with this beginning, the first that comes, makes `step` fail.
  template <class Step>
  void FailsAt(const std::string& beginning, Step step) {
    for (int number = 0;; ++number) {
      Settle();  // what the one before let go of
      failing_statements::Fail(Of::kWriter, number);
      const auto done = step();
      const std::string failed = failing_statements::Heal();
      ASSERT_FALSE(failed.empty()) << "no statement begins with " << beginning;
      if (!failed.starts_with(beginning)) continue;
      EXPECT_EQ(CodeOf(done), ErrorCode::kCellStoreFailed) << failed;
      return;
    }
  }
  // What a worker that waits for jobs of this kind is given.
  using Given = std::future<Result<std::vector<LeasedJob>>>;
  Given Await(const std::string& kind) {
    const auto answer = std::make_shared<std::promise<Result<std::vector<LeasedJob>>>>();
    store().AwaitJobs(
        {.worker = "w", .server = "s", .kinds = {kind}, .duration = kLease},
        [answer](Result<std::vector<LeasedJob>> jobs) { answer->set_value(std::move(jobs)); });
    return answer->get_future();
  }

  SqliteBed bed_{[] {
    failing_statements::Register();
    return SqliteOptions{.program_memory = Roomy};
  }()};
};

TEST_F(SqliteStatements, OfMachinesAndProjects) {
  MachineRecord machine{.id = "m", .parameters = {{"a", "1"}}};
  Writes("a new machine", [&] { return store().PutMachine(machine, 0); });
  Writes("a machine again", [&] { return store().PutMachine(machine, 1); });
  Writes("a record of teaching", [&] { return store().AddTeachRecord({.machine = "m"}); });
  const std::string large(kContentInRecordMax + 1, 'x');
  Writes("a small project", [&] { return store().PutProject({.id = "p", .body = "b"}, 0); });
  Writes("a large project", [&] { return store().PutProject({.id = "p", .body = large}, 1); });
  Writes("another project", [&] { return store().PutProject({.id = "q", .body = large}, 0); });
  Reads("machines", [&] { return store().ListMachines(); });
  Reads("a machine", [&] { return store().GetMachine("m"); });
  Reads("records of teaching", [&] { return store().ListTeachRecords("m", 0, 0, 9); });
  Reads("projects", [&] { return store().ListProjects("", 9); });
  Reads("a project", [&] { return store().GetProject("q"); });
  Writes("no project", [&] { return store().DeleteProject("p", 2); });
  Must(store().PutPrograms("m", {{.slot = 1, .object = "o", .source = "s"}}, {{.number = 3}}));
  Writes("no machine", [&] { return store().DeleteMachine("m", kAnyRevision); });
}

TEST_F(SqliteStatements, OfPrograms) {
  Must(store().PutMachine({.id = "m"}, 0));
  const std::vector<ProgramWrite> programs = {{.slot = 1, .object = "o", .source = "s"},
                                              {.slot = 2, .object = Noise(3'000, 1)}};
  Writes("programs", [&] { return store().PutPrograms("m", programs, {{.number = 3}}); });
  for (const char* bytes : {"first", "second"})
    Writes("an executable", [&] { return store().PutExecutable("m", 1, 1, bytes); });
  Writes("no executable", [&] { return store().DeleteExecutable("m", 1); });
  Must(store().PutExecutable("m", 1, 1, "third"));
  Writes("a schedule", [&] { return store().PutSchedule({.machine = "m", .number = 4}, 0); });
  Reads("programs", [&] { return store().ListPrograms("m", 0, 9); });
  Reads("a program", [&] { return store().GetProgram("m", 1); });
  Reads("a program of chunks", [&] { return store().GetProgram("m", 2); });
  Reads("a summary", [&] { return store().GetProgramSummary("m", 1); });
  Reads("schedules", [&] { return store().ListSchedules("m"); });
  Reads("the memory",
        [&] { return store().GetMachineMemory("m", [](const MachineRecord&) { return true; }); });
  Writes("programs again", [&] { return store().PutPrograms("m", programs, {{.number = 3}}); });
  Writes("no schedule", [&] { return store().DeleteSchedule("m", 3); });
  Writes("no program", [&] { return store().DeleteProgram("m", 1, kAnyRevision); });
}

TEST_F(SqliteStatements, OfHosts) {
  Must(store().PutMachine({.id = "m"}, 0));
  const MachineLease lease = Writes("a host", [&] {
    return store().TakeMachine({.machine = "m", .host = "a", .server = "s", .duration = kLease});
  });
  Writes("a renewal", [&] { return store().RenewMachine(lease, "t"); });
  const std::int64_t job = Submit({.machine = "m", .kind = "RUN"});
  MachineWrite write{.events = {{.kind = "one"}, {.kind = "two"}},
                     .mark = MachineMark{.sequence = 1, .state = "state"}};
  write.job = LeaseOf(job);
  write.job_events = {{.kind = "three"}};
  Writes("what it tells", [&] { return store().AppendMachine(lease, write); });
  Reads("leases of machines", [&] { return store().MachineLeases(); });
  Reads("a mark", [&] { return store().GetMachineMark("m"); });
  write.mark->sequence = 2;
  JobEnd end{.machine_lease = lease, .machine = write};
  end.machine.job.reset();
  Writes("the end of its run", [&] { return store().Finish(*write.job, end); });
  Writes("no host", [&] { return store().ReleaseMachine(lease); });
}

TEST_F(SqliteStatements, OfSubmissions) {
  const std::int64_t first = Submit({.kind = "CHECK"});
  const std::string large(kContentInRecordMax + 1, 'x');
  const std::vector<NewArtifact> attachments = {{.name = "a", .bytes = Noise(3'000, 1)},
                                                {.name = "b", .bytes = "b"},
                                                {.name = "c", .bytes = Noise(4'000, 2)}};
  NewJob job{.request_id = "r",
             .kind = "CHECK",
             .specification = large,
             .held = true,
             .after = {first},
             .attachments = attachments,
             .events = {{.kind = "one"}, {.kind = "two"}}};
  Writes("a job", [&] { return store().SubmitAndWait(job); });
  EXPECT_TRUE(Writes(
                  "it again", [&] { return store().SubmitAndWait(job); }, true)
                  .already_there);
  job.queued_max = 1;
  EXPECT_TRUE(Writes(
                  "it, where no more may wait", [&] { return store().SubmitAndWait(job); }, true)
                  .already_there);
  Writes("a plain job", [&] {
    return store().SubmitAndWait({.kind = "CHECK", .attachments = {{.name = "a", .bytes = "a"}}});
  });
  Reads("what was submitted", [&] { return store().FindSubmitted("r", ""); });
  Reads("a job", [&] { return store().GetJob(2); });
  Reads("jobs", [&] { return store().ListJobs({}); });
  Reads("jobs of the queue", [&] { return store().ListJobs({.order = JobOrder::kQueue}); });
  Reads("counts", [&] { return store().CountByState({}); });
  Reads("events", [&] { return store().JobEvents(2, 0, 9); });
  Reads("all events", [&] { return store().AllEvents(0, 9); });
  Reads("the last position", [&] { return store().LastPosition(); });
  Reads("what is gone", [&] { return store().EventsGoneUntil(); });
  Reads("a position", [&] { return store().HasPosition(store().LogId(), 1); });
  Reads("artifacts", [&] { return store().ListArtifacts(2); });
  Reads("an artifact", [&] { return store().GetArtifact(2, "b"); });
  Reads("its bytes", [&] { return store().ReadArtifact(2, "a"); });
  Reads("its pieces", [&] { return store().OpenArtifact(2, "a"); });
  Reads("attempts", [&] { return store().ListAttempts(2); });
  Reads("how many are before it", [&] { return store().CountBefore(1); });
  const std::string sha256 = HexOf(Sha256(attachments[0].bytes));
  Reads("a content", [&] { return store().ReadBlob(sha256); });
  Reads("a content in pieces", [&] {
    const auto reader = store().OpenBlob(sha256);
    return reader ? (*reader)->Next() : Result<std::string>(reader.error());
  });
}

TEST_F(SqliteStatements, OfTheQueue) {
  const std::int64_t first = Submit({.kind = "CHECK"});
  const std::int64_t second = Submit({.kind = "CHECK"});
  const std::int64_t third = Submit({.kind = "CHECK", .after = {first, second}});
  const std::vector<NewEvent> events = {{.kind = "queue"}};
  Writes("held back", [&] { return store().HoldBack(second, events); });
  Writes("let go", [&] { return store().LetGo(second, events); });
  Writes("moved behind all", [&] { return store().Move(first, 0, 1, events); });
  Writes("moved in front", [&] { return store().Move(second, first, {}, events); });
  for (int i = 0; i < 60; ++i) Must(store().Move(i % 2 == 0 ? first : second, third, {}, {}));
  const auto act = [&](QueueAct what) {
    const std::vector<std::int64_t> jobs = {third, second};
    Writes("many", [&] {
      return store().ActOn(jobs, what, [](const JobRecord&) { return NewEvent{.kind = "queue"}; });
    });
  };
  act(QueueAct::kHold);
  act(QueueAct::kRelease);
  const Lease lease = LeaseOf(second);
  Writes("an order", [&] { return store().PutOrder(second, "t", "stop"); });
  Writes("orders", [&] { return store().TakeOrders("s"); });
  Must(store().Finish(lease, {.outcome = {.state = JobState::kFailed}}));
  Writes("let go behind one that failed", [&] { return store().LetGo(third, events); });
  act(QueueAct::kCancel);
  Writes("cancelled", [&] { return store().RequestCancel(first, events); });
  Writes("deleted", [&] { return store().DeleteJob(first, "anna"); });
}

TEST_F(SqliteStatements, OfWhatWaits) {
  const std::int64_t first = Submit({.kind = "CHECK"});
  const std::int64_t behind = Writes("a job behind another", [&] {
                                return store().SubmitAndWait({.kind = "CHECK", .after = {first}});
                              }).job.id;
  Reads("a job behind another", [&] { return store().GetJob(behind); });
  const std::vector<std::int64_t> jobs = {behind};
  const auto changed = Writes("let go what waits for another", [&] {
    return store().ActOn(jobs, QueueAct::kRelease,
                         [](const JobRecord&) { return NewEvent{.kind = "queue"}; });
  });
  EXPECT_TRUE(changed.empty());
  Reads("whether there are orders", [&] { return store().TakeOrders("s"); });
  const Lease run = LeaseOf(Submit({.machine = "m", .kind = "RUN"}));
  const auto waits = Writes("a run of a machine that is busy",
                            [&] { return store().SubmitAndWait({.machine = "m", .kind = "RUN"}); });
  EXPECT_EQ(waits.job.wait, WaitReason::kMachineBusy);
  EXPECT_EQ(waits.job.waits_for, run.job);
  Must(store().RequestCancel(run.job, {}));
  LossPolicy policy = PolicyOfTests();
  policy.not_begun = true;
  const JobRecord ended =
      Writes("a cancelled run is given back", [&] { return store().HandBack(run, policy); });
  EXPECT_EQ(ended.state, JobState::kCancelled);
}

// Parts that go ahead of the record that names them: without one of them there is no record.
TEST_F(SqliteStatements, OfPartsThatGoAhead) {
  const std::string body = Noise(2 * kChunkBytes + 1, 3);
  const auto put = [&](const std::string& id) {
    return [&, id] { return store().PutProject({.id = id, .body = body}, 0); };
  };
  FailsAt("INSERT INTO blob (", put("p"));
  FailsAt("INSERT INTO blob_chunk ", put("p"));
  FailsAt("UPDATE blob SET sha256 = ?2", put("p"));  // all parts are there
  FailsAt("UPDATE blob SET refs", put("p"));
  EXPECT_EQ(CodeOf(store().GetProject("p")), ErrorCode::kCellNotFound);
  Must(put("p")());
  FailsAt("UPDATE blob SET holds", put("q"));  // it is there already
  EXPECT_EQ(CodeOf(store().GetProject("q")), ErrorCode::kCellNotFound);
  Must(put("q")());
  for (const char* id : {"p", "q"}) EXPECT_TRUE(Must(store().GetProject(id)).body == body) << id;
}

// The same of every record that may have a large content: nothing comes of it.
TEST_F(SqliteStatements, OfContentsThatGoAhead) {
  Must(store().PutMachine({.id = "m"}, 0));
  const std::int64_t job = Submit({.kind = "CHECK"});
  const Lease lease = LeaseOf(job);
  const std::string large = Noise(kChunkBytes + 1, 5);
  const std::string ahead = "INSERT INTO blob (";
  FailsAt(ahead, [&] { return store().SubmitAndWait({.kind = "CHECK", .specification = large}); });
  FailsAt(ahead, [&] {
    return store().SubmitAndWait({.kind = "CHECK", .attachments = {{.name = "a", .bytes = large}}});
  });
  FailsAt(ahead, [&] { return store().PutPrograms("m", {{.slot = 1, .object = large}}, {}); });
  FailsAt(ahead, [&] {
    return store().PutPrograms("m", {{.slot = 1, .object = "o", .source = large}}, {});
  });
  FailsAt(ahead,
          [&] { return store().Finish(lease, {.artifacts = {{.name = "a", .bytes = large}}}); });
  EXPECT_EQ(Must(store().ListJobs({})).size(), 1U);
  EXPECT_EQ(Must(store().GetJob(job)).state, JobState::kRunning);
  EXPECT_TRUE(Must(store().ListPrograms("m", 0, 9)).empty());
}

// A worker that waits, and cannot be given the job that comes, is told so; the job is there all the
// same, and counted once.
TEST_F(SqliteStatements, OfAJobForSomebodyWhoWaits) {
  std::int64_t made = 0;
  for (int number = 0;; ++number) {
    const std::string kind = Numbered("CHECK", number);
    Given given = Await(kind);
    Settle();
    failing_statements::Fail(Of::kWriter, number);
    const auto submitted = store().SubmitAndWait({.kind = kind});
    const std::string failed = failing_statements::Heal();
    ASSERT_FALSE(failed.empty()) << "nobody was given a job";
    if (submitted) ++made;
    if (!failed.starts_with("INSERT INTO lease")) continue;
    ASSERT_TRUE(submitted) << submitted.error().detail;
    EXPECT_EQ(CodeOf(given.get()), ErrorCode::kCellStoreFailed);
    EXPECT_EQ(Must(store().GetJob(submitted->job.id)).state, JobState::kQueued);
    EXPECT_TRUE(Must(store().ListAttempts(submitted->job.id)).empty());
    EXPECT_EQ(Must(store().CountJobs()).queued, made);
    EXPECT_EQ(Must(store().CountJobs()).running, 0);
    return;
  }
}

// The same of one that comes when the job is there.
TEST_F(SqliteStatements, OfARequestThatFindsItsJob) {
  for (int number = 0;; ++number) {
    const std::string kind = Numbered("CHECK", number);
    const std::int64_t job = Submit({.kind = kind});
    failing_statements::Fail(Of::kWriter, number);
    const auto leased = Await(kind).get();
    const std::string failed = failing_statements::Heal();
    const JobState state = Must(store().GetJob(job)).state;
    if (leased) {
      ASSERT_EQ(leased->size(), 1U) << failed;
      EXPECT_EQ(state, JobState::kRunning) << failed;
      if (failed.empty()) return;
      EXPECT_TRUE(failed.starts_with("SELECT specification")) << failed;  // it is begun without
    } else {
      EXPECT_EQ(CodeOf(leased), ErrorCode::kCellStoreFailed) << failed;
      EXPECT_EQ(state, JobState::kQueued) << failed;
    }
  }
}

// The answer to a request that is known has its job whole, or there is none.
TEST_F(SqliteStatements, OfARequestThatIsKnown) {
  const NewJob job{.request_id = "r", .kind = "CHECK", .specification = "what to do"};
  Must(store().SubmitAndWait(job));
  FailsAt("SELECT specification", [&] { return store().SubmitAndWait(job); });
  const SubmittedJob known = Must(store().SubmitAndWait(job));
  EXPECT_TRUE(known.already_there);
  EXPECT_EQ(known.job.specification, "what to do");
}

// What is read behind a write that is done is told whole, or not at all: the write stands.
TEST_F(SqliteStatements, OfWhatIsReadBehindAWrite) {
  const std::int64_t job = Submit({.kind = "CHECK", .specification = "what to do", .held = true});
  for (int number = 0;; ++number) {
    failing_statements::Fail(Of::kReaders, number);
    const auto held = store().HoldBack(job, {});
    const std::string failed = failing_statements::Heal();
    ASSERT_TRUE(held) << failed;
    EXPECT_EQ(held->specification, failed.empty() ? "what to do" : "") << failed;
    if (!failed.empty()) continue;
    EXPECT_GE(number, 2);  // what it works on, and what it waits for
    return;
  }
}

// In front of one that stands next to another, where all of the line are moved.
TEST_F(SqliteStatements, OfAMoveWithoutRoom) {
  const std::int64_t back = Submit({.kind = "CHECK"});
  for (int i = 0; i < 50; ++i) Must(store().Move(Submit({.kind = "CHECK"}), back, {}, {}));
  for (int i = 0; i < 10; ++i) {
    const std::int64_t job = Submit({.kind = "CHECK"});
    Writes("moved", [&] { return store().Move(job, back, {}, {}); });
  }
}

TEST_F(SqliteStatements, OfLeases) {
  for (const char* pool : {"", "paced"}) Submit({.machine = "m", .kind = "CHECK", .pool = pool});
  Submit({.kind = "CHECK", .priority = 3});
  for (int i = 0; i < 2; ++i) Submit({.machine = "m", .kind = "RUN"});
  const JobRequest request{.worker = "w",
                           .server = "s",
                           .kinds = {"RUN", "CHECK"},
                           .pools = {"", "paced"},
                           .count = 9,
                           .duration = kLease,
                           .events = {{.kind = "begun"}}};
  const auto leased = Writes("jobs", [&] { return store().AcquireJobs(request); });
  ASSERT_EQ(leased.size(), 4U);
  const std::vector<NewEvent> events = {{.kind = "e"}};
  const auto lease = [&](std::size_t i) { return leased[i].lease; };
  Writes("renewed", [&] { return store().Renew(lease(0), hours(1)); });
  Writes("told", [&] { return store().AppendAndWait(lease(0), events); });
  Writes("handed back", [&] { return store().HandBack(lease(0), PolicyOfTests()); });
  Writes("abandoned", [&] { return store().Abandon(lease(1), PolicyOfTests()); });
  Writes("cancelled", [&] { return store().RequestCancel(lease(2).job, {}); });
  Writes("lost, and cancelled", [&] { return store().Abandon(lease(2), PolicyOfTests()); });
  Writes("a run is lost", [&] { return store().Abandon(lease(3), PolicyOfTests()); });
  const std::int64_t last = Must(store().UnfinishedJobs()).empty() ? 0 : 5;
  const Lease one =
      Writes("one by its number",
             [&] { return store().AcquireJobs({.worker = "w", .job = last, .duration = kLease}); })
          .at(0)
          .lease;
  LossPolicy held = PolicyOfTests();
  held.not_begun = true;
  held.held = true;
  Writes("a run waits again", [&] { return store().HandBack(one, held); });
  Writes("a run again",
         [&] { return store().AcquireJobs({.worker = "w", .job = last, .duration = kLease}); });
}

TEST_F(SqliteStatements, OfAnEnd) {
  Must(store().PutMachine({.id = "m"}, 0));
  Must(store().PutPrograms("m", {{.slot = 1, .object = "o"}}, {}));
  Must(store().PutExecutable("m", 1, 1, "before"));
  const std::int64_t job = Submit({.machine = "m", .kind = "SIMULATE"});
  const std::int64_t follower = Submit({.kind = "SIMULATE", .after = {job}});
  const Lease lease = LeaseOf(job);
  Writes("an end", [&] {
    return store().Finish(
        lease, {.artifacts = {{.name = "a", .bytes = "a"}, {.name = "b", .bytes = Noise(9'000, 1)}},
                .executables = {{1, 1, "made"}},
                .events = {{.kind = "ended"}}});
  });
  EXPECT_EQ(Must(store().GetProgram("m", 1)).executable, "made");
  EXPECT_EQ(Must(store().GetJob(follower)).wait, WaitReason::kNone);
  Writes("products", [&] {
    return store().AddProducts(job, {.artifacts = {{.name = "c", .bytes = "c"}}, .verdict = "BAD"});
  });
  Writes("no job", [&] { return store().DeleteJob(job, "anna"); });
}

TEST_F(SqliteStatements, OfWhatTheClockDoes) {
  const auto expire = [&] { return store().Expire(PolicyOfTests()); };
  Submit({.kind = "CHECK", .not_before = bed_.clock().Now() + hours(1)});
  bed_.clock().Advance(hours(1));
  Writes("a job whose time has come", expire);
  LeaseOf(1);
  bed_.clock().Advance(hours(1));
  EXPECT_EQ(Writes("a lease that ran out", expire).size(), 1U);
  LeaseOf(1);
  bed_.clock().Advance(hours(1));
  Reads("what has run out", expire, true);
}

TEST_F(SqliteStatements, OfAnUpload) {
  const auto upload = [&](const std::string& content) {
    return [&]() -> Result<WallTime> {
      const std::string name = HexOf(Sha256(content));
      const auto writer = Must(store().WriteBlob(name, content.size()));
      if (const Status added = writer->Append(content); !added) return added.error();
      const Result<WallTime> kept = writer->Finish(hours(1));
      EXPECT_TRUE(!kept || Must(store().ReadBlob(name)) == content);
      return kept;
    };
  };
  const std::string small = "content", large(2 * kChunkBytes + 1, 'a');
  Writes("an upload", upload(small));
  Writes("it again", upload(small));
  // Who cannot let go of the parts in the end has them all the same, until they are swept.
  Writes("an upload of three parts", upload(large), true);
}

TEST_F(SqliteStatements, OfTheOpening) {
  Submit({.kind = "CHECK"});
  LeaseOf(1);
  bed_.Close();
  std::set<std::string> failures;
  for (int number = 0;; ++number) {
    failing_statements::Fail(Of::kWriter, number);
    const auto opened = bed_.Open();
    const std::string failed = failing_statements::Heal();
    if (failed.empty()) break;
    failures.insert(failed);
    EXPECT_EQ(CodeOf(opened), ErrorCode::kCellStoreFailed) << failed;
    if (opened) break;
    EXPECT_THAT(opened.error().detail, HasSubstr("interrupted")) << failed;
    EXPECT_THAT(opened.error().detail, HasSubstr(bed_.path() + ": ")) << failed;
  }
  EXPECT_GE(failures.size(), 11U);
  bed_.Reopen();
  EXPECT_EQ(Must(store().GetJob(1)).state, JobState::kRunning);
}

}  // namespace
}  // namespace rmlcell::storage
