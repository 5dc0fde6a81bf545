// RUN jobs on their way to the host of their machine, which is a line of the test (live.md 5).
#include "server/runs/run_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "proto/bridge/milling.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "server/records/machine_options.h"
#include "tests/server/runs/run_queue_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;
using testing::HasSubstr;

// LIVE-6.03, LIVE-6.08: one that begins at a step is looked at first, and then begins there with
// what somebody has seen to.
TEST_F(RunQueueTest, AJobThatBeginsAtAStepIsLookedAtFirst) {
  Tell(Idle());
  const std::int64_t job = Submit([](v1::Job& asked) {
    asked.set_inline_slot(7);
    asked.mutable_run()->mutable_step()->set_step(2);
    asked.mutable_run()->add_confirmations(v1::CONFIRMATION_TOOL);
  });
  const v1::HostOrder question = NewestOrder(1);
  ASSERT_TRUE(question.has_preview_start());
  EXPECT_EQ(question.preview_start().program(), 7);
  EXPECT_EQ(question.preview_start().step().step(), 2);
  EXPECT_EQ(question.brought().slot(), 7);
  EXPECT_EQ(question.brought().content(), "PA;PU100,0;");
  EXPECT_EQ(question.caller(), "anna");
  EXPECT_EQ(runs.MachineOf(JobName(job)), "mill-1");
  Look(question, "a token");
  const v1::HostOrder order = NewestOrder(2);
  ASSERT_TRUE(order.has_continue_job());
  EXPECT_EQ(order.continue_job().assignment().job().name(), JobName(job));
  EXPECT_EQ(order.continue_job().start().preview_token(), "a token");
  ASSERT_EQ(order.continue_job().start().confirmations_size(), 1);
  EXPECT_EQ(order.continue_job().start().confirmations(0), v1::CONFIRMATION_TOOL);
  Accept(order);
  Settle();
  EXPECT_EQ(Job(job).state, JobState::kRunning);
}

// LIVE-6.04, LIVE-6.08: where it may not begin there it ends before anything moves; where somebody
// looked at another start meanwhile it waits, and is looked at again.
TEST_F(RunQueueTest, AJobThatMayNotBeginAtItsStepEnds) {
  const auto at = [](v1::Job& asked) { asked.mutable_run()->mutable_step()->set_step(2); };
  Tell(Idle());
  const std::int64_t refused = Submit(at);
  Look(NewestOrder(1), "", "CELL-E9426");
  EXPECT_TRUE(Eventually([&] { return Job(refused).state == JobState::kFailed; }));
  EXPECT_EQ(Job(refused).outcome->code, ErrorCode::kCellStepUnreachable);
  const std::int64_t unseen = Submit(at);
  {
    v1::HostRequest request;
    request.mutable_answer()->set_number(NewestOrder(2).number());
    v1::PreviewStartResponse& preview = *request.mutable_answer()->mutable_preview();
    preview.set_preview_token("a token");
    v1::StartDifference& tool = *preview.add_differences();
    tool.set_item("tool");
    tool.set_action(v1::START_ACTION_ASK);
    tool.set_confirmation(v1::CONFIRMATION_TOOL);
    hosts.Receive(*link, std::move(request));
  }
  EXPECT_TRUE(Eventually([&] { return Job(unseen).state == JobState::kFailed; }));
  EXPECT_THAT(Job(unseen).outcome->detail, HasSubstr("nobody has seen to tool"));
  const std::int64_t waits = Submit(at);
  Look(NewestOrder(3), "a token");
  Refuse(NewestOrder(4), "CELL-E9428");
  EXPECT_TRUE(Eventually([&] { return Job(waits).state == JobState::kQueued; }));
  EXPECT_FALSE(Job(waits).blocked);
  clock.Advance(RunQueue::kRests);
  runs.WakeAll();
  EXPECT_TRUE(NewestOrder(5).has_preview_start());
}

