#pragma once

#include <optional>
#include <span>

#include "storage/store.h"

namespace rmlcell::server {

// What the program memory of this machine holds. Nothing: as much as comes, or nobody knows.
std::optional<storage::ProgramMemoryLimit> LimitOfMemory(const storage::MachineRecord& machine);

// What the store would say to these objects, before they are put. Errors:
// ProgramMemoryLimit::full.
Status CheckRoomFor(storage::Store& store, const storage::MachineRecord& machine,
                    std::span<const storage::ProgramWrite> programs);
// The same of an executable.
Status CheckRoomForExecutable(storage::Store& store, const storage::MachineRecord& machine,
                              int slot, std::int64_t bytes);

}  // namespace rmlcell::server
