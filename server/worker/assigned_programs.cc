#include "server/worker/assigned_programs.h"

#include <algorithm>
#include <utility>

#include "engine/families/families.h"

namespace rmlcell::server {

AssignedPrograms::AssignedPrograms(const v1::WorkerAssignment& assignment)
    : assignment_(assignment) {
  for (const v1::AssignedProgram& program : assignment.programs())
    bytes_[program.slot()].append(program.content());
}

bool AssignedPrograms::complete() const {
  return std::ranges::all_of(assignment_.programs(), [this](const v1::AssignedProgram& program) {
    return bytes_.at(program.slot()).size() >= program.size();
  });
}

void AssignedPrograms::Add(const v1::WorkerBlob& part) {
  if (const auto of = bytes_.find(part.slot()); of != bytes_.end()) of->second.append(part.chunk());
}

simulation::ProgramMemory AssignedPrograms::Memory() {
  simulation::ProgramMemory memory{
      .family = families::FindFamily(assignment_.family()),
      .profile = assignment_.profile(),
      .parameters = {assignment_.parameters().begin(), assignment_.parameters().end()},
      .deleted_programs = {assignment_.deleted_programs().begin(),
                           assignment_.deleted_programs().end()},
      .machine_state = assignment_.machine_state()};
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
  if (!assignment_.default_schedules()) {
    memory.schedules.emplace();
    for (const v1::AssignedSchedule& schedule : assignment_.schedules()) {
      memory.schedules->push_back({.number = schedule.number(),
                                   .name = schedule.title(),
                                   .mode = schedule.mode(),
                                   .power_percent = schedule.power_percent()});
    }
  }
  return memory;
}

}  // namespace rmlcell::server
