#pragma once

#include "rmlcell/v1/host.grpc.pb.h"
#include "server/services/later.h"

namespace rmlcell::server {

class HostService final : public v1::HostService::CallbackService {
 public:
  explicit HostService(CallNeeds needs) : needs_(needs) {}

  RMLCELL_LATER_BOTH("HostService", Host)

 private:
  CallNeeds needs_;
};

}  // namespace rmlcell::server
