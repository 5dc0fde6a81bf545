#include "server/events/event_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>

#include "tests/server/events/fake_log.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobName;

using std::chrono::milliseconds;
using storage::EventRecord;

constexpr milliseconds kNever = std::chrono::hours(24 * 366);  // of looks without a hint

// Reads the log of the whole cell whenever it is woken, in batches of its own size, from any
// position.
class Reader {
 public:
  Reader(EventFeed& feed, std::int64_t after, int batch)
      : feed_(feed), cursor_(after), batch_(batch) {
    subscription_ = feed_.Subscribe(std::string(EventFeed::kEverything), [this] {
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
  const auto watch_one = feed.Subscribe(JobName(1), [&] { ++one; });
  const auto watch_two = feed.Subscribe(JobName(2), [&] { ++two; });
  const auto watch_all = feed.Subscribe(std::string(EventFeed::kEverything), [&] { ++all; });
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return all >= 1; }));
  EXPECT_EQ(one, 1);
  EXPECT_EQ(two, 0);
  log.Write(2, 5);
  ASSERT_TRUE(Eventually([&] { return all >= 2; }));
  EXPECT_EQ(one, 1);
  EXPECT_EQ(two, 1);  // one commit wakes once, whatever it holds
}

// The fake log answers no question about one job: what comes, comes from memory. Issue "Watch":
// many watchers of a job cost the store no more than one.
TEST(EventFeed, ServesTheWatchersOfAJobFromMemory) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<int> woken = 0;
  auto first = feed.Subscribe(JobName(1), [&] { ++woken; });
  auto second = feed.Subscribe(JobName(1), [&] { ++woken; });
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
  // It keeps the newest 1024 of a job: 980 to 2003.
  EXPECT_FALSE(feed.JobEvents(1, 978, 1));
  const Result<std::vector<EventRecord>> oldest = feed.JobEvents(1, 979, 1);
  ASSERT_TRUE(oldest);
  ExpectPositions(*oldest, 980, 1);

  first.reset();
  EXPECT_TRUE(feed.JobEvents(1, 2'000, 100));
  second.reset();
  EXPECT_FALSE(feed.JobEvents(1, 2'000, 100));  // nobody watches: nothing is kept
}

// It tells of what comes; what was there before it began is in the log.
TEST(EventFeed, BeginsAtTheEndOfTheLog) {
  FakeLog log;
  log.Write(1, 5);
  EventFeed feed(log, {.poll_interval = kNever});
  EXPECT_EQ(feed.position(), 5);
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  EXPECT_TRUE(Must(feed.EventsAfter(5, 10)).empty());
  EXPECT_EQ(log.reads(), 1);  // whoever is at the end asks the log nothing
  ExpectPositions(Must(feed.EventsAfter(0, 10)), 1, 5);
}

// With nobody to tell it sleeps; the first watcher wakes it.
TEST(EventFeed, ReadsWhatCameBeforeTheFirstWatcher) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = kNever});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  log.Write(1, 3);
  const auto watch = feed.Subscribe(JobName(1), [] {});
  EXPECT_TRUE(Eventually([&] { return feed.position() == 3; }));
}

// Of the positions of many jobs each is there, in the order in which they were told.
TEST(EventFeed, PositionsAreOfTheirJobs) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = kNever});
  for (const int job : {7, 3, 5}) {
    feed.Publish(JobName(job), "of " + std::to_string(job));
    ASSERT_TRUE(Eventually([&] { return feed.LatestAfter(JobName(job), 0).has_value(); }));
  }
  const std::vector<Latest> all = feed.AllLatestAfter(0);
  ASSERT_EQ(all.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(all[i].resource, JobName(std::array{7, 3, 5}[i]));
    EXPECT_EQ(*all[i].bytes, "of " + all[i].resource.substr(5));
    EXPECT_EQ(all[i].version, i + 1);
    EXPECT_EQ(feed.AllLatestAfter(all[i].version).size(), 2 - i);
    EXPECT_FALSE(feed.LatestAfter(all[i].resource, i + 1));
    EXPECT_TRUE(feed.LatestAfter(all[i].resource, i));
  }
}

