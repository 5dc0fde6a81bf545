#pragma once

#include <vector>

#include "engine/simulation/material/milling_recorder.h"
#include "engine/simulation/material/target_files.h"
#include "engine/simulation/run/rehearsal.h"

namespace rmlcell::simulation {

// A program as a target: the heights (Target::heights) that it leaves of the block of `milling`
// with the same tool. Errors: those of PrepareRun and MachineFamily::NewRun, CellBadText for a
// program with errors, the code of its end when it is not its own, CellCancelled when it is not
// wanted any more. Precondition: CheckMilling is well.
Result<std::vector<float>> MilledTarget(const ProgramMemory& memory, const RunOptions& options,
                                        const Milling& milling, const StillWanted& wanted = {});

}  // namespace rmlcell::simulation
