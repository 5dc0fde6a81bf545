#include <grpcpp/grpcpp.h>

#include <chrono>

#include "server/services/host_service.h"
#include "tests/server/services/listening.h"

namespace rmlcell::server {

struct Listening::Server {
  Server(Hosts& hosts, Executor& executor) : service({gate, executor, executor, 1 << 20}, hosts) {}

  Gate gate{"a secret of the web port"};
  HostService service;
  std::unique_ptr<grpc::Server> grpc;
};

Listening::Listening(const std::string& address, Hosts& hosts, Executor& executor)
    : server_(std::make_unique<Server>(hosts, executor)) {
  grpc::ServerBuilder builder;
  builder.AddListeningPort(address, grpc::InsecureServerCredentials());
  builder.RegisterService(&server_->service);
  server_->grpc = builder.BuildAndStart();
}

Listening::~Listening() = default;

void Listening::End() {
  server_->grpc->Shutdown(std::chrono::system_clock::now());
  server_->grpc->Wait();
}

}  // namespace rmlcell::server
