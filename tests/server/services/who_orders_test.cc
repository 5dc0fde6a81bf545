// Who ordered something, as the log of the cell and the store have it.
#include <gmock/gmock.h>

#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

class WhoOrders : public LiveMachines {};

// CellEvent.caller: who did it, which is not the name of his request.
TEST_F(WhoOrders, ACancelledJobSaysWhoCancelledIt) {
  const std::int64_t job =
      Must(store().SubmitAndWait({.machine = "optimo-1", .kind = "CHECK", .caller = "anna"}))
          .job.id;
  const std::int64_t before = Must(store().LastPosition());
  v1::CancelJobRequest request;
  request.set_name(JobName(job));
  request.set_request_id("the name of the request");
  const v1::Job cancelled = Call(jobs, &v1::JobService::Stub::CancelJob, request);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(cancelled.state(), v1::Job::STATE_CANCELLED);
  const auto events = Must(store().AllEvents(before, 10));
  ASSERT_FALSE(events.empty());
  for (const storage::EventRecord& event : events) EXPECT_EQ(event.caller, "local");
}

}  // namespace
}  // namespace rmlcell::server
