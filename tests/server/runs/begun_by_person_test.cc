// RUN jobs that a person begins (live.md 5.20): what they wait for, and what becomes of a refusal.
#include "tests/server/runs/run_queue_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class BegunByPersonTest : public RunQueueTest {
 protected:
  using Answer = Result<v1::HostOrderAnswer>;
  std::future<Answer> Begin(std::int64_t job, v1::HostOrder order = RunJob()) {
    const auto answered = std::make_shared<std::promise<Answer>>();
    runs.BeginByPerson(job, std::move(order),
                       [answered](Answer answer) { answered->set_value(std::move(answer)); });
    return answered->get_future();
  }
  // "CELL-E9004 why"; empty: it is not refused.
  std::string Refused(std::int64_t job, v1::HostOrder order = RunJob()) {
    auto answered = Begin(job, std::move(order));
    if (answered.wait_for(kPatience) != std::future_status::ready) return "no answer";
    const Answer answer = answered.get();
    if (!answer) return CodeText(answer.error().code) + " " + std::string(answer.error().detail);
    return answer->has_refusal() ? answer->refusal().code() : "";
  }
  std::int64_t SubmitAtOptimo() {
    return Submit([](v1::Job& job) {
      job.set_machine("machines/optimo-1");
      job.mutable_inline_program()->set_file_name("a.S");
      job.mutable_inline_program()->set_content("STOP\n");
    });
  }
};

// LIVE-5.04: a RUN that waits, on a machine that is heard of.
TEST_F(BegunByPersonTest, WhatCannotBeBegunWaitsOn) {
  TellBlocked();
  EXPECT_THAT(Refused(99), HasSubstr("CELL-E9004"));
  const std::int64_t check = bed.SubmitCheck();
  EXPECT_EQ(Refused(check), "CELL-E9015 " + JobName(check) + " is no RUN");
  const std::int64_t elsewhere = SubmitAtOptimo();
  EXPECT_EQ(Refused(elsewhere), "CELL-E9424 optimo-1 has no host");
  EXPECT_EQ(Job(elsewhere).state, JobState::kQueued);
  // LIVE-5.10: one that was to go on is over then: where it goes on is decided again.
  EXPECT_EQ(Refused(elsewhere, ContinueJob()), "CELL-E9424 optimo-1 has no host");
  EXPECT_EQ(Job(elsewhere).state, JobState::kCancelled);
  EXPECT_EQ(Refused(elsewhere), "CELL-E9015 " + JobName(elsewhere) + " waits no more");
  v1::Job goes_on;
  goes_on.set_continues("jobs/1");
  const std::int64_t continued =
      Must(bed.store().SubmitAndWait(
               {.machine = "mill-1", .kind = "RUN", .specification = goes_on.SerializeAsString()}))
          .job.id;
  EXPECT_EQ(Refused(continued), "CELL-E9428 decide again where it goes on");
  EXPECT_EQ(Job(continued).state, JobState::kQueued);
  EXPECT_TRUE(Orders().empty());
  // The queue does not begin it either.
  Tell(Idle());
  EXPECT_TRUE(Eventually([&] { return Job(continued).state == JobState::kFailed; }));
  EXPECT_EQ(Job(continued).outcome->code, ErrorCode::kCellPreviewStale);
  EXPECT_EQ(Job(continued).outcome->detail, "decide again where it goes on");
}

// One that runs is begun already; of one that has failed its reason is told, where it is ours.
TEST_F(BegunByPersonTest, WhatDoesNotWaitIsToldAsItIs) {
  Tell(Idle());
  const std::int64_t refused = Submit();
  Refuse(NewestOrder(1), "CELL-E9407");
  EXPECT_TRUE(Eventually([&] { return Job(refused).state == JobState::kFailed; }));
  EXPECT_EQ(Refused(refused), "CELL-E9407 why");
  const std::int64_t failed = Submit();
  Refuse(NewestOrder(2), "OPT-E7102");
  EXPECT_TRUE(Eventually([&] { return Job(failed).state == JobState::kFailed; }));
  EXPECT_EQ(Refused(failed), "CELL-E9015 " + JobName(failed) + " waits no more");
  const std::int64_t running = Submit();
  Accept(NewestOrder(3));
  auto answered = Begin(running);
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  const Answer answer = answered.get();
  ASSERT_TRUE(answer);
  EXPECT_FALSE(answer->has_refusal());
  EXPECT_EQ(answer->status().machine(), "machines/mill-1");
  EXPECT_EQ(Orders().size(), 3U);
  // While it runs no other one begins, and that waits on.
  const std::int64_t second = Submit();
  EXPECT_EQ(Refused(second), "CELL-E9421 another job runs on mill-1");
  EXPECT_EQ(Job(second).state, JobState::kQueued);
}

