#pragma once

#include "clients/cli/local.h"
#include "engine/machine/shape.h"
#include "engine/simulation/material/milling_recorder.h"

// Block and tool of `simulate`, and the file that shows what is left.
namespace rmlcell::cli {

// Errors: CellInvalidArgument for a machine that mills nothing, a block or a tool that cannot be.
Result<simulation::Milling> MillingOf(const SimulateOptions& options,
                                      const machine::MachineShape& shape);

// Errors: CellFileUnwritable.
Status WriteMaterial(const simulation::HeightField& material, const std::string& file);

}  // namespace rmlcell::cli
