// What clients ask about RUN jobs of machines that live: it goes to the host that runs them.
#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>

#include <atomic>
#include <future>

#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class LiveJobs : public LiveMachines {
 protected:
  void GiveToHost(std::int64_t run) {
    ASSERT_EQ(Must(store().AcquireJobs({.worker = "hall/1",
                                        .server = "this server",
                                        .kinds = {"RUN"},
                                        .job = run,
                                        .duration = std::chrono::minutes(1)}))
                  .size(),
              1U);
  }
  std::int64_t Submit(v1::JobKind kind) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(kind);
    job.set_machine(kLaser);
    job.mutable_inline_program()->set_file_name("a.S");
    job.mutable_inline_program()->set_content("STOP\n");
    std::promise<std::int64_t> id;
    book.Submit(request, "anna", [&](const Result<v1::Job>& made) {
      EXPECT_TRUE(made) << (made ? "" : made.error().detail);
      id.set_value(made ? *ParseJobName(made->name()) : 0);
    });
    return id.get_future().get();
  }
};

// LIVE-5.04: a RUN that waits begins for the person who starts it, on its own machine.
TEST_F(LiveJobs, APersonStartsAJob) {
  const std::int64_t run = Submit(v1::JOB_KIND_RUN);
  v1::StartMachineRequest request;
  request.set_request_id("r");
  request.set_control_token("t");
  const auto start = [&](const std::string& machine, const std::string& job) {
    request.set_machine(machine);
    request.set_job(job);
    return Call(machines, &v1::MachineService::Stub::StartMachine, request);
  };
  start(kLaser, "7");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
  start(kLaser, "jobs/99");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND) << status.error_message();
  start("machines/mill-1", JobName(run));
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT,
                "job: " + JobName(run) + " is for machines/optimo-1");
  EXPECT_THAT(host->TakeOrders(), IsEmpty());
  v1::HostOrderAnswer answer;
  answer.mutable_status()->set_state(v1::MACHINE_STATE_RUNNING);
  host->Answer(answer);
  EXPECT_EQ(start(kLaser, JobName(run)).state(), v1::MACHINE_STATE_RUNNING);
  EXPECT_TRUE(status.ok()) << status.error_message();
  const auto orders = host->TakeOrders();
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_EQ(orders[0].caller(), "local");
  EXPECT_EQ(orders[0].by_person().SerializeAsString(), request.SerializeAsString());
  EXPECT_EQ(orders[0].run_job().job().name(), JobName(run));
}

TEST_F(LiveJobs, AStartThatTheHostRefusesIsRefused) {
  const std::int64_t run = Submit(v1::JOB_KIND_RUN);
  v1::HostOrderAnswer answer;
  answer.mutable_refusal()->set_code("CELL-E9409");
  answer.mutable_refusal()->set_message("no control");
  host->Answer(answer);
  v1::StartMachineRequest request;
  request.set_machine(kLaser);
  request.set_job(JobName(run));
  Call(machines, &v1::MachineService::Stub::StartMachine, request);
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "request_id: a UUID");
  request.set_request_id("r");
  Call(machines, &v1::MachineService::Stub::StartMachine, request);
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(status.error_message(), HasSubstr("no control"));
}

