#include "proto/bridge/ticket.h"

#include <algorithm>
#include <utility>

#include "engine/core/hex.h"
#include "engine/simulation/run/version.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/sha256.h"

namespace rmlcell::bridge {
namespace {

std::string DigestOf(const machine::Bytes& bytes) {
  Sha256 digest;
  for (std::size_t at = 0; at < bytes->size(); at += machine::kReleaseEvery) {
    digest.Add(bytes->substr(at, machine::kReleaseEvery));
    bytes.Release();
  }
  return BytesOfHex(digest.Hex()).value_or("");
}

// Its name is for people.
std::string DigestOf(const machine::LaserSchedule& schedule) {
  v1::AssignedSchedule told;
  told.set_number(schedule.number);
  told.set_mode(schedule.mode);
  told.set_power_percent(schedule.power_percent);
  return BytesOfHex(Sha256Hex(StableBytes(told))).value_or("");
}

// The keys under which the two have different values, or one has none.
template <class First, class Second>
std::vector<std::string> Differing(const First& first, const Second& second) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : first) {
    const auto found = second.find(key);
    if (found == second.end() || found->second != value) keys.push_back(key);
  }
  for (const auto& [key, value] : second) {
    if (!first.contains(key)) keys.push_back(key);
  }
  return keys;
}

}  // namespace

RunDependencies DependenciesOf(const machine::MachineFamily& family,
                               const machine::RunSetup& setup) {
  return {.family = family,
          .parameters = setup.parameters,
          .programs = setup.programs,
          .schedules = setup.schedules,
          .main_program = setup.main_program};
}

std::map<std::string, std::string> DigestsOf(const RunDependencies& run) {
  std::map<std::string, std::string> digests;
  if (!run.family.info().has_executables) {
    const auto main = run.programs.find(run.main_program);
    if (main != run.programs.end()) digests["program"] = DigestOf(main->second.object);
    return digests;
  }
  for (const auto& [slot, program] : run.programs)
    digests["programs/" + std::to_string(slot)] = DigestOf(program.object);
  for (const machine::LaserSchedule& schedule : run.schedules)
    digests["schedules/" + std::to_string(schedule.number)] = DigestOf(schedule);
  return digests;
}

std::vector<std::string> ChangedSince(const v1::RunTicket& ticket, const RunDependencies& run) {
  const machine::FamilyInfo& family = run.family.info();
  if (ticket.family() != family.id) return {"family " + std::string(family.id)};
  const std::map<std::string, std::string> inputs(ticket.inputs().begin(), ticket.inputs().end());
  std::vector<std::string> changed = Differing(inputs, DigestsOf(run));
  const std::map<std::string, std::string> parameters(ticket.parameters().begin(),
                                                      ticket.parameters().end());
  for (const std::string& name : Differing(parameters, run.parameters.Changed()))
    changed.push_back("parameter " + name);
  if (family.has_executables && ticket.main_program() != run.main_program)
    changed.push_back("program " + std::to_string(run.main_program) + " instead of " +
                      std::to_string(ticket.main_program()));
  if (ticket.engine_version() != simulation::kEngineVersion)
    changed.push_back("engine " + std::string(simulation::kEngineVersion));
  return changed;
}

Status CheckRun(const RunDependencies& run, const v1::RunTicket* ticket, bool ticket_needed) {
  constexpr std::size_t kChangesTold = 8;
  if (const Status there =
          run.family.CheckNeeds(run.programs, run.schedules, run.parameters, run.main_program);
      !there)
    return there.error();
  if (ticket == nullptr) {
    if (!ticket_needed) return {};
    return Error{ErrorCode::kCellTicket, "jobs need one here", {}};
  }
  const std::vector<std::string> changed = ChangedSince(*ticket, run);
  if (changed.empty()) return {};
  std::string text = "other than in " + ticket->job() + ": ";
  for (std::size_t i = 0; i < std::min(changed.size(), kChangesTold); ++i)
    text += (i == 0 ? "" : ", ") + changed[i];
  if (changed.size() > kChangesTold)
    text += " and " + std::to_string(changed.size() - kChangesTold) + " more";
  return Error{ErrorCode::kCellTicket, Detail(std::move(text)), {}};
}

}  // namespace rmlcell::bridge
