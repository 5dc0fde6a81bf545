// What becomes of a run that was cut off, and what of its journal goes out.
#include <future>

#include "proto/recording/recording.h"
#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

class DecidedJobs : public LiveMachines {
 protected:
  // A RUN that was cut off.
  std::int64_t CutOff() {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_RUN);
    job.set_machine(kLaser);
    job.mutable_inline_program()->set_file_name("a.S");
    job.mutable_inline_program()->set_content("STOP\n");
    std::promise<std::int64_t> made;
    book.Submit(request, "anna", [&](const Result<v1::Job>& one) {
      EXPECT_TRUE(one) << (one ? "" : one.error().detail);
      made.set_value(one ? *ParseJobName(one->name()) : 0);
    });
    const std::int64_t run = made.get_future().get();
    const auto leased = Must(store().AcquireJobs({.worker = "hall/1",
                                                  .server = "this server",
                                                  .kinds = {"RUN"},
                                                  .job = run,
                                                  .duration = std::chrono::minutes(1)}));
    EXPECT_EQ(leased.size(), 1U);
    Must(store().Finish(leased.at(0).lease,
                        {.outcome = {.state = storage::JobState::kInterrupted}}));
    return run;
  }
  static std::string ContinuedBy(const storage::JobRecord& job) {
    v1::Job specification;
    EXPECT_TRUE(specification.ParseFromString(job.specification));
    return specification.continues();
  }
  storage::JobRecord Decided(std::int64_t run, v1::DecideInterruptedRequest::Decision decision) {
    v1::DecideInterruptedRequest request;
    request.set_name(JobName(run));
    request.set_decision(decision);
    request.set_reason("the power was gone");
    request.set_control_token("t");
    request.set_preview_token("p");
    request.set_request_id("r" + std::to_string(decision));
    const auto response = Call(jobs, &v1::JobService::Stub::DecideInterrupted, request);
    EXPECT_TRUE(status.ok()) << status.error_message();
    const auto id = ParseJobName(response.job());
    return id ? Must(store().GetJob(*id)) : storage::JobRecord();
  }
};

// LIVE-5.10: one that begins anew is a job like any other and waits in the queue; one that goes on
// says of which it does.
TEST_F(DecidedJobs, OneBeginsAnewAndOneGoesOn) {
  using Request = v1::DecideInterruptedRequest;
  const std::int64_t run = CutOff();
  const storage::JobRecord anew = Decided(run, Request::DECISION_RESTART);
  EXPECT_EQ(anew.state, storage::JobState::kQueued);
  EXPECT_FALSE(anew.held);
  EXPECT_EQ(ContinuedBy(anew), "");
  const storage::JobRecord goes_on = Decided(run, Request::DECISION_RESUME_AT_STEP);
  EXPECT_EQ(ContinuedBy(goes_on), JobName(run));
}

// What the host refuses goes on nowhere, and its reason is told.
TEST_F(DecidedJobs, AStartThatTheHostRefusesIsNoDecision) {
  v1::DecideInterruptedRequest request;
  request.set_name(JobName(CutOff()));
  request.set_decision(v1::DecideInterruptedRequest::DECISION_RESUME_AT_STEP);
  request.set_reason("the power was gone");
  request.set_control_token("t");
  request.set_preview_token("p");
  const auto decide = [&] { Call(jobs, &v1::JobService::Stub::DecideInterrupted, request); };
  decide();
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "request_id: a UUID");
  EXPECT_TRUE(host->TakeOrders().empty());
  v1::HostOrderAnswer refusal;
  refusal.mutable_refusal()->set_code("CELL-E9409");
  refusal.mutable_refusal()->set_message("not now");
  host->Answer(refusal);
  request.set_request_id("r");
  decide();
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(status.error_message(), testing::HasSubstr("not now"));
}