// LIVE-2.05: a job that is cancelled while its step is looked at does not begin; one that finds the
// host looking at another start waits.
TEST_F(RunQueueTest, WhatIsStoppedWhileItsStepIsLookedAtDoesNotBegin) {
  const auto at = [](v1::Job& asked) { asked.mutable_run()->mutable_step()->set_step(2); };
  Tell(Idle());
  const std::int64_t cancelled = Submit(at);
  const v1::HostOrder question = NewestOrder(1);
  EXPECT_EQ(question.for_job(), JobName(cancelled));
  ASSERT_TRUE(bed.store().RequestCancel(cancelled, {}));
  Look(question, "a token");
  EXPECT_TRUE(Eventually([&] { return Job(cancelled).state == JobState::kCancelled; }));
  for (const v1::HostOrder& order : Orders()) EXPECT_FALSE(order.has_continue_job());
  const std::int64_t waits = Submit(at);
  EXPECT_TRUE(Eventually([&] { return Orders().back().for_job() == JobName(waits); }));
  Refuse(Orders().back(), "CELL-E9002");
  EXPECT_TRUE(Eventually([&] { return Job(waits).state == JobState::kQueued; }));
  EXPECT_FALSE(Job(waits).blocked);
}

// LIVE-5.01, LIVE-5.04: it goes to its host as soon as that can begin it, and is RUNNING in the
// store before; one at a time.
TEST_F(RunQueueTest, AJobGoesToTheHostOfItsMachine) {
  const std::int64_t job = Submit();
  const std::int64_t second = Submit();
  Settle();
  EXPECT_TRUE(Orders().empty()) << "nothing is known of the machine";
  Tell(Idle());
  const v1::HostOrder order = NewestOrder(1);
  ASSERT_TRUE(order.has_run_job());
  EXPECT_EQ(Job(job).state, JobState::kRunning);
  EXPECT_EQ(order.caller(), "anna");
  EXPECT_EQ(order.run_job().job().name(), JobName(job));
  ASSERT_EQ(order.run_job().programs_size(), 1);
  EXPECT_EQ(order.run_job().programs(0).content(), "PA;PU100,0;");
  EXPECT_EQ(order.run_job().main_program(), order.run_job().programs(0).slot());
  Accept(order);
  v1::MachineStatus running = Idle();
  running.set_state(v1::MACHINE_STATE_RUNNING);
  running.mutable_run()->set_job(JobName(job));
  Tell(running);
  clock.Advance(std::chrono::minutes(5));
  runs.WakeAll();
  Settle();
  EXPECT_EQ(Orders().size(), 1U);
  EXPECT_EQ(Job(second).state, JobState::kQueued);
  EXPECT_EQ(ToProto(Job(second)).wait_reason(), v1::WAIT_REASON_MACHINE_BUSY);
  EXPECT_EQ(runs.MachineOf(JobName(job)), "mill-1");
  EXPECT_EQ(runs.MachineOf(JobName(second)), "");
}

// LIVE-5.02 (a): it waits while the machine says that it cannot start, but for what its submitter
// himself is.
TEST_F(RunQueueTest, AJobWaitsUntilItsMachineCanStart) {
  v1::MachineStatus status = Idle();
  Block(status, "CELL-E9423");
  Tell(status);
  const std::int64_t job = Submit();
  Settle();
  EXPECT_TRUE(Orders().empty());
  EXPECT_EQ(Job(job).state, JobState::kQueued);
  const v1::Job told = Must(book.Get(JobName(job)));
  EXPECT_EQ(told.wait_reason(), v1::WAIT_REASON_MACHINE_NOT_READY);
  EXPECT_EQ(told.waits_for(), "machines/mill-1");
  status = Idle();
  Block(status, "CELL-E9408");
  status.mutable_control()->set_holder("bert");
  Block(status, "CELL-E9433");
  Tell(status);
  Settle();
  EXPECT_TRUE(Orders().empty());
  status.clear_start_blockers();
  Block(status, "CELL-E9408");
  Tell(status);
  Settle();
  EXPECT_TRUE(Orders().empty());
  status.mutable_control()->set_holder("anna");
  Tell(status);
  runs.WakeAll();
  EXPECT_TRUE(NewestOrder(1).has_run_job());
}

