#pragma once

#include "rmlcell/v1/handbox.grpc.pb.h"
#include "server/services/later.h"

namespace rmlcell::server {

class HandboxService final : public v1::HandboxService::CallbackService {
 public:
  explicit HandboxService(CallNeeds needs) : needs_(needs) {}

  RMLCELL_LATER("HandboxService", CreateHandboxSession, v1::HandboxSession)
  RMLCELL_LATER("HandboxService", PressKey, v1::PressKeyResponse)
  RMLCELL_LATER("HandboxService", HeartbeatHandbox, v1::HeartbeatResponse)
  RMLCELL_LATER_BOTH("HandboxService", HandboxStream)
  RMLCELL_LATER_READ("HandboxService", WatchHandbox)
  RMLCELL_LATER("HandboxService", DeleteHandboxSession, google::protobuf::Empty)
  RMLCELL_LATER("HandboxService", ListTeachEntries, v1::ListTeachEntriesResponse)
  RMLCELL_LATER("HandboxService", UndoTeachEntries, v1::UndoTeachEntriesResponse)

 private:
  CallNeeds needs_;
};

}  // namespace rmlcell::server
