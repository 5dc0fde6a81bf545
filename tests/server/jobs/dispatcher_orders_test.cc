#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "server/base/names.h"
#include "server/jobs/dispatcher.h"
#include "server/jobs/running_heights.h"
#include "server/jobs/running_toolpath.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using storage::JobState;

TEST(DispatcherCancel, AWaitingJobEndsAtOnce) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  const storage::JobRecord cancelled = Must(bed.dispatcher().Cancel(job, "anna"));
  EXPECT_EQ(cancelled.state, JobState::kCancelled);
  EXPECT_TRUE(bed.Events(job).back().has_ended());
  EXPECT_EQ(bed.Events(job).back().ended().kind(), v1::Outcome::KIND_CANCELLED);
  EXPECT_EQ(CodeOf(bed.dispatcher().Cancel(job + 1, "anna")), ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(bed.dispatcher().Cancel(job, "anna")).state,
            JobState::kCancelled);  // twice is not an error
  // Nobody is given it: who comes is given the one behind it.
  const std::int64_t next = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), next);
}

TEST(DispatcherCancel, ARunningJobIsEndedByItsWorker) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(Must(bed.dispatcher().Cancel(job, "anna")).state, JobState::kRunning);
  const v1::WorkerControl order = worker.Ordered();
  EXPECT_EQ(order.kind(), v1::WorkerControl::KIND_CANCEL);
  EXPECT_EQ(order.lease().fence(), worker.assignment().lease().fence());
  worker.Finish(v1::Outcome::KIND_CANCELLED);
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(bed.Job(job).state, JobState::kCancelled);
}

// The worker died, or gave the job back: a job that nobody wants any more is not begun again.
TEST(DispatcherCancel, ACancelledJobIsNotBegunAgain) {
  for (const bool dies : {true, false}) {
    DispatcherBed bed;
    const std::int64_t job = bed.server.SubmitCheck();
    FakeWorker worker(bed.dispatcher(), "w");
    ASSERT_TRUE(worker.Take());
    Must(bed.dispatcher().Cancel(job, "anna"));
    if (dies) {
      worker.Leave();
    } else {
      worker.HandBack();
    }
    FakeWorker next(bed.dispatcher(), "next");
    ASSERT_TRUE(bed.Becomes(job, JobState::kCancelled)) << dies;
    EXPECT_EQ(bed.Job(job).outcome->code, ErrorCode::kCellCancelled);
    EXPECT_EQ(bed.Events(job).back().ended().kind(), v1::Outcome::KIND_CANCELLED);
    // The worker is free for another, and is given that one only.
    const std::int64_t other = bed.server.SubmitCheck();
    ASSERT_TRUE(next.Take());
    EXPECT_EQ(next.job(), other);
  }
}

// The worker is asked once, however many follow; all of them see the same.
TEST(DispatcherToolpath, IsFollowedWhileTheJobRuns) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  EXPECT_EQ(bed.dispatcher().FollowToolpath(job), nullptr);  // it waits
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  const auto toolpath = bed.dispatcher().FollowToolpath(job);
  ASSERT_NE(toolpath, nullptr);
  EXPECT_EQ(bed.dispatcher().FollowToolpath(job), toolpath);
  const v1::WorkerControl order = worker.Ordered();
  EXPECT_EQ(order.kind(), v1::WorkerControl::KIND_FOLLOW_TOOLPATH);
  EXPECT_EQ(order.lease().fence(), worker.assignment().lease().fence());
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kControl));
  worker.Toolpath("frames ", "open");
  worker.Toolpath("and more", "");
  ASSERT_TRUE(Eventually([&] { return toolpath->Look(0, 0).frames == "frames and more"; }));
  EXPECT_FALSE(toolpath->Look(0, 0).ended);
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  EXPECT_TRUE(toolpath->Look(0, 0).ended);
  EXPECT_EQ(bed.dispatcher().FollowToolpath(job), nullptr);
}