// LIVE-5.02, LIVE-4.05: at submit and whenever it is asked for it tells all that keeps it waiting,
// and who has control.
TEST_F(RunQueueTest, AJobThatWaitsTellsWhy) {
  const auto codes = [](const v1::Job& job) {
    std::vector<std::string> told;
    for (const v1::StartBlocker& one : job.start_blockers()) told.push_back(one.code());
    return told;
  };
  v1::MachineStatus status = Idle();
  Block(status, "CELL-E9423");
  Block(status, "CELL-E9433");
  Block(status, "CELL-E9408");
  status.mutable_control()->set_holder("bert");
  Tell(status);
  v1::SubmitJobRequest request;
  request.mutable_job()->set_kind(v1::JOB_KIND_RUN);
  request.mutable_job()->set_machine("machines/mill-1");
  request.mutable_job()->mutable_inline_program()->set_file_name("a.rml");
  request.mutable_job()->mutable_inline_program()->set_content("PA;PU100,0;");
  request.mutable_job()->add_start_blockers()->set_code("of the client");
  std::promise<v1::Job> submitted;
  book.Submit(request, "anna", [&](Result<v1::Job> made) { submitted.set_value(*made); });
  const v1::Job job = submitted.get_future().get();
  EXPECT_THAT(codes(job), testing::ElementsAre("CELL-E9423", "CELL-E9433", "CELL-E9408"));
  EXPECT_EQ(job.wait_reason(), v1::WAIT_REASON_CONTROL);
  EXPECT_EQ(job.waits_for(), "control: bert");
  const v1::Job asked = Must(book.Get(job.name()));
  EXPECT_THAT(codes(asked), testing::ElementsAre("CELL-E9423", "CELL-E9433", "CELL-E9408"));
  EXPECT_EQ(asked.waits_for(), "control: bert");

  // It is told also where something else keeps it first.
  Must(book.HoldBack(job.name(), "anna"));
  EXPECT_EQ(codes(Must(book.Get(job.name()))).size(), 3U);
  EXPECT_EQ(Must(book.Get(job.name())).wait_reason(), v1::WAIT_REASON_HELD);
  Must(book.LetGo(job.name(), "anna"));
  // His own control does not keep it.
  status.mutable_control()->set_holder("anna");
  Tell(status);
  EXPECT_THAT(codes(Must(book.Get(job.name()))), testing::ElementsAre("CELL-E9423", "CELL-E9433"));
  EXPECT_EQ(Must(book.Get(job.name())).wait_reason(), v1::WAIT_REASON_MACHINE_NOT_READY);
  status = Idle();
  status.set_armed_for("jobs/99");
  Tell(status);
  EXPECT_THAT(codes(Must(book.Get(job.name()))), testing::ElementsAre("CELL-E9406"));
  status = Idle();
  status.set_state(v1::MACHINE_STATE_LOST);
  Tell(status);
  EXPECT_THAT(codes(Must(book.Get(job.name()))), testing::ElementsAre("CELL-E9424"));
  Tell(Idle());
  Accept(NewestOrder(1));
  Settle();
  EXPECT_THAT(codes(Must(book.Get(job.name()))), testing::IsEmpty());
}

// LIVE-5.02: axes without reference keep it waiting, unless its program zeroes them itself.
TEST_F(RunQueueTest, AMachineWithoutReferenceTakesJobsThatZeroIt) {
  v1::MachineStatus status = Idle();
  status.set_state(v1::MACHINE_STATE_NOT_ZEROED);
  status.set_zeroed(false);
  Block(status, "OPT-E7310");
  Tell(status);
  const std::int64_t job = Submit();
  Settle();
  EXPECT_TRUE(Orders().empty());
  Must(bed.store().RequestCancel(job, {}));
  const std::int64_t zeroes = Submit([](v1::Job& made) { made.mutable_run()->set_unzeroed(true); });
  EXPECT_EQ(NewestOrder(1).run_job().job().name(), JobName(zeroes));
  EXPECT_TRUE(NewestOrder(1).run_job().job().run().unzeroed());
}

// LIVE-5.02 (b): what another try does not mend ends it before anything moves.
TEST_F(RunQueueTest, AJobThatCannotBeginFails) {
  Tell(Idle());
  const std::int64_t job = Submit();
  Refuse(NewestOrder(1), "OPT-E7102");
  EXPECT_TRUE(Eventually([&] { return Job(job).state == JobState::kFailed; }));
  EXPECT_EQ(CodeText(*Job(job).outcome->code), "OPT-E7102");
  EXPECT_EQ(Job(job).outcome->detail, "why");
}

