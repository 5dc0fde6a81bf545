#include "server/base/restart_delay.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;

// server/base/restart_delay.h: longer and longer, ten seconds at most.
TEST(RestartDelay, GrowsWithEachShortLife) {
  RestartDelay delay;
  for (const int expected_ms : {100, 300, 700, 1500, 3100, 6300, 10'000, 10'000}) {
    EXPECT_EQ(delay.AfterLife(milliseconds(4999)), milliseconds(expected_ms));
  }
}

TEST(RestartDelay, BeginsAnewAfterAHealthyLife) {
  RestartDelay delay;
  EXPECT_EQ(delay.AfterLife(milliseconds(0)), milliseconds(100));
  EXPECT_EQ(delay.AfterLife(milliseconds(0)), milliseconds(300));
  EXPECT_EQ(delay.AfterLife(milliseconds(5000)), milliseconds(0));
  EXPECT_EQ(delay.AfterLife(milliseconds(0)), milliseconds(100));
}

}  // namespace
}  // namespace rmlcell::server
