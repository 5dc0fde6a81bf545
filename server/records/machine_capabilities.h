#pragma once

#include "rmlcell/v1/machine.pb.h"
#include "storage/records.h"

namespace rmlcell::server {

// What can be done with a virtual machine that has a host; empty where its record is of no family
// or parameters that this version knows. LIVE-8.04
v1::MachineCapabilities CapabilitiesOf(const storage::MachineRecord& record);

}  // namespace rmlcell::server