// Another server may write to the same store: then there is no hint.
TEST(EventFeed, FindsEventsWithoutAHint) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = milliseconds(20)});
  const auto hint = log.Watch([] {});  // takes the hint away from the feed
  ASSERT_TRUE(Eventually([&] { return log.reads() >= 1; }));
  log.Write(1, 3);
  EXPECT_TRUE(Eventually([&] { return feed.position() == 3; }));
}

TEST(EventFeed, GoesOnWhenAFailingStoreWorksAgain) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = milliseconds(20)});
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
  const auto first = feed.Subscribe(JobName(1), [] {});
  log.Write(1, 2);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 2; }));
  std::atomic<int> woken = 0;
  const auto watch = feed.Subscribe(JobName(7), [&] { ++woken; });
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
  // Nor does memory leave them out in silence: who saw the second event of the first job asks the
  // log.
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 14; }));
  EXPECT_FALSE(feed.JobEvents(1, 2, 10));
  EXPECT_TRUE(feed.JobEvents(1, 13, 10));
}

// A watcher costs a cursor: what is in memory is bounded, what is older comes from the log.
TEST(EventFeed, KeepsSoManyEventsInMemoryAndNoMore) {
  constexpr auto kKept = static_cast<std::int64_t>(EventFeed::kRecentEvents);
  FakeLog log;
  EventFeed feed(log, {.poll_interval = kNever});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));  // it looks when it begins
  const auto watch = feed.Subscribe(JobName(2), [] {});
  constexpr std::int64_t kEvents = 3 * kKept + 5;
  log.Write(1, static_cast<int>(kEvents));
  ASSERT_TRUE(Eventually([&] { return feed.position() == kEvents; }));
  const int before = log.reads();
  ExpectPositions(Must(feed.EventsAfter(kEvents - kKept, 100)), kEvents - kKept + 1, 100);
  EXPECT_EQ(log.reads(), before);
  ExpectPositions(Must(feed.EventsAfter(kEvents - kKept - 1, 100)), kEvents - kKept, 100);
  EXPECT_EQ(log.reads(), before + 1);
  ExpectPositions(Must(feed.EventsAfter(0, 100)), 1, 100);
  EXPECT_EQ(log.reads(), before + 2);
}

// Of a log that several servers write: what is in memory is known by the position behind which
// nothing is missing, not by a number that must follow another.
TEST(EventFeed, ServesFromMemoryOverAGap) {
  FakeLog log;
  log.Write(1, 5);
  EventFeed feed(log, {.poll_interval = kNever});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  const auto watch = feed.Subscribe(JobName(2), [] {});
  log.LeaveGap(100);
  log.Write(1, 3);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 108; }));
  const int before = log.reads();
  for (const std::int64_t after : {5, 6, 104, 105}) {
    EXPECT_EQ(Must(feed.EventsAfter(after, 10)).front().position, after < 106 ? 106 : after + 1);
  }
  EXPECT_EQ(log.reads(), before);
  EXPECT_EQ(Must(feed.EventsAfter(4, 10)).front().position, 5);
  EXPECT_EQ(log.reads(), before + 1);
}

TEST(EventFeed, ANewPositionReplacesTheOneBefore) {
  FakeLog log;
  EventFeed feed(log);
  EXPECT_FALSE(feed.LatestAfter(JobName(1), 0));
  for (int i = 1; i <= 1000; ++i) feed.Publish(JobName(1), std::to_string(i));
  feed.Publish(JobName(2), "two");
  ASSERT_TRUE(Eventually([&] {
    const auto progress = feed.LatestAfter(JobName(1), 0);
    return progress && *progress->bytes == "1000";
  }));
  ASSERT_TRUE(Eventually([&] { return feed.LatestAfter(JobName(2), 0).has_value(); }));
  const std::vector<Latest> all = feed.AllLatestAfter(0);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_LT(all[0].version, all[1].version);
  EXPECT_FALSE(feed.LatestAfter(JobName(1), feed.LatestAfter(JobName(1), 0)->version));
  EXPECT_EQ(feed.AllLatestAfter(all[0].version).size(), 1U);
  feed.Forget(JobName(1));
  EXPECT_FALSE(feed.LatestAfter(JobName(1), 0));
  EXPECT_EQ(feed.AllLatestAfter(0).size(), 1U);
}

