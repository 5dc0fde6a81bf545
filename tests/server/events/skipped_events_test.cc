// Events that are gone before the feed has read them.
#include <gtest/gtest.h>

#include <atomic>

#include "server/events/event_feed.h"
#include "tests/server/events/fake_log.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kNoPoll = std::chrono::hours(24 * 366);

// What comes behind them is read at once, and not with the next hint.
TEST(SkippedEvents, WhatComesBehindThemIsReadAtOnce) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = kNoPoll});
  const auto watch = feed.Subscribe(storage::JobName(1), [] {});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  log.Fail(true);
  log.Write(1, 5);
  ASSERT_TRUE(Eventually([&] { return log.reads() == 2; }));
  log.ForgetAll();
  log.Fail(false);
  log.Write(1, 1);
  EXPECT_TRUE(Eventually([&] { return feed.position() == 6; }));
}

// Memory does not leave them out in silence either, when it has forgotten what came before them.
TEST(SkippedEvents, AreNotLeftOutByWhatIsInMemory) {
  FakeLog log;
  EventFeed feed(log, {.poll_interval = kNoPoll});
  const auto watch = feed.Subscribe(storage::JobName(2), [] {});
  ASSERT_TRUE(Eventually([&] { return log.reads() == 1; }));
  log.Write(1, 10);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 10; }));
  log.Fail(true);
  log.Write(1, 5);
  log.ForgetAll();
  log.Fail(false);
  constexpr auto kKept = static_cast<int>(EventFeed::kRecentEvents);
  log.Write(1, kKept);
  ASSERT_TRUE(Eventually([&] { return feed.position() == 15 + kKept; }));
  EXPECT_EQ(CodeOf(feed.EventsAfter(12, 10)), ErrorCode::kCellEventsGone);
  EXPECT_EQ(Must(feed.EventsAfter(15, 10)).front().position, 16);
}

// A log that says that events are gone, and that none behind its reader's are.
class ContradictingLog final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<int> reads = 0;
  std::atomic<bool> knows = true;

  Result<std::vector<storage::EventRecord>> AllEvents(std::int64_t, int) override {
    ++reads;
    return Error{ErrorCode::kCellEventsGone, {}, {}};
  }
  Result<std::int64_t> EventsGoneUntil() override {
    if (knows) return std::int64_t{0};
    return Error{ErrorCode::kCellStoreFailed, "the disk is full", {}};
  }
};

// It is asked again at the next look, and not for ever: what else there is to tell is told.
TEST(SkippedEvents, ALogThatContradictsItselfHoldsNothingUp) {
  for (const bool knows : {true, false}) {
    FakeLog log;
    ContradictingLog store(log);
    store.knows = knows;
    EventFeed feed(store, {.poll_interval = kNoPoll});
    ASSERT_TRUE(Eventually([&] { return store.reads >= 1; }));
    feed.Publish(storage::JobName(7), "here");
    EXPECT_TRUE(Eventually([&] { return feed.LatestAfter(storage::JobName(7), 0).has_value(); }));
    EXPECT_EQ(store.reads, 1);
  }
}

}  // namespace
}  // namespace rmlcell::server
