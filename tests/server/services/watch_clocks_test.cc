// Watches by a clock that stands until it is moved: what is told at an instant, and what before it
// is not.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <string>

#include "server/base/names.h"
#include "server/records/job_messages.h"
#include "server/services/journal_export.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

constexpr const char* kMill = "machines/mill-1";
// Beyond any time that a computer has been on: nothing rings on the way there.
constexpr std::chrono::hours kBookmarks{500'000};

// From the start of the computer's time on, which lies behind every computer that runs: what is to
// be looked at again at an instant of this clock is looked at again at once.
class StandingClock {
 public:
  SteadyClock clock() {
    return [this] {
      ++looks_;
      return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(now_ns_));
    };
  }
  void Advance(std::chrono::nanoseconds by) { now_ns_ += by.count(); }
  // Until somebody has looked at it again and again, and waits for it to move.
  bool IsWaitedFor() {
    const int before = looks_;
    return Eventually([&] { return looks_ > before + 5; });
  }

 private:
  std::atomic<std::int64_t> now_ns_ = 1;
  std::atomic<int> looks_ = 0;
};

class WatchClocks : public testing::Test {
 protected:
  class Cell final
      : public v1::CellService::WithRawCallbackMethod_WatchCell<v1::CellService::CallbackService> {
   public:
    explicit Cell(CellWatchNeeds needs) : needs_(std::move(needs)) {}
    grpc::ServerWriteReactor<grpc::ByteBuffer>* WatchCell(
        grpc::CallbackServerContext* /*context*/, const grpc::ByteBuffer* request) override {
      v1::WatchCellRequest asked;
      grpc::ByteBuffer bytes(*request);
      EXPECT_TRUE(
          grpc::SerializationTraits<v1::WatchCellRequest>::Deserialize(&bytes, &asked).ok());
      auto made = MakeCellWatch(needs_, asked, "local");
      if (keeps) kept_ = made;
      return made->Begin();
    }

    std::atomic<bool> keeps = false;  // the newest, beyond its end

   private:
    const CellWatchNeeds needs_;
    std::shared_ptr<PullStream<grpc::ByteBuffer>> kept_;
  };
  class Machines final : public v1::MachineService::CallbackService {
   public:
    explicit Machines(MachineWatchNeeds needs) : needs_(std::move(needs)) {}
    grpc::ServerWriteReactor<v1::WatchMachineResponse>* WatchMachine(
        grpc::CallbackServerContext* /*context*/, const v1::WatchMachineRequest* request) override {
      return MakeMachineWatch(needs_, *request)->Begin();
    }
    grpc::ServerWriteReactor<v1::ExportJournalResponse>* ExportJournal(
        grpc::CallbackServerContext* /*context*/,
        const v1::ExportJournalRequest* request) override {
      return MakeJournalExport(
                 {.executor = needs_.executor, .open = needs_.open, .store = needs_.store},
                 *request)
          ->Begin();
    }

   private:
    const MachineWatchNeeds needs_;
  };

