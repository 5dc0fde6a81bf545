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

// What has ended otherwise meanwhile is not given back: its worker just hears that it was lost.
TEST(DispatcherLease, ThatIsLostLeavesItsJobAlone) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  const storage::AttemptRecord attempt = Must(bed.server.store().ListAttempts(job)).back();
  Must(bed.server.store().Finish(
      {.job = job, .attempt = attempt.number, .fence = attempt.fence, .worker = attempt.worker},
      {.outcome = {.state = storage::JobState::kFailed}}));
  bed.hooks.losses_that_fail = 1;  // the first that would be given back or abandoned
  worker.Finish();
  EXPECT_EQ(worker.Released(), false);
  bed.Settle();
  EXPECT_EQ(bed.hooks.losses_that_fail, 1);
  EXPECT_EQ(bed.Job(job).state, storage::JobState::kFailed);
}

}  // namespace
}  // namespace rmlcell::server
