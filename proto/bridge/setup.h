#pragma once

#include <string>
#include <vector>

#include "engine/simulation/run/rehearsal.h"

namespace rmlcell::v1 {
class Breakpoint;
class Budget;
class SimulationOptions;
}  // namespace rmlcell::v1

// What a simulation is asked for, as the options of a run: the same for jobs of the queue and for
// the command on a laptop.
namespace rmlcell::bridge {

// `default_mode`: where none is asked for; REMOTE for jobs, CYCLE for the command. Errors: those of
// InputsOf.
Result<simulation::RunOptions> RunOptionsOf(const v1::SimulationOptions& options,
                                            const v1::Budget& budget, int main_program,
                                            machine::Mode default_mode);

machine::Breakpoint FromProto(const v1::Breakpoint& breakpoint, int main_program);

// "VR[0..9]", "VI[99]", "Z1" -> the single names, at most 1,000. Error: CellInvalidArgument.
Result<std::vector<std::string>> ExpandVariables(const std::vector<std::string>& names);

}  // namespace rmlcell::bridge
