#pragma once

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "proto/bridge/findings.h"
#include "server/services/call.h"
#include "server/services/open_stream.h"

namespace rmlcell::server {

// A stream each message of which gets one answer, some while others are still under way, in the
// order in which they are there. A client that sends faster than kAtOnce waits.
template <class Request, class Response>
class AnsweredStream : public grpc::ServerBidiReactor<Request, Response>,
                       public OpenStreams::Stream,
                       public std::enable_shared_from_this<AnsweredStream<Request, Response>> {
 public:
  static constexpr int kAtOnce = 256;

  AnsweredStream(const CallNeeds& needs, OpenStreams& open, std::string method, CallFacts facts,
                 Caller caller)
      : needs_(needs),
        open_(open),
        method_(std::move(method)),
        facts_(std::move(facts)),
        caller_(std::move(caller)) {}

  // Keeps itself alive and begins. Call once, on a shared_ptr.
  grpc::ServerBidiReactor<Request, Response>* Begin() {
    self_ = this->shared_from_this();
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

 protected:
  const CallNeeds& needs() const { return needs_; }
  const Caller& caller() const { return caller_; }
  // Of one message: `answer` is to be called once, on any thread.
  using Answer = std::function<void(Response)>;
  virtual void Take(std::shared_ptr<Request> request, Answer answer) = 0;

 private:
  // A message may come while others are still on their way: what a client may keep in our memory.
  static constexpr std::size_t kBytesAtOnce = 16 << 20;

  void OnReadDone(bool ok) override {
    if (!ok) {
      const std::lock_guard lock(mutex_);
      reading_ = false;
      return End(grpc::Status::OK);
    }
    auto request = std::make_shared<Request>(std::move(incoming_));
    incoming_.Clear();
    const std::size_t bytes = request->ByteSizeLong();
    {
      const std::lock_guard lock(mutex_);
      ++under_way_;
      bytes_ += bytes;
    }
    Take(std::move(request), [self = this->shared_from_this(), bytes](Response response) {
      self->Answered(bytes, std::move(response));
    });
    const std::lock_guard lock(mutex_);
    reading_ = false;
    GoOn();
  }

  // On any thread, that of OnReadDone among them.
  void Answered(std::size_t bytes, Response response) {
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
      this->StartWrite(&outgoing_, options);
    }
    if (ending_) {
      // What was taken is answered first.
      if (writing_ || (under_way_ > 0 && !cancelled_)) return;
      finished_ = true;
      return this->Finish(end_);
    }
    // Answers that nobody reads count, too.
    const std::size_t unread = answers_.size() + static_cast<std::size_t>(under_way_);
    if (reading_ || unread >= kAtOnce || bytes_ >= kBytesAtOnce) return;
    reading_ = true;
    this->StartRead(&incoming_);
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
    LogCall(method_, caller_, end_, std::chrono::steady_clock::now() - begun_);
    self_.reset();
  }

  const CallNeeds needs_;
  OpenStreams& open_;
  const std::string method_;
  const CallFacts facts_;
  const Caller caller_;
  const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  std::shared_ptr<AnsweredStream> self_;
  Request incoming_;
  Response outgoing_;

  std::mutex mutex_;  // of all below
  std::deque<Response> answers_;
  int under_way_ = 0;
  std::size_t bytes_ = 0;
  bool reading_ = false;
  bool writing_ = false;
  bool cancelled_ = false;
  bool ending_ = false;
  bool finished_ = false;
  grpc::Status end_;
};

// One for a caller who is admitted, made by `make(facts, caller)`.
template <class Request, class Response, class Make>
grpc::ServerBidiReactor<Request, Response>* BeginAnsweredStream(
    const CallNeeds& needs, grpc::CallbackServerContext& context, std::string_view method,
    Make make) {
  CallFacts facts = FactsOfCall(needs.gate, context, method, nullptr);
  const Result<Caller> caller = needs.gate.Admit(facts);
  if (!caller)
    return new EndedStream<grpc::ServerBidiReactor<Request, Response>>(
        ToGrpcStatus(caller.error()));
  return make(std::move(facts), *caller)->Begin();
}

}  // namespace rmlcell::server
