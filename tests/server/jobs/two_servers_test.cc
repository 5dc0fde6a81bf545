// Two servers work on one store, each over a line that breaks and loses hints: no job is done
// twice, none is lost, and orders arrive at whichever server has the job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <thread>

#include "server/base/names.h"
#include "tests/server/faulty_store.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using storage::JobState;

// One of the servers, with its own line to the store.
class OneServer {
 public:
  OneServer(storage::Store& shared, const Config& config, unsigned seed, unsigned one_in)
      : store(shared, seed, one_in),
        feed(store),
        dispatcher(store, feed, config, executor, std::string(kToken), steady.clock()) {
    spdlog::default_logger();  // made in the library, where the race detector sees no lock
  }
  ~OneServer() { dispatcher.Drain(milliseconds(0)); }

  TestSteadyClock steady;
  FaultyStore store;
  Executor executor{4};
  EventFeed feed;
  Dispatcher dispatcher;
};

constexpr unsigned kNeverFails = 1U << 30;

class TwoServers : public testing::Test {
 protected:
  TwoServers() { config.workers_lease_ms = 400; }

  void Open(unsigned seed, unsigned one_in) {
    first = std::make_unique<OneServer>(bed.store(), config, seed, one_in);
    second = std::make_unique<OneServer>(bed.store(), config, seed + 1000, one_in);
  }
  void Advance(milliseconds by) {
    bed.clock().Advance(by);
    first->steady.Advance(by);
    second->steady.Advance(by);
  }

  // Takes jobs and does them until it is told to stop.
  std::jthread Worker(OneServer& server, const std::string& name) {
    return std::jthread([this, &server, name](const std::stop_token& stop) {
      FakeWorker worker(server.dispatcher, name);
      while (!stop.stop_requested()) {
        if (!worker.Take(milliseconds(20))) continue;
        ++at_work;
        worker.Heartbeat();
        worker.Events(2);
        worker.Artifact("report", "of " + name);
        worker.Finish();
        (void)worker.Released();
        --at_work;
      }
      worker.Leave();
    });
  }

  std::atomic<int> at_work = 0;  // workers that have a job
  ServerBed bed;
  Config config;
  std::unique_ptr<OneServer> first;
  std::unique_ptr<OneServer> second;
};

TEST_F(TwoServers, NoJobIsDoneTwiceAndNoneIsLost) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Open(seed, 25);
    std::vector<std::int64_t> jobs;
    for (int k = 0; k < 60; ++k) jobs.push_back(bed.SubmitCheck("STOP\n", 10));
    {
      std::vector<std::jthread> workers;
      for (int k = 0; k < 3; ++k) {
        workers.push_back(Worker(*first, "a" + std::to_string(k)));
        workers.push_back(Worker(*second, "b" + std::to_string(k)));
      }
      const auto ended = [&](std::int64_t job) {
        return storage::IsFinal(Must(bed.store().GetJob(job)).state);
      };
      // Leases that nobody knows of run out, and at first those of slow workers as well: four
      // times, so that no job has used all of its attempts up, however long a worker stands still.
      int among_workers = 4 * 400 / 50;
      EXPECT_TRUE(Eventually([&] {
        if (at_work == 0 || among_workers-- > 0) Advance(milliseconds(50));
        return std::ranges::all_of(jobs, ended);
      }));
      first->store.Heal();
      second->store.Heal();
    }
    EXPECT_GT(first->store.failures() + second->store.failures(), 0);
    for (const std::int64_t job : jobs) {
      const storage::JobRecord record = Must(bed.store().GetJob(job));
      EXPECT_EQ(record.state, JobState::kSucceeded) << seed << " " << JobName(job);
      int ends = 0;
      std::int64_t sequence = 0;
      for (const storage::EventRecord& event : Must(bed.store().JobEvents(job, 0, 1000))) {
        EXPECT_EQ(event.sequence, ++sequence);
        ends += ToProto(event).has_ended() ? 1 : 0;
      }
      EXPECT_EQ(ends, 1) << JobName(job);
      EXPECT_EQ(Must(bed.store().ListArtifacts(job)).size(), 2U);  // program, and one report
    }
    first.reset();
    second.reset();
  }
}

// Whoever got the call: the server that has the job hears of it.
TEST_F(TwoServers, OrdersReachTheServerThatHasTheJob) {
  config.workers_lease_ms = 60'000;
  Open(1, kNeverFails);
  const std::int64_t job = bed.SubmitCheck();
  FakeWorker worker(first->dispatcher, "w");
  ASSERT_TRUE(worker.Take());
  ASSERT_TRUE(second->dispatcher.Control(job, {.kind = v1::WorkerControl::KIND_OVERRIDE,
                                               .value = 55.5,
                                               .caller = "anna",
                                               .request_id = "r"}));
  ASSERT_TRUE(second->dispatcher.Control(job, {.kind = v1::WorkerControl::KIND_STOP}));
  const v1::WorkerControl order = worker.Ordered();
  EXPECT_EQ(order.kind(), v1::WorkerControl::KIND_OVERRIDE);
  EXPECT_EQ(order.value(), 55.5);
  EXPECT_EQ(order.caller(), "anna");
  EXPECT_EQ(order.request_id(), "r");
  EXPECT_EQ(order.lease().fence(), worker.assignment().lease().fence());
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_STOP);
  // A cancel, too, long before the next renewal of the lease.
  EXPECT_EQ(Must(second->dispatcher.Cancel(job, "anna")).state, JobState::kRunning);
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_CANCEL);
  worker.Finish(v1::Outcome::KIND_CANCELLED);
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(CodeOf(second->dispatcher.Control(job, {.kind = v1::WorkerControl::KIND_STOP})),
            ErrorCode::kCellPrecondition);
}

// One that a newer server has written in its own way is passed over, and those behind it are not.
TEST_F(TwoServers, AnOrderThatCannotBeReadIsPassedOver) {
  config.workers_lease_ms = 60'000;
  Open(1, kNeverFails);
  const std::int64_t job = bed.SubmitCheck();
  FakeWorker worker(first->dispatcher, "w");
  ASSERT_TRUE(worker.Take());
  ASSERT_TRUE(bed.store().PutOrder(job, "a server", "\xFF"));
  ASSERT_TRUE(second->dispatcher.Control(job, {.kind = v1::WorkerControl::KIND_HOLD}));
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_HOLD);
}

// An order is for the attempt that ran when it was given.
TEST_F(TwoServers, AnOrderIsNotForTheNextAttempt) {
  config.workers_lease_ms = 60'000;
  Open(1, kNeverFails);
  const std::int64_t job = bed.SubmitCheck();
  auto worker = std::make_unique<FakeWorker>(first->dispatcher, "w");
  ASSERT_TRUE(worker->Take());
  ASSERT_TRUE(bed.store().PutOrder(job, "a server", "of the first attempt"));
  worker->HandBack();
  FakeWorker next(second->dispatcher, "next");
  ASSERT_TRUE(next.Take());
  ASSERT_TRUE(first->dispatcher.Control(job, {.kind = v1::WorkerControl::KIND_HOLD}));
  EXPECT_EQ(next.Ordered().kind(), v1::WorkerControl::KIND_HOLD);
}

}  // namespace
}  // namespace rmlcell::server
