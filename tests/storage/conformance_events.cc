// Events, watchers and artifacts of any Store.
#include <gmock/gmock.h>

#include <algorithm>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<NewEvent> EventsNamed(const std::vector<std::string>& kinds) {
  std::vector<NewEvent> events;
  for (const std::string& kind : kinds) events.push_back({.kind = kind, .payload = "p" + kind});
  return events;
}

// A place where a watcher tells and a test waits.
class Bell {
 public:
  void Ring() {
    const std::lock_guard lock(mutex_);
    ++rings_;
    rung_.notify_all();
  }
  bool WaitFor(int rings) {
    std::unique_lock lock(mutex_);
    return rung_.wait_for(lock, kPatience, [&] { return rings_ >= rings; });
  }
  int rings() {
    const std::lock_guard lock(mutex_);
    return rings_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable rung_;
  int rings_ = 0;
};

// records.h: sequence numbers of a job from 1 without a gap, positions growing over all jobs.
TEST_P(StoreConformance, EventsAreNumberedWithoutGap) {
  const LeasedJob first = (Submit(), Acquire());
  const LeasedJob second = (Submit(), Acquire());
  clock().Advance(std::chrono::seconds(1));
  EXPECT_EQ(Must(store().AppendAndWait(first.lease, EventsNamed({"a", "b"}))), 2);
  EXPECT_EQ(Must(store().AppendAndWait(second.lease, EventsNamed({"c"}))), 1);
  EXPECT_EQ(Must(store().AppendAndWait(first.lease, {})), 2);
  Reopen();
  EXPECT_EQ(Must(store().AppendAndWait(first.lease, EventsNamed({"d"}))), 3);
  EXPECT_EQ(Must(store().GetJob(first.job.id)).last_sequence, 3);

  const auto events = EventsOf(first.job.id);
  EXPECT_THAT(KindsOf(events), ElementsAre("a", "b", "d"));
  ExpectWithoutGap(events);
  EXPECT_EQ(events[1].payload, "pb");
  EXPECT_EQ(events[1].job, first.job.id);
  EXPECT_EQ(events[1].attempt, 1);
  EXPECT_EQ(events[1].at, clock().Now());
  const auto all = Must(store().AllEvents(0, 100));
  EXPECT_THAT(KindsOf(all), ElementsAre("a", "b", "c", "d"));
  EXPECT_EQ(Must(store().LastPosition()), all.back().position);
  EXPECT_EQ(Must(store().EventsGoneUntil()), 0);
}

TEST_P(StoreConformance, EventsAreReadInPages) {
  const LeasedJob leased = (Submit(), Acquire());
  Must(store().AppendAndWait(leased.lease, EventsNamed({"1", "2", "3", "4", "5"})));
  const std::int64_t job = leased.job.id;
  EXPECT_THAT(KindsOf(Must(store().JobEvents(job, 0, 2))), ElementsAre("1", "2"));
  EXPECT_THAT(KindsOf(Must(store().JobEvents(job, 2, 2))), ElementsAre("3", "4"));
  EXPECT_THAT(KindsOf(Must(store().JobEvents(job, 4, 2))), ElementsAre("5"));
  EXPECT_THAT(Must(store().JobEvents(job, 5, 2)), IsEmpty());
  EXPECT_THAT(Must(store().JobEvents(job, 99, 2)), IsEmpty());
  EXPECT_THAT(Must(store().JobEvents(job, 0, 0)), IsEmpty());
  EXPECT_THAT(Must(store().JobEvents(job, 0, -1)), IsEmpty());
  const auto page = Must(store().AllEvents(0, 3));
  EXPECT_THAT(KindsOf(page), ElementsAre("1", "2", "3"));
  EXPECT_THAT(KindsOf(Must(store().AllEvents(page.back().position, 3))), ElementsAre("4", "5"));
  EXPECT_THAT(Must(store().AllEvents(0, -1)), IsEmpty());
}

TEST_P(StoreConformance, LastPositionOfAnEmptyStoreIs0) {
  EXPECT_EQ(Must(store().LastPosition()), 0);
  EXPECT_THAT(Must(store().AllEvents(0, 10)), IsEmpty());
}

// records.h kEventPayloadBytesMax, both sides; the batch around one that is too large is not
// written.
TEST_P(StoreConformance, LargestEventIsTaken) {
  const LeasedJob leased = (Submit(), Acquire());
  const std::string largest = Noise(kEventPayloadBytesMax, 6);
  EXPECT_EQ(CodeOf(store().AppendAndWait(leased.lease, {{.kind = "a", .payload = ""},
                                                        {.kind = "b", .payload = largest + "x"}})),
            ErrorCode::kCellTooLarge);
  EXPECT_THAT(EventsOf(leased.job.id), IsEmpty());
  EXPECT_EQ(Must(store().AppendAndWait(leased.lease, {{.kind = "c", .payload = largest}})), 1);
  EXPECT_TRUE(EventsOf(leased.job.id).at(0).payload == largest);
}

// store.h Append: what one thread appends is written in the order of its calls, and answered in it.
TEST_P(StoreConformance, AppendedEventsKeepTheirOrder) {
  const LeasedJob leased = (Submit(), Acquire());
  constexpr int kBatches = 200;
  std::mutex mutex;
  std::vector<std::int64_t> answers;
  Bell bell;
  for (int i = 0; i < kBatches; ++i) {
    store().Append(leased.lease, EventsNamed({std::to_string(2 * i), std::to_string(2 * i + 1)}),
                   [&](const Result<std::int64_t>& last) {
                     const std::lock_guard lock(mutex);
                     answers.push_back(last ? *last : -1);
                     bell.Ring();
                   });
  }
  ASSERT_TRUE(bell.WaitFor(kBatches));
  const std::lock_guard lock(mutex);
  for (int i = 0; i < kBatches; ++i) {
    EXPECT_EQ(answers[static_cast<std::size_t>(i)], 2 * i + 2);
  }
  const auto events = EventsOf(leased.job.id);
  ExpectWithoutGap(events);
  for (std::size_t i = 0; i < events.size(); ++i) EXPECT_EQ(events[i].kind, std::to_string(i));
}

// Positions grow in the order of commits: who reads on from the newest position seen misses
// nothing.
TEST_P(StoreConformance, ReaderOfAllEventsMissesNothing) {
  constexpr int kWorkers = 6;
  constexpr int kBatches = 40;
  std::vector<LeasedJob> jobs;
  for (int i = 0; i < kWorkers; ++i) jobs.push_back((Submit(), Acquire()));
  std::atomic<bool> done = false;
  std::vector<EventRecord> seen;
  std::jthread reader([&] {
    for (;;) {
      const bool last = done;
      const auto page = Must(store().AllEvents(seen.empty() ? 0 : seen.back().position, 16));
      seen.insert(seen.end(), page.begin(), page.end());
      if (page.empty() && last) return;
    }
  });
  {
    std::vector<std::jthread> workers;
    for (const LeasedJob& job : jobs) {
      workers.emplace_back([&] {
        for (int i = 0; i < kBatches; ++i) {
          Must(store().AppendAndWait(job.lease, EventsNamed({"x", "y", "z"})));
        }
      });
    }
  }
  done = true;
  reader.join();
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(kWorkers * kBatches * 3));
  EXPECT_TRUE(std::ranges::is_sorted(seen, std::less_equal(), &EventRecord::position));
  for (const LeasedJob& job : jobs) {
    const auto events = EventsOf(job.job.id);
    EXPECT_EQ(events.size(), static_cast<std::size_t>(kBatches * 3));
    ExpectWithoutGap(events);
  }
}

