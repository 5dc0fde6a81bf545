#pragma once

#include "rmlcell/v1/worker.grpc.pb.h"
#include "server/services/call.h"

namespace rmlcell::server {

class Dispatcher;

// The line to engine workers: one stream each. Who joins is checked by the token that the
// dispatcher knows.
class WorkerService final : public v1::WorkerService::CallbackService {
 public:
  WorkerService(CallNeeds needs, Dispatcher& dispatcher) : needs_(needs), dispatcher_(dispatcher) {}

  grpc::ServerBidiReactor<v1::WorkRequest, v1::WorkResponse>* Work(
      grpc::CallbackServerContext* context) override;

 private:
  CallNeeds needs_;
  Dispatcher& dispatcher_;
};

}  // namespace rmlcell::server