// What was published just before the job ended must not come back after it.
TEST(EventFeed, AForgottenPositionDoesNotComeBack) {
  FakeLog log;
  EventFeed feed(log);
  for (int i = 0; i < 50; ++i) {
    feed.Publish(JobName(1), "late");
    feed.Forget(JobName(1));
  }
  feed.Publish(JobName(2), "next");
  ASSERT_TRUE(Eventually([&] { return feed.LatestAfter(JobName(2), 0).has_value(); }));
  EXPECT_FALSE(feed.LatestAfter(JobName(1), 0));
}

// Issue "Watch": at most 20 position updates a second, also for a watcher that many events wake.
TEST(EventFeed, TellsAtMostTwentyPositionsASecond) {
  FakeLog log;
  TestSteadyClock steady;
  EventFeed feed(log, {.clock = steady.clock(),
                       .poll_interval = kNever,
                       .message_time = std::chrono::microseconds(0)});
  std::vector<std::string>
      told;  // touched by the thread of the feed alone, until `feed` has caught up
  std::atomic<int> tellings = 0;
  const auto watch = feed.Subscribe(JobName(1), [&, seen = std::uint64_t{0}]() mutable {
    const auto progress = feed.LatestAfter(JobName(1), seen);
    if (!progress) return;
    seen = progress->version;
    told.push_back(*progress->bytes);
    ++tellings;
  });
  int published = 0;
  const auto publish = [&](int count) {
    for (int i = 0; i < count; ++i) {
      feed.Publish(JobName(1), std::to_string(++published));
      log.Write(1, 1);
    }
  };
  const auto has_read = [&] {
    const std::int64_t last = Must(log.LastPosition());
    return Eventually([&] { return feed.position() == last; });
  };
  // The feed has read all that was written, told who watches, and looked at the clock again.
  const auto wait_for_the_feed = [&] {
    ASSERT_TRUE(has_read());
    ASSERT_TRUE(steady.GoneRound());
  };
  // What has told a position is not done until it has noted when: it reads the log behind that.
  const auto has_noted_when = [&] {
    log.Write(1, 1);
    return has_read();
  };
  publish(1);
  ASSERT_TRUE(Eventually([&] { return tellings == 1; }));  // at once: there was none for a while
  publish(100);
  wait_for_the_feed();
  EXPECT_EQ(tellings, 1);
  steady.Advance(milliseconds(49));
  publish(100);
  wait_for_the_feed();
  EXPECT_EQ(tellings, 1);
  // The last one is told, though nothing follows it.
  steady.Advance(milliseconds(1));
  ASSERT_TRUE(Eventually([&] { return tellings == 2; }));
  ASSERT_TRUE(has_noted_when());
  steady.Advance(milliseconds(50));
  publish(1);
  ASSERT_TRUE(Eventually([&] { return tellings == 3; }));
  EXPECT_THAT(told, testing::ElementsAre("1", "201", "202"));
  // Once: a position that stands is not told again beside that of another.
  const auto stands = feed.LatestAfter(JobName(1), 0);
  ASSERT_TRUE(stands);
  ASSERT_TRUE(has_noted_when());
  steady.Advance(milliseconds(50));
  feed.Publish(JobName(2), "another");
  ASSERT_TRUE(Eventually([&] { return feed.LatestAfter(JobName(2), 0).has_value(); }));
  EXPECT_FALSE(feed.LatestAfter(JobName(1), stands->version));
}

// Nothing else wakes it: it looks at the log by itself next year.
TEST(EventFeed, TellsTheFirstPositionAfterAQuietTimeAtOnce) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = kNever});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  std::atomic<bool> woken = false;
  const auto watch = feed.Subscribe(JobName(1), [&] { woken = true; });
  feed.Publish(JobName(1), "here");
  EXPECT_TRUE(Eventually([&] { return woken.load(); }));
}

TEST(EventFeed, NobodyIsCalledAfterItsHandleIsGone) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<bool> inside = false;
  std::atomic<bool> go_on = false;
  std::atomic<int> calls = 0;
  auto watch = feed.Subscribe(JobName(1), [&] {
    inside = true;
    while (!go_on) std::this_thread::yield();
    ++calls;
  });
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return inside.load(); }));
  std::jthread free([&] {
    // The handle is on its way out: nothing of the job is kept any more.
    Eventually([&] { return !feed.JobEvents(1, 0, 1); });
    go_on = true;
  });
  watch.reset();  // waits for the call that is under way
  EXPECT_EQ(calls, 1);
  // Who watches the same is called in the same round.
  std::atomic<int> others = 0;
  const auto other = feed.Subscribe(JobName(1), [&] { ++others; });
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return others == 1; }));
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return others == 2; }));
  EXPECT_EQ(calls, 1);
}

