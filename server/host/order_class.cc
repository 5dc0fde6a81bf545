#include "server/host/order_class.h"

namespace rmlcell::server {

OrderClass ClassOf(const v1::HostOrder& order) {
  switch (order.request_case()) {
    case v1::HostOrder::kStop:
    case v1::HostOrder::kHold:
    case v1::HostOrder::kEmergencyStop:
    case v1::HostOrder::kAbort:
      return OrderClass::kActsFirst;
    case v1::HostOrder::kStart:
    case v1::HostOrder::kRunJob:
    case v1::HostOrder::kZero:
    case v1::HostOrder::kResume:
    case v1::HostOrder::kMode:
    case v1::HostOrder::kAcknowledgeAlarm:
    case v1::HostOrder::kConfirm:
    case v1::HostOrder::kAcquireControl:
      return OrderClass::kWrittenFirst;
    case v1::HostOrder::kReadVariables:
    case v1::HostOrder::kRunState:
    case v1::HostOrder::kRecording:
    case v1::HostOrder::kRenewControl:
      return OrderClass::kAsks;
    default:
      return OrderClass::kWrittenBehind;
  }
}

}  // namespace rmlcell::server
