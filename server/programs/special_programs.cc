#include "server/programs/special_programs.h"

#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/families/families.h"
#include "server/base/names.h"
#include "server/records/program_place.h"
#include "storage/store.h"

namespace rmlcell::server {
namespace {

using SpecialSet = std::vector<machine::SpecialProgram>;

// "1, 2, 4, 90".
std::string SlotsOf(const auto& programs) {
  std::string text;
  for (const machine::SpecialProgram& program : programs)
    text += (text.empty() ? "" : ", ") + std::to_string(program.slot);
  return text;
}

// Those that are asked for, by slot, each once.
Result<SpecialSet> Choose(const machine::MachineFamily& family,
                          const v1::StoreSpecialProgramsRequest& request) {
  const auto all = family.special_programs();
  if (all.empty()) {
    return Error{ErrorCode::kCellPrecondition,
                 request.parent() + " is of the family " + std::string(family.info().id) +
                     ", which has no special programs",
                 {}};
  }
  for (const int slot : request.slots()) {
    if (std::ranges::find(all, slot, &machine::SpecialProgram::slot) != all.end()) continue;
    return InvalidArgument("there is no special program " + std::to_string(slot) + "; there are " +
                           SlotsOf(all));
  }
  SpecialSet chosen;
  for (const machine::SpecialProgram& program : all) {
    if (request.slots().empty() || std::ranges::count(request.slots(), program.slot) > 0)
      chosen.push_back(program);
  }
  return chosen;
}

// All of them at once: the store would name the first.
Status CheckEmpty(storage::Store& store, const std::string& machine, const SpecialSet& programs) {
  const auto stored = store.ListPrograms(machine, 0, kSlotMax);
  if (!stored) return stored.error();
  SpecialSet filled;
  for (const machine::SpecialProgram& program : programs) {
    if (std::ranges::find(*stored, program.slot, &storage::ProgramSummary::slot) != stored->end())
      filled.push_back(program);
  }
  if (filled.empty()) return {};
  return Error{ErrorCode::kCellAlreadyExists,
               "programs of " + MachineName(machine) + " that are there: " + SlotsOf(filled) +
                   "; ask to replace them, or leave them out",
               {}};
}

Result<storage::ProgramWrite> SpecialWrite(const machine::SpecialProgram& program,
                                           const machine::MachineFamily& family,
                                           const machine::Parameters& parameters, bool replace) {
  machine::Translation made = family.Translate(
      {.name = std::string(program.file_name), .bytes = program.source, .is_object = false},
      parameters, {});
  if (!made.ok) {
    const auto wrong = std::ranges::find_if(made.diagnostics, [](const Diagnostic& diagnostic) {
      return IsError(diagnostic.severity);
    });
    if (wrong == made.diagnostics.end()) return Error{ErrorCode::kCellBadText, {}, {}};
    return Error{wrong->code, std::string(program.file_name) + ": " + wrong->detail, wrong->where};
  }
  return storage::ProgramWrite{.slot = program.slot,
                               .name = std::string(program.name),
                               .object = std::move(made.object),
                               .source = std::string(program.source),
                               .source_name = std::string(program.file_name),
                               .expected = replace ? storage::kAnyRevision : 0};
}

}  // namespace

Result<v1::StoreSpecialProgramsResponse> StoreSpecialPrograms(
    storage::Store& store, const v1::StoreSpecialProgramsRequest& request,
    std::string_view caller) {
  const Result<std::string> id = ParseMachineName(request.parent());
  if (!id) return id.error();
  const auto machine = store.GetMachine(*id);
  if (!machine) return machine.error();
  const machine::MachineFamily* family = families::FindFamily(machine->family);
  if (family == nullptr) return families::UnknownFamily(machine->family);
  const Result<SpecialSet> chosen = Choose(*family, request);
  if (!chosen) return chosen.error();
  if (!request.replace()) {
    if (const Status empty = CheckEmpty(store, *id, *chosen); !empty) return empty.error();
  }
  const Result<machine::Parameters> parameters =
      machine::MakeParameters(*family, machine->profile, machine->parameters);
  if (!parameters) return parameters.error();
  std::vector<storage::ProgramWrite> writes;
  for (const machine::SpecialProgram& program : *chosen) {
    Result<storage::ProgramWrite> write =
        SpecialWrite(program, *family, *parameters, request.replace());
    if (!write) return write.error();
    writes.push_back(*std::move(write));
  }
  const auto stored = store.PutPrograms(*id, writes, {}, caller);
  if (!stored) return stored.error();
  v1::StoreSpecialProgramsResponse response;
  for (const storage::ProgramSummary& summary : *stored)
    *response.add_programs() = ToProto(*id, summary);
  return response;
}

}  // namespace rmlcell::server
