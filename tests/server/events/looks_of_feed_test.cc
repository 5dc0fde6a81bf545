// When the feed looks at the log again, and of which jobs it keeps the events.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

#include "server/base/steady_clock.h"
#include "server/events/event_feed.h"
#include "tests/server/events/fake_log.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kWhenHinted = std::chrono::hours(24 * 366);

// docs/decisions/0030: a look waits as long as the messages of the one before cost, and as long
// again for each 8 events of it: 3 ms behind 16 events for one watcher at 1 ms.
TEST(LooksOfFeed, ManyEventsPutOffTheNextOne) {
  FakeLog log;
  TestSteadyClock steady;
  EventFeed feed(log, {.clock = steady.clock(),
                       .poll_interval = kWhenHinted,
                       .message_time = std::chrono::milliseconds(1)});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  const auto watch = feed.Subscribe(storage::JobName(1), [] {});
  log.Write(1, 16);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 16; }));
  log.Write(1, 1);
  ASSERT_TRUE(steady.GoneRound());  // the feed is done with the first ones
  EXPECT_EQ(feed.position(), 16);
  steady.Advance(std::chrono::milliseconds(2));
  ASSERT_TRUE(steady.GoneRound());
  EXPECT_EQ(feed.position(), 16);
  steady.Advance(std::chrono::milliseconds(1));
  EXPECT_TRUE(Eventually([&] { return feed.position() == 17; }));
}

// Of jobs that nobody watches nothing is kept, whoever watches everything: the log has it, and this
// one answers no question about a job.
TEST(LooksOfFeed, EventsOfAJobThatNobodyWatchesAreNotKeptForIt) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = kWhenHinted});
  const auto all = feed.Subscribe(std::string(EventFeed::kEverything), [] {});
  const auto watched = feed.Subscribe(storage::JobName(2), [] {});
  log.Write(3, 2);
  log.Write(2, 1);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 3; }));
  EXPECT_FALSE(feed.JobEvents(3, 0, 10));
  EXPECT_EQ(Must(feed.JobEvents(2, 2, 10)).size(), 1U);
}

// Whoever still watches a job that is deleted is told that it is gone, as by the store.
TEST(LooksOfFeed, EventsOfAJobThatIsDeletedAreGone) {
  ServerBed bed;
  EventFeed feed(bed.store());
  const auto caught_up = [&] {
    return Eventually([&] { return feed.position() == Must(bed.store().LastPosition()); });
  };
  const std::int64_t job = bed.SubmitCheck();
  const storage::Lease lease = bed.Lease();
  const auto watch = feed.Subscribe(storage::JobName(job), [] {});
  ASSERT_TRUE(caught_up());
  const std::int64_t seen = Must(bed.store().GetJob(job)).last_sequence;
  bed.Append(lease, 3);
  ASSERT_TRUE(caught_up());
  EXPECT_EQ(Must(feed.JobEvents(job, seen, 100)).size(), 3U);
  Must(bed.store().Finish(lease, {}));
  Must(bed.store().DeleteJob(job));
  ASSERT_TRUE(caught_up());
  EXPECT_EQ(CodeOf(feed.JobEvents(job, seen, 100)), ErrorCode::kCellNotFound);
}

// What was forgotten is told as what was never told: it waits with all others, for 5 ms, and not
// for its own last time.
TEST(LooksOfFeed, APositionThatWasForgottenIsANewOne) {
  FakeLog log;
  TestSteadyClock steady;
  EventFeed feed(log, {.clock = steady.clock(), .poll_interval = kWhenHinted});
  const std::string job = storage::JobName(1);
  const auto told = [&] { return Eventually([&] { return bool(feed.LatestAfter(job, 0)); }); };
  feed.Publish(job, "of the first attempt");
  ASSERT_TRUE(told());
  feed.Forget(job);
  feed.Publish(job, "of the second one");
  ASSERT_TRUE(steady.GoneRound());  // the feed is done with the first one, and waits
  steady.Advance(std::chrono::milliseconds(5));
  EXPECT_TRUE(told());
}

// The log is asked once for what a look finds, unless it may hold more.
TEST(LooksOfFeed, ALookThatBroughtLittleIsTheLastOne) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = kWhenHinted});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  const auto watch = feed.Subscribe(storage::JobName(1), [] {});
  log.Write(1, 3);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 3; }));
  feed.Publish(storage::JobName(1), "told when the look is over");
  ASSERT_TRUE(Eventually([&] { return bool(feed.LatestAfter(storage::JobName(1), 0)); }));
  EXPECT_EQ(log.reads(), 2);
}

// With nothing to tell it sleeps until its next look, which is in a year: it looks at its clock
// when it begins, when it goes to sleep, when it wakes, behind the first look, and when it sleeps
// again.
TEST(LooksOfFeed, WithNothingToTellItSleeps) {
  FakeLog log;
  std::atomic<int> looks_at_clock = 0;
  const auto counted = [&looks_at_clock] {
    ++looks_at_clock;
    return SteadyTime();
  };
  EventFeed feed(log, {.clock = counted, .poll_interval = kWhenHinted});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  FakeLog log_of_another;
  EventFeed another(log_of_another, {.poll_interval = kWhenHinted});
  for (int job = 1; job <= 10; ++job) {  // meanwhile
    another.Publish(storage::JobName(job), "here");
    ASSERT_TRUE(Eventually([&] { return bool(another.LatestAfter(storage::JobName(job), 0)); }));
  }
  EXPECT_LE(looks_at_clock, 5);
}

}  // namespace
}  // namespace rmlcell::server
