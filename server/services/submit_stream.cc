#include "server/services/submit_stream.h"

#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>

#include "proto/bridge/findings.h"
#include "server/jobs/job_book.h"
#include "server/services/open_stream.h"

namespace rmlcell::server {
namespace {

// A message may come while others are still on their way: what a client may keep in our memory.
constexpr std::size_t kBytesAtOnce = 16 << 20;

class SubmitStream final
    : public grpc::ServerBidiReactor<v1::SubmitJobsRequest, v1::SubmitJobsResponse>,
      public OpenStreams::Stream,
      public std::enable_shared_from_this<SubmitStream> {
 public:
  SubmitStream(const CallNeeds& needs, JobBook& book, OpenStreams& open, CallFacts facts,
               Caller caller)
      : needs_(needs),
        book_(book),
        open_(open),
        facts_(std::move(facts)),
        caller_(std::move(caller)) {}

  // Keeps itself alive and begins. Call once, on a shared_ptr.
  grpc::ServerBidiReactor<v1::SubmitJobsRequest, v1::SubmitJobsResponse>* Begin() {
    self_ = shared_from_this();
    open_.Add(this);
    RightsChanged();  // perhaps between its admission and this moment
    const std::lock_guard lock(mutex_);
    GoOn();
    return this;
  }

  void ServerStops() override {
    const std::lock_guard lock(mutex_);
    End(ToGrpcStatus(Error{ErrorCode::kCellUnavailable, "the server stops", {}}));
  }
  void RightsChanged() override {
    const Result<Caller> still = needs_.gate.Admit(facts_);
    if (still) return;
    const std::lock_guard lock(mutex_);
    End(ToGrpcStatus(still.error()));
  }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) {
      const std::lock_guard lock(mutex_);
      reading_ = false;
      return End(grpc::Status::OK);
    }
    auto request = std::make_shared<v1::SubmitJobsRequest>(std::move(incoming_));
    incoming_.Clear();
    const std::size_t bytes = request->ByteSizeLong();
    {
      const std::lock_guard lock(mutex_);
      ++under_way_;
      bytes_ += bytes;
    }
    Submit(std::move(request), bytes);
    const std::lock_guard lock(mutex_);
    reading_ = false;
    GoOn();
  }

  void Submit(std::shared_ptr<v1::SubmitJobsRequest> request, std::size_t bytes) {
    auto answer = [self = shared_from_this(), number = request->number(),
                   bytes](const Result<v1::Job>& job) { self->Answer(number, bytes, job); };
    if (const Status size = CheckSize(needs_, *request); !size) return answer(size.error());
    const v1::SubmitJobRequest& submission = request->submission();
    book_.Submit(
        submission, caller_.identity,
        [request, answer = std::move(answer)](const Result<v1::Job>& job) { answer(job); },
        /*more_come=*/true);
  }

  // From a thread of the store, or that of OnReadDone.
  void Answer(std::int64_t number, std::size_t bytes, const Result<v1::Job>& job) {
    v1::SubmitJobsResponse response;
    response.set_number(number);
    if (job) {
      response.set_job(job->name());
    } else {
      *response.mutable_refusal() = bridge::ToErrorDetail(job.error());
    }
    const std::lock_guard lock(mutex_);
    answers_.push_back(std::move(response));
    --under_way_;
    bytes_ -= bytes;
    GoOn();
  }

  // Reads and writes what can be read and written now. Precondition: mutex_ is held.
  void GoOn() {
    if (finished_) return;
    if (!writing_ && !answers_.empty() && !cancelled_) {
      outgoing_ = std::move(answers_.front());
      answers_.pop_front();
      writing_ = true;
      grpc::WriteOptions options;
      if (!answers_.empty()) options.set_buffer_hint();
      StartWrite(&outgoing_, options);
    }
    if (ending_) {
      // What was taken is answered first.
      if (writing_ || (under_way_ > 0 && !cancelled_)) return;
      finished_ = true;
      return Finish(end_);
    }
    // Answers that nobody reads count, too.
    const std::size_t unread = answers_.size() + static_cast<std::size_t>(under_way_);
    if (reading_ || unread >= kSubmittedAtOnce || bytes_ >= kBytesAtOnce) return;
    reading_ = true;
    StartRead(&incoming_);
  }

  // Nothing more is taken. Precondition: mutex_ is held.
  void End(const grpc::Status& status) {
    if (!ending_) end_ = status;
    ending_ = true;
    GoOn();
  }

  void OnWriteDone(bool ok) override {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    if (!ok) cancelled_ = true;
    if (cancelled_) return End(grpc::Status::CANCELLED);
    GoOn();
  }

  void OnCancel() override {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    End(grpc::Status::CANCELLED);
  }

  void OnDone() override {
    open_.Remove(this);
    LogCall("JobService/SubmitJobs", caller_, end_, std::chrono::steady_clock::now() - begun_);
    self_.reset();
  }

  const CallNeeds needs_;
  JobBook& book_;
  OpenStreams& open_;
  const CallFacts facts_;
  const Caller caller_;
  const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  std::shared_ptr<SubmitStream> self_;
  v1::SubmitJobsRequest incoming_;
  v1::SubmitJobsResponse outgoing_;

  std::mutex mutex_;  // of all below
  std::deque<v1::SubmitJobsResponse> answers_;
  int under_way_ = 0;
  std::size_t bytes_ = 0;
  bool reading_ = false;
  bool writing_ = false;
  bool cancelled_ = false;
  bool ending_ = false;
  bool finished_ = false;
  grpc::Status end_;
};

}  // namespace

grpc::ServerBidiReactor<v1::SubmitJobsRequest, v1::SubmitJobsResponse>* MakeSubmitStream(
    const CallNeeds& needs, grpc::CallbackServerContext& context, JobBook& book,
    OpenStreams& open) {
  CallFacts facts = FactsOfCall(needs.gate, context, "JobService/SubmitJobs", nullptr);
  const Result<Caller> caller = needs.gate.Admit(facts);
  if (!caller) {
    return new EndedStream<grpc::ServerBidiReactor<v1::SubmitJobsRequest, v1::SubmitJobsResponse>>(
        ToGrpcStatus(caller.error()));
  }
  return std::make_shared<SubmitStream>(needs, book, open, std::move(facts), *caller)->Begin();
}

}  // namespace rmlcell::server
