#include "server/events/feed_rhythm.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;

FeedRhythm::Instant At(int ms) { return FeedRhythm::Instant(milliseconds(1'000'000 + ms)); }

// server/events/event_feed.h: without a hint every second, counted from the last look.
TEST(FeedRhythm, LooksWhenHintedOrWhenItIsTime) {
  FeedRhythm rhythm(At(0), milliseconds(1000));
  EXPECT_EQ(rhythm.Next(false, false), At(0));
  EXPECT_TRUE(rhythm.TakeLook(At(0), false));
  EXPECT_EQ(rhythm.Next(false, false), At(1000));
  EXPECT_FALSE(rhythm.TakeLook(At(999), false));
  EXPECT_EQ(rhythm.Next(false, false), At(1000));
  EXPECT_TRUE(rhythm.TakeLook(At(1000), false));
  EXPECT_EQ(rhythm.Next(false, false), At(2000));
  EXPECT_TRUE(rhythm.TakeLook(At(1300), true));
  EXPECT_EQ(rhythm.Next(false, false), At(2300));
}

// Issue "Watch": at most 20 position updates a second.
TEST(FeedRhythm, TellsPositionsAtMostTwentyTimesASecond) {
  FeedRhythm rhythm(At(0), milliseconds(1000));
  ASSERT_TRUE(rhythm.TakeLook(At(0), true));
  EXPECT_EQ(rhythm.Next(false, true), At(0));
  int told = 0;
  for (int ms = 0; ms < 1000; ++ms) told += rhythm.TakeLatest(At(ms)) ? 1 : 0;
  EXPECT_EQ(told, 20);
  EXPECT_EQ(rhythm.Next(false, true), At(1000));
  EXPECT_TRUE(rhythm.TakeLatest(At(1030)));  // late: the next interval begins here
  EXPECT_FALSE(rhythm.TakeLatest(At(1079)));
  EXPECT_EQ(rhythm.Next(false, true), At(1000));  // the look is due before
  EXPECT_TRUE(rhythm.TakeLook(At(1079), false));
  EXPECT_EQ(rhythm.Next(false, true), At(1080));
  EXPECT_EQ(rhythm.Next(false, false), At(2079));
  EXPECT_TRUE(rhythm.TakeLatest(At(1080)));
}

// docs/decisions/0030: a message to each of a hundred watchers costs 5 ms, so that is how long
// the next look waits; with many events at once longer, at most 20 ms.
TEST(FeedRhythm, UnderLoadMoreEventsGoTogether) {
  using std::chrono::microseconds;
  FeedRhythm rhythm(At(0), milliseconds(1000));
  ASSERT_TRUE(rhythm.TakeLook(At(0), true));
  rhythm.Told(At(0), 7, 100);
  EXPECT_EQ(rhythm.Next(true, false), At(0) + microseconds(5000));
  EXPECT_FALSE(rhythm.TakeLook(At(0) + microseconds(4999), true));
  EXPECT_TRUE(rhythm.TakeLook(At(0) + microseconds(5000), true));
  rhythm.Told(At(5), 8, 100);
  EXPECT_EQ(rhythm.Next(true, false), At(15));
  rhythm.Told(At(8), 1000, 100);
  EXPECT_EQ(rhythm.Next(true, false), At(28));
  rhythm.Told(At(8), 1, 1);
  EXPECT_EQ(rhythm.Next(true, false), At(8) + microseconds(50));
  rhythm.Told(At(8), 1000, 0);  // nobody was woken
  EXPECT_TRUE(rhythm.TakeLook(At(8), true));
}

}  // namespace
}  // namespace rmlcell::server
