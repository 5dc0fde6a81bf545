#include "server/worker/pacer.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr SimTime kHour = std::chrono::hours(1);

Pacer::Instant At(milliseconds real) { return Pacer::Instant(seconds(1000) + real); }

TEST(Pacer, LetsVirtualTimePassWithRealTime) {
  Pacer pacer(1.0);
  EXPECT_EQ(pacer.Due(At(milliseconds(0)), SimTime(0), kHour), SimTime(0));
  EXPECT_EQ(pacer.Due(At(milliseconds(10)), SimTime(0), kHour), milliseconds(10));
  EXPECT_EQ(pacer.Due(At(milliseconds(25)), milliseconds(10), kHour), milliseconds(15));
}

TEST(Pacer, CountsByItsPace) {
  Pacer pacer(10.0);
  pacer.Due(At(milliseconds(0)), seconds(5), kHour);
  EXPECT_EQ(pacer.Due(At(milliseconds(20)), seconds(5), kHour), milliseconds(200));
  EXPECT_EQ(pacer.Due(At(milliseconds(20)), seconds(5), milliseconds(50)), milliseconds(50))
      << "a slice at most";
}

TEST(Pacer, NeverGoesBack) {
  Pacer pacer(1.0);
  pacer.Due(At(milliseconds(0)), SimTime(0), kHour);
  EXPECT_EQ(pacer.Due(At(milliseconds(5)), milliseconds(30), kHour), SimTime(0));
}

TEST(Pacer, DoesNotCatchUpAfterStanding) {
  Pacer pacer(1.0);
  pacer.Due(At(milliseconds(0)), SimTime(0), kHour);
  pacer.Stand();
  EXPECT_EQ(pacer.Due(At(milliseconds(400)), SimTime(0), kHour), SimTime(0));
  EXPECT_EQ(pacer.Due(At(milliseconds(410)), SimTime(0), kHour), milliseconds(10));
}

TEST(Pacer, DoesNotCatchUpALongDelay) {
  Pacer pacer(1.0);
  pacer.Due(At(milliseconds(0)), SimTime(0), kHour);
  EXPECT_EQ(pacer.Due(At(milliseconds(500)), SimTime(0), kHour), milliseconds(500));
  EXPECT_EQ(pacer.Due(At(milliseconds(501)), SimTime(0), kHour), SimTime(0)) << "counts anew";
  EXPECT_EQ(pacer.Due(At(milliseconds(521)), SimTime(0), kHour), milliseconds(20));
}

TEST(Pacer, WithoutPaceGivesTheSlice) {
  Pacer pacer(0.0);
  EXPECT_FALSE(pacer.paced());
  EXPECT_EQ(pacer.Due(At(milliseconds(0)), SimTime(0), seconds(3)), seconds(3));
}

}  // namespace
}  // namespace rmlcell::server
