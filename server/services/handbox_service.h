#pragma once

#include "rmlcell/v1/handbox.grpc.pb.h"
#include "server/services/call.h"

namespace rmlcell::server {

// Teach sessions come in a later version; the methods pass the gate and say so.
class HandboxService final : public v1::HandboxService::CallbackService {
 public:
  explicit HandboxService(CallNeeds needs) : needs_(needs) {}

  grpc::ServerUnaryReactor* CreateHandboxSession(grpc::CallbackServerContext* context,
                                                 const v1::CreateHandboxSessionRequest* request,
                                                 v1::HandboxSession* response) override;
  grpc::ServerUnaryReactor* PressKey(grpc::CallbackServerContext* context,
                                     const v1::PressKeyRequest* request,
                                     v1::HandboxSession* response) override;
  grpc::ServerWriteReactor<v1::WatchHandboxSessionResponse>* WatchHandboxSession(
      grpc::CallbackServerContext* context, const v1::WatchHandboxSessionRequest* request) override;
  grpc::ServerUnaryReactor* DeleteHandboxSession(grpc::CallbackServerContext* context,
                                                 const v1::DeleteHandboxSessionRequest* request,
                                                 google::protobuf::Empty* response) override;

 private:
  CallNeeds needs_;
};

}  // namespace rmlcell::server
