#include "server/records/program_memory.h"

#include <algorithm>

#include "engine/core/units.h"
#include "engine/families/families.h"

namespace rmlcell::server {
namespace {

std::int64_t ExecutableBytes(const storage::ProgramSummary& program) {
  return std::max<std::int64_t>(program.executable_bytes, 0);
}

// `change` makes of each program what it will have.
template <class Change>
Status CheckChange(storage::Store& store, const storage::MachineRecord& machine, std::int64_t added,
                   Change change) {
  const auto limit = LimitOfMemory(machine);
  if (!limit) return {};
  const auto programs = store.ListPrograms(machine.id, 0, kSlotMax);
  if (!programs) return programs.error();
  std::int64_t before = 0;
  std::int64_t after = added;
  for (const storage::ProgramSummary& program : *programs) {
    before += program.object_bytes + ExecutableBytes(program);
    after += change(program);
  }
  return storage::CheckRoom(limit, before, after);
}

}  // namespace

std::optional<storage::ProgramMemoryLimit> LimitOfMemory(const storage::MachineRecord& machine) {
  const machine::MachineFamily* family = families::FindFamily(machine.family);
  if (family == nullptr) return std::nullopt;
  const auto parameters = machine::MakeParameters(*family, machine.profile, machine.parameters);
  if (!parameters) return std::nullopt;
  const auto limit = family->ProgramMemory(*parameters);
  if (!limit) return std::nullopt;
  return storage::ProgramMemoryLimit{.bytes = limit->bytes, .full = limit->full};
}

Status CheckRoomFor(storage::Store& store, const storage::MachineRecord& machine,
                    std::span<const storage::ProgramWrite> programs) {
  std::int64_t added = 0;
  for (const storage::ProgramWrite& write : programs)
    added += static_cast<std::int64_t>(write.object.size());
  return CheckChange(store, machine, added, [&](const storage::ProgramSummary& program) {
    const bool replaced =
        std::ranges::find(programs, program.slot, &storage::ProgramWrite::slot) != programs.end();
    return replaced ? 0 : program.object_bytes + ExecutableBytes(program);
  });
}

Status CheckRoomForExecutable(storage::Store& store, const storage::MachineRecord& machine,
                              int slot, std::int64_t bytes) {
  return CheckChange(store, machine, bytes, [&](const storage::ProgramSummary& program) {
    return program.object_bytes + (program.slot == slot ? 0 : ExecutableBytes(program));
  });
}

}  // namespace rmlcell::server
