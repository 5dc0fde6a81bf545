#include "server/events/event_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "tests/server/events/fake_log.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::EventRecord;
using Clock = std::chrono::steady_clock;

// Reads the log of the whole cell whenever it is woken, in batches of its own size, from any
// position.
class Reader {
 public:
  Reader(EventFeed& feed, std::int64_t after, int batch)
      : feed_(feed), cursor_(after), batch_(batch) {
    subscription_ = feed_.Subscribe(std::nullopt, [this] {
      woken_ = true;
      woken_.notify_all();
    });
    thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
  }
  ~Reader() { Stop(); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  void Stop() {
    subscription_.reset();
    thread_.request_stop();
    woken_ = true;
    woken_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  std::size_t count() const { return count_; }
  // After Stop().
  const std::vector<EventRecord>& events() const { return events_; }

 private:
  void Run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      for (;;) {
        Result<std::vector<EventRecord>> read = feed_.EventsAfter(cursor_, batch_);
        if (!read || read->empty()) break;
        cursor_ = read->back().position;
        for (EventRecord& event : *read) events_.push_back(std::move(event));
        count_ = events_.size();
      }
      woken_.wait(false);
      woken_ = false;
    }
  }

  EventFeed& feed_;
  std::int64_t cursor_;
  int batch_;
  std::vector<EventRecord> events_;
  std::atomic<std::size_t> count_ = 0;
  std::atomic<bool> woken_ = true;
  std::unique_ptr<EventFeed::Subscription> subscription_;
  std::jthread thread_;
};

void ExpectPositions(const std::vector<EventRecord>& events, std::int64_t first,
                     std::size_t count) {
  ASSERT_EQ(events.size(), count);
  for (std::size_t i = 0; i < count; ++i)
    ASSERT_EQ(events[i].position, first + static_cast<std::int64_t>(i));
}

// Issue "Watch": log events, each exactly once and in order, whoever writes and whoever reads at
// the time.
TEST(EventFeed, EveryReaderGetsEveryEventOnceAndInOrderWhileManyWrite) {
  constexpr int kWriters = 4;
  constexpr int kBatches = 60;
  ServerBed bed;
  std::vector<storage::Lease> leases;
  for (int i = 0; i < kWriters; ++i) {
    bed.SubmitCheck();
    leases.push_back(bed.Lease());
  }
  const std::int64_t begin = Must(bed.store().LastPosition());
  EventFeed feed(bed.store());
  std::vector<std::unique_ptr<Reader>> readers;
  for (const int batch : {1, 3, 64, 1000})
    readers.push_back(std::make_unique<Reader>(feed, begin, batch));
  {
    std::vector<std::jthread> writers;
    for (const storage::Lease& lease : leases) {
      writers.emplace_back([&bed, lease] {
        for (int i = 0; i < kBatches; ++i) bed.Append(lease, 1 + i % 3, std::to_string(i));
      });
    }
  }
  constexpr std::size_t kEvents = kWriters * kBatches * 2;  // 1 + i % 3 is 2 on average
  for (const auto& reader : readers) {
    EXPECT_TRUE(Eventually([&] { return reader->count() >= kEvents; })) << reader->count();
  }
  for (const auto& reader : readers) {
    reader->Stop();
    ExpectPositions(reader->events(), begin + 1, kEvents);
    std::map<std::int64_t, std::int64_t> sequences;
    for (const EventRecord& event : reader->events()) {
      std::int64_t& last = sequences[event.job];
      if (last != 0) {
        EXPECT_EQ(event.sequence, last + 1) << "job " << event.job;
      }
      last = event.sequence;
    }
    EXPECT_EQ(sequences.size(), static_cast<std::size_t>(kWriters));
  }
}