  WatchClocks() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&cell_);
    builder.RegisterService(&machines_);
    server_ = builder.BuildAndStart();
    cell_stub_ = v1::CellService::NewStub(server_->InProcessChannel({}));
    machine_stub_ = v1::MachineService::NewStub(server_->InProcessChannel({}));
  }
  ~WatchClocks() override {
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
  }

  OpenedStream<v1::WatchCellResponse> WatchJobs(double rate_hz) {
    v1::WatchCellRequest request;
    v1::Subscription& jobs = *request.add_subscriptions();
    jobs.set_id("jobs");
    jobs.set_max_rate_hz(rate_hz);
    jobs.mutable_jobs();
    return OpenedStream<v1::WatchCellResponse>(
        [&](grpc::ClientContext* context) { return cell_stub_->WatchCell(context, request); });
  }
  OpenedStream<v1::WatchMachineResponse> WatchMill(double rate_hz) {
    v1::WatchMachineRequest request;
    request.set_name(kMill);
    request.set_max_rate_hz(rate_hz);
    return OpenedStream<v1::WatchMachineResponse>([&](grpc::ClientContext* context) {
      return machine_stub_->WatchMachine(context, request);
    });
  }
  OpenedStream<v1::ExportJournalResponse> Journal(std::int64_t job) {
    v1::ExportJournalRequest request;
    request.set_machine("machines/optimo-1");
    request.set_job(JobName(job));
    return OpenedStream<v1::ExportJournalResponse>([&](grpc::ClientContext* context) {
      return machine_stub_->ExportJournal(context, request);
    });
  }
  void TellState(v1::MachineState state) {
    v1::MachineStatus status;
    status.set_machine(kMill);
    status.set_state(state);
    const std::uint64_t before = room.feed.version();
    room.feed.Publish(kMill, status.SerializeAsString());
    EXPECT_TRUE(Eventually([&] { return room.feed.version() > before; }));
  }
  void KeepWatches() { cell_.keeps = true; }
  // A watch that has looked at the clock may not have looked at the log yet. While the second of
  // two snapshots waits for its reader it looks at neither: what happens then it sees at once.
  void BehindSnapshots(OpenedStream<v1::WatchCellResponse>& watch, const std::string& watch_id,
                       const std::function<void()>& happens) {
    v1::UpdateWatchRequest change;
    change.set_watch_id(watch_id);
    for (const char* id : {"first", "second"}) {
      v1::Subscription& added = *change.add_add();
      added.set_id(id);
      added.mutable_projects();
    }
    ASSERT_TRUE(room.registry.Change(change, "local"));
    EXPECT_EQ(WordOf(watch.Next()), "snapshot");
    happens();
    EXPECT_TRUE(
        Eventually([&] { return room.feed.position() == Must(room.bed.store().LastPosition()); }));
    EXPECT_EQ(WordOf(watch.Next()), "snapshot");
  }
  static std::string WordOf(const v1::WatchCellResponse& message) {
    if (message.has_progress()) return "at " + std::to_string(message.progress().steps());
    if (message.has_event()) return message.event().job().message().text();
    return message.has_snapshot() ? "snapshot" : message.has_bookmark() ? "bookmark" : "nothing";
  }

  StreamBed room;
  StandingClock clock;

 private:
  Executor executor_{2};
  JobBook book_{room.bed.store(), room.config};
  JobFactsBook facts_{room.bed.store()};
  CellRecords records_{room.bed.store(), book_, room.programs, room.projects};
  SharedLogs logs_{{records_, room.feed, facts_, "this server"}};
  Cell cell_{{.executor = executor_,
              .open = room.open,
              .records = records_,
              .feed = room.feed,
              .logs = logs_,
              .facts = facts_,
              .registry = room.registry,
              .instance_id = "this server",
              .clock = clock.clock(),
              .bookmark_interval = kBookmarks}};
  Machines machines_{{.executor = executor_,
                      .open = room.open,
                      .store = room.bed.store(),
                      .feed = room.feed,
                      .instance_id = "this server",
                      .clock = clock.clock()}};
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::CellService::Stub> cell_stub_;
  std::unique_ptr<v1::MachineService::Stub> machine_stub_;
};

// WEB, needs 1: with two a second what comes within half a second waits, and comes with its end.
TEST_F(WatchClocks, APositionComesWhenItsTimeHasCome) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  auto watch = WatchJobs(2.0);
  EXPECT_EQ(WordOf(watch.Next()), "snapshot");
  room.TellSteps(job, 1);
  EXPECT_EQ(WordOf(watch.Next()), "at 1");
  room.TellSteps(job, 2);
  clock.Advance(std::chrono::nanoseconds(499'999'999));
  EXPECT_TRUE(clock.IsWaitedFor());
  room.TellSteps(job, 3);
  room.Say(lease, {"early"});
  EXPECT_EQ(WordOf(watch.Next()), "early");
  EXPECT_TRUE(clock.IsWaitedFor());
  clock.Advance(std::chrono::nanoseconds(1));
  EXPECT_EQ(WordOf(watch.Next()), "at 3");
}

