// Orders for jobs that no machine runs: those of a worker go to it at once, those that wait stay in
// the queue (proto/rmlcell/v1/job.proto).
#include <gmock/gmock.h>

#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

class WorkerOrders : public LiveMachines {
 protected:
  using Stub = v1::JobService::Stub;

  template <class Request, class Response>
  Response Order(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                 Request request = {}) {
    request.set_name(JobName(job));
    request.set_request_id("r");
    return Call(jobs, method, request);
  }
  // The next order that the worker has, as this caller's.
  static v1::WorkerControl Told(FakeWorker& worker) {
    v1::WorkerControl order = worker.Ordered();
    EXPECT_EQ(order.caller(), "local");
    return order;
  }

  std::int64_t job = bed().server.SubmitCheck();
};

TEST_F(WorkerOrders, GoToTheWorkerThatRunsTheJob) {
  FakeWorker worker(bed().dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  const v1::HaltJobResponse held = Order(&Stub::HoldJob);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(held.has_acted_at());
  EXPECT_EQ(held.job().name(), JobName(job));
  const v1::WorkerControl hold = Told(worker);
  EXPECT_EQ(hold.kind(), v1::WorkerControl::KIND_HOLD);
  EXPECT_EQ(hold.request_id(), "r");
  const v1::HaltJobResponse stopped = Order(&Stub::StopJob);
  EXPECT_TRUE(stopped.has_acted_at());
  EXPECT_EQ(stopped.job().name(), JobName(job));
  EXPECT_EQ(Told(worker).kind(), v1::WorkerControl::KIND_STOP);
  EXPECT_EQ(Order(&Stub::ResumeJob).name(), JobName(job));
  EXPECT_EQ(Told(worker).kind(), v1::WorkerControl::KIND_RESUME);
  v1::SetJobOverrideRequest faster;
  faster.set_override_percent(70);
  EXPECT_EQ(Order(&Stub::SetJobOverride, faster).name(), JobName(job));
  const v1::WorkerControl changed = Told(worker);
  EXPECT_EQ(changed.kind(), v1::WorkerControl::KIND_OVERRIDE);
  EXPECT_EQ(changed.value(), 70.0);
  EXPECT_EQ(changed.request_id(), "r");
  faster.set_override_percent(-1);
  Order(&Stub::SetJobOverride, faster);
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "override_percent");
  EXPECT_EQ(Order(&Stub::CancelJob).name(), JobName(job));
  const v1::WorkerControl cancel = Told(worker);
  EXPECT_EQ(cancel.kind(), v1::WorkerControl::KIND_CANCEL);
  EXPECT_EQ(cancel.request_id(), "r");
}

// Many at once: each worker of theirs is told.
TEST_F(WorkerOrders, ACancelOfManyGoesToTheWorker) {
  FakeWorker worker(bed().dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  v1::CancelJobsRequest request;
  request.mutable_jobs()->set_all(true);
  EXPECT_EQ(Call(jobs, &Stub::CancelJobs, request).jobs(), 1);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(Told(worker).kind(), v1::WorkerControl::KIND_CANCEL);
}

// One that waits is held back and let go; there is nothing of it to stop or to change.
TEST_F(WorkerOrders, OneThatWaitsIsHeldBack) {
  EXPECT_TRUE(Order(&Stub::HoldJob).has_acted_at());
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(Must(store().GetJob(job)).held);
  EXPECT_EQ(Order(&Stub::ResumeJob).name(), JobName(job));
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_FALSE(Must(store().GetJob(job)).held);
  Order(&Stub::StopJob);
  ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, "CELL-E9015");
  EXPECT_THAT(status.error_message(), testing::HasSubstr(JobName(job) + " does not run"));
  v1::SetJobOverrideRequest faster;
  faster.set_override_percent(70);
  Order(&Stub::SetJobOverride, faster);
  ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, JobName(job) + " does not run");
}

}  // namespace
}  // namespace rmlcell::server
