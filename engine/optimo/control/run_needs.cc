#include "engine/optimo/control/run_needs.h"

#include <optional>
#include <string_view>

namespace rmlcell::optimo {
namespace {

std::size_t BytesOf(const std::map<int, machine::StoredProgram>& programs) {
  std::size_t bytes = 0;
  for (const auto& [slot, program] : programs) {
    if (program.object != nullptr) bytes += program.object->size();
    if (program.executable != nullptr) bytes += program.executable->size();
  }
  return bytes;
}

// The schedule that a WORKDEF names by a number. OPT-3.06, OPT-3.07
std::optional<int> ScheduleOf(const Module& module, const Instruction& i) {
  if (i.op != Op::kWorkdef) return std::nullopt;
  if (i.numbers[0] != 2 && i.value_count != 5) return std::nullopt;
  const Expression value = module.Value(i, i.value_count - 1);
  if (value.size() != 1 || value[0].op == Node::kVariable || value[0].op == Node::kName)
    return std::nullopt;
  return static_cast<int>(value[0].number);
}

Status CheckSchedules(const RunMemory& memory, const Executable& executable) {
  // What else a WORK 2 is refused for stands before what it names. OPT-3.43
  if (memory.parameters.laser == Laser::kEfa51) return {};
  for (const LinkedModule& part : executable.modules) {
    for (const Instruction& i : part.module.instructions) {
      const std::optional<int> schedule = ScheduleOf(part.module, i);
      if (!schedule || HasSchedule(memory.parameters, memory.schedules, *schedule)) continue;
      return Error{ErrorCode::kScheduleMissing,
                   "laser schedule " + Told("schedule", *schedule) + ", of program " +
                       Told("program", part.slot) + ", step " + Told("step", i.step),
                   {}};
    }
  }
  return {};
}

}  // namespace

ObjectLookup ObjectsOf(const std::map<int, machine::StoredProgram>& programs) {
  return [&programs](int slot) -> std::optional<std::string_view> {
    const auto found = programs.find(slot);
    if (found == programs.end() || found->second.object == nullptr) return std::nullopt;
    return std::string_view(*found->second.object);
  };
}

Status CheckNeeds(const RunMemory& memory, int main_slot) {
  std::size_t used = BytesOf(memory.programs);
  const auto executable_of = [&](int slot) -> Result<Executable> {
    const auto found = memory.programs.find(slot);
    // What was made before is what runs, whatever became of its parts. OPT-1.15
    const bool made = found != memory.programs.end() && found->second.executable != nullptr;
    Result<Executable> executable = made ? DecodeExecutable(*found->second.executable)
                                         : Link(slot, ObjectsOf(memory.programs),
                                                {.executable_limit = static_cast<std::uint32_t>(
                                                     memory.parameters.executable_limit),
                                                 .rotary_table = memory.parameters.rotary_table});
    if (!executable) return executable;
    if (!made) used += EncodeExecutable(*executable).size();
    if (static_cast<double>(used) > memory.parameters.cmos_bytes && !made) {  // OPT-B.73
      return Error{ErrorCode::kCmosFull,
                   "no room for executable " + Told("executable", slot + kExecutableOffset),
                   {}};
    }
    if (const Status schedules = CheckSchedules(memory, *executable); !schedules)
      return schedules.error();
    return executable;
  };
  return CheckCalls(main_slot, executable_of);
}

}  // namespace rmlcell::optimo
