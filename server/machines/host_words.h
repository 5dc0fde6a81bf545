#pragma once

#include <optional>
#include <string>

#include "rmlcell/v1/cell.pb.h"
#include "rmlcell/v1/host.pb.h"
#include "rmlcell/v1/job.pb.h"
#include "storage/store.h"

// What hosts and the store tell one another, each in the words of the other.
namespace rmlcell::server {

// As it stands in the log of the cell; nothing: it is not told.
std::optional<v1::MachineEvent> EventOf(const v1::JournalEntry& entry);
storage::NewEvent ToRecord(const v1::MachineEvent& event);
// Where the job of its run is.
v1::JobProgress ProgressOf(const v1::MachineStatus& status);
v1::HostMemory MemoryOf(const storage::MachineMemory& memory);

inline Error NotLive(const std::string& why) { return {ErrorCode::kCellNotLive, why, {}}; }

}  // namespace rmlcell::server