// Of a worker that is gone nothing more comes.
TEST(DispatcherToolpath, EndsWithItsAttempt) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  const auto toolpath = bed.dispatcher().FollowToolpath(job);
  ASSERT_NE(toolpath, nullptr);
  worker.Toolpath("of this attempt", "");
  worker.Leave();
  ASSERT_TRUE(Eventually([&] { return toolpath->Look(0, 0).ended; }));
  EXPECT_EQ(toolpath->Look(0, 0).frames, "of this attempt");
  FakeWorker next(bed.dispatcher(), "next");
  ASSERT_TRUE(next.Take());
  EXPECT_NE(bed.dispatcher().FollowToolpath(job), toolpath);
}

// What is left of the block likewise.
TEST(DispatcherHeights, AreFollowedWhileTheJobRuns) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  EXPECT_EQ(bed.dispatcher().FollowHeights(job), nullptr);  // it waits
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  const auto heights = bed.dispatcher().FollowHeights(job);
  ASSERT_NE(heights, nullptr);
  EXPECT_EQ(bed.dispatcher().FollowHeights(job), heights);
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_FOLLOW_HEIGHTS);
  v1::WorkerHeights told;
  told.mutable_grid()->set_columns(1);
  told.mutable_grid()->set_rows(1);
  v1::HeightTile& tile = *told.add_tiles();
  tile.set_columns(1);
  tile.set_rows(1);
  tile.set_heights("ab");
  worker.Heights(told);
  ASSERT_TRUE(Eventually([&] { return heights->Look(0).tiles.size() == 1; }));
  EXPECT_EQ(heights->Look(0).tiles[0].heights(), "ab");
  EXPECT_FALSE(heights->Look(0).ended);
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  EXPECT_TRUE(heights->Look(0).ended);
  EXPECT_TRUE(heights->Look(0).stored);
  EXPECT_EQ(bed.dispatcher().FollowHeights(job), nullptr);
}

// A RUN is at its machine, and at no worker: without a host nobody takes the order.
TEST(DispatcherControl, ARunIsOrderedAtItsMachine) {
  DispatcherBed bed;
  const std::int64_t job =
      Must(bed.server.store().SubmitAndWait({.machine = "optimo-1", .kind = "RUN"})).job.id;
  bed.server.Lease("RUN");
  EXPECT_EQ(CodeOf(bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_HOLD})),
            ErrorCode::kCellNotLive);
}

TEST(DispatcherControl, OrdersReachTheWorkerThatHasTheJob) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  EXPECT_EQ(CodeOf(bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_HOLD})),
            ErrorCode::kCellPrecondition);
  EXPECT_EQ(CodeOf(bed.dispatcher().Control(job + 1, {.kind = v1::WorkerControl::KIND_HOLD})),
            ErrorCode::kCellNotFound);
  FakeWorker holder(bed.dispatcher(), "holder");
  ASSERT_TRUE(holder.Take());
  FakeWorker idle(bed.dispatcher(), "idle");
  for (const auto kind : {v1::WorkerControl::KIND_HOLD, v1::WorkerControl::KIND_RESUME,
                          v1::WorkerControl::KIND_STOP}) {
    EXPECT_TRUE(bed.dispatcher().Control(job, {.kind = kind}));
    EXPECT_EQ(holder.Ordered().kind(), kind);
  }
  EXPECT_TRUE(
      bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_OVERRIDE, .value = 42.5}));
  EXPECT_EQ(holder.Ordered().value(), 42.5);
  bed.Settle();
  EXPECT_FALSE(idle.line().Has(v1::WorkResponse::kControl));
  holder.Finish();
  EXPECT_EQ(holder.Released(), true);
  EXPECT_EQ(CodeOf(bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_HOLD})),
            ErrorCode::kCellPrecondition);
}