// LIVE-5.04: it goes out with its program; where its machine refuses it, it waits again, held where
// the queue would begin it by itself.
TEST_F(BegunByPersonTest, AJobThatIsRefusedWaitsAgain) {
  TellBlocked();
  const std::int64_t job = Submit();
  auto answered = Begin(job);
  const v1::HostOrder order = NewestOrder(1);
  EXPECT_EQ(order.caller(), "bert");
  EXPECT_EQ(order.run_job().job().name(), JobName(job));
  EXPECT_EQ(order.run_job().programs(0).content(), "PA;PU100,0;");
  EXPECT_EQ(Job(job).state, JobState::kRunning);
  Refuse(order, "CELL-E9420");
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(answered.get()->refusal().code(), "CELL-E9420");
  EXPECT_EQ(Job(job).state, JobState::kQueued);
  EXPECT_TRUE(Job(job).held);
  // Where a person starts each job there is nobody else to hold it from.
  storage::MachineRecord mill = Must(bed.store().GetMachine("mill-1"));
  v1::MachineOptions options;
  options.set_start(v1::MachineOptions::START_PERSON);
  mill.options = BytesOf(options);
  Must(bed.store().PutMachine(mill, mill.revision, "anna"));
  const std::int64_t next = Submit();
  answered = Begin(next);
  Refuse(NewestOrder(2), "CELL-E9420");
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(Job(next).state, JobState::kQueued);
  EXPECT_FALSE(Job(next).held);
  answered = Begin(next);
  Accept(NewestOrder(3));
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  EXPECT_FALSE(answered.get()->has_refusal());
  EXPECT_EQ(Job(next).state, JobState::kRunning);
}

// LIVE-5.10: one that was to go on has ended with why it does not.
TEST_F(BegunByPersonTest, AJobThatMayNotGoOnEnds) {
  TellBlocked();
  const std::int64_t job = Submit();
  auto answered = Begin(job, ContinueJob());
  const v1::HostOrder order = NewestOrder(1);
  ASSERT_TRUE(order.has_continue_job());
  EXPECT_EQ(order.continue_job().start().preview_token(), "a token");
  EXPECT_EQ(order.continue_job().assignment().job().name(), JobName(job));
  Refuse(order, "CELL-E9426");
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(answered.get()->refusal().code(), "CELL-E9426");
  EXPECT_EQ(Job(job).state, JobState::kFailed);
  EXPECT_EQ(Job(job).outcome->code, ErrorCode::kCellStepUnreachable);
  EXPECT_EQ(Job(job).outcome->detail, "why");
}

// LIVE-2.05: one that somebody took away while its step was looked at does not begin.
TEST_F(BegunByPersonTest, AJobThatIsTakenAwayMeanwhileDoesNotBegin) {
  TellBlocked();
  const std::int64_t job =
      Submit([](v1::Job& asked) { asked.mutable_run()->mutable_step()->set_step(2); });
  auto answered = Begin(job);
  const v1::HostOrder question = NewestOrder(1);
  ASSERT_TRUE(question.has_preview_start());
  const storage::AttemptRecord attempt = Must(bed.store().ListAttempts(job)).back();
  Must(bed.store().Finish(
      {.job = job, .attempt = attempt.number, .fence = attempt.fence, .worker = attempt.worker},
      {.outcome = {.state = JobState::kFailed}}));
  Look(question, "a token");
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  const Answer answer = answered.get();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kCellLeaseLost);
  EXPECT_EQ(answer.error().detail, JobName(job) + " was taken away");
}

}  // namespace
}  // namespace rmlcell::server