// What another try may mend sends it back to the queue, and the machine is left alone for a while.
TEST_F(RunQueueTest, AJobThatCannotBeginNowWaitsAgain) {
  Tell(Idle());
  const std::int64_t job = Submit();
  Refuse(NewestOrder(1), "CELL-E9429");
  EXPECT_TRUE(Eventually([&] { return Job(job).state == JobState::kQueued; }));
  EXPECT_FALSE(Job(job).held);
  EXPECT_EQ(Job(job).attempts, 0);
  runs.WakeAll();
  Settle();
  EXPECT_EQ(Orders().size(), 1U);
  clock.Advance(RunQueue::kRests);
  runs.WakeAll();
  EXPECT_TRUE(NewestOrder(2).has_run_job());
}

// LIVE-2.05: somebody stopped the machine at that moment; it does not begin by itself a moment
// later.
TEST_F(RunQueueTest, AJobThatWasStoppedBeforeItBeganIsHeld) {
  Tell(Idle());
  const std::int64_t job = Submit();
  Refuse(NewestOrder(1), "CELL-E9421");
  EXPECT_TRUE(Eventually([&] { return Job(job).state == JobState::kQueued && Job(job).held; }));
  clock.Advance(std::chrono::minutes(1));
  runs.WakeAll();
  Settle();
  EXPECT_EQ(Orders().size(), 1U);
  Must(book.LetGo(JobName(job), "bert"));
  EXPECT_TRUE(NewestOrder(2).has_run_job());
}

// An order that got lost on its way: the machine stands and speaks of no job. Its host is asked,
// and what it does not know never began; nothing is concluded from silence.
TEST_F(RunQueueTest, AJobThatItsHostNeverHeardOfWaitsAgain) {
  Tell(Idle());
  Mark();
  const std::int64_t job = Submit();
  NewestOrder(1);
  const auto look = [&] {
    runs.WakeAll();
    Settle();
  };
  look();
  clock.Advance(RunQueue::kUnheardOf);
  look();
  look();
  EXPECT_EQ(Orders().size(), 1U) << "its order may still be answered";
  clock.Advance(Hosts::kAnswerPatience);
  v1::HostRequest beat;
  beat.mutable_heartbeat();
  hosts.Receive(*link, beat);  // the order is given up
  Settle();
  look();
  EXPECT_EQ(Orders().size(), 1U);
  clock.Advance(RunQueue::kUnheardOf);
  look();
  const v1::HostOrder asked = NewestOrder(2);
  EXPECT_TRUE(asked.has_run_state());
  EXPECT_EQ(asked.for_job(), JobName(job));
  Accept(asked);  // it knows it: its end is on the way
  Settle();
  EXPECT_EQ(Job(job).state, JobState::kRunning);
  clock.Advance(RunQueue::kUnheardOf);
  look();
  Refuse(NewestOrder(3), "CELL-E9424");  // it does not know yet
  Settle();
  EXPECT_EQ(Job(job).state, JobState::kRunning);
  clock.Advance(RunQueue::kUnheardOf);
  look();
  Refuse(NewestOrder(4), "CELL-E9004");
  EXPECT_TRUE(Eventually([&] { return Job(job).attempts == 0; }));
  EXPECT_FALSE(Job(job).held);
}

// Nor is it asked again before a while has gone by.
TEST_F(RunQueueTest, AHostIsAskedForAJobNowAndThen) {
  Tell(Idle());
  Mark();
  const std::int64_t job = Submit();
  NewestOrder(1);
  clock.Advance(Hosts::kAnswerPatience);
  v1::HostRequest beat;
  beat.mutable_heartbeat();
  hosts.Receive(*link, beat);  // the order is given up
  const auto asked_after = [&](std::chrono::milliseconds time) {
    clock.Advance(time);
    Settle();
    runs.WakeAll();
    Settle();
    return Orders().size() - 1;
  };
  EXPECT_EQ(asked_after(std::chrono::milliseconds(0)), 0U);
  EXPECT_EQ(asked_after(RunQueue::kUnheardOf - std::chrono::milliseconds(1)), 0U);
  EXPECT_EQ(asked_after(std::chrono::milliseconds(1)), 1U);
  EXPECT_EQ(asked_after(RunQueue::kUnheardOf - std::chrono::milliseconds(1)), 1U);
  EXPECT_EQ(asked_after(std::chrono::milliseconds(1)), 2U);
  EXPECT_EQ(Job(job).state, JobState::kRunning);
}

