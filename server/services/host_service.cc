#include "server/services/host_service.h"

#include <deque>
#include <memory>
#include <mutex>
#include <utility>

#include "server/machines/hosts.h"
#include "server/services/later.h"

namespace rmlcell::server {
namespace {

class HostStream;

// What the hosts hold of a line; it may outlive the stream.
class StreamLink final : public HostLink {
 public:
  explicit StreamLink(HostStream* stream) : stream_(stream) {}
  void Send(v1::HostResponse message) override;
  void Close(const Error& why) override;
  bool ReadOn();  // false: the stream is gone
  void Detach() {
    const std::lock_guard lock(mutex_);
    stream_ = nullptr;
  }

 private:
  std::mutex mutex_;
  HostStream* stream_;
};

class HostStream final : public grpc::ServerBidiReactor<v1::HostRequest, v1::HostResponse> {
 public:
  HostStream(Hosts& hosts, Executor& executor)
      : hosts_(hosts), executor_(executor), link_(std::make_shared<StreamLink>(this)) {
    StartRead(&incoming_);
  }

  void Queue(v1::HostResponse message) {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(message));
    WriteNext();
  }

  void ReadOn() {
    const std::lock_guard lock(mutex_);
    if (finished_) return;  // a call that is over reads nothing
    joined_ = true;
    incoming_.Clear();
    StartRead(&incoming_);
  }

  void End(const grpc::Status& status) {
    const std::lock_guard lock(mutex_);
    if (finished_) return;
    end_ = status;
    ending_ = true;
    WriteNext();
  }

 private:
  // Precondition: mutex_ is held.
  void WriteNext() {
    if (writing_ || finished_) return;
    if (ending_) {
      finished_ = true;
      return Finish(end_);
    }
    if (queue_.empty()) return;
    outgoing_ = std::move(queue_.front());
    queue_.pop_front();
    writing_ = true;
    StartWrite(&outgoing_);
  }

  void OnReadDone(bool ok) override {
    if (!ok) return End(grpc::Status::OK);
    if (joined_) {
      hosts_.Receive(*link_, std::move(incoming_));
      incoming_.Clear();
      return StartRead(&incoming_);
    }
    if (!incoming_.has_hello()) {
      return End(ToGrpcStatus(
          Error{ErrorCode::kCellInvalidArgument, "the first message must be hello", {}}));
    }
    // The stream may be gone when it has joined.
    executor_.Post([&hosts = hosts_, link = link_, hello = incoming_.hello()] {
      const Status joined = hosts.Join(link, hello);
      if (!joined) {
        link->Close(joined.error());
      } else if (!link->ReadOn()) {
        hosts.Leave(*link);
      }
    });
  }

  void OnWriteDone(bool ok) override {
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      if (ok) return WriteNext();
    }
    End(grpc::Status::CANCELLED);
  }

  void OnCancel() override { End(grpc::Status::CANCELLED); }

  void OnDone() override {
    link_->Detach();
    hosts_.Leave(*link_);
    delete this;
  }

  Hosts& hosts_;
  Executor& executor_;
  std::shared_ptr<StreamLink> link_;
  v1::HostRequest incoming_;
  bool joined_ = false;
  std::mutex mutex_;
  std::deque<v1::HostResponse> queue_;
  v1::HostResponse outgoing_;
  bool writing_ = false;
  bool ending_ = false;
  bool finished_ = false;
  grpc::Status end_;
};

void StreamLink::Send(v1::HostResponse message) {
  const std::lock_guard lock(mutex_);
  if (stream_ != nullptr) stream_->Queue(std::move(message));
}

bool StreamLink::ReadOn() {
  const std::lock_guard lock(mutex_);
  if (stream_ != nullptr) stream_->ReadOn();
  return stream_ != nullptr;
}

void StreamLink::Close(const Error& why) {
  const std::lock_guard lock(mutex_);
  if (stream_ != nullptr) stream_->End(ToGrpcStatus(why));
}

}  // namespace

grpc::ServerBidiReactor<v1::HostRequest, v1::HostResponse>* HostService::Host(
    grpc::CallbackServerContext* context) {
  if (const auto caller = Admit(needs_.gate, *context, "HostService/Host"); !caller) {
    return new EndedStream<grpc::ServerBidiReactor<v1::HostRequest, v1::HostResponse>>(
        ToGrpcStatus(caller.error()));
  }
  return new HostStream(hosts_, needs_.executor);
}

}  // namespace rmlcell::server
