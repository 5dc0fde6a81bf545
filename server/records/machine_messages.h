#pragma once

#include <google/protobuf/field_mask.pb.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "rmlcell/v1/machine.pb.h"
#include "rmlcell/v1/worker.pb.h"
#include "storage/records.h"

namespace rmlcell::machine {
class MachineFamily;
}

namespace rmlcell::server {

// As workers and hosts are told of it.
v1::AssignedSchedule ToAssigned(const storage::ScheduleRecord& schedule);

// "X Y Z": each of them.
std::vector<std::string> WordsOf(std::string_view text);

v1::Family ToProto(const machine::MachineFamily& family);
v1::Machine ToProto(const storage::MachineRecord& record);
// With what its jobs do, of those that Store::UnfinishedJobs gave.
v1::Machine ToProto(const storage::MachineRecord& record,
                    const std::vector<storage::MachineJobs>& unfinished);
// How it stands as far as its jobs tell, where it has no host.
v1::MachineStatus StatusOf(const storage::MachineRecord& record,
                           const std::vector<storage::MachineJobs>& unfinished);
// The kind of what a host tells of its machine in the log of the cell: a v1::MachineEvent.
inline constexpr std::string_view kMachineEvent = "machine";
// What jobs of the queue do with it.
void AddJobs(std::string_view machine, const std::vector<storage::MachineJobs>& unfinished,
             v1::MachineStatus& status);
// What a run on a machine that stands like that begins with (RunSetup::machine_state); empty: on a
// new machine. CellStoreCorrupt: its host wrote what this version cannot read.
Result<std::string> StateForRun(std::string_view machine,
                                const std::optional<storage::MachineMark>& mark);
v1::LaserSchedule ToProto(const storage::ScheduleRecord& record);
// "CW", "PULSE", as the store and the engine have it. CellInvalidArgument for a mode that there is
// not.
Result<std::string> ModeText(v1::LaserMode mode);
v1::LaserMode ModeOf(std::string_view text);

// A record that is not stored yet.
storage::MachineRecord FromProto(const v1::Machine& message, const std::string& id);

// `machine` with those fields of `wanted` that an update takes over (update_mask.h); its revision
// stays. Errors: CellInvalidArgument for another family or a field that cannot be changed, those of
// CheckMachine.
Result<storage::MachineRecord> Updated(storage::MachineRecord machine, const v1::Machine& wanted,
                                       const google::protobuf::FieldMask& mask);

// Family, profile and parameters must exist and be in range.
// Errors: CellUnknownFamily, CellInvalidArgument, CellUnknownParameter, CellParameterRange.
Status CheckMachine(const storage::MachineRecord& machine);

}  // namespace rmlcell::server
