#pragma once

#include <string>
#include <variant>
#include <vector>

#include "engine/machine/editing.h"
#include "engine/optimo/editing/program_index.h"

// A new name for a declared name, a new number for a sequence number: everywhere in the program,
// and only where the program stays the same. Everything else is refused with the reason: reserved
// words, variables of the machine, program numbers (the file has the number), a name that is
// reserved or taken in its first eight characters (OPT-7.46 to 7.48), a number that is taken.
namespace rmlcell::optimo::editing {

std::variant<machine::TextSpan, machine::Refusal> Renamable(const ProgramIndex& index,
                                                            std::size_t offset);

// Where the new name is to stand.
std::variant<std::vector<machine::TextSpan>, machine::Refusal> Rename(const ProgramIndex& index,
                                                                      std::size_t offset,
                                                                      const std::string& name);

}  // namespace rmlcell::optimo::editing
