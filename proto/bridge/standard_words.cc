#include "proto/bridge/standard_words.h"

namespace rmlcell::bridge {
namespace {

// Of a run that stands: by its program, by a key, or because somebody was lost.
const char* ExecutionOfHeld(v1::HoldReason reason) {
  switch (reason) {
    case v1::HOLD_REASON_CONTROL:
    case v1::HOLD_REASON_MACHINE_LEASE:
    case v1::HOLD_REASON_SERVER_LOST:
    case v1::HOLD_REASON_LATE:
      return "INTERRUPTED";
    case v1::HOLD_REASON_PROGRAM:
    case v1::HOLD_REASON_BREAKPOINT:
    case v1::HOLD_REASON_SINGLE:
    case v1::HOLD_REASON_ENTRY:
      return "PROGRAM_STOPPED";
    default:
      return "FEED_HOLD";
  }
}

const char* ExecutionOf(const v1::MachineStatus& status) {
  switch (status.state()) {
    case v1::MACHINE_STATE_NOT_ZEROED:
    case v1::MACHINE_STATE_IDLE:
      return "READY";
    case v1::MACHINE_STATE_JOGGING:
      return "ACTIVE";
    case v1::MACHINE_STATE_RUNNING:
      return status.run().instruction() == "WAIT" ? "WAIT" : "ACTIVE";
    case v1::MACHINE_STATE_STOPPING:
      return "FEED_HOLD";
    case v1::MACHINE_STATE_HELD:
      return ExecutionOfHeld(status.hold_reason());
    case v1::MACHINE_STATE_ALARM:
    case v1::MACHINE_STATE_INSPECT:
    case v1::MACHINE_STATE_OFF:
      return "STOPPED";
    default:
      return "UNAVAILABLE";
  }
}

const char* ControllerModeOf(v1::OperatingMode mode) {
  if (mode == v1::OPERATING_MODE_MANUAL) return "MANUAL";
  return mode == v1::OPERATING_MODE_SINGLE ? "SEMI_AUTOMATIC" : "AUTOMATIC";
}

const char* ItemStateOf(v1::MachineState state) {
  switch (state) {
    case v1::MACHINE_STATE_ALARM:
    case v1::MACHINE_STATE_INSPECT:
      return "OutOfService";
    case v1::MACHINE_STATE_JOGGING:
    case v1::MACHINE_STATE_RUNNING:
    case v1::MACHINE_STATE_STOPPING:
      return "Executing";
    case v1::MACHINE_STATE_NOT_ZEROED:
    case v1::MACHINE_STATE_IDLE:
    case v1::MACHINE_STATE_HELD:
      return "NotExecuting";
    default:
      return "NotAvailable";
  }
}

const char* DeviceStateOf(const v1::MachineStatus& status) {
  switch (status.state()) {
    case v1::MACHINE_STATE_IDLE:
    case v1::MACHINE_STATE_NOT_ZEROED:
    case v1::MACHINE_STATE_JOGGING:
      return status.has_armed_until() ? "ARMED" : "IDLE";
    case v1::MACHINE_STATE_RUNNING:
      return status.run().phase() == v1::RUN_PHASE_DRAINING ? "DRAINING" : "SENDING";
    case v1::MACHINE_STATE_STOPPING:
      return status.hold_reason() == v1::HOLD_REASON_ABORT ? "ENDING" : "HOLDING";
    case v1::MACHINE_STATE_HELD:
      return "HELD";
    case v1::MACHINE_STATE_ALARM:
      return "ALARM";
    case v1::MACHINE_STATE_INSPECT:
      return "INSPECT";
    default:
      return "OFFLINE";
  }
}

}  // namespace

v1::StandardWords StandardWordsOf(const v1::MachineStatus& status) {
  v1::StandardWords words;
  words.set_execution(ExecutionOf(status));
  words.set_controller_mode(ControllerModeOf(status.mode()));
  words.set_item_state(ItemStateOf(status.state()));
  const bool setup =
      status.mode() == v1::OPERATING_MODE_MANUAL || status.mode() == v1::OPERATING_MODE_SINGLE;
  words.set_operation_mode(setup ? "Setup" : "Processing");
  words.set_device_state(DeviceStateOf(status));
  return words;
}

bool IsAtRest(v1::MachineState state) {
  return state == v1::MACHINE_STATE_OFF || state == v1::MACHINE_STATE_NOT_ZEROED ||
         state == v1::MACHINE_STATE_IDLE || state == v1::MACHINE_STATE_ALARM ||
         state == v1::MACHINE_STATE_INSPECT;
}

}  // namespace rmlcell::bridge
