#include "server/services/handbox_service.h"

#include "server/services/job_streams.h"

namespace rmlcell::server {

grpc::ServerUnaryReactor* HandboxService::CreateHandboxSession(
    grpc::CallbackServerContext* context, const v1::CreateHandboxSessionRequest*,
    v1::HandboxSession*) {
  return NotYet(needs_, context, "HandboxService/CreateHandboxSession");
}

grpc::ServerUnaryReactor* HandboxService::PressKey(grpc::CallbackServerContext* context,
                                                   const v1::PressKeyRequest*,
                                                   v1::HandboxSession*) {
  return NotYet(needs_, context, "HandboxService/PressKey");
}

grpc::ServerWriteReactor<v1::WatchHandboxSessionResponse>* HandboxService::WatchHandboxSession(
    grpc::CallbackServerContext* context, const v1::WatchHandboxSessionRequest*) {
  const auto caller = Admit(needs_.gate, *context, "HandboxService/WatchHandboxSession");
  const Error error =
      caller ? Error{ErrorCode::kCellUnimplemented, "HandboxService/WatchHandboxSession", {}}
             : caller.error();
  return new RefusedStream<v1::WatchHandboxSessionResponse>(ToGrpcStatus(error));
}

grpc::ServerUnaryReactor* HandboxService::DeleteHandboxSession(
    grpc::CallbackServerContext* context, const v1::DeleteHandboxSessionRequest*,
    google::protobuf::Empty*) {
  return NotYet(needs_, context, "HandboxService/DeleteHandboxSession");
}

}  // namespace rmlcell::server
