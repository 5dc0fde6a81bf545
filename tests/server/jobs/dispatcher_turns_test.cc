// Whose turn it is: what is said of another lease, orders for jobs that are on their way, and jobs
// that are on their way while the server stops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "server/base/names.h"
#include "server/jobs/dispatcher.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using storage::JobState;
using testing::ElementsAre;

// One of each kind that would change something.
std::vector<v1::WorkRequest> SaidOf(const v1::WorkerLease& lease) {
  std::vector<v1::WorkRequest> said(5);
  *said[0].mutable_heartbeat()->mutable_lease() = lease;
  *said[1].mutable_events()->mutable_lease() = lease;
  said[1].mutable_events()->add_events()->mutable_message()->set_text("of another lease");
  *said[2].mutable_artifact()->mutable_lease() = lease;
  said[2].mutable_artifact()->set_name("report");
  said[2].mutable_artifact()->set_chunk("of another lease");
  *said[3].mutable_hand_back()->mutable_lease() = lease;
  *said[4].mutable_finish()->mutable_lease() = lease;
  said[4].mutable_finish()->mutable_outcome()->set_kind(v1::Outcome::KIND_FAILED);
  return said;
}

// Who worked on a job stands with each attempt, under the name that the worker gave.
TEST(DispatcherJoin, AnAttemptHasTheNameOfItsWorker) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 2);
  FakeWorker first(bed.dispatcher(), "hall/1");
  ASSERT_TRUE(first.Take());
  first.BeginAndLeave();
  FakeWorker second(bed.dispatcher(), "hall/2");
  ASSERT_TRUE(second.Take());
  const auto attempts = Must(bed.server.store().ListAttempts(job));
  ASSERT_EQ(attempts.size(), 2U);
  EXPECT_EQ(attempts[0].worker, "hall/1");
  EXPECT_EQ(attempts[1].worker, "hall/2");
}

// Job, attempt and fence are those of its lease, all three of them, or nothing of it is heard.
TEST(DispatcherLease, WhatIsSaidOfAnotherLeaseIsNotHeard) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  const auto line = std::make_shared<FakeLine>();
  const Dispatcher::WorkerId worker = Must(bed.dispatcher().Join(line, Hello("w")));
  const v1::WorkerLease own = line->Next(v1::WorkResponse::kAssignment).assignment().lease();
  ASSERT_EQ(own.job(), job);
  bed.Advance(milliseconds(bed.config.workers_lease_ms / 3));  // the next heartbeat would renew
  std::vector<v1::WorkerLease> others(3, own);
  others[0].set_job(own.job() + 1);
  others[1].set_attempt(own.attempt() + 1);
  others[2].set_fence(own.fence() + 1);
  for (const v1::WorkerLease& other : others) {
    for (const v1::WorkRequest& said : SaidOf(other)) bed.dispatcher().Receive(worker, said);
  }
  bed.Settle();
  EXPECT_EQ(bed.hooks.renewals, 0);
  EXPECT_FALSE(line->Has(v1::WorkResponse::kEventsStored));
  EXPECT_FALSE(line->Has(v1::WorkResponse::kRelease));
  EXPECT_EQ(bed.Job(job).state, JobState::kRunning);
  v1::WorkRequest end;
  *end.mutable_finish()->mutable_lease() = own;
  end.mutable_finish()->mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  bed.dispatcher().Receive(worker, end);
  EXPECT_TRUE(line->Next(v1::WorkResponse::kRelease).release().stored());
  EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
  EXPECT_EQ(CodeOf(bed.server.store().GetArtifact(job, "report")), ErrorCode::kCellNotFound);
}

// The lease of the job before is none of the next one's, which has not gone out yet.
TEST(DispatcherControl, AnOrderForASecondJobOnItsWayHasTheLeaseOfThat) {
  DispatcherBed bed;
  std::atomic<std::int64_t> next = 0;
  std::atomic<bool> taken = false;
  bed.hooks.before_machine = [&] {
    if (next == 0) return;
    taken = bed.dispatcher().OrderAtOnce(next, {.kind = v1::WorkerControl::KIND_STOP});
  };
  bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  next = bed.server.SubmitCheck();
  worker.Finish();
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), next.load());
  EXPECT_TRUE(taken.load());
  const v1::WorkerControl order = worker.Ordered();
  EXPECT_EQ(order.kind(), v1::WorkerControl::KIND_STOP);
  EXPECT_EQ(order.lease().fence(), worker.assignment().lease().fence());
}

