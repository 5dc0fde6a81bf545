#pragma once

#include <string>
#include <string_view>

#include "proto/bridge/framing.h"
#include "server/services/pull_stream.h"

namespace rmlcell::server {

// Products that are a series of frames (proto/bridge/framing.h), some frames a message.
template <class Response>
class FramesStream : public PullStream<Response> {
 public:
  using typename PullStream<Response>::Next;
  using PullStream<Response>::PullStream;

 protected:
  // All frames, once.
  virtual Result<std::string> Read() = 0;

  // What goes before the first frame; false: nothing.
  virtual bool AddHeader(std::string_view /*frames*/, Response& /*message*/) { return false; }

  // Adds one frame; false: the message is full with it.
  virtual bool Add(std::string_view frame, Response& message) = 0;

 private:
  Next Make(Response& message, grpc::Status& status) override {
    if (!begun_) {
      begun_ = true;
      Result<std::string> bytes = Read();
      if (!bytes) {
        status = ToGrpcStatus(bytes.error());
        return Next::kEnd;
      }
      bytes_ = *std::move(bytes);
      rest_ = bytes_;
      if (AddHeader(bytes_, message)) return Next::kMessage;
    }
    bool any = false;
    while (const auto frame = bridge::TakeFrame(rest_)) {
      any = true;
      if (!Add(*frame, message)) break;
    }
    return any ? Next::kMessage : Next::kEnd;
  }

  bool begun_ = false;
  std::string bytes_;
  std::string_view rest_;
};

}  // namespace rmlcell::server
