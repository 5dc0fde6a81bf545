#pragma once

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "clients/cli/remote.h"
#include "tests/clients/cli/cli_folder.h"

// Services in the process of the test, so that it sees what the command asks for and decides what
// is answered.
namespace rmlcell::cli {

// A server on a socket in the folder, as long as it lives. The services must outlive it.
class FakeServer {
 public:
  FakeServer(const CliFolder& folder, const std::vector<grpc::Service*>& services)
      : address_("unix:" + folder.File("s")) {
    grpc::ServerBuilder builder;
    builder.SetMaxReceiveMessageSize(-1);
    // A poller of gRPC that misses its call looks by itself after ten seconds else.
    builder.SetSyncServerOption(grpc::ServerBuilder::SyncServerOption::CQ_TIMEOUT_MSEC, 100);
    builder.AddListeningPort(address_, grpc::InsecureServerCredentials());
    for (grpc::Service* service : services) builder.RegisterService(service);
    server_ = builder.BuildAndStart();
  }
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;
  ~FakeServer() { server_->Shutdown(); }

  // Only a failing test has the patience.
  Remote remote(bool json = false) const {
    return {.server = address_, .json = json, .short_patience = std::chrono::minutes(1)};
  }

 private:
  std::string address_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace rmlcell::cli
