// Watchers of what is no job, and a log that does not say what is gone.
#include <gtest/gtest.h>

#include <atomic>

#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kNeverLooks = std::chrono::hours(24 * 366);

// Who watches a program is woken when it changes, and nobody else.
TEST(FeedOfResources, AProgramHasItsWatchers) {
  ServerBed bed;
  EventFeed feed(bed.store(), {.poll_interval = kNeverLooks});
  std::atomic<int> woken = 0;
  std::atomic<int> others = 0;
  const auto of_it = feed.Subscribe("machines/optimo-1/programs/7", [&] { ++woken; });
  const auto of_another = feed.Subscribe("machines/optimo-1/programs/8", [&] { ++others; });
  const std::int64_t before = Must(bed.store().LastPosition());
  ASSERT_TRUE(Eventually([&] { return feed.position() == before; }));
  woken = 0;
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 7, .object = "an object"}}, {}));
  EXPECT_TRUE(Eventually([&] { return woken >= 1; }));
  EXPECT_TRUE(Eventually([&] { return feed.position() > before; }));
  EXPECT_EQ(others, 0);
}

// Of a log that lost events and knows nothing of it.
class ForgetfulStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::EventRecord>> AllEvents(std::int64_t /*after*/,
                                                      int /*limit*/) override {
    ++reads;
    return Error{ErrorCode::kCellEventsGone, {}, {}};
  }
  Result<std::int64_t> EventsGoneUntil() override { return ForwardingStore::LastPosition(); }
  std::unique_ptr<Subscription> Watch(std::function<void()> changed) override {
    changed_ = std::move(changed);
    return ForwardingStore::Watch([] {});
  }
  void Hint() { changed_(); }

  std::atomic<int> reads = 0;

 private:
  std::function<void()> changed_;
};

// Nothing is gone that was not there before: it is read again when something is new, and nobody is
// woken for nothing.
TEST(FeedOfResources, WhatWasGoneAlreadyWakesNobody) {
  ServerBed bed;
  ForgetfulStore store(bed.store());
  EventFeed feed(store, {.poll_interval = kNeverLooks});
  ASSERT_TRUE(Eventually([&] { return store.reads >= 1; }));
  std::atomic<int> woken = 0;
  const auto watch = feed.Subscribe(std::string(EventFeed::kEverything), [&] { ++woken; });
  const int before = store.reads;
  store.Hint();
  ASSERT_TRUE(Eventually([&] { return store.reads > before; }));
  store.Hint();
  ASSERT_TRUE(Eventually([&] { return store.reads > before + 1; }));
  EXPECT_EQ(woken, 0);
}

}  // namespace
}  // namespace rmlcell::server