// LIVE-5.05: between its lease and the first word of its host, too.
TEST_F(RunQueueTest, AJobThatIsAboutToBeginIsStopped) {
  Tell(Idle());
  const std::int64_t job = Submit();
  NewestOrder(1);
  EXPECT_EQ(runs.MachineOf(JobName(job)), "mill-1");
  v1::HostOrder stop;
  stop.mutable_stop();
  runs.Ask(JobName(job), stop, [](const Result<v1::HostOrderAnswer>&) {});
  EXPECT_TRUE(NewestOrder(2).has_stop());
  EXPECT_EQ(NewestOrder(2).for_job(), JobName(job));
}

// A cancel is not lost with a job that did not begin.
TEST_F(RunQueueTest, ACancelledJobThatDidNotBeginIsCancelled) {
  Tell(Idle());
  const std::int64_t job = Submit();
  const v1::HostOrder order = NewestOrder(1);
  Must(bed.store().RequestCancel(job, {}));
  Refuse(order, "CELL-E9421");
  EXPECT_TRUE(Eventually([&] { return Job(job).state == JobState::kCancelled; }));
}

// LIVE-5.05: an order for a job goes to the host that runs it, and says for which it is.
TEST_F(RunQueueTest, OrdersGoToTheHostThatRunsTheJob) {
  v1::MachineStatus running = Idle();
  running.set_state(v1::MACHINE_STATE_RUNNING);
  running.mutable_run()->set_job("jobs/5");
  Tell(running);
  Settle();
  runs.Abort("jobs/5", "bert", "id");
  const v1::HostOrder order = NewestOrder(1);
  EXPECT_TRUE(order.has_abort());
  EXPECT_EQ(order.for_job(), "jobs/5");
  EXPECT_EQ(order.caller(), "bert");
  EXPECT_EQ(order.abort().request_id(), "id");
  ErrorCode refused = ErrorCode::kCellInternal;
  runs.Ask("jobs/6", {},
           [&](const Result<v1::HostOrderAnswer>& answer) { refused = answer.error().code; });
  EXPECT_EQ(refused, ErrorCode::kCellNotLive);
}

// A cancel that came while its order was on the way reaches the run as soon as that is known.
class CancelledRun : public RunQueueTest {
 protected:
  // What the queue orders of a job is its abort by now.
  void SetUp() override {
    RunQueueTest::SetUp();
    Tell(Idle());
    job = Submit();
    const v1::HostOrder order = NewestOrder(1);
    Must(bed.store().RequestCancel(job, {}));
    Accept(order);
    running.set_state(v1::MACHINE_STATE_RUNNING);
    running.mutable_run()->set_job(JobName(job));
    Tell(running);
    ASSERT_TRUE(Eventually([&] { return Orders().back().has_abort(); }));
  }
  std::int64_t job = 0;
  v1::MachineStatus running = Idle();
};

TEST_F(CancelledRun, IsAbortedOnce) {
  runs.WakeAll();
  Settle();
  EXPECT_EQ(Orders().size(), 2U);
}

// Nor when its host has answered: what it was told it does.
TEST_F(CancelledRun, IsNotAbortedAgainBehindItsAnswer) {
  Accept(Orders().back());
  Settle();
  runs.WakeAll();
  Settle();
  EXPECT_EQ(Orders().size(), 2U);
}

// LIVE-2.10: an order that was on its way when the line broke may never have come there: the run of
// a cancelled job ends when its host is back.
TEST_F(CancelledRun, IsAbortedAgainWhereThatWasLostWithItsLine) {
  hosts.Leave(*link);
  link = std::make_shared<FakeLink>();
  v1::HostHello hello = Hello();
  hello.set_fence(fence);
  ASSERT_TRUE(hosts.Join(link, hello));
  Tell(running);
  const v1::HostOrder again = NewestOrder(1);
  EXPECT_TRUE(again.has_abort());
  EXPECT_EQ(again.for_job(), JobName(job));
  EXPECT_EQ(again.caller(), "anna");
}

