// What a worker that leaves takes back, and what it leaves to others.
#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using storage::JobState;

// A store that tells which requests are withdrawn, and does something while it is asked.
class WithdrawingStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::function<void()> while_asked;
  std::atomic<std::int64_t> newest = 0;
  std::atomic<std::int64_t> withdrawn = 0;
  std::atomic<int> withdrawals = 0;
  std::atomic<int> asks_that_throw = 0;

  std::int64_t AwaitJobs(storage::JobRequest request,
                         storage::Done<std::vector<storage::LeasedJob>> done) override {
    if (asks_that_throw > 0) {
      --asks_that_throw;
      throw std::bad_alloc();
    }
    newest = store_.AwaitJobs(std::move(request), std::move(done));
    if (while_asked) while_asked();
    return newest;
  }
  // Events do not fit for now, and an end not at all.
  std::atomic<bool> refuses = false;
  std::atomic<bool> throws = false;

  void Append(const storage::Lease& lease, std::vector<storage::NewEvent> events,
              storage::Done<std::int64_t> done) override {
    if (refuses) return done(Error{ErrorCode::kCellStoreFailed, "the disk is full", {}});
    store_.Append(lease, std::move(events), std::move(done));
  }
  void SendFinish(const storage::Lease& lease, std::shared_ptr<const storage::JobEnd> end,
                  std::optional<storage::JobRequest> next,
                  storage::Done<storage::FinishedJob> done) override {
    if (throws) throw std::bad_alloc();
    if (refuses) return done(Error{ErrorCode::kCellTooLarge, "an event of 5 GiB", {}});
    store_.SendFinish(lease, std::move(end), std::move(next), std::move(done));
  }
  void Withdraw(std::int64_t request) override {
    withdrawn = request;
    ++withdrawals;
    store_.Withdraw(request);
  }
};

class WorkersThatLeave : public testing::Test {
 protected:
  Dispatcher& dispatcher() {
    if (dispatcher_ == nullptr)
      dispatcher_ = std::make_unique<Dispatcher>(store, feed, config, executor, std::string(kToken),
                                                 steady.clock());
    return *dispatcher_;
  }

  ServerBed server;
  WithdrawingStore store{server.store()};
  EventFeed feed{server.store()};
  Config config;
  TestSteadyClock steady;
  Executor executor{2};
  std::unique_ptr<Dispatcher> dispatcher_;
};

// It goes while the store is asked for its first job: what it asked for is taken back, or a job
// would be given to nobody.
TEST_F(WorkersThatLeave, WhatItAsksForAsItGoesIsWithdrawn) {
  std::promise<void> asked;
  std::promise<void> goes_on;
  store.while_asked = [&asked, wait = goes_on.get_future().share()] {
    asked.set_value();
    wait.wait();
  };
  const Dispatcher::WorkerId worker =
      Must(dispatcher().Join(std::make_shared<FakeLine>(), Hello("w")));
  asked.get_future().wait();
  dispatcher().Leave(worker);
  EXPECT_EQ(store.withdrawals, 0);  // its number is not known yet
  goes_on.set_value();
  EXPECT_TRUE(Eventually([&] { return store.withdrawals == 1; }));
  EXPECT_EQ(store.withdrawn, store.newest);
}

// One that works asks for nothing: what others ask for stays.
TEST_F(WorkersThatLeave, OneThatWorksWithdrawsNothing) {
  server.SubmitCheck();
  FakeWorker busy(dispatcher(), "busy");
  ASSERT_TRUE(busy.Take());
  FakeWorker idle(dispatcher(), "idle");
  dispatcher().Settle();
  busy.Leave();
  EXPECT_EQ(store.withdrawals, 0);
}

// One that waits takes back what it asked for.
TEST_F(WorkersThatLeave, OneThatWaitsWithdrawsWhatItAskedFor) {
  FakeWorker idle(dispatcher(), "idle");
  ASSERT_TRUE(Eventually([&] { return store.newest != 0; }));
  dispatcher().Settle();
  idle.Leave();
  EXPECT_EQ(store.withdrawals, 1);
  EXPECT_EQ(store.withdrawn, store.newest);
}

// Nor does a dispatcher that goes leave anything in the store, which would be answered to nobody.
TEST_F(WorkersThatLeave, WhatIsAskedForGoesWithTheDispatcher) {
  FakeWorker idle(dispatcher(), "idle");
  ASSERT_TRUE(Eventually([&] { return store.newest != 0; }));
  dispatcher().Settle();
  dispatcher_.reset();
  EXPECT_EQ(store.withdrawals, 1);
  EXPECT_EQ(store.withdrawn, store.newest);
}

// A store that throws as it is asked for a job is asked again a little later.
TEST_F(WorkersThatLeave, OneWhoseStoreThrewStays) {
  store.asks_that_throw = 1;
  FakeWorker worker(dispatcher(), "w");
  ASSERT_TRUE(Eventually([&] { return store.asks_that_throw == 0; }));
  const std::int64_t job = server.SubmitCheck();
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), job);
  EXPECT_FALSE(worker.line().closed);
  worker.Leave();
}

