// Runs of which it is not known whether they began, what is left of one that did not, and what a
// host is not told (live.md 5.01 to 5.10).
#include <atomic>

#include "engine/machine/machine_note.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/runs/run_queue_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

// A store that for a while does not say which attempts a job had, or says that the last one is over
// by now. Thread-safe.
class SilentAttempts final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<bool> silent = false;
  std::atomic<bool> over = false;

  Result<std::vector<storage::AttemptRecord>> ListAttempts(std::int64_t job) override {
    if (silent) return Error{ErrorCode::kCellStoreFailed, "the line broke", {}};
    auto attempts = store_.ListAttempts(job);
    if (over && attempts && !attempts->empty())
      attempts->back().ended_at = attempts->back().started_at;
    return attempts;
  }
};

// The queue looks when the test says so, and not by itself.
class DoubtfulRuns : public RunQueueTest {
 protected:
  using Answer = Result<v1::HostOrderAnswer>;

  void SetUp() override {
    RunQueueTest::SetUp();
    hosts.OnNews({});
    book.OnRunWaits({});
  }
  void LookAt(const std::string& machine, RunQueue& queue) {
    queue.Wake(machine);
    Settle();
  }
  std::size_t OrdersAfter(std::chrono::milliseconds time, RunQueue& queue) {
    clock.Advance(time);
    LookAt("mill-1", queue);
    return Orders().size();
  }
  static std::future<Answer> Begin(RunQueue& queue, std::int64_t job) {
    const auto answered = std::make_shared<std::promise<Answer>>();
    queue.BeginByPerson(job, RunJob(),
                        [answered](Answer answer) { answered->set_value(std::move(answer)); });
    return answered->get_future();
  }
  static std::vector<std::string> Codes(const v1::Job& job) {
    std::vector<std::string> codes;
    for (const v1::StartBlocker& one : job.start_blockers()) codes.push_back(one.code());
    return codes;
  }
  static void AtStep(v1::Job& job) { job.mutable_run()->mutable_step()->set_step(2); }

  SilentAttempts store{bed.store()};
  RunQueue others{{.store = store,
                   .hosts = hosts,
                   .config = config,
                   .executor = *executor,
                   .server = "this server",
                   .clock = clock.clock()}};
};

// A host is asked when all that was before it is in the store: the end of the job may be among it.
TEST_F(DoubtfulRuns, AHostThatHasNotSaidAllIsNotAsked) {
  Tell(Idle());
  const std::int64_t job = Submit();
  LookAt("mill-1", runs);
  Accept(NewestOrder(1));
  Settle();
  EXPECT_EQ(OrdersAfter(RunQueue::kUnheardOf, runs), 1U);
  Mark();
  Settle();
  EXPECT_EQ(OrdersAfter(RunQueue::kUnheardOf, runs), 2U);
  EXPECT_TRUE(Orders().back().has_run_state());
  EXPECT_EQ(Orders().back().for_job(), JobName(job));
}

// Nor of a job that another host was given: it knows nothing of that.
TEST_F(DoubtfulRuns, AHostIsNotAskedForTheJobOfAnother) {
  Tell(Idle());
  Mark();
  const std::int64_t job = Submit();
  const auto leased = Must(bed.store().AcquireJobs(
      {.worker = "hall/9", .kinds = {"RUN"}, .job = job, .duration = std::chrono::hours(1)}));
  ASSERT_EQ(leased.size(), 1U);
  EXPECT_EQ(OrdersAfter(std::chrono::milliseconds(0), runs), 0U);
  EXPECT_EQ(OrdersAfter(RunQueue::kUnheardOf, runs), 0U);
  EXPECT_EQ(Job(job).state, JobState::kRunning);
}

// Nothing is concluded from a store that does not say which attempt runs.
TEST_F(DoubtfulRuns, NothingIsAskedWhileTheAttemptIsNotKnown) {
  Tell(Idle());
  Mark();
  const std::int64_t job = Submit();
  LookAt("mill-1", others);
  Accept(NewestOrder(1));
  Settle();
  store.silent = true;
  EXPECT_EQ(OrdersAfter(RunQueue::kUnheardOf, others), 1U);
  store.silent = false;
  EXPECT_EQ(OrdersAfter(std::chrono::milliseconds(0), others), 2U);
  EXPECT_EQ(Orders().back().for_job(), JobName(job));
}