// Without a rate each comes at once, though no time passes.
TEST_F(WatchClocks, WithoutARateNothingWaits) {
  const std::int64_t job = room.Submit();
  room.bed.Lease();
  auto watch = WatchJobs(0.0);
  EXPECT_EQ(WordOf(watch.Next()), "snapshot");
  for (const int steps : {1, 2, 3}) {
    room.TellSteps(job, steps);
    EXPECT_EQ(WordOf(watch.Next()), "at " + std::to_string(steps));
  }
  auto mill = WatchMill(0.0);
  EXPECT_EQ(mill.Next().status().state(), v1::MACHINE_STATE_IDLE);
  for (const auto state : {v1::MACHINE_STATE_RUNNING, v1::MACHINE_STATE_HELD}) {
    TellState(state);
    EXPECT_EQ(mill.Next().status().state(), state);
  }
}

// What a subscription does not want takes nothing of its rate.
TEST_F(WatchClocks, WhatIsNotWantedPutsNothingOff) {
  const std::int64_t job = room.Submit();
  room.bed.Lease();
  auto watch = WatchJobs(2.0);
  EXPECT_EQ(WordOf(watch.Next()), "snapshot");
  for (int i = 1; i <= 10; ++i) {
    TellState(i % 2 == 0 ? v1::MACHINE_STATE_HELD : v1::MACHINE_STATE_RUNNING);
    room.TellSteps(job, i);
    ASSERT_EQ(WordOf(watch.Next()), "at " + std::to_string(i));
    clock.Advance(std::chrono::milliseconds(500));
  }
}

// WEB, needs 1: a bookmark at least so often, before what else there is to tell then.
TEST_F(WatchClocks, ABookmarkComesWhenItsTimeHasCome) {
  room.Submit();
  const storage::Lease lease = room.bed.Lease();
  auto watch = WatchJobs(0.0);
  const v1::WatchCellResponse first = watch.Next();
  EXPECT_EQ(WordOf(first), "snapshot");
  room.Say(lease, {"a"});
  EXPECT_EQ(WordOf(watch.Next()), "a");
  clock.Advance(kBookmarks - std::chrono::nanoseconds(1));
  room.Say(lease, {"b"});
  EXPECT_EQ(WordOf(watch.Next()), "b");
  BehindSnapshots(watch, first.watch_id(), [&] {
    clock.Advance(std::chrono::nanoseconds(1));
    room.Say(lease, {"c"});
  });
  EXPECT_EQ(WordOf(watch.Next()), "bookmark");
  EXPECT_EQ(WordOf(watch.Next()), "c");
  BehindSnapshots(watch, first.watch_id(), [&] {
    clock.Advance(kBookmarks + std::chrono::nanoseconds(1));  // it may be late
    room.Say(lease, {"d"});
  });
  EXPECT_EQ(WordOf(watch.Next()), "bookmark");
  EXPECT_EQ(WordOf(watch.Next()), "d");
}

// Nobody can change it any more, also where somebody still has the stream.
TEST_F(WatchClocks, AWatchThatIsOverIsUnknown) {
  KeepWatches();
  auto watch = WatchJobs(0.0);
  v1::UpdateWatchRequest change;
  change.set_watch_id(watch.Next().watch_id());
  ASSERT_TRUE(room.registry.Change(change, "local"));
  watch.Cancel();
  EXPECT_TRUE(Eventually(
      [&] { return CodeOf(room.registry.Change(change, "local")) == ErrorCode::kCellNotFound; }));
}

