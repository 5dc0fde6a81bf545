#pragma once

#include <functional>
#include <memory>

#include "server/auth/caller.h"

namespace grpc {
class ServerBuilder;
}

namespace rmlcell::server {

// Services that come with gRPC, health and reflection, answer by themselves and not through our
// wrapper: their calls pass the gate here. gRPC lets nobody choose the status of such a call: one
// that is refused ends as CANCELLED.
void AdmitForeignCalls(grpc::ServerBuilder& builder,
                       std::function<Result<Caller>(const CallFacts&)> admit);

}  // namespace rmlcell::server
