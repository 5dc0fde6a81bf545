// The queue of runs while the store does not answer, and jobs that cannot be read (live.md 5.02,
// 5.04).
#include <atomic>

#include "tests/server/forwarding_store.h"
#include "tests/server/runs/run_queue_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

enum class QueueTrouble { kNone, kRunning, kJob, kRead, kMachine, kLease };

// Of which one kind of call fails, as long as it is told so; what it is told to do once is done
// before a job is leased. Thread-safe.
class TroubledQueueStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<QueueTrouble> fails = QueueTrouble::kNone;
  std::function<void()> before_lease;  // of one thread alone

  Result<std::vector<storage::JobRecord>> ListJobs(const storage::JobQuery& query) override {
    if (fails == QueueTrouble::kRunning && query.state == JobState::kRunning) return Away();
    return store_.ListJobs(query);
  }
  Result<storage::JobRecord> GetJob(std::int64_t id) override {
    if (fails == QueueTrouble::kJob) return Away();
    return store_.GetJob(id);
  }
  Result<std::string> ReadArtifact(std::int64_t job, std::string_view name) override {
    if (fails == QueueTrouble::kRead) return Away();
    return store_.ReadArtifact(job, name);
  }
  Result<storage::MachineRecord> GetMachine(std::string_view id) override {
    if (fails == QueueTrouble::kMachine) return Away();
    return store_.GetMachine(id);
  }
  Result<std::vector<storage::LeasedJob>> AcquireJobs(const storage::JobRequest& request) override {
    if (fails == QueueTrouble::kLease) return Away();
    if (const auto act = std::exchange(before_lease, {})) act();
    return store_.AcquireJobs(request);
  }

 private:
  static Error Away() { return {ErrorCode::kCellStoreFailed, "the line broke", {}}; }
};

class QueueInTrouble : public RunQueueTest {
 protected:
  using Begun = Result<v1::HostOrderAnswer>;

  void SetUp() override {
    RunQueueTest::SetUp();
    hosts.OnNews({});
    book.OnRunWaits({});
  }
  std::future<Begun> Begin(std::int64_t job, v1::HostOrder order = RunJob()) {
    const auto answered = std::make_shared<std::promise<Begun>>();
    others.BeginByPerson(job, std::move(order),
                         [answered](Begun answer) { answered->set_value(std::move(answer)); });
    return answered->get_future();
  }
  // Nothing: it was answered.
  std::optional<ErrorCode> WhyNotBegunNow(std::int64_t job, v1::HostOrder order = RunJob()) {
    auto answered = Begin(job, std::move(order));
    if (answered.wait_for(kPatience) != std::future_status::ready) {
      ADD_FAILURE() << "no answer";
      return std::nullopt;
    }
    return CodeOf(answered.get());
  }
  void LookAtMill() {
    others.Wake("mill-1");
    Settle();
  }

  TroubledQueueStore store{bed.store()};
  RunQueue others{{.store = store,
                   .hosts = hosts,
                   .config = config,
                   .executor = *executor,
                   .server = "this server",
                   .clock = clock.clock()}};
};

// LIVE-5.01: what it is not known to be free to begin does not begin.
TEST_F(QueueInTrouble, NothingBeginsWhileTheStoreDoesNotSay) {
  Tell(Idle());
  const std::int64_t job = Submit();
  for (const QueueTrouble call :
       {QueueTrouble::kRunning, QueueTrouble::kJob, QueueTrouble::kLease}) {
    store.fails = call;
    LookAtMill();
    EXPECT_TRUE(Orders().empty()) << static_cast<int>(call);
    EXPECT_EQ(Job(job).state, JobState::kQueued) << static_cast<int>(call);
  }
  store.fails = QueueTrouble::kNone;
  LookAtMill();
  EXPECT_EQ(NewestOrder(1).run_job().job().name(), JobName(job));
}

