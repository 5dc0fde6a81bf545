#pragma once

#include <memory>
#include <string>

#include "server/base/executor.h"
#include "server/machines/hosts.h"

namespace rmlcell::server {

// A server that hosts find at this address, until End. Over gRPC (listening_grpc.cc), or in the
// same process without it (lines_in_process.cc), where HostLine is another one: gRPC is not built
// for the race detector.
class Listening {
 public:
  Listening(const std::string& address, Hosts& hosts, Executor& executor);
  ~Listening();
  void End();

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace rmlcell::server
