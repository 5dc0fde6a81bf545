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
  CallFacts facts = FactsOfCall(needs.gate, context, method, &request);
  const Result<Caller> caller = needs.gate.Admit(facts);
  if (!caller)
    return new EndedStream<grpc::ServerWriteReactor<Response>>(ToGrpcStatus(caller.error()));
  const auto stream = make(*caller);
  stream->SetAdmission([&gate = needs.gate, facts = std::move(facts)]() -> Status {
    const Result<Caller> still = gate.Admit(facts);
    return still ? Status() : Status(still.error());
  });
  return stream->Begin();
}

}  // namespace rmlcell::server
