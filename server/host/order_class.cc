#include "server/host/order_class.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace rmlcell::server {

namespace {

// What lets go, slows down or halts acts first; what may move is written before.
template <class Request>
OrderClass ClassOfKey(const Request& key) {
  constexpr std::array<std::string_view, 5> kHalt = {"PAUSE", "STOP", "HOLD", "BUFFER_CLEAR",
                                                     "EMERGENCY_STOP"};
  constexpr std::array<std::string_view, 2> kSlow = {"COVER", "OVERRIDE_MINUS"};
  const bool halts = std::ranges::find(kHalt, key.key()) != kHalt.end();
  const bool slows = std::ranges::find(kSlow, key.key()) != kSlow.end();
  if (slows || key.action() == v1::KEY_ACTION_RELEASE) return OrderClass::kLetsGo;
  return halts ? OrderClass::kActsFirst : OrderClass::kWrittenFirst;
}

// A gate begins a run; the door stops one.
OrderClass ClassOfInputs(const v1::SetInputsRequest& request) {
  if (std::ranges::any_of(request.inputs(), &v1::MachineInput::has_gate))
    return OrderClass::kWrittenFirst;
  return std::ranges::any_of(request.inputs(), &v1::MachineInput::door_open)
             ? OrderClass::kLetsGo
             : OrderClass::kWrittenBehind;
}

}  // namespace

OrderClass ClassOf(const v1::HostOrder& order) {
  switch (order.request_case()) {
    case v1::HostOrder::kInputs:
      return ClassOfInputs(order.inputs());
    case v1::HostOrder::kPanelKey:
      return ClassOfKey(order.panel_key());
    case v1::HostOrder::kKey:
      return ClassOfKey(order.key());
    case v1::HostOrder::kPanelHeartbeat:
    case v1::HostOrder::kHandboxHeartbeat:
    case v1::HostOrder::kDeleteSession:
      return OrderClass::kAsks;
    case v1::HostOrder::kStop:
    case v1::HostOrder::kHold:
    case v1::HostOrder::kEmergencyStop:
    case v1::HostOrder::kAbort:
    case v1::HostOrder::kDisarm:
      return OrderClass::kActsFirst;
    case v1::HostOrder::kStart:
    case v1::HostOrder::kStartAtStep:
    case v1::HostOrder::kRunJob:
    case v1::HostOrder::kContinueJob:
    case v1::HostOrder::kZero:
    case v1::HostOrder::kArm:
    case v1::HostOrder::kResume:
    case v1::HostOrder::kMode:
    case v1::HostOrder::kAcknowledgeAlarm:
    case v1::HostOrder::kConfirm:
    case v1::HostOrder::kAcquireControl:
      return OrderClass::kWrittenFirst;
    case v1::HostOrder::kReadVariables:
    case v1::HostOrder::kRunState:
    case v1::HostOrder::kRecording:
    case v1::HostOrder::kPreviewStart:
    case v1::HostOrder::kRenewControl:
    case v1::HostOrder::kUndoTeaching:
      return OrderClass::kAsks;
    default:
      return OrderClass::kWrittenBehind;
  }
}

bool Halts(const v1::HostResponse& message) {
  return message.has_order() && ClassOf(message.order()) == OrderClass::kActsFirst;
}

std::vector<v1::HostOrder> StopFirst(std::deque<v1::HostResponse>& messages) {
  std::vector<v1::HostOrder> taken;
  const auto last = std::find_if(messages.rbegin(), messages.rend(), Halts).base();
  const auto begins = [](const v1::HostResponse& message) {
    return message.has_order() && BeginsMotion(message.order());
  };
  for (auto message = messages.begin(); message != last; ++message) {
    if (begins(*message)) taken.push_back(message->order());
  }
  messages.erase(std::remove_if(messages.begin(), last, begins), last);
  std::stable_partition(messages.begin(), messages.end(), Halts);
  return taken;
}

}  // namespace rmlcell::server