// Who comes back says the last position it saw: nothing is left out, nothing comes twice.
TEST(EventFeed, AReaderThatComesBackGoesOnWhereItWas) {
  ServerBed bed;
  bed.SubmitCheck();
  const storage::Lease lease = bed.Lease();
  const std::int64_t begin = Must(bed.store().LastPosition());
  EventFeed feed(bed.store());
  bed.Append(lease, 300);
  ASSERT_TRUE(Eventually([&] { return feed.position() == begin + 300; }));
  for (const std::int64_t seen : {0, 1, 150, 299, 300}) {
    Reader reader(feed, begin + seen, 7);
    const auto left = static_cast<std::size_t>(300 - seen);
    EXPECT_TRUE(Eventually([&] { return reader.count() >= left; }));
    reader.Stop();
    ExpectPositions(reader.events(), begin + seen + 1, left);
  }
  EXPECT_TRUE(Must(feed.EventsAfter(begin + 300, 10)).empty());
  EXPECT_TRUE(Must(feed.EventsAfter(begin + 9999, 10)).empty());
  EXPECT_TRUE(Must(feed.EventsAfter(begin, 0)).empty());
}

TEST(EventFeed, WakesTheWatchersOfTheJobAndThoseOfEverything) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<int> one = 0;
  std::atomic<int> two = 0;
  std::atomic<int> all = 0;
  const auto watch_one = feed.Subscribe(1, [&] { ++one; });
  const auto watch_two = feed.Subscribe(2, [&] { ++two; });
  const auto watch_all = feed.Subscribe(std::nullopt, [&] { ++all; });
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return all >= 1; }));
  EXPECT_EQ(one, 1);
  EXPECT_EQ(two, 0);
  log.Write(2, 5);
  ASSERT_TRUE(Eventually([&] { return all >= 2; }));
  EXPECT_EQ(one, 1);
  EXPECT_EQ(two, 1);  // one commit wakes once, whatever it holds
}