// LIVE-5.02: what may be otherwise in a while sends a job back to the queue. Where somebody was at
// the machine, or it takes no jobs, it is held (LIVE-2.05).
TEST_F(RunQueueTest, WhatMayGoBetterLaterEndsNoJob) {
  std::size_t orders = 0;
  for (const std::string code :
       {"CELL-E9421", "CELL-E9423", "CELL-E9424", "CELL-E9409", "CELL-E9429", "CELL-E9408",
        "CELL-E9433", "CELL-E9014", "CELL-E9406", "CELL-E9002"}) {
    Tell(Idle());
    const std::int64_t job = Submit();
    Refuse(NewestOrder(++orders), code);
    EXPECT_TRUE(Eventually([&] { return Job(job).state == JobState::kQueued; })) << code;
    EXPECT_EQ(Job(job).held, code == "CELL-E9421" || code == "CELL-E9014") << code;
    Must(bed.store().RequestCancel(job, {}));
    clock.Advance(RunQueue::kRests);
  }
}

// A refusal without a code that is known is an error of ours; a preview without a token and without
// a reason says that there is no way to the step.
TEST_F(RunQueueTest, ARefusalThatSaysNothingEndsTheJob) {
  Tell(Idle());
  const std::int64_t unknown = Submit();
  Refuse(NewestOrder(1), "no code");
  EXPECT_TRUE(Eventually([&] { return Job(unknown).state == JobState::kFailed; }));
  EXPECT_EQ(Job(unknown).outcome->code, ErrorCode::kCellInternal);
  const std::int64_t at_step =
      Submit([](v1::Job& asked) { asked.mutable_run()->mutable_step()->set_step(2); });
  Look(NewestOrder(2), "");
  EXPECT_TRUE(Eventually([&] { return Job(at_step).state == JobState::kFailed; }));
  EXPECT_EQ(Job(at_step).outcome->code, ErrorCode::kCellStepUnreachable);
}

// LIVE-5.10: block and tool of the simulation that proves a run, with cells that fit the tool, and
// without its target.
TEST_F(RunQueueTest, TheMillingOfAJobIsThatOfItsSimulation) {
  const auto run_of = [&](const std::string& stock, const std::string& tool) {
    v1::Job simulation;
    v1::Milling& milling = *simulation.mutable_simulation()->mutable_milling();
    Must(bridge::SetBlockAndTool(stock, tool, milling));
    milling.set_cell_mm(0.5);
    milling.mutable_target()->set_slot(7);
    const std::int64_t proof =
        Must(bed.store().SubmitAndWait({.machine = "mill-1",
                                        .kind = "SIMULATE",
                                        .specification = simulation.SerializeAsString()}))
            .job.id;
    v1::Job run;
    run.mutable_run()->set_ticket(JobName(proof));
    return Must(bed.store().SubmitAndWait({.machine = "optimo-1",
                                           .kind = "RUN",
                                           .specification = run.SerializeAsString()}))
        .job.id;
  };
  const auto milling = runs.MillingOf(run_of("60x30x5", "flat:3"));
  ASSERT_TRUE(milling);
  EXPECT_EQ(milling->stock().size_x_mm(), 60.0);
  EXPECT_EQ(milling->tool().diameter_mm(), 3.0);
  EXPECT_EQ(milling->cell_mm(), 0.0);
  EXPECT_FALSE(milling->has_target());
  // 67,108,864 cells at most: of 2000 by 2000 mm they are wider than a tool of 0.1 mm.
  EXPECT_FALSE(runs.MillingOf(run_of("2000x2000x5", "flat:0.1")));
  EXPECT_FALSE(runs.MillingOf(Submit()));  // nothing proves it
  EXPECT_FALSE(runs.MillingOf(bed.SubmitCheck()));
  EXPECT_FALSE(runs.MillingOf(99));
}

}  // namespace
}  // namespace rmlcell::server
