#pragma once

#include <grpcpp/grpcpp.h>

#include <memory>
#include <mutex>
#include <set>

#include "server/base/executor.h"
#include "server/services/rpc_status.h"

namespace rmlcell::server {

// Streams that are open, so that a stop can end them with a last word.
class OpenStreams {
 public:
  class Stream {
   public:
    virtual ~Stream() = default;
    virtual void ServerStops() = 0;
  };
  void Add(Stream* stream);
  void Remove(Stream* stream);
  // Tells every open stream, and those that are opened later.
  void StopAll();
  // How many are open.
  std::size_t count() const;

 private:
  mutable std::mutex mutex_;
  std::set<Stream*> streams_;
  bool stopping_ = false;
};

// A server stream whose next message is made when the last one is written: a client that does not
// read costs its cursor and one message, and slows nobody. Owns itself until the call is done.
template <class Response>
class PullStream : public grpc::ServerWriteReactor<Response>,
                   public OpenStreams::Stream,
                   public std::enable_shared_from_this<PullStream<Response>> {
 public:
  PullStream(Executor& executor, OpenStreams& open) : executor_(executor), open_(open) {}

  // Keeps itself alive and begins. Call once, on a shared_ptr.
  grpc::ServerWriteReactor<Response>* Begin() {
    self_ = this->shared_from_this();
    open_.Add(this);
    Wake();
    return this;
  }

  // There may be something to send. Any thread; never blocks.
  void Wake() {
    {
      const std::lock_guard lock(mutex_);
      again_ = true;
      if (pumping_ || writing_ || finished_) return;
      pumping_ = true;
    }
    executor_.Post([self = this->shared_from_this()] { self->Pump(); });
  }

  void ServerStops() override {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    Wake();
  }

 protected:
  enum class Next { kMessage, kNothing, kEnd };

  // Makes the next message, or says that there is none now, or how the stream ends. On the
  // executor, never twice at once; may block.
  virtual Next Make(Response& message, grpc::Status& status) = 0;

  // A last message that tells the client to come back; false: there is none of that kind.
  virtual bool MakeGoodbye(Response&) { return false; }

  // The call is over; no Make is under way or comes.
  virtual void Closed() {}

 private:
  void Pump() {
    for (;;) {
      bool stopping = false;
      bool cancelled = false;
      {
        const std::lock_guard lock(mutex_);
        again_ = false;
        stopping = stopping_;
        cancelled = cancelled_;
      }
      message_.Clear();
      grpc::Status status;
      Next next = Next::kEnd;
      if (cancelled) {
        status = grpc::Status::CANCELLED;
      } else if (stopping && goodbye_said_) {
        status = ToGrpcStatus(Error{ErrorCode::kCellUnavailable, "the server stops", {}});
      } else if (stopping) {
        goodbye_said_ = true;
        if (!MakeGoodbye(message_)) continue;
        next = Next::kMessage;
      } else {
        next = Make(message_, status);
      }
      {
        const std::lock_guard lock(mutex_);
        if (next == Next::kNothing && again_) continue;
        pumping_ = false;
        writing_ = next == Next::kMessage;
        finished_ = next == Next::kEnd;
      }
      if (next == Next::kMessage) this->StartWrite(&message_);
      if (next == Next::kEnd) this->Finish(status);
      return;
    }
  }

  void OnWriteDone(bool ok) override {
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      if (!ok) cancelled_ = true;
    }
    Wake();
  }

  // A write may be under way: only noted here.
  void OnCancel() override {
    {
      const std::lock_guard lock(mutex_);
      cancelled_ = true;
    }
    Wake();
  }

  void OnDone() override {
    open_.Remove(this);
    Closed();
    self_.reset();
  }

  Executor& executor_;
  OpenStreams& open_;
  std::shared_ptr<PullStream> self_;
  Response message_;
  bool goodbye_said_ = false;
  std::mutex mutex_;
  bool pumping_ = false;
  bool writing_ = false;
  bool again_ = false;
  bool finished_ = false;
  bool cancelled_ = false;
  bool stopping_ = false;
};

}  // namespace rmlcell::server
