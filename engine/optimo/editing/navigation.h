#pragma once

#include <vector>

#include "engine/machine/editing.h"
#include "engine/optimo/editing/program_index.h"

// Where things are, and where they are used. Sequence numbers and names belong to one program;
// programs are found in its folder.
namespace rmlcell::optimo::editing {

// The uses in this program that mean the same as `use`, in order of the text: a sequence number and
// the jumps to it, a name, a variable, a program number, a process word alone.
std::vector<const Use*> SameUses(const ProgramIndex& index, const Use& use);

// The sequence number of a jump, the DECLARE of a name, the file of a called program, the WORKDEF
// of a WORK. Empty when it is nowhere.
machine::Places Definition(const ProgramIndex& index, std::size_t offset,
                           const machine::Surroundings& around);

// In this program; of a program number in all programs of the folder.
machine::Places References(const ProgramIndex& index, std::size_t offset, bool with_definition,
                           const machine::Surroundings& around);

// The same thing in this program.
std::vector<machine::Highlight> Highlights(const ProgramIndex& index, std::size_t offset);

}  // namespace rmlcell::optimo::editing