// A request id that made another job makes none of these.
TEST_F(DecidedJobs, ARequestIdIsOfOneJob) {
  using Request = v1::DecideInterruptedRequest;
  Must(store().SubmitAndWait({.request_id = "taken", .machine = "optimo-1", .kind = "CHECK"}));
  Request request;
  request.set_name(JobName(CutOff()));
  request.set_reason("the power was gone");
  request.set_control_token("t");
  request.set_preview_token("p");
  request.set_request_id("taken");
  for (const auto decision : {Request::DECISION_RESTART, Request::DECISION_RESUME_AT_STEP}) {
    request.set_decision(decision);
    Call(jobs, &v1::JobService::Stub::DecideInterrupted, request);
    ExpectRefused(grpc::StatusCode::ALREADY_EXISTS, "CELL-E9019");
  }
}

// From a time on: from the newest state that is not behind it, and a nanosecond is a time.
TEST_F(DecidedJobs, AJournalGoesOutFromItsFirstInstant) {
  const auto mark = [](std::int64_t sequence, std::int64_t time_ns) {
    v1::JournalEntry entry;
    entry.set_fence(7);
    entry.set_sequence(sequence);
    entry.set_virtual_time_ns(time_ns);
    entry.mutable_mark()->set_state("state " + std::to_string(sequence));
    return entry;
  };
  v1::MachineRecording head;
  head.set_fence(7);
  const recording::Recording all{.head = head, .entries = {mark(1, 0), mark(2, 1), mark(3, 2)}};
  Must(store().SubmitAndWait({.machine = "optimo-1", .kind = "SIMULATE"}));
  const auto leased = Must(store().Acquire("w", {"SIMULATE"}, std::chrono::minutes(1), {}));
  ASSERT_TRUE(leased);
  Must(store().Finish(leased->lease,
                      {.artifacts = {{.name = "recording", .bytes = recording::FileOf(all)}}}));
  const auto exported = [&](std::int64_t fence, std::int64_t from_ns) {
    v1::ExportJournalRequest request;
    request.set_machine(kLaser);
    request.set_job(JobName(leased->lease.job));
    request.set_fence(fence);
    request.set_from_virtual_time_ns(from_ns);
    const auto context = Context();
    const auto reader = machines->ExportJournal(context.get(), request);
    std::string bytes;
    for (v1::ExportJournalResponse part; reader->Read(&part);) bytes += part.chunk();
    EXPECT_TRUE(reader->Finish().ok());
    return bytes;
  };
  for (const std::int64_t fence : {0, 7}) {
    EXPECT_EQ(exported(fence, 0), recording::FileOf(all));
    EXPECT_EQ(exported(fence, 1),
              recording::FileOf({.head = head, .entries = {mark(2, 1), mark(3, 2)}}));
    EXPECT_EQ(exported(fence, 2), recording::FileOf({.head = head, .entries = {mark(3, 2)}}));
  }
}

// The host has the last word: without it nothing is decided.
TEST_F(DecidedJobs, AHostThatGoesDecidesNothing) {
  v1::DecideInterruptedRequest request;
  const std::int64_t run = CutOff();
  request.set_name(JobName(run));
  request.set_decision(v1::DecideInterruptedRequest::DECISION_RESTART);
  request.set_reason("the power was gone");
  request.set_control_token("t");
  request.set_request_id("r");
  host->LeaveOnOrder();
  Call(jobs, &v1::JobService::Stub::DecideInterrupted, request);
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "its host is not heard of any more");
  EXPECT_FALSE(store().GetJob(run + 1));  // no other begins
}

// Whoever lets a job go on is told so, too.
TEST_F(DecidedJobs, AHostThatGoesGoesOnWithNothing) {
  v1::DecideInterruptedRequest request;
  request.set_name(JobName(CutOff()));
  request.set_decision(v1::DecideInterruptedRequest::DECISION_RESUME_AT_STEP);
  request.set_reason("the power was gone");
  request.set_control_token("t");
  request.set_preview_token("p");
  request.set_request_id("r");
  host->LeaveOnOrder();
  Call(jobs, &v1::JobService::Stub::DecideInterrupted, request);
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "its host is not heard of any more");
  EXPECT_EQ(host->TakeOrders().size(), 1U);
}

}  // namespace
}  // namespace rmlcell::server
