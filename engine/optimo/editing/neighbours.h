#pragma once

#include <optional>

#include "engine/machine/editing.h"
#include "engine/optimo/editing/program_index.h"

namespace rmlcell::optimo::editing {

// The source of a program number beside this one; nothing when there is none that can be read.
std::optional<machine::NumberedSource> FindNeighbour(const machine::Surroundings& around,
                                                     int number);

// The number that a GO, CALL or FUNCTION at this use names: 44, or the constant of a name; nothing
// for a variable and for what is called from nowhere.
std::optional<int> CalledProgram(const ProgramIndex& index, const Use& use);

}  // namespace rmlcell::optimo::editing