// Nothing of it counts, what could be read of it neither; it stays until a person begins it.
TEST_F(QueueInTrouble, AJobThatIsDamagedFailsWhenAPersonBeginsIt) {
  v1::Job asked;
  asked.set_kind(v1::JOB_KIND_RUN);
  asked.set_continues("jobs/1");
  const std::int64_t job =
      Must(bed.store().SubmitAndWait({.machine = "mill-1",
                                      .kind = "RUN",
                                      .specification = asked.SerializeAsString() + "\xFF"}))
          .job.id;
  Tell(Idle());
  LookAtMill();
  EXPECT_EQ(Job(job).state, JobState::kQueued);
  EXPECT_EQ(WhyNotBegunNow(job), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(Job(job).state, JobState::kFailed);
  EXPECT_EQ(Job(job).outcome->code, ErrorCode::kCellStoreCorrupt);
  EXPECT_TRUE(Orders().empty());
}

// It waits again, and for nobody: the store answers in a while.
TEST_F(QueueInTrouble, AProgramThatCannotBeReadNowEndsNoJob) {
  TellBlocked();
  for (const bool at_step : {false, true}) {
    const std::int64_t job = Submit([at_step](v1::Job& asked) {
      if (at_step) asked.mutable_run()->mutable_step()->set_step(2);
    });
    store.fails = QueueTrouble::kRead;
    EXPECT_EQ(WhyNotBegunNow(job), ErrorCode::kCellStoreFailed) << at_step;
    store.fails = QueueTrouble::kNone;
    EXPECT_EQ(Job(job).state, JobState::kQueued) << at_step;
    EXPECT_FALSE(Job(job).held) << at_step;
    EXPECT_EQ(Job(job).attempts, 0) << at_step;
    Must(bed.store().RequestCancel(job, {}));
  }
  EXPECT_TRUE(Orders().empty());
}

// LIVE-5.02: another try does not mend it.
TEST_F(QueueInTrouble, ATicketThatProvesNothingEndsTheJob) {
  const std::int64_t check = bed.SubmitCheck();
  Must(bed.store().Finish(bed.Lease(), {.outcome = {.state = JobState::kSucceeded}}));
  TellBlocked();
  const std::int64_t job =
      Submit([check](v1::Job& asked) { asked.mutable_run()->set_ticket(JobName(check)); });
  EXPECT_EQ(WhyNotBegunNow(job), ErrorCode::kCellTicket);
  EXPECT_EQ(Job(job).state, JobState::kFailed);
  EXPECT_EQ(Job(job).outcome->code, ErrorCode::kCellTicket);
  EXPECT_THAT(Job(job).outcome->detail, HasSubstr("is no simulation"));
}

// One of more than what goes with the other messages to a worker goes to a host all the same.
TEST_F(QueueInTrouble, ALargeProgramGoesWhole) {
  std::string text = "PA;";
  while (text.size() < 100'000) text += "PU100,0;PU0,0;";
  Tell(Idle());
  Submit([&text](v1::Job& asked) { asked.mutable_inline_program()->set_content(text); });
  LookAtMill();
  const v1::WorkerAssignment assignment = NewestOrder(1).run_job();
  ASSERT_EQ(assignment.programs_size(), 1);
  EXPECT_EQ(assignment.programs(0).content(), text);
}

// The queue of another server was first: it runs, and that is what the person wanted.
TEST_F(QueueInTrouble, OneThatBeginsAtTheSameMomentHasBegun) {
  TellBlocked();
  const std::int64_t job = Submit();
  store.before_lease = [this, job] {
    Must(bed.store().AcquireJobs(
        {.worker = "hall/1", .kinds = {"RUN"}, .job = job, .duration = std::chrono::hours(1)}));
  };
  auto answered = Begin(job);
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  const Begun answer = answered.get();
  ASSERT_TRUE(answer) << answer.error().detail;
  EXPECT_FALSE(answer->has_refusal());
  EXPECT_EQ(answer->status().host(), "hall/1");
  EXPECT_TRUE(Orders().empty());
}

// LIVE-5.10: nor is one that was to go on over for it.
TEST_F(QueueInTrouble, ALeaseThatCannotBeHadLeavesTheJobAsItIs) {
  TellBlocked();
  const std::int64_t job = Submit();
  store.fails = QueueTrouble::kLease;
  for (const v1::HostOrder& order : {RunJob(), ContinueJob()}) {
    EXPECT_EQ(WhyNotBegunNow(job, order), ErrorCode::kCellStoreFailed);
    EXPECT_EQ(Job(job).state, JobState::kQueued);
  }
}

// LIVE-2.05: where it cannot be read who starts jobs there, none starts by itself.
TEST_F(QueueInTrouble, WhatWasRefusedIsHeldWhereItsMachineCannotBeRead) {
  TellBlocked();
  const std::int64_t job = Submit();
  auto answered = Begin(job);
  const v1::HostOrder order = NewestOrder(1);
  store.fails = QueueTrouble::kMachine;
  Refuse(order, "CELL-E9429");
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(Job(job).state, JobState::kQueued);
  EXPECT_TRUE(Job(job).held);
}

// Of a host of a later version, perhaps.
TEST_F(QueueInTrouble, ABlockerThatNobodyKnowsBlocks) {
  v1::MachineStatus status = Idle();
  Block(status, "NEW-E1");
  Tell(status);
  const std::int64_t job = Submit([](v1::Job& asked) { asked.mutable_run()->set_unzeroed(true); });
  LookAtMill();
  EXPECT_TRUE(Orders().empty());
  EXPECT_EQ(Job(job).state, JobState::kQueued);
}

TEST_F(QueueInTrouble, ASimulationThatIsNotKeptHasNoBlock) {
  v1::Job run;
  run.mutable_run()->set_ticket("jobs/99");
  const storage::SubmittedJob made = Must(bed.store().SubmitAndWait(
      {.machine = "optimo-1", .kind = "RUN", .specification = run.SerializeAsString()}));
  EXPECT_FALSE(others.MillingOf(made.job.id));
}

}  // namespace
}  // namespace rmlcell::server