// Clients see that a job runs before its worker has heard of it; another worker looks meanwhile,
// and gets another.
TEST(DispatcherControl, AnOrderForAJobOnItsWayComesAfterTheJob) {
  DispatcherBed bed;
  const std::int64_t first = bed.server.SubmitCheck();
  FakeWorker other(bed.dispatcher(), "other");
  ASSERT_TRUE(other.Take());
  bed.hooks.keeps_ends = true;
  other.Finish();  // its answer does not come: it looks for a further one
  ASSERT_TRUE(Eventually([&] { return bed.hooks.ends_kept == 1; }));
  std::promise<Status> ordered;
  std::jthread client;
  bed.hooks.after_acquire = [&] {
    if (client.joinable()) return;
    const int read = bed.hooks.jobs_read;
    client = std::jthread([&] {
      ordered.set_value(
          bed.dispatcher().Control(first + 1, {.kind = v1::WorkerControl::KIND_HOLD}));
    });
    Eventually([&] { return bed.hooks.jobs_read > read; });  // it has seen that the job runs
  };
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(Eventually([&] { return bed.hooks.standing == 1; }));
  Must(bed.server.store().ActOn({}, storage::QueueAct::kHold, {}));  // it stands by now
  ASSERT_EQ(bed.server.SubmitCheck(), first + 1);
  ASSERT_TRUE(worker.Take());
  EXPECT_TRUE(ordered.get_future().get());
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_HOLD);
  bed.hooks.Answer();
  EXPECT_EQ(other.Released(), true);
  EXPECT_FALSE(other.line().Has(v1::WorkResponse::kControl));
}

// The same of one that came with the end of the job before.
TEST(DispatcherControl, AnOrderForTheNextJobComesAfterIt) {
  DispatcherBed bed;
  bed.server.SubmitCheck();
  const std::int64_t next = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  Status ordered = Error{ErrorCode::kCellInternal, {}, {}};
  bed.hooks.after_acquire = [&] {
    ordered = bed.dispatcher().Control(next, {.kind = v1::WorkerControl::KIND_HOLD});
  };
  worker.Finish();
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), next);
  EXPECT_EQ(bed.hooks.next_given, 1);
  EXPECT_TRUE(ordered);
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_HOLD);
}

TEST(DispatcherControl, AnOrderForAJobThatIsBeingMadeReadyComesAfterTheJob) {
  DispatcherBed bed;
  std::atomic<std::int64_t> job = 0;
  std::optional<bool> taken;
  bed.hooks.before_machine = [&] {
    taken = bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_STOP});
  };
  job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(taken, true);
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_STOP);
}

// Whoever has read that a job is over is not told that it was held.
TEST(DispatcherControl, AJobThatItsWorkerHasFinishedTakesNoOrders) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_TRUE(bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_HOLD}));
  bed.hooks.finishes_that_fail = 1'000'000;
  worker.Finish();
  bed.Settle();
  {
    // The end is not tried again meanwhile: for a moment it would look for a further job, too.
    const auto busy = bed.Occupy();
    EXPECT_FALSE(bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_HOLD}));
    EXPECT_EQ(CodeOf(bed.dispatcher().Control(job, {.kind = v1::WorkerControl::KIND_HOLD})),
              ErrorCode::kCellPrecondition);
  }
  bed.hooks.finishes_that_fail = 0;
  EXPECT_EQ(worker.Released(), true);
}

// It is for the other server to give it.
TEST(DispatcherControl, AnOrderForAJobOfAnotherServerGoesToNoWorkerHere) {
  DispatcherBed bed;
  const std::int64_t elsewhere = bed.server.SubmitCheck();
  const auto leased = Must(bed.server.store().Acquire("elsewhere", {"CHECK"}, kPatience, {}));
  ASSERT_EQ(leased->lease.job, elsewhere);
  Status ordered;
  bed.hooks.after_acquire = [&] {
    ordered = bed.dispatcher().Control(elsewhere, {.kind = v1::WorkerControl::KIND_HOLD});
  };
  bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_TRUE(ordered);
  bed.Settle();
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kControl));
}

// A stop waits neither for the store nor for what keeps the threads of the server busy.
TEST(DispatcherControl, AnOrderAtOncePassesByTheStoreAndBusyThreads) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  EXPECT_FALSE(bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_CANCEL}));
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.Settle();
  {
    const auto busy = bed.Occupy();
    const int read = bed.hooks.jobs_read;
    EXPECT_TRUE(bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_CANCEL}));
    EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_CANCEL);
    EXPECT_EQ(bed.hooks.jobs_read, read);
  }
  worker.Finish(v1::Outcome::KIND_CANCELLED);
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(bed.Job(job).state, JobState::kCancelled);
  EXPECT_FALSE(bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_CANCEL}));
}