// Whoever was given his next job with the end of the one before looks for none any more: what is
// ordered of a job that its worker gave back is for nobody.
TEST(DispatcherControl, WhoHasHisNextJobTakesNoOrderForAnother) {
  DispatcherBed bed;
  bed.server.SubmitCheck();
  FakeWorker goes_on(bed.dispatcher(), "goes on");
  ASSERT_TRUE(goes_on.Take());
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker gives_back(bed.dispatcher(), "gives back");
  ASSERT_TRUE(gives_back.Take());
  ASSERT_EQ(gives_back.job(), job);
  bed.server.SubmitCheck();
  goes_on.Finish();
  ASSERT_TRUE(goes_on.Take());
  ASSERT_EQ(bed.hooks.next_given, 1);
  bed.hooks.losses_that_fail = 1'000'000;
  gives_back.HandBack();
  bed.Settle();
  EXPECT_EQ(bed.Job(job).state, JobState::kRunning);  // in the store, for now
  EXPECT_EQ(CodeOf(bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_HOLD})),
            ErrorCode::kCellPrecondition);
  bed.hooks.losses_that_fail = 0;
  EXPECT_EQ(gives_back.Released(), false);
}

// Who looks for a job keeps an order for one that he may be given, and no longer than he looks: it
// was for the attempt that ran then.
TEST(DispatcherControl, AnOrderThatFoundNobodyIsNotForTheNextAttempt) {
  DispatcherBed bed;
  bed.server.SubmitCheck();
  FakeWorker looks(bed.dispatcher(), "looks");
  ASSERT_TRUE(looks.Take());
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker gives_back(bed.dispatcher(), "gives back");
  ASSERT_TRUE(gives_back.Take());
  ASSERT_EQ(gives_back.job(), job);
  bed.hooks.keeps_ends = true;
  looks.Finish();
  ASSERT_TRUE(Eventually([&] { return bed.hooks.ends_kept == 1; }));
  bed.hooks.losses_that_fail = 1'000'000;
  gives_back.HandBack();
  ASSERT_TRUE(Eventually([&] {
    return !bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_RESUME});
  }));
  EXPECT_TRUE(bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_HOLD}));
  bed.hooks.Answer();  // there is no other job: it waits for one
  EXPECT_EQ(looks.Released(), true);
  bed.LookAgain();
  EXPECT_EQ(CodeOf(bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_HOLD})),
            ErrorCode::kCellPrecondition);  // it waits for a job, and does not look any more
  bed.hooks.losses_that_fail = 0;
  ASSERT_TRUE(looks.Take());
  EXPECT_EQ(looks.job(), job);
  bed.Settle();
  EXPECT_FALSE(looks.line().Has(v1::WorkResponse::kControl));
}

// Nor for a later job of his who had looked and was given another: that it could not be begun
// changes nothing.
TEST(DispatcherControl, AnOrderIsNotKeptBeyondTheJobThatWasFound) {
  std::atomic<bool> keeps_next_end = false;
  DispatcherBed bed;
  bed.hooks.after_acquire = [&] {
    if (keeps_next_end) bed.hooks.keeps_ends = true;
  };
  bed.server.SubmitCheck();
  FakeWorker looks(bed.dispatcher(), "looks");
  ASSERT_TRUE(looks.Take());
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker gives_back(bed.dispatcher(), "gives back");
  ASSERT_TRUE(gives_back.Take());
  ASSERT_EQ(gives_back.job(), job);
  Must(bed.server.store().SubmitAndWait(
      {.machine = "optimo-1", .kind = "CHECK", .specification = "\xFF\xFF no message"}));
  bed.hooks.keeps_ends = true;
  looks.Finish();
  ASSERT_TRUE(Eventually([&] { return bed.hooks.ends_kept == 1; }));
  bed.hooks.losses_that_fail = 1'000'000;
  gives_back.HandBack();
  ASSERT_TRUE(Eventually([&] {
    return !bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_RESUME});
  }));
  EXPECT_TRUE(bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_HOLD}));
  keeps_next_end = true;
  bed.hooks.Answer();  // it is given what nobody can work on
  ASSERT_TRUE(Eventually([&] { return bed.hooks.ends_kept == 2; }));
  keeps_next_end = false;
  bed.hooks.losses_that_fail = 0;
  ASSERT_TRUE(bed.Becomes(job, JobState::kQueued));
  bed.hooks.Answer();
  ASSERT_TRUE(looks.Take());
  EXPECT_EQ(looks.job(), job);
  bed.Settle();
  EXPECT_FALSE(looks.line().Has(v1::WorkResponse::kControl));
}

// scale-out.md PG-15.26: a server whose workers do nothing does not ask the store for orders.
TEST(DispatcherControl, NoOrdersAreLookedForWhereNobodyWorks) {
  std::atomic<int> looks = 0;
  DispatcherBed bed;
  bed.hooks.before_orders = [&looks] { ++looks; };
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(Eventually([&] { return bed.hooks.sweeps > 0; }));  // the thread beside it is at work
  bed.LookAgain();
  EXPECT_EQ(looks, 0);
  bed.server.SubmitCheck();
  ASSERT_TRUE(worker.Take());
  EXPECT_TRUE(Eventually([&] { return looks > 0; }));
}

