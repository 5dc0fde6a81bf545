// Events as they go out to watches that share them: cell.proto, WatchCellRequest.batched.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <thread>
#include <vector>

#include "server/base/names.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using WatchedCell = OpenedStream<v1::WatchCellResponse>;

class SharedLogTest : public testing::Test {
 protected:
  v1::WatchCellRequest After(std::int64_t sequence, bool batched) {
    v1::WatchCellRequest request;
    v1::Subscription& jobs = *request.add_subscriptions();
    jobs.set_id("jobs");
    jobs.mutable_jobs()->set_events_only(true);
    request.set_after_sequence(sequence);
    request.set_batched(batched);
    return request;
  }
  static std::vector<v1::CellEvent> EventsOf(const v1::WatchCellResponse& message) {
    if (message.has_event()) return {message.event()};
    return {message.events().events().begin(), message.events().events().end()};
  }
  // Every event behind this position, one watch alone, with its numbers.
  std::vector<std::int64_t> Positions(WatchedCell& watch, std::size_t count) {
    std::vector<std::int64_t> positions;
    while (positions.size() < count) {
      const v1::WatchCellResponse message = watch.Next();
      if (message.instance_id().empty()) break;  // it has ended
      for (const v1::CellEvent& event : EventsOf(message)) positions.push_back(event.sequence());
    }
    return positions;
  }
  std::vector<std::int64_t> Stored(std::int64_t after) {
    std::vector<std::int64_t> positions;
    for (const storage::EventRecord& event : Must(room.bed.store().AllEvents(after, 100'000)))
      positions.push_back(event.position);
    return positions;
  }

  StreamBed room;
};

// What is there at once comes in few messages; what comes alone is an event as ever.
TEST_F(SharedLogTest, SeveralEventsAreOneMessage) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  const std::int64_t before = Must(room.bed.store().LastPosition());
  room.Say(lease, std::vector<std::string>(200, "again"));
  auto watch = room.WatchCell(After(before, true));
  EXPECT_TRUE(watch.Next().has_bookmark());
  std::vector<std::int64_t> told;
  int messages = 0;
  while (told.size() < 200) {
    const v1::WatchCellResponse message = watch.Next();
    ASSERT_FALSE(message.instance_id().empty());
    EXPECT_THAT(message.subscriptions(), ElementsAre("jobs"));
    EXPECT_EQ(message.log_id(), room.bed.store().LogId());
    const std::vector<v1::CellEvent> events = EventsOf(message);
    ASSERT_FALSE(events.empty());
    EXPECT_LE(events.size(), 64U);
    EXPECT_EQ(message.sequence(), events.back().sequence());  // to go on after all of them
    for (const v1::CellEvent& event : events) {
      EXPECT_EQ(event.resource(), JobName(job));
      EXPECT_EQ(event.job().message().text(), "again");
      told.push_back(event.sequence());
    }
    ++messages;
  }
  EXPECT_EQ(told, Stored(before));
  EXPECT_LE(messages, 5);  // 64 positions each, and what is left at both ends
  room.Say(lease, {"alone"});
  const v1::WatchCellResponse alone = watch.Next();
  EXPECT_FALSE(alone.has_events());
  EXPECT_EQ(alone.event().job().message().text(), "alone");
}

TEST_F(SharedLogTest, WithoutAskingEachEventIsAMessage) {
  room.Submit();
  const storage::Lease lease = room.bed.Lease();
  const std::int64_t before = Must(room.bed.store().LastPosition());
  room.Say(lease, std::vector<std::string>(70, "again"));
  auto watch = room.WatchCell(After(before, false));
  EXPECT_TRUE(watch.Next().has_bookmark());
  for (const std::int64_t position : Stored(before)) {
    const v1::WatchCellResponse message = watch.Next();
    ASSERT_TRUE(message.has_event());
    EXPECT_EQ(message.event().sequence(), position);
    EXPECT_EQ(message.sequence(), position);
  }
}

// One message is for the same subscriptions: it ends where they change.
TEST_F(SharedLogTest, AMessageIsForTheSameSubscriptions) {
  const std::int64_t one = room.Submit();
  const storage::Lease first = room.bed.Lease();
  const std::int64_t two = room.Submit();
  const storage::Lease second = room.bed.Lease();
  const std::int64_t before = Must(room.bed.store().LastPosition());
  room.Say(first, {"a", "b"});
  room.Say(second, {"c", "d", "e"});
  room.Say(first, {"f"});
  v1::WatchCellRequest request = After(before, true);
  request.mutable_subscriptions(0)->mutable_jobs()->add_names(JobName(one));
  v1::Subscription& other = *request.add_subscriptions();
  other.set_id("other");
  other.mutable_jobs()->set_events_only(true);
  other.mutable_jobs()->add_names(JobName(two));
  auto watch = room.WatchCell(request);
  EXPECT_TRUE(watch.Next().has_bookmark());
  const v1::WatchCellResponse ab = watch.Next();
  EXPECT_THAT(ab.subscriptions(), ElementsAre("jobs"));
  EXPECT_EQ(ab.events().events_size(), 2);
  const v1::WatchCellResponse cde = watch.Next();
  EXPECT_THAT(cde.subscriptions(), ElementsAre("other"));
  EXPECT_EQ(cde.events().events_size(), 3);
  EXPECT_EQ(watch.Next().event().job().message().text(), "f");
}

// The number of a message is that of its last event, also where others follow that nobody wants.
TEST_F(SharedLogTest, TheNumberIsThatOfTheLastEvent) {
  room.Submit();
  const storage::Lease lease = room.bed.Lease();
  const std::int64_t other = room.Submit();
  const storage::Lease of_other = room.bed.Lease();
  const std::int64_t before = Must(room.bed.store().LastPosition());
  room.Say(of_other, {"a", "b"});
  room.Say(lease, {"not wanted", "not wanted"});
  for (const bool batched : {false, true}) {
    v1::WatchCellRequest request = After(before, batched);
    request.mutable_subscriptions(0)->mutable_jobs()->add_names(JobName(other));
    auto watch = room.WatchCell(request);
    EXPECT_TRUE(watch.Next().has_bookmark());
    if (!batched) {
      EXPECT_EQ(watch.Next().sequence(), before + 1);
    }
    EXPECT_EQ(watch.Next().sequence(), before + 2);
  }
}

// Events that nobody wants are passed over, however many there are, by both kinds.
TEST_F(SharedLogTest, WhatIsNotWantedIsPassedOver) {
  room.Submit();
  const storage::Lease lease = room.bed.Lease();
  const std::int64_t other = room.Submit();
  const storage::Lease of_other = room.bed.Lease();
  const std::int64_t before = Must(room.bed.store().LastPosition());
  room.Say(lease, std::vector<std::string>(500, "not wanted"));
  room.Say(of_other, {"wanted"});
  for (const bool batched : {false, true}) {
    v1::WatchCellRequest request = After(before, batched);
    request.mutable_subscriptions(0)->mutable_jobs()->add_names(JobName(other));
    auto watch = room.WatchCell(request);
    EXPECT_TRUE(watch.Next().has_bookmark());
    EXPECT_EQ(watch.Next().event().job().message().text(), "wanted");
  }
}

// Many watches of three kinds, that come and go, break off and go on, while events are written by
// several threads: each sees what a plain look into the log gives, once and in order.
TEST_F(SharedLogTest, EachWatchSeesWhatThePlainLogHas) {
  constexpr int kWriters = 3;
  constexpr int kRounds = 40;
  std::vector<std::int64_t> jobs;
  std::vector<storage::Lease> leases;
  for (int i = 0; i < kWriters; ++i) {
    jobs.push_back(room.Submit());
    leases.push_back(room.bed.Lease());
  }
  const std::int64_t before = Must(room.bed.store().LastPosition());
  std::vector<std::jthread> threads;
  for (int writer = 0; writer < kWriters; ++writer) {
    threads.emplace_back([&, writer] {
      std::mt19937 random(static_cast<unsigned>(writer));
      for (int round = 0; round < kRounds; ++round)
        room.Say(leases[static_cast<std::size_t>(writer)],
                 std::vector<std::string>(1 + random() % 20, "of " + std::to_string(writer)));
      room.Say(leases[static_cast<std::size_t>(writer)], {"last"});
    });
  }
  struct Seen {
    std::int64_t job = 0;  // 0: all
    std::vector<std::int64_t> positions;
  };
  std::vector<Seen> seen(12);
  std::vector<std::jthread> watchers;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    watchers.emplace_back([&, i] {
      std::mt19937 random(static_cast<unsigned>(100 + i));
      const std::size_t wanted = i % 4;
      Seen& mine = seen[i];
      if (wanted < kWriters) mine.job = jobs[wanted];
      std::int64_t at = before;
      int lasts = 0;
      while (lasts < (mine.job == 0 ? kWriters : 1)) {
        v1::WatchCellRequest request = After(at, i % 2 == 0);
        if (mine.job != 0)
          request.mutable_subscriptions(0)->mutable_jobs()->add_names(JobName(mine.job));
        auto watch = room.WatchCell(request);
        // Breaks off somewhere, and comes back with the last number.
        for (auto left = 1 + random() % 40; left > 0; --left) {
          const v1::WatchCellResponse message = watch.Next();
          ASSERT_FALSE(message.instance_id().empty());
          for (const v1::CellEvent& event : EventsOf(message)) {
            mine.positions.push_back(event.sequence());
            if (event.job().message().text() == "last") ++lasts;
          }
          at = message.sequence();
          if (lasts == (mine.job == 0 ? kWriters : 1)) break;
        }
        watch.Cancel();
      }
    });
  }
  threads.clear();
  watchers.clear();
  for (const Seen& one : seen) {
    std::vector<std::int64_t> plain;
    for (const storage::EventRecord& event : Must(room.bed.store().AllEvents(before, 100'000))) {
      if (one.job == 0 || event.job == one.job) plain.push_back(event.position);
    }
    EXPECT_EQ(one.positions, plain) << one.job;
  }
}

}  // namespace
}  // namespace rmlcell::server
