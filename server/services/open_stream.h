#pragma once

#include <memory>

#include "server/services/call.h"
#include "server/services/pull_stream.h"

namespace rmlcell::server {

// A stream of any kind that ends before it began.
template <class Reactor>
class EndedStream final : public Reactor {
 public:
  explicit EndedStream(const grpc::Status& status) { this->Finish(status); }
  void OnDone() override { delete this; }
};

// The stream that `make(caller)` gives, a shared_ptr to a PullStream, once the caller is admitted.
template <class Response, class Make>
grpc::ServerWriteReactor<Response>* OpenStream(const CallNeeds& needs,
                                               const grpc::CallbackServerContext& context,
                                               const google::protobuf::Message& request,
                                               std::string_view method, Make make) {
  const Result<Caller> caller = Admit(needs.gate, context, method, &request);
  if (!caller)
    return new EndedStream<grpc::ServerWriteReactor<Response>>(ToGrpcStatus(caller.error()));
  return make(*caller)->Begin();
}

}  // namespace rmlcell::server