// A client may read that a job runs before its server has heard so: when the store says that no
// other server has it, this one has.
TEST(DispatcherControl, AnOrderForAJobThatIsJustGivenOutIsNotRefused) {
  DispatcherBed bed;
  std::promise<Status> ordered;
  std::jthread client;
  bed.hooks.after_acquire = [&] {
    if (client.joinable()) return;
    client = std::jthread([&] {
      ordered.set_value(bed.dispatcher().Control(1, {.kind = v1::WorkerControl::KIND_HOLD}));
    });
    Eventually([&] { return bed.hooks.orders_put == 1; });  // it has found no worker that has it
  };
  FakeWorker worker(bed.dispatcher(), "w");
  bed.LookAgain();
  ASSERT_EQ(bed.server.SubmitCheck(), 1);
  ASSERT_TRUE(worker.Take());
  EXPECT_TRUE(ordered.get_future().get());
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_HOLD);
}

// The server begins to stop between the lease of a job and its way to the worker, who is told to
// stop as well: the job goes back.
TEST(DispatcherDrain, AJobThatIsBeingMadeReadyGoesBack) {
  DispatcherBed bed;
  std::atomic<bool> begun = false;
  std::atomic<bool> go_on = false;
  bed.hooks.before_machine = [&] {
    begun = true;
    Eventually([&] { return go_on.load(); });
  };
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(Eventually([&] { return begun.load(); }));
  std::jthread server([&] { bed.dispatcher().Drain(kPatience); });
  EXPECT_TRUE(worker.line().Next(v1::WorkResponse::kStop).has_stop());
  go_on = true;
  server.join();
  EXPECT_EQ(bed.Job(job).state, JobState::kQueued);
  EXPECT_EQ(bed.Job(job).attempts, 0);
}

// One that was leased as the server stopped goes back without a word to the worker.
TEST(DispatcherDrain, AJobThatComesAsTheServerStopsIsNotSent) {
  DispatcherBed bed;
  std::atomic<bool> leased = false;
  std::atomic<bool> go_on = false;
  bed.hooks.after_acquire = [&] {
    leased = true;
    Eventually([&] { return go_on.load(); });
  };
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(Eventually([&] { return leased.load(); }));
  std::jthread server([&] { bed.dispatcher().Drain(kPatience); });
  EXPECT_TRUE(worker.line().Next(v1::WorkResponse::kStop).has_stop());
  go_on = true;
  server.join();
  EXPECT_EQ(bed.Job(job).state, JobState::kQueued);
  EXPECT_EQ(bed.Job(job).attempts, 0);
  EXPECT_FALSE(worker.HasJob());
}

// scale-out.md IF-04: a store that could not give its programs is not asked for a job at once. In a
// moment it is, by the thread that looks for orders, which does not come to that here.
TEST(DispatcherFailures, AJobThatGoesBackUnreadIsNotGivenOutAtOnce) {
  std::atomic<bool> looks = false;
  std::promise<void> go_on;
  DispatcherBed bed;
  bed.hooks.before_orders = [&looks, wait = go_on.get_future().share()] {
    looks = true;
    wait.wait();
  };
  bed.hooks.before_machine = [&looks] { Eventually([&looks] { return looks.load(); }); };
  bed.hooks.machines_that_fail = 1;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  EXPECT_TRUE(Eventually([&] { return bed.hooks.machines_that_fail == 0; }));
  bed.LookAgain();
  EXPECT_EQ(bed.Job(job).state, JobState::kQueued);
  EXPECT_FALSE(worker.HasJob());
  go_on.set_value();
  EXPECT_TRUE(worker.Take());
}

// scale-out.md IF-03: events that the store did not take at first went with the end of their job; a
// moment later there is nothing left of it to be tried again.
TEST(DispatcherFailures, WhatWasPutOffIsOverWithItsJob) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.appends_that_fail = 1;
  worker.Events(1, "a");
  bed.Settle();
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  bed.LookAgain();
  // Whoever asks again a moment later does so behind what is tried again.
  bed.hooks.acquires_that_fail = 1;
  FakeWorker other(bed.dispatcher(), "other");
  ASSERT_TRUE(Eventually([&] { return bed.hooks.standing == 2; }));
  bed.Settle();
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kRelease));
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kEventsStored));
  EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
  bed.server.SubmitCheck();
  EXPECT_TRUE(Eventually([&] { return worker.HasJob() || other.HasJob(); }));
}

// scale-out.md IF-04: the job is as good as before, and its log says that it waits again, no more.
TEST(DispatcherFailures, AJobThatGoesBackUnreadHasLostNothing) {
  DispatcherBed bed;
  bed.hooks.machines_that_fail = 2;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  std::vector<v1::Job::State> states;
  for (const v1::JobEvent& event : bed.Events(job)) {
    EXPECT_FALSE(event.has_message()) << event.message().text();
    states.push_back(event.state());
  }
  ASSERT_EQ(states.size(), 6U);
  states.erase(states.begin());  // of its submission, which the bed leaves empty
  EXPECT_THAT(states,
              ElementsAre(v1::Job::STATE_RUNNING, v1::Job::STATE_QUEUED, v1::Job::STATE_RUNNING,
                          v1::Job::STATE_QUEUED, v1::Job::STATE_RUNNING));
}

}  // namespace
}  // namespace rmlcell::server
