#include "server/base/credentials.h"

#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>

namespace rmlcell::server {

std::shared_ptr<grpc::ServerCredentials> CredentialsOfServer() {
  return grpc::InsecureServerCredentials();
}

std::shared_ptr<grpc::ChannelCredentials> CredentialsOfChannel() {
  return grpc::InsecureChannelCredentials();
}

}  // namespace rmlcell::server