// What cannot be stored at all may be what it told: the attempt is lost without that.
TEST_F(WorkersThatLeave, WhatCannotBeStoredIsLeftOut) {
  const std::int64_t job = server.SubmitCheck();
  FakeWorker worker(dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  store.refuses = true;
  worker.Events(1, "too large");
  worker.Finish();
  EXPECT_EQ(worker.Released(), false);
  store.refuses = false;
  std::vector<std::string> told;
  for (const storage::EventRecord& record : Must(server.store().JobEvents(job, 0, 100))) {
    const v1::JobEvent event = rmlcell::server::ToProto(record);
    if (event.has_message()) told.push_back(event.message().text());
  }
  EXPECT_EQ(told, std::vector<std::string>{"the worker of attempt 1 died"});
  worker.Leave();
}

// A line that keeps why it was closed. Before its worker leaves it may be given its job once more:
// the first lease counts.
class ClosedLine final : public WorkerLine {
 public:
  void Send(v1::WorkResponse message) override {
    if (message.has_assignment() && !given_.exchange(true))
      taken.set_value(message.assignment().lease());
  }
  void SendProgram(int, std::shared_ptr<const std::string>) override {}
  void Close(const Error& why) override { closed.set_value(why.code); }
  std::promise<v1::WorkerLease> taken;
  std::promise<ErrorCode> closed;

 private:
  std::atomic<bool> given_ = false;
};

// A worker whose work throws is sent away with a mistake of ours, and none of its own.
TEST_F(WorkersThatLeave, WhatThrowsIsAMistakeOfOurs) {
  server.SubmitCheck();
  const auto line = std::make_shared<ClosedLine>();
  const Dispatcher::WorkerId worker = Must(dispatcher().Join(line, Hello("w")));
  v1::WorkRequest message;
  *message.mutable_finish()->mutable_lease() = line->taken.get_future().get();
  store.throws = true;
  dispatcher().Receive(worker, std::move(message));
  EXPECT_EQ(line->closed.get_future().get(), ErrorCode::kCellInternal);
  store.throws = false;
  dispatcher().Leave(worker);
}

// A job whose last attempt is lost ends where its worker was last.
TEST_F(WorkersThatLeave, WhereOneWasIsWhereItsJobEnds) {
  const std::int64_t job = server.SubmitCheck("STOP\n", 1);
  const auto line = std::make_shared<ClosedLine>();
  const Dispatcher::WorkerId worker = Must(dispatcher().Join(line, Hello("w")));
  v1::WorkRequest message;
  v1::WorkerHeartbeat& heartbeat = *message.mutable_heartbeat();
  *heartbeat.mutable_lease() = line->taken.get_future().get();
  heartbeat.mutable_progress()->mutable_place()->set_program(12);
  heartbeat.mutable_progress()->mutable_place()->set_step(7);
  dispatcher().Receive(worker, std::move(message));
  dispatcher().Leave(worker);
  ASSERT_TRUE(
      Eventually([&] { return Must(server.store().GetJob(job)).state == JobState::kFailed; }));
  const std::optional<storage::JobOutcome> outcome = Must(server.store().GetJob(job)).outcome;
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->program, 12);
  EXPECT_EQ(outcome->step, 7);
}

// Nobody is given a job with an end that is stored when he is gone.
TEST(JobsOfThoseWhoAreGone, AnEndThatIsStoredLaterBringsNoNextJob) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.finishes_that_fail = 1'000'000;
  worker.Finish();
  bed.Settle();
  worker.Leave();
  bed.Settle();
  const std::int64_t next = bed.server.SubmitCheck();
  bed.hooks.finishes_that_fail = 0;
  EXPECT_TRUE(bed.Becomes(job, JobState::kSucceeded));
  bed.Settle();
  EXPECT_EQ(bed.hooks.next_given, 0);
  EXPECT_TRUE(Must(bed.server.store().ListAttempts(next)).empty());
}

// What nobody can work on has been begun as far as anybody could: an end that the store does not
// take in the time of a lease uses its only attempt up.
TEST(JobsNobodyCanDo, AnEndThatIsLostCountsAsAnAttempt) {
  DispatcherBed bed;
  const std::int64_t broken =
      Must(bed.server.store().SubmitAndWait({.machine = "optimo-1",
                                             .kind = "CHECK",
                                             .specification = "\xFF\xFF no message",
                                             .attempts_max = 1}))
          .job.id;
  bed.hooks.finishes_that_fail = 1'000'000;
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(bed.Becomes(broken, JobState::kRunning));
  ASSERT_TRUE(Eventually([&] { return bed.hooks.finishes_that_fail < 1'000'000; }));
  // The look at leases of the beginning is over, and the next one is far.
  ASSERT_TRUE(Eventually([&] { return bed.hooks.sweeps > 0; }));
  bed.Advance(milliseconds(bed.config.workers_lease_ms));
  EXPECT_TRUE(bed.Becomes(broken, JobState::kFailed));
  EXPECT_EQ(bed.Job(broken).outcome->code, ErrorCode::kCellWorkerDied);
  EXPECT_EQ(bed.Job(broken).attempts, 1);
}

}  // namespace
}  // namespace rmlcell::server
