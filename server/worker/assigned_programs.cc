#include "server/worker/assigned_programs.h"

#include <algorithm>
#include <utility>

#include "engine/core/units.h"
#include "engine/families/families.h"
#include "proto/bridge/machine_inputs.h"

namespace rmlcell::server {

AssignedPrograms::AssignedPrograms(const v1::WorkerAssignment& assignment)
    : assignment_(assignment) {
  for (const v1::AssignedProgram& program : assignment.programs())
    bytes_[program.slot()].append(program.content());
  if (assignment.has_target()) bytes_[0].append(assignment.target().content());
}

bool AssignedPrograms::IsComplete(const v1::AssignedProgram& program) const {
  return bytes_.at(program.slot()).size() >= program.size();
}

bool AssignedPrograms::complete() const {
  return std::ranges::all_of(
             assignment_.programs(),
             [this](const v1::AssignedProgram& program) { return IsComplete(program); }) &&
         (!assignment_.has_target() || IsComplete(assignment_.target()));
}

void AssignedPrograms::Add(const v1::WorkerBlob& part) {
  if (const auto of = bytes_.find(part.slot()); of != bytes_.end()) of->second.append(part.chunk());
}

simulation::ProgramMemory AssignedPrograms::EmptyMemory() const {
  return {.family = families::FindFamily(assignment_.family()),
          .profile = assignment_.profile(),
          .parameters = {assignment_.parameters().begin(), assignment_.parameters().end()},
          .parameters_of =
              assignment_.parameters().empty() ? std::string() : assignment_.job().machine()};
}

machine::MachineUsed AssignedPrograms::Machine() const {
  return simulation::MachineOf(EmptyMemory());
}

simulation::ProgramMemory AssignedPrograms::Memory() {
  simulation::ProgramMemory memory = EmptyMemory();
  memory.deleted_programs = {assignment_.deleted_programs().begin(),
                             assignment_.deleted_programs().end()};
  memory.machine_state = assignment_.machine_state();
  memory.given = simulation::MemoryGiven::kWhole;
  for (const v1::AssignedProgram& program : assignment_.programs()) {
    simulation::MemoryProgram made{
        .slot = program.slot(),
        .name = program.title().empty() ? program.file_name() : program.title(),
        .file_name = program.file_name(),
        .bytes = bytes_.at(program.slot()).Finish(),
        .is_source = program.is_source()};
    if (!program.executable().empty()) made.executable = machine::Bytes::Of(program.executable());
    memory.programs.push_back(std::move(made));
  }
  for (const v1::AssignedSchedule& schedule : assignment_.schedules())
    memory.schedules.push_back(bridge::FromProto(schedule));
  return memory;
}

Result<std::vector<float>> AssignedPrograms::TargetHeights(const simulation::Milling& milling,
                                                           simulation::RunOptions options,
                                                           const simulation::StillWanted& wanted) {
  const v1::AssignedProgram& target = assignment_.target();
  machine::Bytes bytes = bytes_.at(0).Finish();
  if (assignment_.job().simulation().milling().target().has_file())
    return simulation::ReadTarget(*bytes, milling.stock, wanted);
  simulation::ProgramMemory memory = EmptyMemory();
  memory.programs.push_back({.slot = kSlotMin,
                             .file_name = target.file_name(),
                             .bytes = std::move(bytes),
                             .is_source = target.is_source()});
  options.main_program = kSlotMin;
  return simulation::MilledTarget(memory, options, milling, wanted);
}

}  // namespace rmlcell::server
