#pragma once

#include "engine/core/result.h"
#include "rmlcell/v1/machine.pb.h"
#include "storage/records.h"

namespace rmlcell::machine {
class MachineFamily;
}

namespace rmlcell::server {

v1::Family ToProto(const machine::MachineFamily& family);
v1::Machine ToProto(const storage::MachineRecord& record);
v1::LaserSchedule ToProto(const storage::ScheduleRecord& record);

// Family, profile and parameters must exist and be in range.
// Errors: CellUnknownFamily, CellInvalidArgument, CellUnknownParameter, CellParameterRange.
Status CheckMachine(const storage::MachineRecord& machine);

}  // namespace rmlcell::server
