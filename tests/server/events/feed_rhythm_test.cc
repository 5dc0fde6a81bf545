#include "server/events/feed_rhythm.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;

FeedRhythm::Instant At(int ms) { return FeedRhythm::Instant(milliseconds(1'000'000 + ms)); }

// server/events/event_feed.h: without a hint every second, counted from the last look.
TEST(FeedRhythm, LooksWhenHintedOrWhenItIsTime) {
  FeedRhythm rhythm(At(0), milliseconds(1000));
  EXPECT_EQ(rhythm.NextLook(false), At(0));
  EXPECT_TRUE(rhythm.TakeLook(At(0), false));
  EXPECT_EQ(rhythm.NextLook(false), At(1000));
  EXPECT_FALSE(rhythm.TakeLook(At(999), false));
  EXPECT_EQ(rhythm.NextLook(false), At(1000));
  EXPECT_TRUE(rhythm.TakeLook(At(1000), false));
  EXPECT_EQ(rhythm.NextLook(false), At(2000));
  EXPECT_TRUE(rhythm.TakeLook(At(1300), true));
  EXPECT_EQ(rhythm.NextLook(false), At(2300));
}

// LIVE-3.16: at most 20 updates of one position a second.
TEST(FeedRhythm, TellsAPositionAtMostTwentyTimesASecond) {
  FeedRhythm rhythm(At(0), milliseconds(1000));
  int told = 0;
  FeedRhythm::Instant last{};
  for (int ms = 0; ms < 1000; ++ms) {
    if (rhythm.LatestDue(last) > At(ms)) continue;
    ++told;
    last = At(ms);
    rhythm.ToldLatest(At(ms), 1);
  }
  EXPECT_EQ(told, 20);
  EXPECT_EQ(rhythm.LatestDue(last), At(1000));
}

// LIVE-3.17: one position does not wait for another; what many watchers cost puts off the next.
TEST(FeedRhythm, APositionWaitsForNoOther) {
  FeedRhythm rhythm(At(0), milliseconds(1000));
  EXPECT_EQ(rhythm.LatestDue({}), At(0));
  rhythm.ToldLatest(At(0), 1);
  EXPECT_EQ(rhythm.LatestDue(At(0)), At(50));
  EXPECT_EQ(rhythm.LatestDue({}), At(5));
  rhythm.ToldLatest(At(100), 200);  // 10 ms
  EXPECT_EQ(rhythm.LatestDue({}), At(110));
  rhythm.ToldLatest(At(200), 10'000);
  EXPECT_EQ(rhythm.LatestDue({}), At(250));
}

// docs/decisions/0030: a message to each of a hundred watchers costs 5 ms, so that is how long
// the next look waits; with many events at once longer, at most 20 ms.
TEST(FeedRhythm, UnderLoadMoreEventsGoTogether) {
  using std::chrono::microseconds;
  FeedRhythm rhythm(At(0), milliseconds(1000));
  ASSERT_TRUE(rhythm.TakeLook(At(0), true));
  rhythm.Told(At(0), 7, 100);
  EXPECT_EQ(rhythm.NextLook(true), At(0) + microseconds(5000));
  EXPECT_FALSE(rhythm.TakeLook(At(0) + microseconds(4999), true));
  EXPECT_TRUE(rhythm.TakeLook(At(0) + microseconds(5000), true));
  rhythm.Told(At(5), 8, 100);
  EXPECT_EQ(rhythm.NextLook(true), At(15));
  rhythm.Told(At(8), 1000, 100);
  EXPECT_EQ(rhythm.NextLook(true), At(28));
  rhythm.Told(At(8), 1, 1);
  EXPECT_EQ(rhythm.NextLook(true), At(8) + microseconds(50));
  rhythm.Told(At(8), 1000, 0);  // nobody was woken
  EXPECT_TRUE(rhythm.TakeLook(At(8), true));
}

}  // namespace
}  // namespace rmlcell::server