// The fake log answers no question about one job: what comes, comes from memory. Issue "Watch": many
// watchers of a job cost the store no more than one.
TEST(EventFeed, ServesTheWatchersOfAJobFromMemory) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<int> woken = 0;
  auto first = feed.Subscribe(1, [&] { ++woken; });
  auto second = feed.Subscribe(1, [&] { ++woken; });
  log.Write(1, 3);
  ASSERT_TRUE(Eventually([&] { return woken >= 2; }));
  const Result<std::vector<EventRecord>> all = feed.JobEvents(1, 0, 100);
  ASSERT_TRUE(all);
  ExpectPositions(*all, 1, 3);
  const Result<std::vector<EventRecord>> rest = feed.JobEvents(1, 1, 1);
  ASSERT_TRUE(rest);
  ExpectPositions(*rest, 2, 1);
  EXPECT_TRUE(feed.JobEvents(1, 3, 100)->empty());

  log.Write(1, 2'000);  // more than memory keeps: who is that far behind asks the store
  ASSERT_TRUE(Eventually([&] { return woken >= 4 && feed.position() == 2'003; }));
  EXPECT_FALSE(feed.JobEvents(1, 3, 100));
  EXPECT_TRUE(feed.JobEvents(1, 2'000, 100));

  first.reset();
  EXPECT_TRUE(feed.JobEvents(1, 2'000, 100));
  second.reset();
  EXPECT_FALSE(feed.JobEvents(1, 2'000, 100));  // nobody watches: nothing is kept
}

// Another server may write to the same store: then there is no hint.
TEST(EventFeed, FindsEventsWithoutAHint) {
  FakeLog log;
  EventFeed feed(log);
  const auto hint = log.Watch([] {});  // takes the hint away from the feed
  ASSERT_TRUE(Eventually([&] { return log.reads() >= 1; }));
  log.Write(1, 3);
  EXPECT_TRUE(Eventually([&] { return feed.position() == 3; }));
}

TEST(EventFeed, GoesOnWhenAFailingStoreWorksAgain) {
  FakeLog log;
  EventFeed feed(log);
  log.Fail(true);
  log.Write(1, 3);
  const int before = log.reads();
  ASSERT_TRUE(Eventually([&] { return log.reads() > before + 1; }));  // it keeps trying
  EXPECT_EQ(feed.position(), 0);
  log.Fail(false);
  EXPECT_TRUE(Eventually([&] { return feed.position() == 3; }));
  ExpectPositions(Must(feed.EventsAfter(0, 10)), 1, 3);
}

// A store that keeps a bounded log may have removed events before they were read here.
TEST(EventFeed, SkipsEventsThatAreGoneAndTellsWatchersSo) {
  FakeLog log;
  EventFeed feed(log);
  log.Write(1, 2);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 2; }));
  std::atomic<int> woken = 0;
  const auto watch = feed.Subscribe(7, [&] { ++woken; });
  log.Fail(true);
  log.Write(7, 10);
  log.ForgetAll();
  log.Fail(false);
  log.Hint();
  ASSERT_TRUE(Eventually([&] { return feed.position() == 12; }));
  ASSERT_TRUE(Eventually([&] { return woken >= 1; }));
  EXPECT_EQ(CodeOf(feed.EventsAfter(2, 10)), ErrorCode::kCellEventsGone);
  log.Write(7, 1);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 13; }));
  ExpectPositions(Must(feed.EventsAfter(12, 10)), 13, 1);
}

// A watcher costs a cursor: what is in memory is bounded, what is older comes from the log.
TEST(EventFeed, KeepsSoManyEventsInMemoryAndNoMore) {
  constexpr auto kKept = static_cast<std::int64_t>(EventFeed::kRecentEvents);
  FakeLog log;
  EventFeed feed(log);
  constexpr std::int64_t kEvents = 3 * kKept + 5;
  log.Write(1, static_cast<int>(kEvents));
  ASSERT_TRUE(Eventually([&] { return feed.position() == kEvents; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const int before = log.reads();
  ExpectPositions(Must(feed.EventsAfter(kEvents - kKept, 100)), kEvents - kKept + 1, 100);
  EXPECT_LE(log.reads(), before + 1);  // at most a poll
  ExpectPositions(Must(feed.EventsAfter(kEvents - kKept - 1, 100)), kEvents - kKept, 100);
  const int first = log.reads();
  ExpectPositions(Must(feed.EventsAfter(0, 100)), 1, 100);
  EXPECT_GT(log.reads(), first);
}

TEST(EventFeed, ANewPositionReplacesTheOneBefore) {
  FakeLog log;
  EventFeed feed(log);
  EXPECT_FALSE(feed.ProgressAfter(1, 0));
  for (int i = 1; i <= 1000; ++i) feed.PublishProgress(1, std::to_string(i));
  feed.PublishProgress(2, "two");
  ASSERT_TRUE(Eventually([&] {
    const auto progress = feed.ProgressAfter(1, 0);
    return progress && *progress->bytes == "1000";
  }));
  ASSERT_TRUE(Eventually([&] { return feed.ProgressAfter(2, 0).has_value(); }));
  const std::vector<ProgressText> all = feed.AllProgressAfter(0);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_LT(all[0].version, all[1].version);
  EXPECT_FALSE(feed.ProgressAfter(1, feed.ProgressAfter(1, 0)->version));
  EXPECT_EQ(feed.AllProgressAfter(all[0].version).size(), 1U);
  feed.ForgetProgress(1);
  EXPECT_FALSE(feed.ProgressAfter(1, 0));
  EXPECT_EQ(feed.AllProgressAfter(0).size(), 1U);
}

// What was published just before the job ended must not come back after it.
TEST(EventFeed, AForgottenPositionDoesNotComeBack) {
  FakeLog log;
  EventFeed feed(log);
  for (int i = 0; i < 50; ++i) {
    feed.PublishProgress(1, "late");
    feed.ForgetProgress(1);
  }
  feed.PublishProgress(2, "next");
  ASSERT_TRUE(Eventually([&] { return feed.ProgressAfter(2, 0).has_value(); }));
  EXPECT_FALSE(feed.ProgressAfter(1, 0));
}

// Issue "Watch": at most 20 position updates a second, also for a watcher that many events wake.
TEST(EventFeed, TellsAtMostTwentyPositionsASecond) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<std::uint64_t> seen = 0;
  std::atomic<int> told = 0;
  const auto watch = feed.Subscribe(1, [&] {
    if (const auto progress = feed.ProgressAfter(1, seen)) {
      seen = progress->version;
      ++told;
    }
  });
  const auto begin = Clock::now();
  int published = 0;
  while (Clock::now() - begin < std::chrono::milliseconds(600)) {
    feed.PublishProgress(1, std::to_string(++published));
    log.Write(1, 1);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const auto took = Clock::now() - begin;
  const auto intervals = took / EventFeed::kProgressInterval;
  EXPECT_LE(told, intervals + 1);
  EXPECT_GE(told, 2);
  EXPECT_GT(published, 5 * told);
  // The last one is told, though nothing follows it.
  EXPECT_TRUE(
      Eventually([&] { return *feed.ProgressAfter(1, 0)->bytes == std::to_string(published); }));
}

TEST(EventFeed, TellsTheFirstPositionAfterAQuietTimeAtOnce) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<bool> woken = false;
  const auto watch = feed.Subscribe(1, [&] { woken = true; });
  std::this_thread::sleep_for(std::chrono::milliseconds(150));  // nothing is there: the feed sleeps
  const auto begin = Clock::now();
  feed.PublishProgress(1, "here");
  ASSERT_TRUE(Eventually([&] { return woken.load(); }));
  EXPECT_LT(Clock::now() - begin,
            std::chrono::milliseconds(500));  // and not at the next poll, after 1 s
}

TEST(EventFeed, NobodyIsCalledAfterItsHandleIsGone) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<bool> inside = false;
  std::atomic<bool> go_on = false;
  std::atomic<int> calls = 0;
  auto watch = feed.Subscribe(1, [&] {
    inside = true;
    while (!go_on) std::this_thread::yield();
    ++calls;
  });
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return inside.load(); }));
  std::jthread free([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    go_on = true;
  });
  watch.reset();  // waits for the call that is under way
  EXPECT_EQ(calls, 1);
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 2; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(calls, 1);
}

// For the race detector: watchers come and go, positions change, events flow, all at once.
TEST(EventFeed, StandsManyThreads) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<bool> stop = false;
  std::atomic<int> woken = 0;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 2; ++i) {
    threads.emplace_back([&, i] {
      while (!stop) {
        const auto one = feed.Subscribe(i, [&] { ++woken; });
        const auto all = feed.Subscribe(std::nullopt, [&] { ++woken; });
        (void)feed.EventsAfter(std::max<std::int64_t>(0, feed.position() - 10), 10);
        (void)feed.AllProgressAfter(0);
      }
    });
    threads.emplace_back([&, i] {
      while (!stop) {
        feed.PublishProgress(i + 1, "here");
        (void)feed.ProgressAfter(i + 1, 0);
        feed.ForgetProgress(2 - i);
      }
    });
    threads.emplace_back([&, i] {
      while (!stop) {
        log.Write(i + 1, 1);
        std::this_thread::sleep_for(std::chrono::microseconds(50));
      }
    });
  }
  EXPECT_TRUE(Eventually([&] { return woken > 200; }));
  stop = true;
  threads.clear();
  EXPECT_TRUE(Eventually([&] { return feed.position() == Must(log.LastPosition()); }));
}

TEST(EventFeed, EndsAtOnceThoughEventsFlow) {
  FakeLog log;
  std::atomic<bool> stop = false;
  std::jthread writer([&] {
    while (!stop) log.Write(1, 10);
  });
  for (int i = 0; i < 20; ++i) {
    const auto begin = Clock::now();
    { EventFeed feed(log); }
    EXPECT_LT(Clock::now() - begin, std::chrono::seconds(5));
  }
  stop = true;
}

}  // namespace
}  // namespace rmlcell::server
