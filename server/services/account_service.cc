#include "server/services/account_service.h"

namespace rmlcell::server {

grpc::ServerUnaryReactor* AccountService::GetCaller(grpc::CallbackServerContext* context,
                                                    const v1::GetCallerRequest* request,
                                                    v1::GetCallerResponse* response) {
  return Answer(needs_, context, *request, "AccountService/GetCaller",
                [response](const Caller& caller) {
                  response->set_name(caller.identity);
                  v1::Grant& grant = *response->add_grants();
                  for (const v1::Permission permission :
                       {v1::PERMISSION_VIEW, v1::PERMISSION_STOP, v1::PERMISSION_PROGRAM,
                        v1::PERMISSION_OPERATE, v1::PERMISSION_ADMINISTER}) {
                    if (caller.permissions.Has(permission)) grant.add_permissions(permission);
                  }
                  return grpc::Status::OK;
                });
}

}  // namespace rmlcell::server