// store.h Watch: a hint after each commit that wrote events or changed jobs.
TEST_P(StoreConformance, WatcherIsToldOfEveryKindOfChange) {
  Bell bell;
  const auto watch = store().Watch([&] { bell.Ring(); });
  int told = 0;
  const auto expect_told = [&](const std::string& what) {
    EXPECT_TRUE(bell.WaitFor(told + 1)) << what;
    told = bell.rings();
  };
  Submit();
  expect_told("submit");
  const LeasedJob leased = Acquire();
  expect_told("acquire");
  Must(store().AppendAndWait(leased.lease, EventsNamed({"e"})));
  expect_told("append");
  Must(store().RequestCancel(leased.job.id, {}));
  expect_told("cancel");
  Finish(leased.lease);
  expect_told("finish");
}

// store.h Watch: when the hint comes, the rows are there.
TEST_P(StoreConformance, WatcherFindsTheRows) {
  std::atomic<std::int64_t> read_until = 0;
  Bell bell;
  const auto watch = store().Watch([&] {
    for (const EventRecord& event : Must(store().AllEvents(read_until, 1000))) {
      read_until = event.position;
    }
    bell.Ring();
  });
  const LeasedJob leased = (Submit(), Acquire());
  std::int64_t last = 0;
  for (int i = 0; i < 100; ++i) {
    last = Must(store().AppendAndWait(leased.lease, EventsNamed({"e"})));
  }
  EXPECT_EQ(last, 100);
  const std::int64_t position = Must(store().LastPosition());
  Eventually([&] { return read_until >= position; });
  EXPECT_EQ(read_until, position);
}

