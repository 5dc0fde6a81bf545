#include "server/services/later.h"

namespace rmlcell::server {

grpc::Status LaterStatus(const CallNeeds& needs, const grpc::ServerContextBase& context,
                         std::string_view method, const google::protobuf::Message* request) {
  const Result<Caller> caller = Admit(needs.gate, context, method, request);
  return ToGrpcStatus(caller ? Error{ErrorCode::kCellUnimplemented, std::string(method), {}}
                             : caller.error());
}

}  // namespace rmlcell::server