// Of a job that a machine runs they go to its host.
TEST_F(LiveJobs, OrdersForAJobGoToTheHostThatRunsIt) {
  const std::string run = JobName(Submit(v1::JOB_KIND_RUN));
  Tell(*host, v1::MACHINE_STATE_RUNNING, run);
  const auto ordered = [&](auto method, auto request) {
    request.set_name(run);
    request.set_request_id("r");
    v1::HostOrderAnswer refusal;
    refusal.mutable_refusal()->set_message("not now");
    host->Answer(refusal);
    Call(jobs, method, request);
    EXPECT_THAT(status.error_message(), HasSubstr("not now"));
    host->TakeOrders();
    host->Answer({});
    const auto response = Call(jobs, method, request);
    EXPECT_TRUE(status.ok()) << status.error_message();
    const auto orders = host->TakeOrders();
    EXPECT_EQ(orders.size(), 1U);
    const v1::HostOrder order = orders.empty() ? v1::HostOrder() : orders[0];
    EXPECT_EQ(order.caller(), "local");
    EXPECT_EQ(order.for_job(), run);
    return std::pair(order, response);
  };
  using Stub = v1::JobService::Stub;
  const auto [hold, held] = ordered(&Stub::HoldJob, v1::HoldJobRequest());
  EXPECT_EQ(hold.hold().request_id(), "r");
  EXPECT_EQ(held.job().name(), run);
  EXPECT_TRUE(held.has_acted_at());
  const auto [stop, stopped] = ordered(&Stub::StopJob, v1::StopJobRequest());
  EXPECT_EQ(stop.stop().request_id(), "r");
  EXPECT_EQ(stopped.job().name(), run);
  v1::ResumeJobRequest resume;
  resume.set_control_token("t");
  resume.set_accept_displaced(true);
  resume.set_restore_process(true);
  const auto [resumed, job] = ordered(&Stub::ResumeJob, resume);
  EXPECT_EQ(resumed.resume().control_token(), "t");
  EXPECT_EQ(resumed.resume().request_id(), "r");
  EXPECT_TRUE(resumed.resume().accept_displaced());
  EXPECT_TRUE(resumed.resume().restore_process());
  EXPECT_EQ(job.name(), run);
  v1::SetJobOverrideRequest faster;
  faster.set_control_token("t");
  faster.set_override_percent(70);
  const auto [changed, same] = ordered(&Stub::SetJobOverride, faster);
  EXPECT_EQ(changed.override().control_token(), "t");
  EXPECT_EQ(changed.override().request_id(), "r");
  EXPECT_EQ(changed.override().override_percent(), 70.0);
  EXPECT_EQ(same.name(), run);
}

// LIVE-5.10: the host has the last word; then the job is abandoned, begins anew, or goes on at a
// step as another one.
TEST_F(LiveJobs, WhatWasCutOffIsDecided) {
  const std::int64_t run = Submit(v1::JOB_KIND_RUN);
  const auto leased = Must(store().AcquireJobs({.worker = "hall/1",
                                                .server = "this server",
                                                .kinds = {"RUN"},
                                                .job = run,
                                                .duration = std::chrono::minutes(1)}));
  ASSERT_EQ(leased.size(), 1U);
  Must(store().Finish(leased[0].lease, {.outcome = {.state = storage::JobState::kInterrupted}}));
  v1::DecideInterruptedRequest request;
  request.set_name(JobName(run));
  request.set_reason("it burnt");
  request.set_control_token("t");
  request.set_request_id("r");
  const auto decide = [&](v1::DecideInterruptedRequest::Decision decision) {
    request.set_decision(decision);
    return Call(jobs, &v1::JobService::Stub::DecideInterrupted, request);
  };
  using Request = v1::DecideInterruptedRequest;
  decide(Request::DECISION_RESUME_AT_STEP);
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "preview_token: of PreviewStart");
  EXPECT_THAT(host->TakeOrders(), IsEmpty());
  v1::HostOrderAnswer refusal;
  refusal.mutable_refusal()->set_message("not now");
  host->Answer(refusal);
  decide(Request::DECISION_RESTART);
  EXPECT_THAT(status.error_message(), HasSubstr("not now"));
  host->TakeOrders();
  host->Answer({});
  EXPECT_EQ(decide(Request::DECISION_ABANDON).job(), "");
  EXPECT_TRUE(status.ok()) << status.error_message();
  const auto confirmed = host->TakeOrders();
  ASSERT_EQ(confirmed.size(), 1U);
  EXPECT_EQ(confirmed[0].caller(), "local");
  EXPECT_EQ(confirmed[0].reason(), "it burnt");
  EXPECT_EQ(confirmed[0].for_job(), JobName(run));
  EXPECT_EQ(confirmed[0].confirm().control_token(), "t");
  EXPECT_EQ(confirmed[0].confirm().request_id(), "r");
  EXPECT_THAT(confirmed[0].confirm().confirmations(),
              testing::ElementsAre(v1::CONFIRMATION_INSPECTED));
  request.set_request_id("s");
  EXPECT_EQ(decide(Request::DECISION_RESTART).job(), JobName(run + 1));
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(Must(store().GetJob(run + 1)).state, storage::JobState::kQueued);
  EXPECT_EQ(Must(store().GetJob(run + 1)).caller, "local");
  EXPECT_EQ(host->TakeOrders().size(), 1U);
  request.set_request_id("q");
  request.set_preview_token("p");
  request.add_confirmations(v1::CONFIRMATION_INSPECTED);
  request.set_halt_at_entry(true);
  EXPECT_EQ(decide(Request::DECISION_RESUME_AT_STEP).job(), JobName(run + 2));
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(Must(store().GetJob(run + 2)).caller, "local");
  const auto continued = host->TakeOrders();
  ASSERT_EQ(continued.size(), 1U);
  EXPECT_EQ(continued[0].caller(), "local");
  EXPECT_EQ(continued[0].reason(), "it burnt");
  const v1::StartAtStepRequest& start = continued[0].continue_job().start();
  EXPECT_EQ(start.machine(), kLaser);
  EXPECT_EQ(start.control_token(), "t");
  EXPECT_EQ(start.request_id(), "q");
  EXPECT_EQ(start.preview_token(), "p");
  EXPECT_TRUE(start.halt_at_entry());
  EXPECT_EQ(start.confirmations_size(), 1);
}