// Whichever of the two is called first takes the other away before its turn comes.
TEST(EventFeed, NobodyIsCalledWhoLeftInTheSameRound) {
  FakeLog log;
  EventFeed feed(log);
  std::atomic<int> calls = 0;
  std::unique_ptr<EventFeed::Subscription> one, two;
  one = feed.Subscribe(JobName(1), [&] {
    two.reset();
    ++calls;
  });
  two = feed.Subscribe(JobName(1), [&] {
    one.reset();
    ++calls;
  });
  std::atomic<bool> over = false;  // those of everything are called last
  const auto all = feed.Subscribe(std::string(EventFeed::kEverything), [&] { over = true; });
  log.Write(1, 1);
  ASSERT_TRUE(Eventually([&] { return over.load(); }));
  EXPECT_EQ(calls, 1);
}

// Who comes back is told of what the store still has, and that it was deleted; also where the
// events are still in memory.
TEST(EventFeed, ForgetsTheEventsOfAJobThatIsDeleted) {
  ServerBed bed;
  EventFeed feed(bed.store());
  const auto all = feed.Subscribe(std::string(EventFeed::kEverything), [] {});
  const std::int64_t begin = Must(bed.store().LastPosition());
  const std::int64_t gone = bed.SubmitCheck();
  const storage::Lease lease = bed.Lease();
  bed.Append(lease, 20);
  const std::int64_t kept = bed.SubmitCheck();
  Must(bed.store().Finish(lease, {}));
  const auto told = [&] { return Must(feed.EventsAfter(begin, 1'000)); };
  ASSERT_TRUE(Eventually([&] { return feed.position() == Must(bed.store().LastPosition()); }));
  EXPECT_GT(told().size(), 20U);
  Must(bed.store().DeleteJob(gone));
  ASSERT_TRUE(Eventually([&] { return feed.position() == Must(bed.store().LastPosition()); }));
  const std::vector<EventRecord> left = told();
  ASSERT_EQ(left.size(), 2U);
  EXPECT_EQ(left[0].job, kept);
  EXPECT_EQ(left[1].resource, JobName(gone));
  EXPECT_EQ(left[1].kind, storage::kDeleted);
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
        const auto one = feed.Subscribe(JobName(i), [&] { ++woken; });
        const auto all = feed.Subscribe(std::string(EventFeed::kEverything), [&] { ++woken; });
        (void)feed.EventsAfter(std::max<std::int64_t>(0, feed.position() - 10), 10);
        (void)feed.AllLatestAfter(0);
      }
    });
    threads.emplace_back([&, i] {
      while (!stop) {
        feed.Publish(JobName(i + 1), "here");
        (void)feed.LatestAfter(JobName(i + 1), 0);
        feed.Forget(JobName(2 - i));
      }
    });
    threads.emplace_back([&, i] {
      while (!stop) {
        log.Write(i + 1, 1);
        std::this_thread::yield();
      }
    });
  }
  EXPECT_TRUE(Eventually([&] { return woken > 200; }));
  stop = true;
  threads.clear();
  EXPECT_TRUE(Eventually([&] { return feed.position() == Must(log.LastPosition()); }));
}

// Its thread ends though more and more comes, and does not wait for the time of its next look.
TEST(EventFeed, EndsThoughEventsFlow) {
  FakeLog log;
  std::atomic<bool> stop = false;
  std::jthread writer([&] {
    while (!stop) log.Write(1, 10);
  });
  for (int i = 0; i < 20; ++i) {
    EventFeed feed(log, {.poll_interval = kNever});
    const auto watch = feed.Subscribe(std::string(EventFeed::kEverything), [] {});
  }
  stop = true;
  writer.join();
  const int reads = log.reads();
  log.Write(1, 1);
  EXPECT_EQ(log.reads(), reads);  // nobody is told any more
}

}  // namespace
}  // namespace rmlcell::server
