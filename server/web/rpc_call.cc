#include "server/web/rpc_call.h"

#include <grpcpp/channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "server/web/base64.h"

namespace rmlcell::web {
namespace {

std::string BytesOf(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  static_cast<void>(buffer.Dump(&slices));  // of what cannot be read there are none
  std::string bytes;
  bytes.reserve(buffer.Length());
  for (const grpc::Slice& slice : slices) {
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return bytes;
}

// What a browser may see of a server's metadata.
HeaderList Visible(const std::multimap<grpc::string_ref, grpc::string_ref>& metadata) {
  HeaderList out;
  for (const auto& [key, value] : metadata) {
    const std::string name(key.data(), key.size());
    const std::string_view bytes(value.data(), value.size());
    if (name.starts_with("grpc-") || name.starts_with("rmlcell-") || name.starts_with(":"))
      continue;
    if (name == "content-type" || name == "user-agent" || name == "content-length" ||
        name == "date" || name == "connection" || name == "transfer-encoding" || name == "te") {
      continue;
    }
    out.emplace_back(name, name.ends_with("-bin") ? Base64(bytes, false) : std::string(bytes));
  }
  return out;
}

// Owns itself between StartCall and OnDone; RpcCall objects only point at it. The hold keeps gRPC
// from ending the call while nobody reads: StartRead comes from outside the reactor's own
// callbacks.
class Reactor : public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  Reactor(RpcCallSpec spec, RpcCallEvents events) : events_(std::move(events)) {
    for (const auto& [name, value] : spec.metadata) context_->AddMetadata(name, value);
    if (spec.timeout) context_->set_deadline(std::chrono::system_clock::now() + *spec.timeout);
    grpc::Slice slice(spec.message);
    request_ = grpc::ByteBuffer(&slice, 1);
  }

  void Begin(grpc::GenericStub& stub, const std::string& method, std::shared_ptr<Reactor> self) {
    self_ = std::move(self);
    stub.PrepareBidiStreamingCall(context_.get(), method, {}, this);
    AddHold();
    StartWriteLast(&request_, {});
    StartCall();
  }

  void ReadNext() {
    {
      const std::lock_guard lock(mutex_);
      if (released_) return;  // the end is on its way
      RMLCELL_CHECK(!reading_);
      reading_ = true;
    }
    StartRead(&answer_);
  }

  void Cancel() {
    bool release = false;
    std::shared_ptr<grpc::ClientContext> context;
    {
      const std::lock_guard lock(mutex_);
      context = context_;
      cancelled_ = true;
      // With a read under way its end releases the hold.
      if (!released_ && !reading_) release = released_ = true;
    }
    if (context) context->TryCancel();
    context.reset();  // before the hold is gone, and the end told
    if (release) RemoveHold();
  }

  void OnReadDone(bool ok) override {
    bool release = false;
    {
      const std::lock_guard lock(mutex_);
      reading_ = false;
      // After a cancellation nobody asks for more, also when this read was just in time.
      release = released_ = !ok || cancelled_;
    }
    if (release) {
      RemoveHold();
    } else {
      events_.on_message(BytesOf(answer_));
    }
  }

  void OnDone(const grpc::Status& status) override {
    RpcCallEnd end{.status = {.code = static_cast<int>(status.error_code()),
                              .message = status.error_message(),
                              .details = status.error_details()},
                   .headers = Visible(context_->GetServerInitialMetadata()),
                   .trailers = Visible(context_->GetServerTrailingMetadata())};
    LeaveChannel();
    events_.on_end(std::move(end));
    events_ = {};  // what they hold may hold this call
    self_.reset();
  }

 private:
  // Whoever hears of the end may let the channel go; its last owner must be no thread of gRPC,
  // which would take away from itself the queue that it works on.
  void LeaveChannel() {
    std::shared_ptr<grpc::ClientContext> context;
    const std::lock_guard lock(mutex_);
    context.swap(context_);
  }

  RpcCallEvents events_;
  std::shared_ptr<grpc::ClientContext> context_ = std::make_shared<grpc::ClientContext>();
  grpc::ByteBuffer request_;
  grpc::ByteBuffer answer_;
  std::shared_ptr<Reactor> self_;
  std::mutex mutex_;
  bool reading_ = false;    // guarded by mutex_
  bool cancelled_ = false;  // guarded by mutex_
  bool released_ = false;   // guarded by mutex_: the hold is gone, or is just being removed
};

class Handle : public RpcCall {
 public:
  explicit Handle(std::shared_ptr<Reactor> reactor) : reactor_(std::move(reactor)) {}
  void ReadNext() override { reactor_->ReadNext(); }
  void Cancel() override { reactor_->Cancel(); }

 private:
  std::shared_ptr<Reactor> reactor_;
};

}  // namespace

std::shared_ptr<RpcCall> RpcCall::Start(const std::shared_ptr<grpc::Channel>& channel,
                                        RpcCallSpec spec, RpcCallEvents events) {
  grpc::GenericStub stub(channel);
  const std::string method = spec.method;
  auto reactor = std::make_shared<Reactor>(std::move(spec), std::move(events));
  auto handle = std::make_shared<Handle>(reactor);
  reactor->Begin(stub, method, reactor);
  return handle;
}

bool IsMetadata(std::string_view name, std::string_view value) {
  const bool name_good = !name.empty() && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
  });
  if (!name_good || name.starts_with("grpc-")) return false;
  if (name.ends_with("-bin")) return true;  // any bytes
  const bool visible = std::ranges::all_of(value, [](char c) { return c >= 0x20 && c < 0x7F; });
  return visible && (value.empty() || (value.front() != ' ' && value.back() != ' '));
}

}  // namespace rmlcell::web
