// A watch of the cell that has nothing to tell says that it lives when its time has come, whatever
// woke it in between (WEB, needs 1).
#include <gtest/gtest.h>

#include <string>

#include "server/base/names.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

class WatchWakes : public testing::Test {
 protected:
  // Of jobs, where they are at most twice a second.
  static v1::WatchCellRequest TwiceASecond() {
    v1::WatchCellRequest request;
    v1::Subscription& jobs = *request.add_subscriptions();
    jobs.set_id("jobs");
    jobs.set_max_rate_hz(2);
    jobs.mutable_jobs();
    return request;
  }
  // On a machine that is busy a bookmark may fall due before.
  static std::int64_t NextSteps(OpenedStream<v1::WatchCellResponse>& watch) {
    v1::WatchCellResponse message = watch.Next();
    while (message.has_bookmark()) message = watch.Next();
    return message.progress().steps();
  }
  // On such a machine the time of a position may come before, too.
  static void ExpectBookmarks(OpenedStream<v1::WatchCellResponse>& watch) {
    for (int i = 0; i < 2; ++i) {
      v1::WatchCellResponse message = watch.Next();
      while (message.has_progress()) message = watch.Next();
      EXPECT_TRUE(message.has_bookmark()) << message.ShortDebugString();
    }
  }

  StreamBed room{storage::SqliteOptions{}, std::chrono::milliseconds(1500)};
};

// Where another job is comes while there is nothing to tell yet, and is nothing to this watch.
TEST_F(WatchWakes, APositionOfAnotherJobCostsNoBookmark) {
  const std::int64_t mine = room.Submit();
  const std::int64_t other = room.Submit();
  v1::WatchCellRequest request = TwiceASecond();
  request.mutable_subscriptions(0)->mutable_jobs()->add_names(JobName(mine));
  auto watch = room.WatchCell(request);
  EXPECT_TRUE(watch.Next().has_snapshot());
  room.TellSteps(mine, 1);
  EXPECT_EQ(NextSteps(watch), 1);
  room.TellSteps(other, 1);
  ExpectBookmarks(watch);
}

// A subscription goes while something of it is put off: there is nothing to tell at that time.
TEST_F(WatchWakes, ASubscriptionThatGoesCostsNoBookmark) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  v1::WatchCellRequest request = TwiceASecond();
  v1::Subscription& projects = *request.add_subscriptions();
  projects.set_id("projects");
  projects.mutable_projects();
  auto watch = room.WatchCell(request);
  v1::UpdateWatchRequest change;
  change.set_watch_id(watch.Next().watch_id());
  change.add_remove("jobs");
  EXPECT_TRUE(watch.Next().has_snapshot());
  room.TellSteps(job, 1);
  EXPECT_EQ(NextSteps(watch), 1);
  room.TellSteps(job, 2);
  room.Say(lease, {"meanwhile"});
  v1::WatchCellResponse message = watch.Next();
  while (message.has_bookmark() || message.has_progress()) message = watch.Next();
  EXPECT_EQ(message.event().job().message().text(), "meanwhile");
  EXPECT_TRUE(room.registry.Change(change, StreamBed::kCaller));
  ExpectBookmarks(watch);
}

}  // namespace
}  // namespace rmlcell::server
