// The lease of a machine, as its host keeps it (live.md 3.04).
#include "server/host/lease_clock.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;

// LIVE-3.04: 60 s of lease, 5 s of them at rest, and 2 s to come there.
TEST(LeaseClock, TheMachineRestsBeforeItsLeaseEnds) {
  LeaseClock lease;
  lease.Given(60s, 100s);
  EXPECT_FALSE(lease.MustStop(152s + 999ms));
  EXPECT_TRUE(lease.MustStop(153s));
}

// LIVE-3.04: a renewal counts from when it was sent, not from when its answer came.
TEST(LeaseClock, ARenewalCountsFromWhenItWasSent) {
  LeaseClock lease;
  lease.Given(60s, 0s);
  EXPECT_FALSE(lease.RenewalDue(19s));
  EXPECT_TRUE(lease.RenewalDue(20s));
  lease.Renews(20s);
  EXPECT_FALSE(lease.RenewalDue(39s));
  EXPECT_TRUE(lease.MustStop(53s));
  lease.Renewed();  // at whatever time
  EXPECT_FALSE(lease.MustStop(72s + 999ms));
  EXPECT_TRUE(lease.MustStop(73s));
}

// LIVE-3.04: one that the store did not take is never confirmed, and stands in the way of none that
// comes later.
TEST(LeaseClock, ARenewalThatIsLostIsForgotten) {
  LeaseClock lease;
  lease.Given(60s, 0s);
  lease.Renews(20s);
  lease.Renews(40s);
  lease.Renewed();
  EXPECT_FALSE(lease.MustStop(92s));
  lease.Renewed();  // of none
  EXPECT_TRUE(lease.MustStop(93s));
  lease.Renews(95s);
  lease.Renewed();
  EXPECT_FALSE(lease.MustStop(147s));
}

// LIVE-3.04: what was sent over a line that is gone is answered no more.
TEST(LeaseClock, ANewLineBeginsAnew) {
  LeaseClock lease;
  lease.Given(60s, 0s);
  lease.Renews(20s);
  lease.Given(60s, 30s);
  lease.Renewed();
  EXPECT_FALSE(lease.MustStop(82s));
  EXPECT_TRUE(lease.MustStop(83s));
  EXPECT_EQ(lease.next_renewal(), 50s);
}

}  // namespace
}  // namespace rmlcell::server
