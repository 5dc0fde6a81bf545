// A machine that something comes of while it is looked at (live.md 5.04).
#include "tests/server/forwarding_store.h"
#include "tests/server/runs/run_queue_bed.h"

namespace rmlcell::server {
namespace {

// Does something once, between what the queue read and what it makes of it.
class ReadQueueStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::function<void()> when_read;

  Result<std::vector<storage::JobRecord>> ListJobs(const storage::JobQuery& query) override {
    auto read = store_.ListJobs(query);
    if (query.state == JobState::kQueued) {
      if (const auto act = std::exchange(when_read, {})) act();
    }
    return read;
  }
};

class LookedAtAgain : public RunQueueTest {
 protected:
  void SetUp() override {
    RunQueueTest::SetUp();
    hosts.OnNews({});
    book.OnRunWaits([this](const std::string& machine) { others.Wake(machine); });
  }

  ReadQueueStore store{bed.store()};
  RunQueue others{{.store = store,
                   .hosts = hosts,
                   .config = config,
                   .executor = *executor,
                   .server = "this server",
                   .clock = clock.clock()}};
};

// A job that comes just when it was read that none waits begins all the same.
TEST_F(LookedAtAgain, AJobThatComesMeanwhileBegins) {
  Tell(Idle());
  std::int64_t job = 0;
  store.when_read = [this, &job] { job = Submit(); };
  others.Wake("mill-1");
  const v1::HostOrder order = NewestOrder(1);
  Settle();
  EXPECT_EQ(order.run_job().job().name(), JobName(job));
  EXPECT_EQ(Job(job).state, JobState::kRunning);
}

// A host that was asked is asked again a while later, and not with each look.
TEST_F(RunQueueTest, AHostIsAskedOnceInAWhile) {
  Tell(Idle());
  Mark();
  const std::int64_t job = Submit();
  Accept(NewestOrder(1));
  const auto orders_after = [this](std::chrono::milliseconds time) {
    clock.Advance(time);
    runs.WakeAll();
    Settle();
    return Orders().size();
  };
  EXPECT_EQ(orders_after(std::chrono::milliseconds(0)), 1U);
  EXPECT_EQ(orders_after(RunQueue::kUnheardOf), 2U);
  EXPECT_TRUE(Orders().back().has_run_state());
  EXPECT_EQ(Orders().back().for_job(), JobName(job));
  EXPECT_EQ(orders_after(std::chrono::milliseconds(0)), 2U);
  EXPECT_EQ(orders_after(RunQueue::kUnheardOf - std::chrono::milliseconds(1)), 2U);
  EXPECT_EQ(orders_after(std::chrono::milliseconds(1)), 3U);
}

// LIVE-2.05: one that was taken away and given anew while its step was looked at begins as the new
// one alone.
TEST_F(RunQueueTest, WhatIsGivenAnewMeanwhileDoesNotBeginTwice) {
  v1::MachineStatus status = Idle();
  Block(status, "CELL-E9423");
  Tell(status);
  const std::int64_t job =
      Submit([](v1::Job& asked) { asked.mutable_run()->mutable_step()->set_step(2); });
  std::promise<Result<v1::HostOrderAnswer>> answered;
  v1::HostOrder run;
  run.mutable_run_job();
  runs.BeginByPerson(job, std::move(run), [&answered](Result<v1::HostOrderAnswer> answer) {
    answered.set_value(std::move(answer));
  });
  const v1::HostOrder question = NewestOrder(1);
  ASSERT_TRUE(question.has_preview_start());
  const storage::AttemptRecord attempt = Must(bed.store().ListAttempts(job)).back();
  storage::LossPolicy policy = LossOf(StoppedOutcome(), {}, "taken away");
  policy.not_begun = true;
  Must(bed.store().HandBack(
      {.job = job, .attempt = attempt.number, .fence = attempt.fence, .worker = attempt.worker},
      policy));
  ASSERT_EQ(Must(bed.store().AcquireJobs({.worker = "hall/1",
                                          .kinds = {"RUN"},
                                          .job = job,
                                          .duration = std::chrono::hours(1)}))
                .size(),
            1U);
  Look(question, "a token");
  const auto answer = answered.get_future().get();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kCellLeaseLost);
  EXPECT_EQ(Orders().size(), 1U);
}

// An order for a job that nobody runs says so.
TEST_F(RunQueueTest, AnOrderForNobodySaysWhoIsMissing) {
  std::string why;
  runs.Ask("jobs/6", {}, [&why](const Result<v1::HostOrderAnswer>& answer) {
    why = answer ? "answered" : std::string(answer.error().detail);
  });
  EXPECT_EQ(why, "no machine is heard of that runs jobs/6");
}

}  // namespace
}  // namespace rmlcell::server
