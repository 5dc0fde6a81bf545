#include "server/records/program_place.h"

#include "engine/core/units.h"
#include "engine/families/families.h"
#include "server/records/job_messages.h"

namespace rmlcell::server {

Result<ProgramPlace> FindProgramPlace(storage::Store& store, std::string_view name) {
  Result<ProgramName> parsed = ParseProgramName(name);
  if (!parsed) return parsed.error();
  Result<storage::MachineRecord> machine = store.GetMachine(parsed->machine);
  if (!machine) return machine.error();
  const machine::MachineFamily* family = families::FindFamily(machine->family);
  if (family == nullptr) return families::UnknownFamily(machine->family);
  if (const Status there = CheckNumber(*family, *parsed); !there) return there.error();
  return ProgramPlace{*std::move(machine), family, parsed->slot, parsed->executable};
}

Status CheckNumber(const machine::MachineFamily& family, const ProgramName& name) {
  const bool has_executables = family.info().has_executables;
  if (name.slot != 0 && (!name.executable || has_executables)) return {};
  if (!has_executables) return CheckSlot(family, name.number, "program number");
  return Error{family.info().no_slot,
               "program number is " + Told("program", name.number) +
                   "; programs have 1 to 99, and their executables 101 to 199",
               {}};
}

Status CheckSlot(const machine::MachineFamily& family, std::int64_t number,
                 std::string_view field) {
  if (number >= kSlotMin && number <= kSlotMax) return {};
  std::string allowed = "slots are " + std::to_string(kSlotMin) + " to " + std::to_string(kSlotMax);
  if (!family.info().has_executables) allowed += ", and there are no executables";
  return Error{family.info().no_slot,
               std::string(field) + " is " + std::to_string(number) + "; " + allowed,
               {}};
}

Status CheckSchedule(const machine::MachineFamily& family, std::int64_t number) {
  const int most = family.info().schedules;
  if (most == 0)
    return Error{ErrorCode::kCellPrecondition, "this machine has no laser schedules", {}};
  if (number >= 1 && number <= most) return {};
  return Error{family.info().no_schedule, "laser schedule is " + std::to_string(number), {}};
}

Error EmptySlot(const machine::MachineFamily& family, std::string_view name) {
  return {family.info().empty_slot, "there is no " + std::string(name), {}};
}

v1::Program ToProto(const std::string& machine, const storage::ProgramSummary& summary) {
  v1::Program program;
  program.set_name(NameOfProgram(machine, summary.slot));
  program.set_title(summary.name);
  program.set_file_name(summary.source_name);
  program.set_object_bytes(summary.object_bytes);
  if (summary.source_bytes >= 0) program.set_source_bytes(summary.source_bytes);
  if (summary.executable_bytes >= 0) program.set_executable_bytes(summary.executable_bytes);
  program.set_object_sha256(summary.object_sha256);
  program.set_etag(std::to_string(summary.revision));
  *program.mutable_create_time() = ToProto(summary.created_at);
  *program.mutable_update_time() = ToProto(summary.updated_at);
  return program;
}

}  // namespace rmlcell::server
