#include "server/runs/run_advice.h"

#include <map>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "engine/machine/parameters.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/ticket.h"
#include "proto/recording/recording.h"
#include "server/jobs/assignment.h"
#include "server/records/machine_options.h"
#include "server/runs/run_ticket.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kBytesRead = std::size_t{1} << 20;  // of programs; more would take too long

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
  if (!record) return std::nullopt;
  auto made = MakeAssignment(store, config, {.lease = {}, .job = *record});
  if (!made) return std::nullopt;
  v1::WorkerAssignment& assignment = *made->first.mutable_assignment();
  std::size_t bytes = 0;
  for (v1::AssignedProgram& program : *assignment.mutable_programs()) {
    for (const auto& [slot, content] : made->programs) {
      if (slot == program.slot()) program.set_content(*content);
    }
    bytes += program.content().size();
  }
  const machine::MachineFamily* family = families::FindFamily(assignment.family());
  if (family == nullptr || bytes > kBytesRead) return std::nullopt;
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
  if (const std::string& simulation = assignment.job().run().ticket(); !simulation.empty()) {
    Result<v1::RunTicket> known = TicketOf(store, simulation);
    if (!known) return known.error();
    ticket = *std::move(known);
  }
  const auto machine = store.GetMachine(record->machine);
  const auto options = machine ? OptionsOf(*machine) : std::nullopt;
  const Status may =
      bridge::CheckRun({.family = *family,
                        .parameters = *parameters,
                        .programs = *programs,
                        .schedules = schedules,
                        .main_program = assignment.main_program()},
                       ticket ? &*ticket : nullptr, options && options->ticket_needed());
  return may ? std::nullopt : std::optional(may.error());
}

}  // namespace rmlcell::server