// store.h Watch: after the handle is gone there is no call, not even one under way.
TEST_P(StoreConformance, EndedWatcherIsNotCalled) {
  for (int round = 0; round < 30; ++round) {
    auto alive = std::make_unique<std::atomic<bool>>(true);
    std::atomic<int> bad = 0;
    std::atomic<int> calls = 0;
    auto watch = store().Watch([&bad, &calls, flag = alive.get()] {
      ++calls;
      for (int i = 0; i < 200; ++i) {
        if (!*flag) ++bad;
        std::this_thread::yield();
      }
    });
    std::jthread writer([&] {
      for (int i = 0; i < 5; ++i) Submit();
    });
    // Before a call or in the middle of one, as it happens.
    ASSERT_TRUE(Eventually([&] { return calls >= round % 2; }));
    watch.reset();
    *alive = false;
    writer.join();
    EXPECT_EQ(bad, 0);
  }
}

// store.h Watch: the handle may be destroyed inside the call itself, or of another watcher.
TEST_P(StoreConformance, WatchersMayEndInsideACall) {
  Bell own;
  Bell other;
  std::unique_ptr<Store::Subscription> first;
  std::unique_ptr<Store::Subscription> second;
  std::mutex mutex;
  const auto end_both = [&](Bell& bell) {
    const std::lock_guard lock(mutex);
    first.reset();
    second.reset();
    bell.Ring();
  };
  {
    const std::lock_guard lock(mutex);
    first = store().Watch([&] { end_both(own); });
    second = store().Watch([&] { end_both(other); });
  }
  Submit();
  const auto rings = [&] { return own.rings() + other.rings(); };
  ASSERT_TRUE(Eventually([&] { return rings() > 0; }));
  EXPECT_EQ(rings(), 1);
  // One that watches later is told of both: when it hears of the second, all was told of the first.
  Bell later;
  const auto third = store().Watch([&] { later.Ring(); });
  for (int told = 1; told <= 2; ++told) {
    Submit();
    ASSERT_TRUE(later.WaitFor(told));
  }
  EXPECT_EQ(rings(), 1);
}

TEST_P(StoreConformance, WatcherMayOutliveTheStore) {
  auto watch = store().Watch([] {});
  Submit();
  Reopen();
  watch.reset();
  EXPECT_EQ(Submit().id, 2);
}

// A watcher that is slow delays no writer.
TEST_P(StoreConformance, SlowWatcherDelaysNobody) {
  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  std::promise<void> entered;
  std::once_flag once;
  const auto watch = store().Watch([&] {
    std::call_once(once, [&] { entered.set_value(); });
    released.wait();
  });
  Submit();
  entered.get_future().wait();
  for (int i = 0; i < 20; ++i) Submit();  // would hang
  release.set_value();
  EXPECT_EQ(Must(store().CountJobs()).queued, 21);
}