// Nor of an attempt that was over between the look at the job and the look at that.
TEST_F(DoubtfulRuns, AnAttemptThatIsOverIsNotAskedFor) {
  Tell(Idle());
  Mark();
  Submit();
  LookAt("mill-1", others);
  Accept(NewestOrder(1));
  Settle();
  store.over = true;
  EXPECT_EQ(OrdersAfter(std::chrono::milliseconds(0), others), 1U);
  EXPECT_EQ(OrdersAfter(RunQueue::kUnheardOf, others), 1U);
}

// Nor is anything concluded from a line that breaks before its host has answered.
TEST_F(DoubtfulRuns, AQuestionWithoutAnAnswerSaysNothing) {
  Tell(Idle());
  Mark();
  const std::int64_t job = Submit();
  LookAt("mill-1", runs);
  Accept(NewestOrder(1));
  Settle();
  ASSERT_EQ(OrdersAfter(RunQueue::kUnheardOf, runs), 2U);
  ASSERT_TRUE(Orders().back().has_run_state());
  hosts.Leave(*link);
  Settle();
  EXPECT_EQ(Job(job).state, JobState::kRunning);
  EXPECT_EQ(Job(job).attempts, 1);
}

// LIVE-2.05: what is not known to be this server's any more does not begin.
TEST_F(DoubtfulRuns, AJobWhoseAttemptIsNotKnownDoesNotBeginAtItsStep) {
  TellBlocked();
  const std::int64_t job = Submit(AtStep);
  auto answered = Begin(others, job);
  const v1::HostOrder question = NewestOrder(1);
  ASSERT_TRUE(question.has_preview_start());
  store.silent = true;
  Look(question, "a token");
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(CodeOf(answered.get()), ErrorCode::kCellLeaseLost);
  store.silent = false;
  EXPECT_EQ(Orders().size(), 1U);
}

// LIVE-2.05: whoever began a job that is cancelled while its step is looked at hears that it was.
TEST_F(DoubtfulRuns, AJobThatIsCancelledMeanwhileSaysSo) {
  TellBlocked();
  const std::int64_t job = Submit(AtStep);
  auto answered = Begin(runs, job);
  const v1::HostOrder question = NewestOrder(1);
  ASSERT_TRUE(question.has_preview_start());
  Must(bed.store().RequestCancel(job, {}));
  Look(question, "a token");
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  const Answer answer = answered.get();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kCellCancelled);
  EXPECT_EQ(answer.error().detail, JobName(job) + " was cancelled");
  EXPECT_EQ(Job(job).state, JobState::kCancelled);
  EXPECT_EQ(Orders().size(), 1U);
}

// RunQueue::MachineOf: of a job that is about to begin, and no longer than that.
TEST_F(DoubtfulRuns, AJobThatWasRefusedIsAtNoMachine) {
  Tell(Idle());
  const std::int64_t at_step = Submit(AtStep);
  LookAt("mill-1", runs);
  const v1::HostOrder question = NewestOrder(1);
  EXPECT_EQ(runs.MachineOf(JobName(at_step)), "mill-1");
  Look(question, "", "CELL-E9426");
  EXPECT_TRUE(Eventually([&] { return Job(at_step).state == JobState::kFailed; }));
  EXPECT_EQ(runs.MachineOf(JobName(at_step)), "");
  const std::int64_t job = Submit();
  LookAt("mill-1", runs);
  const v1::HostOrder order = NewestOrder(2);
  EXPECT_EQ(runs.MachineOf(JobName(job)), "mill-1");
  Refuse(order, "OPT-E7102");
  EXPECT_TRUE(Eventually([&] { return Job(job).state == JobState::kFailed; }));
  EXPECT_EQ(runs.MachineOf(JobName(job)), "");
}

