// What a watch owes to a subscription that comes to it on the way (docs/api.md, "Watching").
#include <gtest/gtest.h>

#include <string>

#include "server/base/names.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

// It is told where each job is, also where that was all that ever stood, was told to the others
// before it came, and an event comes first.
TEST(WatchChanges, WhereAJobIsComesBehindTheEvents) {
  StreamBed room;
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  v1::WatchCellRequest request;
  v1::Subscription& projects = *request.add_subscriptions();
  projects.set_id("projects");
  projects.mutable_projects();
  auto watch = room.WatchCell(request);
  v1::UpdateWatchRequest change;
  change.set_watch_id(watch.Next().watch_id());
  room.TellSteps(job, 7);
  ASSERT_EQ(room.feed.version(), 1U);
  constexpr int kAdded = 30;
  for (int i = 0; i < kAdded; ++i) {
    v1::Subscription& added = *change.add_add();
    added.set_id("jobs " + std::to_string(i));
    added.mutable_jobs();
  }
  ASSERT_TRUE(room.registry.Change(change, StreamBed::kCaller));
  EXPECT_TRUE(watch.Next().has_snapshot());
  // The others wait for their reader, and the event comes behind them.
  room.Say(lease, {"meanwhile"});
  ASSERT_TRUE(
      Eventually([&] { return room.feed.position() == Must(room.bed.store().LastPosition()); }));
  for (int i = 1; i < kAdded; ++i) EXPECT_TRUE(watch.Next().has_snapshot()) << i;
  EXPECT_EQ(watch.Next().event().job().message().text(), "meanwhile");
  EXPECT_EQ(watch.Next().progress().steps(), 7);
}

}  // namespace
}  // namespace rmlcell::server