// records.h: artifacts by content; store.h: of any size, by name, after a restart.
TEST_P(StoreConformance, ArtifactsComeBack) {
  const LeasedJob leased = (Submit(), Acquire());
  const std::string toolpath = PlotText(3'500'000);
  const std::string picture = Noise(1'200'000, 7);
  Must(store().Finish(
      leased.lease,
      {.artifacts = {{.name = "toolpath", .media_type = "text/plain", .bytes = toolpath},
                     {.name = "picture.svg", .media_type = "image/svg+xml", .bytes = picture},
                     {.name = "empty", .media_type = "", .bytes = ""}}}));
  Reopen();
  const auto artifacts = Must(store().ListArtifacts(leased.job.id));
  ASSERT_EQ(artifacts.size(), 3U);
  EXPECT_EQ(artifacts[0].name, "empty");
  EXPECT_EQ(artifacts[0].size, 0);
  // SHA-256 of nothing, as in RFC 6234's tests.
  EXPECT_EQ(artifacts[0].sha256,
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(artifacts[1].name, "picture.svg");
  EXPECT_EQ(artifacts[2].name, "toolpath");
  EXPECT_EQ(artifacts[2].media_type, "text/plain");
  EXPECT_EQ(artifacts[2].size, 3'500'000);
  EXPECT_EQ(artifacts[2].job, leased.job.id);
  EXPECT_TRUE(Must(store().ReadBlob(artifacts[2].sha256)) == toolpath);
  EXPECT_TRUE(Must(store().ReadBlob(artifacts[1].sha256)) == picture);
  EXPECT_TRUE(Must(store().ReadArtifact(leased.job.id, "toolpath")) == toolpath);
  EXPECT_EQ(Must(store().ReadArtifact(leased.job.id, "empty")), "");
  const ArtifactRecord one = Must(store().GetArtifact(leased.job.id, "picture.svg"));
  EXPECT_EQ(one.sha256, artifacts[1].sha256);
  EXPECT_EQ(one.media_type, "image/svg+xml");
  EXPECT_EQ(CodeOf(store().GetArtifact(leased.job.id, "missing")), ErrorCode::kCellNotFound);
}

// store.h NewJob: attachments are artifacts of the job from the start, by bytes or by the hash of
// what is there, and outlive the slot they came from.
TEST_P(StoreConformance, AttachmentsStayWithTheJob) {
  PutMachine("m");
  const std::string hash = PutProgram("m", 1, "stored program").object_sha256;
  const JobRecord job =
      Must(store().SubmitAndWait(
               {.kind = "SIMULATE",
                .attachments = {{.name = "main", .existing_sha256 = hash},
                                {.name = "program-2", .media_type = "x", .bytes = "inline"}}}))
          .job;
  Must(store().DeleteProgram("m", 1, kAnyRevision));
  PutProgram("m", 1, "another program");
  Reopen();
  EXPECT_EQ(Must(store().ReadArtifact(job.id, "main")), "stored program");
  EXPECT_EQ(Must(store().ReadArtifact(job.id, "program-2")), "inline");
  const LeasedJob leased = Acquire();
  EXPECT_EQ(CodeOf(store().Finish(leased.lease, {.artifacts = {{.name = "main", .bytes = "x"}}})),
            ErrorCode::kCellInvalidArgument);
  Must(store().Finish(leased.lease, {.artifacts = {{.name = "report", .existing_sha256 = hash}}}));
  EXPECT_EQ(Must(store().ListArtifacts(job.id)).size(), 3U);
}

TEST_P(StoreConformance, ContentThatIsNotThereCannotBeAttached) {
  for (const std::string& hash : {std::string(64, 'a'), std::string("no hash")}) {
    EXPECT_EQ(
        CodeOf(store().SubmitAndWait({.attachments = {{.name = "main", .existing_sha256 = hash}}})),
        ErrorCode::kCellNotFound);
    EXPECT_EQ(CodeOf(store().ReadBlob(hash)), ErrorCode::kCellNotFound);
  }
  const LeasedJob leased = (Submit(), Acquire());
  EXPECT_EQ(
      CodeOf(store().Finish(
          leased.lease, {.artifacts = {{.name = "a", .existing_sha256 = std::string(64, 'a')}}})),
      ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(store().GetJob(leased.job.id)).state, JobState::kRunning);
}

// Many who put the same and different contents at once: each gets back what it put.
TEST_P(StoreConformance, ManyWritersShareContents) {
  constexpr int kThreads = 6;
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&, thread] {
        for (int i = 0; i < 6; ++i) {
          // Seeds are shared by threads that are three apart; some contents need several chunks.
          const auto seed = static_cast<std::uint64_t>(i * 3 + thread % 3);
          const std::string bytes = Noise(i % 2 == 0 ? 5'000 : 1'500'000, seed);
          const std::string id = Numbered("p", thread);
          const auto put = store().PutProject({.id = id, .body = bytes}, kAnyRevision);
          const auto got = store().GetProject(id);
          if (!put || !got || got->body != bytes) ++wrong;
          if (i % 3 == 2 && !store().DeleteProject(id, kAnyRevision)) ++wrong;
        }
      });
    }
  }
  EXPECT_EQ(wrong, 0);
}

// What a function holds goes with its watch, another watch of the same store among it.
TEST_P(StoreConformance, AWatchMayHoldAnotherOne) {
  Bell told;
  {
    std::shared_ptr<Store::Subscription> inner = store().Watch([&] { told.Ring(); });
    const auto outer = store().Watch([inner] {});
    inner.reset();
    Submit();
    ASSERT_TRUE(told.WaitFor(1));
  }
  Bell again;
  const auto watch = store().Watch([&] { again.Ring(); });
  Submit();
  EXPECT_TRUE(again.WaitFor(1));
}

}  // namespace
}  // namespace rmlcell::storage