// A worker that gives its job back is about to end: the job goes to another, and no attempt is
// lost.
TEST(DispatcherHandBack, GivesTheJobToAnotherAndCountsNoAttempt) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker ending(bed.dispatcher(), "ending");
  ASSERT_TRUE(ending.Take());
  ending.HandBack();
  EXPECT_EQ(ending.Released(), false);
  bed.LookAgain();
  EXPECT_FALSE(ending.HasJob());
  EXPECT_EQ(bed.Job(job).state, JobState::kQueued);
  EXPECT_EQ(bed.Job(job).attempts, 0);
  FakeWorker other(bed.dispatcher(), "other");
  ASSERT_TRUE(other.Take());
  EXPECT_EQ(other.job(), job);
  ending.Leave();
  other.Finish();
  EXPECT_EQ(other.Released(), true);
  EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
}

TEST(DispatcherDrain, AsksForEverythingBackAndGivesOutNothingMore) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker busy(bed.dispatcher(), "busy");
  ASSERT_TRUE(busy.Take());
  FakeWorker idle(bed.dispatcher(), "idle");
  std::jthread server([&] { bed.dispatcher().Drain(std::chrono::hours(1)); });
  // worker.proto, WorkerStop: each is told why.
  EXPECT_NE(busy.line().Next(v1::WorkResponse::kStop).stop().reason(), "");
  EXPECT_NE(idle.line().Next(v1::WorkResponse::kStop).stop().reason(), "");
  busy.HandBack();
  server.join();
  EXPECT_EQ(bed.Job(job).state, JobState::kQueued);
  EXPECT_EQ(bed.Job(job).attempts, 0);
  bed.server.SubmitCheck();
  FakeWorker late(bed.dispatcher(), "late");
  EXPECT_TRUE(late.line().Has(v1::WorkResponse::kStop));
  bed.LookAgain();
  EXPECT_FALSE(idle.HasJob());
  EXPECT_FALSE(late.HasJob());
}

TEST(DispatcherDrain, WaitsNoLongerThanItsPatience) {
  DispatcherBed bed;
  bed.server.SubmitCheck();
  FakeWorker stubborn(bed.dispatcher(), "stubborn");
  ASSERT_TRUE(stubborn.Take());
  stubborn.Events(1);  // answered when the server is done with giving out the job
  ASSERT_TRUE(stubborn.line().Next(v1::WorkResponse::kEventsStored).has_events_stored());
  bed.dispatcher().Drain(milliseconds(100));  // returns, though nothing is handed back
  EXPECT_EQ(bed.Job(stubborn.job()).state, JobState::kRunning);
}

// dispatcher.h, Drain: for good; leases are not looked after any more.
TEST(DispatcherDrain, LooksAtNoLeaseAnyMore) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 2;  // leases are looked at all the time
  bed.dispatcher().Drain(milliseconds(0));
  const int looks = bed.hooks.sweeps;
  for (int job = 0; job < 50; ++job) bed.server.SubmitCheck();
  EXPECT_EQ(bed.hooks.sweeps, looks);
}

// The server stops while a job is on its way to a worker that is told to stop as well.
TEST(DispatcherDrain, AJobOnItsWayToAWorkerGoesBack) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 100;  // leases are looked at often, by a clock that stands still
  std::atomic<bool> found_one = false;
  std::atomic<bool> go_on = false;
  bed.hooks.after_acquire = [&] {
    found_one = true;
    Eventually([&] { return go_on.load(); });
  };
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(Eventually([&] { return found_one.load(); }));
  std::jthread server([&] { bed.dispatcher().Drain(std::chrono::hours(1)); });
  EXPECT_TRUE(worker.line().Next(v1::WorkResponse::kStop).has_stop());
  EXPECT_TRUE(bed.Swept()) << "it waits: leases are looked after until it returns";
  go_on = true;
  server.join();
  EXPECT_EQ(bed.Job(job).state, JobState::kQueued);
  EXPECT_EQ(bed.Job(job).attempts, 0);
}

}  // namespace
}  // namespace rmlcell::server
