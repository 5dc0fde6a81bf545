#include "server/runs/run_advice.h"

#include <map>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "engine/machine/parameters.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/ticket.h"
#include "proto/recording/recording.h"
#include "server/base/names.h"
#include "server/jobs/assignment.h"
#include "server/records/machine_options.h"
#include "server/runs/run_ticket.h"
#include "storage/trouble.h"

namespace rmlcell::server {
namespace {

constexpr std::int64_t kBytesRead = std::int64_t{1} << 20;  // of a program; more takes too long

// An object that is brought, and is the same as what is stored, runs with what was made of that.
void AddStoredExecutable(storage::Store& store, const storage::JobRecord& job,
                         v1::AssignedProgram& program) {
  if (program.is_source() || !program.executable().empty()) return;
  auto stored = store.GetProgram(job.machine, program.slot());
  if (stored && stored->object == program.content() && stored->executable)
    program.set_executable(*std::move(stored->executable));
}

// The simulation that is to prove it has not come to its end: it is waited for.
bool IsAwaited(storage::Store& store, std::string_view simulation) {
  const auto id = ParseJobName(simulation);
  const auto record = id ? store.GetJob(*id) : Result<storage::JobRecord>(id.error());
  return record && !storage::IsFinal(record->state);
}

Result<std::map<int, machine::StoredProgram>> ProgramsOf(const v1::WorkerAssignment& assignment,
                                                         const machine::MachineFamily& family,
                                                         const machine::Parameters& parameters) {
  std::map<int, machine::StoredProgram> programs;
  for (const v1::AssignedProgram& program : assignment.programs()) {
    auto made = recording::ProgramOf(program, family, parameters);
    if (!made) return made.error();
    programs[program.slot()] = *std::move(made);
  }
  return programs;
}

}  // namespace

std::optional<Error> WhyItWouldFail(storage::Store& store, const Config& config, std::int64_t job) {
  const auto record = store.GetJob(job);
  const auto artifacts = store.ListArtifacts(job);
  if (!record || !artifacts) return std::nullopt;
  for (const storage::ArtifactRecord& one : *artifacts) {
    if (one.size > kBytesRead) return std::nullopt;
  }
  auto made = MakeAssignment(store, config, {.lease = {}, .job = *record});
  if (!made) return std::nullopt;
  v1::WorkerAssignment& assignment = *made->first.mutable_assignment();
  for (v1::AssignedProgram& program : *assignment.mutable_programs()) {
    for (const auto& [slot, content] : made->programs) {
      if (slot == program.slot()) program.set_content(*content);
    }
    if (program.slot() == assignment.main_program()) AddStoredExecutable(store, *record, program);
  }
  const machine::MachineFamily* family = families::FindFamily(assignment.family());
  if (family == nullptr) return std::nullopt;
  const auto parameters =
      machine::MakeParameters(*family, assignment.profile(),
                              {assignment.parameters().begin(), assignment.parameters().end()});
  if (!parameters) return parameters.error();
  const auto programs = ProgramsOf(assignment, *family, *parameters);
  if (!programs) return programs.error();
  std::vector<machine::LaserSchedule> schedules;
  for (const v1::AssignedSchedule& schedule : assignment.schedules())
    schedules.push_back(bridge::FromProto(schedule));
  std::optional<v1::RunTicket> ticket;
  const std::string& simulation = assignment.job().run().ticket();
  const bool awaited = !simulation.empty() && IsAwaited(store, simulation);
  if (!simulation.empty() && !awaited) {
    Result<v1::RunTicket> known = TicketOf(store, simulation);
    if (!known && storage::IsTroubleOfTheStore(known.error())) return std::nullopt;
    if (!known) return known.error();
    ticket = *std::move(known);
  }
  const auto machine = store.GetMachine(record->machine);
  const auto options = machine ? OptionsOf(*machine) : std::nullopt;
  const Status may = bridge::CheckRun({.family = *family,
                                       .parameters = *parameters,
                                       .programs = *programs,
                                       .schedules = schedules,
                                       .main_program = assignment.main_program()},
                                      ticket ? &*ticket : nullptr,
                                      options && options->ticket_needed() && !awaited);
  return may ? std::nullopt : std::optional(may.error());
}

}  // namespace rmlcell::server