// MachineService.WatchMachine: once a second the newest status, and the first one counts.
TEST_F(WatchClocks, AStatusComesWhenItsTimeHasCome) {
  auto mill = WatchMill(1.0);
  EXPECT_EQ(mill.Next().status().state(), v1::MACHINE_STATE_IDLE);
  TellState(v1::MACHINE_STATE_RUNNING);
  clock.Advance(std::chrono::nanoseconds(999'999'999));
  EXPECT_TRUE(clock.IsWaitedFor());
  TellState(v1::MACHINE_STATE_HELD);
  EXPECT_TRUE(clock.IsWaitedFor());
  clock.Advance(std::chrono::nanoseconds(1));
  EXPECT_EQ(mill.Next().status().state(), v1::MACHINE_STATE_HELD);
}

// machine.proto ExportJournal: all of it in parts, in order, none of them empty.
TEST_F(WatchClocks, ALongJournalGoesOutInParts) {
  std::string kept;
  for (int i = 0; kept.size() < 2 * kChunkBytes + 1000; ++i) kept += std::to_string(i) + ';';
  kept.resize(2 * kChunkBytes + 1000);
  auto journal = Journal(room.Ended("recording", kept));
  std::string together;
  std::vector<std::size_t> sizes;
  for (const v1::ExportJournalResponse& part : journal.Rest()) {
    sizes.push_back(part.chunk().size());
    together += part.chunk();
    if (together.size() > kept.size()) break;
  }
  EXPECT_EQ(sizes, (std::vector<std::size_t>{kChunkBytes, kChunkBytes, 1000}));
  EXPECT_TRUE(together == kept);
}

// Of a job of which nothing was ever told there is nothing to wait for when it is over.
TEST_F(WatchClocks, AJobWithoutEventsEndsItsWatch) {
  const std::int64_t job =
      Must(room.bed.store().SubmitAndWait({.machine = "optimo-1", .kind = "CHECK"})).job.id;
  v1::Outcome outcome;
  outcome.set_kind(v1::Outcome::KIND_COMPLETED);
  Must(room.bed.store().Finish(room.bed.Lease(), {.outcome = OutcomeOf(outcome)}));
  auto watch = room.Watch(job);
  const std::vector<v1::WatchJobResponse> told = watch.Rest();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_TRUE(told[0].has_snapshot());
  EXPECT_EQ(told[0].snapshot().last_sequence(), 0);
  watch.ExpectGoodEnd();
}

// What is made of one event is made once, however large it is; a filter asks the store, and what
// was made already is there at once all the same.
TEST_F(WatchClocks, OneLargeMessageIsKept) {
  room.Submit();
  const storage::Lease lease = room.bed.Lease();
  const std::int64_t before = Must(room.bed.store().LastPosition());
  room.Say(lease, {std::string(SharedLog::kBytesOfOne, 'x')});
  ASSERT_TRUE(
      Eventually([&] { return room.feed.position() == Must(room.bed.store().LastPosition()); }));
  JobBook book{room.bed.store(), room.config};
  JobFactsBook facts{room.bed.store()};
  const CellRecords records{room.bed.store(), book, room.programs, room.projects};
  v1::Subscription wanted;
  wanted.set_id("jobs");
  wanted.mutable_jobs()->set_filter("kind = CHECK");
  const auto log = std::make_shared<SharedLog>(
      SharedLogNeeds{records, room.feed, facts, "instance"}, std::make_shared<ToldEvents>(records),
      std::vector<CellSubscription>{Must(CellSubscription::Make(wanted))});
  EXPECT_FALSE(log->AtOnce(before, false));
  const auto first = Must(log->After(before, false));
  ASSERT_TRUE(first && first->message);
  EXPECT_EQ(Must(log->After(before, false))->message->begin(), first->message->begin());
  const auto again = log->AtOnce(before, false);
  ASSERT_TRUE(again && again->message);
  EXPECT_EQ(again->message->begin(), first->message->begin());
  EXPECT_FALSE(log->AtOnce(before, true));  // of several in one none was made
}

}  // namespace
}  // namespace rmlcell::server