// LIVE-5.10: what was cut off is decided first.
TEST_F(LiveJobs, WhatWaitsForADecisionIsNotDeleted) {
  const std::int64_t run = Submit(v1::JOB_KIND_RUN);
  v1::HostRequest told;
  told.mutable_status()->set_machine(kLaser);
  told.mutable_status()->set_state(v1::MACHINE_STATE_IDLE);
  told.mutable_status()->set_host("hall/1");
  told.mutable_status()->set_cut_off_job(JobName(run));
  hosts.Receive(*host, std::move(told));
  v1::DeleteJobRequest request;
  request.set_name(JobName(run));
  Call(jobs, &v1::JobService::Stub::DeleteJob, request);
  ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, "waits for a decision about it");
  EXPECT_THAT(status.error_message(), HasSubstr("CELL-E9409"));
}

// LIVE-5.05: a RUN is cancelled by its host, which says when it is over; where none is heard of it
// is kept for it, and said.
TEST_F(LiveJobs, ACancelGoesToTheHost) {
  const std::int64_t run = Submit(v1::JOB_KIND_RUN);
  GiveToHost(run);
  v1::CancelJobRequest request;
  request.set_name(JobName(run));
  request.set_request_id("c");
  Call(jobs, &v1::JobService::Stub::CancelJob, request);
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "the host of its machine is not heard of");
  EXPECT_THAT(status.error_message(), HasSubstr("CELL-E9424"));
  EXPECT_TRUE(Must(store().GetJob(run)).cancel_requested);
  EXPECT_THAT(host->TakeOrders(), IsEmpty());
  Tell(*host, v1::MACHINE_STATE_RUNNING, JobName(run));
  request.set_request_id("d");
  const v1::Job job = Call(jobs, &v1::JobService::Stub::CancelJob, request);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(job.name(), JobName(run));
  const auto orders = host->TakeOrders();
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_EQ(orders[0].caller(), "local");
  EXPECT_EQ(orders[0].for_job(), JobName(run));
  EXPECT_EQ(orders[0].abort().request_id(), "d");
}

// LIVE-5.05: nor do other orders for it go anywhere then, and it is told why: it does not wait in
// the queue, where it could be held back or let go.
TEST_F(LiveJobs, WhereNoHostIsHeardOfARunTakesNoOrders) {
  const std::int64_t run = Submit(v1::JOB_KIND_RUN);
  GiveToHost(run);
  const auto expect_refused = [&](auto method, auto request) {
    request.set_name(JobName(run));
    request.set_request_id("r");
    Call(jobs, method, request);
    ExpectRefused(grpc::StatusCode::UNAVAILABLE,
                  "no machine is heard of that runs " + JobName(run));
  };
  using Stub = v1::JobService::Stub;
  expect_refused(&Stub::HoldJob, v1::HoldJobRequest());
  expect_refused(&Stub::StopJob, v1::StopJobRequest());
  expect_refused(&Stub::ResumeJob, v1::ResumeJobRequest());
  EXPECT_FALSE(Must(store().GetJob(run)).held);
  EXPECT_THAT(host->TakeOrders(), IsEmpty());
}

