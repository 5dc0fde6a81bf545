#pragma once

#include <grpcpp/alarm.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>

#include "rmlcell/v1/common.pb.h"
#include "server/base/executor.h"
#include "server/services/rpc_status.h"

namespace rmlcell::server {

// Of a file that is sent in pieces, in each message.
inline constexpr std::size_t kChunkBytes = 256 << 10;

// When a client comes back after a server has stopped.
v1::Reconnect ServerStopped();

// Streams that are open, so that a stop can end them with a last word.
class OpenStreams {
 public:
  class Stream {
   public:
    virtual ~Stream() = default;
    virtual void ServerStops() = 0;
    virtual void RightsChanged() = 0;
  };
  void Add(Stream* stream);
  void Remove(Stream* stream);
  // Tells every open stream, and those that are opened later.
  void StopAll();
  // Rights have changed: streams whose callers may not have them any more end.
  void AskAgain();
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

  // How the caller is asked for again when rights change. Before Begin().
  void SetAdmission(std::function<Status()> admission) { admission_ = std::move(admission); }

  // Keeps itself alive and begins. Call once, on a shared_ptr.
  grpc::ServerWriteReactor<Response>* Begin() {
    self_ = this->shared_from_this();
    open_.Add(this);
    RightsChanged();  // perhaps between its admission and this moment
    return this;
  }

  // There may be something to send. Any thread; never blocks.
  void Wake() {
    bool at_once = false;
    {
      const std::lock_guard lock(mutex_);
      again_ = true;
      if (pumping_ || writing_ || finished_) return;
      pumping_ = true;
      at_once = !cancelled_ && !stopping_ && !asked_again_;
      if (at_once) again_ = false;
    }
    if (!at_once || !GoOn()) Ask();
  }

  void ServerStops() override {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    Wake();
  }
  void RightsChanged() override {
    {
      const std::lock_guard lock(mutex_);
      asked_again_ = true;
    }
    Wake();
  }

 protected:
  enum class Next { kMessage, kNothing, kEnd };

  // Makes the next message, or says that there is none now, or how the stream ends. On the
  // executor, never twice at once; may block.
  virtual Next Make(Response& message, grpc::Status& status) = 0;

  // The same on the thread that wakes, or on that of gRPC when a message has gone out: what is in
  // memory goes on without a change of thread. Must not block; nothing: Make() is to be asked.
  virtual std::optional<Next> MakeAtOnce(Response&) { return std::nullopt; }

  // Make() is called at this moment, or before.
  void WakeAt(std::chrono::steady_clock::time_point when) {
    const std::lock_guard lock(mutex_);
    if (finished_ || (alarm_ != nullptr && alarm_due_ <= when)) return;
    alarm_due_ = when;
    // A new one each time: the call of one that has just gone off may still be under way.
    alarm_ = std::make_unique<grpc::Alarm>();
    alarm_->Set(std::chrono::system_clock::now() + (when - std::chrono::steady_clock::now()),
                [self = this->shared_from_this(), when](bool on_time) {
                  if (on_time) self->AlarmRang(when);
                });
  }

  // A last message that tells the client to come back; false: there is none of that kind.
  virtual bool MakeGoodbye(Response&) { return false; }

  // The call is over; no Make is under way or comes.
  virtual void Closed() {}

 private:
  void Pump() {
    for (;;) {
      message_.Clear();
      grpc::Status status;
      Next next = Next::kEnd;
      EndWhereThrown(
          "a stream", [&] { next = MakeNext(status); },
          [&](const grpc::Status& thrown) { status = thrown; });
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

  // What comes next, which is not always what Make() makes.
  Next MakeNext(grpc::Status& status) {
    bool stopping = false;
    bool cancelled = false;
    bool ask = false;
    {
      const std::lock_guard lock(mutex_);
      ask = std::exchange(asked_again_, false);
      again_ = false;
      stopping = stopping_;
      cancelled = cancelled_;
    }
    const Status admitted = ask && admission_ ? admission_() : Status();
    if (cancelled) {
      status = grpc::Status::CANCELLED;
    } else if (!admitted) {
      status = ToGrpcStatus(admitted.error());
    } else if (!stopping) {
      return Make(message_, status);
    } else if (!std::exchange(goodbye_said_, true) && MakeGoodbye(message_)) {
      return Next::kMessage;
    } else {
      status = ToGrpcStatus(Error{ErrorCode::kCellUnavailable, "the server stops", {}});
    }
    return Next::kEnd;
  }

  void OnWriteDone(bool ok) override {
    bool go_on = false;
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      if (!ok) cancelled_ = true;
      pumping_ = true;
      go_on = !cancelled_ && !stopping_ && !asked_again_;
      again_ = false;
    }
    if (!go_on || !GoOn()) Ask();
  }

  // With what is there at once. False: Make() is to be asked. Precondition: pumping_, which stays
  // so then.
  bool GoOn() {
    message_.Clear();
    const std::optional<Next> next = MakeAtOnce(message_);
    {
      const std::lock_guard lock(mutex_);
      if (next != Next::kMessage && (next != Next::kNothing || again_)) return false;
      pumping_ = false;
      writing_ = next == Next::kMessage;
    }
    if (next == Next::kMessage) this->StartWrite(&message_);
    return true;
  }

  void Ask() {
    executor_.Post([self = this->shared_from_this()] { self->Pump(); });
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
    {
      const std::lock_guard lock(mutex_);
      alarm_.reset();
    }
    self_.reset();
  }

  void AlarmRang(std::chrono::steady_clock::time_point due) {
    {
      const std::lock_guard lock(mutex_);
      if (alarm_due_ == due) alarm_.reset();
    }
    Wake();
  }

  Executor& executor_;
  OpenStreams& open_;
  std::function<Status()> admission_;
  std::shared_ptr<PullStream> self_;
  Response message_;
  bool goodbye_said_ = false;
  std::mutex mutex_;
  bool pumping_ = false;
  bool writing_ = false;
  bool again_ = false;
  bool finished_ = false;
  bool cancelled_ = false;
  bool asked_again_ = false;
  bool stopping_ = false;
  std::unique_ptr<grpc::Alarm> alarm_;                 // guarded by mutex_; null: none is set
  std::chrono::steady_clock::time_point alarm_due_{};  // guarded by mutex_
};

}  // namespace rmlcell::server
