#include "server/services/worker_service.h"

#include <deque>
#include <mutex>

#include "server/jobs/dispatcher.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kBlobBytes = 128 << 10;

class Line;

// What the dispatcher holds of a line; it may outlive the stream.
class LineHandle final : public WorkerLine {
 public:
  explicit LineHandle(Line* line) : line_(line) {}
  void Send(v1::WorkResponse message) override;
  void SendProgram(int slot, std::shared_ptr<const std::string> bytes) override;
  void Close(const Error& why) override;
  void Detach() {
    const std::lock_guard lock(mutex_);
    line_ = nullptr;
  }

 private:
  std::mutex mutex_;
  Line* line_;
};

// One stream. What is to be sent waits in a queue: messages, and programs that are cut into
// messages when the line takes them. The queue is bounded by what one assignment needs.
class Line final : public grpc::ServerBidiReactor<v1::WorkRequest, v1::WorkResponse> {
 public:
  explicit Line(Dispatcher& dispatcher)
      : dispatcher_(dispatcher), handle_(std::make_shared<LineHandle>(this)) {
    StartRead(&incoming_);
  }

  struct Item {
    v1::WorkResponse message;
    int slot = 0;
    std::shared_ptr<const std::string> bytes;
    std::size_t sent = 0;
  };

  void Queue(Item item) {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(item));
    WriteNext();
  }

  void End(const grpc::Status& status) {
    const std::lock_guard lock(mutex_);
    EndLocked(status);
  }

 private:
  void EndLocked(const grpc::Status& status) {
    if (finished_) return;
    end_ = status;
    ending_ = true;
    WriteNext();
  }

  // Precondition: mutex_ is held.
  void WriteNext() {
    if (writing_ || finished_) return;
    if (ending_) {
      finished_ = true;
      return Finish(end_);
    }
    if (queue_.empty()) return;
    Item& item = queue_.front();
    if (item.bytes == nullptr) {
      outgoing_ = std::move(item.message);
      queue_.pop_front();
    } else {
      outgoing_.Clear();
      outgoing_.mutable_blob()->set_slot(item.slot);
      outgoing_.mutable_blob()->set_chunk(item.bytes->substr(item.sent, kBlobBytes));
      item.sent += kBlobBytes;
      if (item.sent >= item.bytes->size()) queue_.pop_front();
    }
    writing_ = true;
    StartWrite(&outgoing_);
  }

  void OnReadDone(bool ok) override {
    if (!ok) return End(grpc::Status::OK);
    if (worker_ == 0) {
      if (!incoming_.has_hello()) {
        return End(ToGrpcStatus(
            Error{ErrorCode::kCellInvalidArgument, "the first message must be hello", {}}));
      }
      const Result<Dispatcher::WorkerId> joined = dispatcher_.Join(handle_, incoming_.hello());
      if (!joined) return End(ToGrpcStatus(joined.error()));
      worker_ = *joined;
    } else {
      dispatcher_.Receive(worker_, std::move(incoming_));
    }
    incoming_.Clear();
    StartRead(&incoming_);
  }

  void OnWriteDone(bool ok) override {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    if (!ok) return EndLocked(grpc::Status::CANCELLED);
    WriteNext();
  }

  void OnCancel() override { End(grpc::Status::CANCELLED); }

  void OnDone() override {
    handle_->Detach();
    if (worker_ != 0) dispatcher_.Leave(worker_);
    delete this;
  }

  Dispatcher& dispatcher_;
  std::shared_ptr<LineHandle> handle_;
  Dispatcher::WorkerId worker_ = 0;
  v1::WorkRequest incoming_;
  std::mutex mutex_;
  std::deque<Item> queue_;
  v1::WorkResponse outgoing_;
  bool writing_ = false;
  bool ending_ = false;
  bool finished_ = false;
  grpc::Status end_;
};

void LineHandle::Send(v1::WorkResponse message) {
  const std::lock_guard lock(mutex_);
  if (line_ != nullptr) line_->Queue({.message = std::move(message), .bytes = nullptr});
}

void LineHandle::SendProgram(int slot, std::shared_ptr<const std::string> bytes) {
  const std::lock_guard lock(mutex_);
  if (line_ != nullptr) line_->Queue({.message = {}, .slot = slot, .bytes = std::move(bytes)});
}

void LineHandle::Close(const Error& why) {
  const std::lock_guard lock(mutex_);
  if (line_ != nullptr) line_->End(ToGrpcStatus(why));
}

class RefusedLine final : public grpc::ServerBidiReactor<v1::WorkRequest, v1::WorkResponse> {
 public:
  explicit RefusedLine(const grpc::Status& status) { Finish(status); }
  void OnDone() override { delete this; }
};

}  // namespace

grpc::ServerBidiReactor<v1::WorkRequest, v1::WorkResponse>* WorkerService::Work(
    grpc::CallbackServerContext* context) {
  const Result<Caller> caller = Admit(needs_.gate, *context, "WorkerService/Work");
  if (!caller) return new RefusedLine(ToGrpcStatus(caller.error()));
  return new Line(dispatcher_);
}

}  // namespace rmlcell::server
