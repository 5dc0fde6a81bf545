#pragma once

#include "rmlcell/v1/host.grpc.pb.h"
#include "server/services/call.h"

namespace rmlcell::server {

class Hosts;

// Lines of hosts.
class HostService final : public v1::HostService::CallbackService {
 public:
  HostService(CallNeeds needs, Hosts& hosts) : needs_(needs), hosts_(hosts) {}

  grpc::ServerBidiReactor<v1::HostRequest, v1::HostResponse>* Host(
      grpc::CallbackServerContext* context) override;

 private:
  CallNeeds needs_;
  Hosts& hosts_;
};

}  // namespace rmlcell::server
