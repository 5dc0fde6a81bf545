#pragma once

#include <memory>

namespace grpc {
class ChannelCredentials;
class ServerCredentials;
}  // namespace grpc

namespace rmlcell::server {

// How the server and its callers prove who they are: in one place, for all that listens and all
// that connects. Nothing is encrypted yet: addresses are loopback and unix sockets only
// (`listen.grpc`), and the private socket lies in a folder of the server's own user.
std::shared_ptr<grpc::ServerCredentials> CredentialsOfServer();
std::shared_ptr<grpc::ChannelCredentials> CredentialsOfChannel();

}  // namespace rmlcell::server
