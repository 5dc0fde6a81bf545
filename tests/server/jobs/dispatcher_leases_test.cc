// Leases that were renewed.
#include <gtest/gtest.h>

#include <chrono>

#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;

// It may hold its job for a whole lease after the last renewal: so long events are tried again.
TEST(DispatcherLease, ThatWasRenewedIsHeldForItsWholeTime) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 900;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.Settle();
  bed.Advance(milliseconds(600));
  worker.Heartbeat();
  ASSERT_TRUE(Eventually([&] { return bed.hooks.renewals == 1; }));
  bed.Settle();
  bed.Advance(milliseconds(600));
  bed.hooks.appends_that_fail = 2;
  worker.Events(1, "a");
  EXPECT_EQ(worker.line().Next(v1::WorkResponse::kEventsStored).events_stored().count(), 1);
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(bed.Job(job).attempts, 1);
}

}  // namespace
}  // namespace rmlcell::server
