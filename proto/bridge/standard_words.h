#pragma once

#include "rmlcell/v1/machine_status.pb.h"

namespace rmlcell::bridge {

// What the standards of the field call what a machine does: Execution and ControllerMode of
// MTConnect, MachineryItemState and MachineryOperationMode of OPC 40001-1, and the states of
// machines with a device. Computed of the rest of the status, and stored nowhere. LIVE-2.14, 2.15
v1::StandardWords StandardWordsOf(const v1::MachineStatus& status);

// Whether it stands and has no run open: nothing is to be held there.
bool IsAtRest(v1::MachineState state);

}  // namespace rmlcell::bridge