// Many at once: those that run on a machine are aborted there.
TEST_F(LiveJobs, ACancelOfManyGoesToTheHost) {
  const std::int64_t run = Submit(v1::JOB_KIND_RUN);
  const std::int64_t waits = Submit(v1::JOB_KIND_CHECK);
  GiveToHost(run);
  Tell(*host, v1::MACHINE_STATE_RUNNING, JobName(run));
  v1::CancelJobsRequest request;
  request.mutable_jobs()->set_all(true);
  EXPECT_EQ(Call(jobs, &v1::JobService::Stub::CancelJobs, request).jobs(), 2);
  EXPECT_TRUE(status.ok()) << status.error_message();
  const auto orders = host->TakeOrders();
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_TRUE(orders[0].has_abort());
  EXPECT_EQ(orders[0].for_job(), JobName(run));
  EXPECT_EQ(orders[0].caller(), "local");
  EXPECT_EQ(Must(store().GetJob(waits)).state, storage::JobState::kCancelled);
}

// Its line breaks before it has answered: who asked is told so. What it has done is done, and what
// the job is by now cannot be told where the store refuses it.
TEST_F(LiveJobs, WhatComesOfAnOrderIsToldAsItIs) {
  const std::string run = JobName(Submit(v1::JOB_KIND_RUN));
  Tell(*host, v1::MACHINE_STATE_RUNNING, run);
  v1::HoldJobRequest request;
  request.set_name(run);
  request.set_request_id("r");
  host->Answer({});
  refusing.Refuse("GetJob");
  Call(jobs, &v1::JobService::Stub::HoldJob, request);
  ExpectRefused(grpc::StatusCode::INTERNAL, "the disk is full");
  refusing.Heal();
  request.set_request_id("s");
  host->LeaveOnOrder();
  Call(jobs, &v1::JobService::Stub::HoldJob, request);
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "its host is not heard of any more");
}

// Of many at once nobody reads why each waits: that is worked out for one that comes alone.
TEST_F(LiveJobs, WhyItWaitsIsToldOfOneThatComesAlone) {
  std::atomic<int> told = 0;
  book.OnToldToWait([&told](v1::Job&) { ++told; });
  v1::SubmitJobsRequest request;
  request.set_number(1);
  v1::Job& job = *request.mutable_submission()->mutable_job();
  job.set_kind(v1::JOB_KIND_RUN);
  job.set_machine(kLaser);
  job.mutable_inline_program()->set_file_name("a.S");
  job.mutable_inline_program()->set_content("STOP\n");
  const auto context = Context();
  const auto stream = jobs->SubmitJobs(context.get());
  v1::SubmitJobsResponse response;
  ASSERT_TRUE(stream->Write(request) && stream->Read(&response));
  EXPECT_NE(response.job(), "") << response.ShortDebugString();
  stream->WritesDone();
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(told, 0);
  Submit(v1::JOB_KIND_RUN);
  EXPECT_EQ(told, 1);
}

TEST_F(LiveJobs, WhoMayNotSubmitSubmitsNothing) {
  v1::SubmitJobRequest request;
  request.mutable_job()->set_kind(v1::JOB_KIND_CHECK);
  request.mutable_job()->set_machine(kLaser);
  request.mutable_job()->mutable_inline_program()->set_file_name("a.S");
  const auto submit = [&] { Call(jobs, &v1::JobService::Stub::SubmitJob, request); };
  request.mutable_job()->mutable_inline_program()->set_content(std::string(8 << 20, ' '));
  submit();  // more than a message may have
  ExpectRefused(grpc::StatusCode::RESOURCE_EXHAUSTED, "limits.message_bytes");
  request.mutable_job()->mutable_inline_program()->set_content("STOP\n");
  gate.SetLocal(ViewerPermissions());
  submit();
  ExpectRefused(grpc::StatusCode::PERMISSION_DENIED, "CELL-E9012");
  EXPECT_TRUE(Must(store().ListJobs({})).empty());
}

}  // namespace
}  // namespace rmlcell::server
