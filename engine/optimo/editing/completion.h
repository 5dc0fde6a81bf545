#pragma once

#include "engine/machine/editing.h"
#include "engine/optimo/editing/program_index.h"

namespace rmlcell::optimo::editing {

// What fits behind what is written at `offset`: instructions at the beginning of a statement, the
// attributes of its instruction behind a '/', sequence numbers where one is jumped to, programs of
// the folder behind CALL and GO, else what an expression may have.
machine::Suggestions Complete(const ProgramIndex& index, std::size_t offset,
                              const machine::Surroundings& around);

}  // namespace rmlcell::optimo::editing
