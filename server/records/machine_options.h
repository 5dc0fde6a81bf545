#pragma once

#include <optional>
#include <string>

#include "engine/core/result.h"
#include "rmlcell/v1/machine.pb.h"
#include "storage/records.h"

// How a machine lives.
namespace rmlcell::server {

// As its record has it; nothing: nothing is stated.
std::optional<v1::MachineOptions> OptionsOf(const storage::MachineRecord& record);

std::string BytesOf(const v1::MachineOptions& options);

// Whether its host is to be started. `by_default`: where its record does not say so.
bool IsEnabled(const storage::MachineRecord& record, bool by_default);

// Whether the host of the machine would have to be told of the change.
bool LivesOtherwise(const storage::MachineRecord& before, const storage::MachineRecord& now);

// Of a virtual machine. Errors: CellInvalidArgument, for what only devices have, and for times out
// of range; CellUnknownMachine and the like are not looked for.
Status CheckOptions(const v1::MachineOptions& options);

}  // namespace rmlcell::server
