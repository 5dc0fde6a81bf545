// Calls while the lane that carries them out stands: what needs none of it is done all the same,
// and what has no room on it is refused at once.
#include <future>
#include <latch>
#include <utility>

#include "server/base/names.h"
#include "tests/server/services/unary_calls_bed.h"

namespace rmlcell::server {
namespace {

class StandingLane : public UnaryCalls {
 protected:
  StandingLane() {
    const auto begun = std::make_shared<std::latch>(1);
    executor_.Post([begun, goes_on = goes_on_] {
      begun->count_down();
      goes_on->wait();
    });
    begun->wait();
  }
  ~StandingLane() override { GoOn(); }

  void GoOn() {
    if (std::exchange(stands_, false)) goes_on_->count_down();
  }

 private:
  std::shared_ptr<std::latch> goes_on_ = std::make_shared<std::latch>(1);
  bool stands_ = true;
};

// job.proto, CancelJob: a job that runs ends as soon as its worker hears of it, and that waits for
// nothing that waits for the store.
TEST_F(StandingLane, ACancelReachesTheWorker) {
  const std::int64_t job = bed_.server.SubmitCheck();
  FakeWorker worker(bed_.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  const auto ended = std::async(std::launch::async, [&] {
    Call(jobs, &v1::JobService::Stub::CancelJob,
         "name: '" + JobName(job) + "' request_id: 'of the cancel'");
  });
  const v1::WorkerControl told = worker.Ordered();
  EXPECT_EQ(told.kind(), v1::WorkerControl::KIND_CANCEL);
  EXPECT_EQ(told.caller(), "local");
  EXPECT_EQ(told.request_id(), "of the cancel");
  GoOn();
  ended.wait();
  EXPECT_TRUE(status.ok()) << status.error_message();
}

// A lane has room for so many that wait; one more is told to come again.
TEST_F(StandingLane, WhatHasNoRoomIsRefused) {
  for (std::size_t i = 0; i < kWaitingMax; ++i) executor_.Post([] {});
  const std::string text = "try again when some are done";
  Call(jobs, &v1::JobService::Stub::DecideInterrupted,
       "name: 'jobs/1' decision: DECISION_RESTART reason: 'it burnt' control_token: 't' "
       "request_id: 'r'");
  ExpectRefused(grpc::StatusCode::RESOURCE_EXHAUSTED, text);
  EXPECT_THAT(status.error_message(), testing::HasSubstr("CELL-E9020"));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  v1::Project response;
  const auto writer = projects->ImportProject(&context, &response);
  writer->Write(FromText<v1::ImportProjectRequest>("project_id: 'lid'"));
  writer->WritesDone();
  status = writer->Finish();
  ExpectRefused(grpc::StatusCode::RESOURCE_EXHAUSTED, text);
  EXPECT_THAT(status.error_message(), testing::HasSubstr("CELL-E9020"));
  GoOn();
  EXPECT_TRUE(Eventually([&] {
    Call(projects, &v1::ProjectService::Stub::ListProjects, "");
    return status.ok();
  }));
}

}  // namespace
}  // namespace rmlcell::server
