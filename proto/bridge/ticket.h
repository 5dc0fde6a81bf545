#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/machine/family.h"
#include "rmlcell/v1/worker.pb.h"

// What holds a run to the simulation of its program. LIVE-5.02
namespace rmlcell::bridge {

// What a run depends on besides its machine's state and inputs. Borrowed.
struct RunDependencies {
  const machine::MachineFamily& family;
  const machine::Parameters& parameters;
  const std::map<int, machine::StoredProgram>&
      programs;  // by slot, the one that is started among them
  const std::vector<machine::LaserSchedule>& schedules;  // that were stored
  int main_program = 0;
};

RunDependencies DependenciesOf(const machine::MachineFamily& family,
                               const machine::RunSetup& setup);

// SHA-256, 32 bytes each, by what a machine calls it: "programs/7", "schedules/3". Where programs
// do not call each other it is the one that is started, whatever its slot: "program".
std::map<std::string, std::string> DigestsOf(const RunDependencies& run);

// What is other than in the simulation: "programs/7", "schedules/3", "parameter VMAX", "engine
// 0.1.0". Empty: nothing is.
std::vector<std::string> ChangedSince(const v1::RunTicket& ticket, const RunDependencies& run);

// What ends a run before anything moves: something that it needs is not there, or it is not what
// was simulated. `ticket`: null, it has none. Errors: those of MachineFamily::CheckNeeds;
// CellTicket. LIVE-5.02 (b)
Status CheckRun(const RunDependencies& run, const v1::RunTicket* ticket, bool ticket_needed);

}  // namespace rmlcell::bridge