// A cancel that came while a person's order was on its way reaches the run with the answer: what
// the host told before that was looked at by nobody.
TEST_F(DoubtfulRuns, ACancelOfWhatAPersonBeganIsHandedOn) {
  TellBlocked();
  const std::int64_t job = Submit();
  auto answered = Begin(runs, job);
  const v1::HostOrder order = NewestOrder(1);
  ASSERT_TRUE(order.has_run_job());
  Must(bed.store().RequestCancel(job, {}));
  v1::MachineStatus running = Idle();
  running.set_state(v1::MACHINE_STATE_RUNNING);
  running.mutable_run()->set_job(JobName(job));
  Tell(running);
  Settle();
  EXPECT_EQ(Orders().size(), 1U);
  Accept(order);
  ASSERT_EQ(answered.wait_for(kPatience), std::future_status::ready);
  const v1::HostOrder abort = NewestOrder(2);
  EXPECT_TRUE(abort.has_abort());
  EXPECT_EQ(abort.for_job(), JobName(job));
}

// LIVE-5.02, LIVE-5.10: where it goes on a person has looked at what it does: it needs no ticket,
// and is not said to end for one.
TEST_F(DoubtfulRuns, ARunThatGoesOnIsNotToldOfItsTicket) {
  const std::int64_t check = bed.SubmitCheck();
  Must(bed.store().Finish(bed.Lease(), {.outcome = {.state = JobState::kSucceeded}}));
  TellBlocked();
  const std::int64_t first =
      Submit([check](v1::Job& asked) { asked.mutable_run()->set_ticket(JobName(check)); });
  EXPECT_THAT(Codes(Must(book.Get(JobName(first)))), ElementsAre("CELL-E9407", "CELL-E9423"));
  std::promise<Result<v1::Job>> again;
  book.Again(JobName(first), "bert", "a request", true,
             [&](Result<v1::Job> made) { again.set_value(std::move(made)); });
  const v1::Job goes_on = Must(again.get_future().get());
  EXPECT_EQ(goes_on.run().ticket(), JobName(check));
  EXPECT_THAT(Codes(goes_on), ElementsAre("CELL-E9423"));
}

// The host knows how its machine stands and which of its programs were deleted.
TEST_F(DoubtfulRuns, WhatAMachineWasIsNotSentWithAJob) {
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 9, .object = "an object"}}, {}));
  Must(bed.store().DeleteProgram("optimo-1", 9, storage::kAnyRevision));
  const storage::MachineLease before = Must(bed.store().TakeMachine(
      {.machine = "optimo-1", .host = "hall/2", .duration = std::chrono::seconds(60)}));
  const std::string stands = machine::WriteMachineNote({.family = "how it stands"});
  Must(bed.store().AppendMachine(before,
                                 {.mark = storage::MachineMark{.sequence = 1, .state = stands}}));
  Must(bed.store().ReleaseMachine(before));
  const auto other = std::make_shared<FakeLink>();
  v1::HostHello hello = Hello();
  hello.set_machine("machines/optimo-1");
  hello.set_host("hall/2");
  ASSERT_TRUE(hosts.Join(other, hello));
  v1::HostRequest request;
  *request.mutable_status() = Idle();
  request.mutable_status()->set_machine("machines/optimo-1");
  request.mutable_status()->set_host("hall/2");
  hosts.Receive(*other, std::move(request));
  Submit([](v1::Job& asked) {
    asked.set_machine("machines/optimo-1");
    asked.mutable_inline_program()->set_file_name("a.S");
    asked.mutable_inline_program()->set_content("STOP\n");
  });
  LookAt("optimo-1", runs);
  const auto sent = other->Newest(v1::HostResponse::kOrder);
  ASSERT_TRUE(sent);
  const v1::WorkerAssignment& assignment = sent->order().run_job();
  EXPECT_EQ(assignment.programs_size(), 1);
  EXPECT_EQ(assignment.machine_state(), "");
  EXPECT_TRUE(assignment.deleted_programs().empty());
}

}  // namespace
}  // namespace rmlcell::server
