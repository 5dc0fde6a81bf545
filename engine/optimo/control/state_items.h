#pragma once

#include <span>
#include <vector>

#include "engine/core/units.h"
#include "engine/machine/outcome.h"
#include "engine/machine/step_entry.h"
#include "engine/optimo/control/program_context.h"
#include "engine/optimo/machine/machine_state.h"

// All that an Optimo is at, a value each, for people and to be compared. LIVE-6.02
namespace rmlcell::optimo {

// What the machine keeps: pose, TCP, SYSDEF, variables and images by their names ("VR[5]",
// "OL[11]"), "input IL[5]", "output OL[11]", schedule, gas, table.
std::vector<machine::StateItem> ItemsOf(const MachineState& state);

// What programs have of their own, those that wait for others, too: stack, modal values, PAR, ERR,
// TIMER, WORKDEFs, the WORKs that are ON. Precondition: there is one.
std::vector<machine::StateItem> ItemsOf(std::span<const ProgramContext> programs,
                                        std::span<const machine::Place> stack, SimTime now);

}  // namespace rmlcell::optimo
