#pragma once

#include "rmlcell/v1/account.grpc.pb.h"
#include "server/services/later.h"

namespace rmlcell::server {

class AccountService final : public v1::AccountService::CallbackService {
 public:
  explicit AccountService(CallNeeds needs) : needs_(needs) {}

  grpc::ServerUnaryReactor* GetCaller(grpc::CallbackServerContext* context,
                                      const v1::GetCallerRequest* request,
                                      v1::GetCallerResponse* response) override;

  RMLCELL_LATER("AccountService", LogIn, v1::LogInResponse)
  RMLCELL_LATER("AccountService", LogOut, google::protobuf::Empty)
  RMLCELL_LATER("AccountService", ListSessions, v1::ListSessionsResponse)
  RMLCELL_LATER("AccountService", DeleteSession, google::protobuf::Empty)
  RMLCELL_LATER("AccountService", CreateUser, v1::User)
  RMLCELL_LATER("AccountService", ListUsers, v1::ListUsersResponse)
  RMLCELL_LATER("AccountService", UpdateUser, v1::User)
  RMLCELL_LATER("AccountService", DeleteUser, google::protobuf::Empty)
  RMLCELL_LATER("AccountService", CreateToken, v1::CreateTokenResponse)
  RMLCELL_LATER("AccountService", ListTokens, v1::ListTokensResponse)
  RMLCELL_LATER("AccountService", DeleteToken, google::protobuf::Empty)
  RMLCELL_LATER("AccountService", ListAuditEntries, v1::ListAuditEntriesResponse)

 private:
  CallNeeds needs_;
};

}  // namespace rmlcell::server
