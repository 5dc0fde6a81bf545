#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "clients/lsp/open_program.h"
#include "clients/lsp/protocol.h"

// Where things are, and where they are used. Sequence numbers and names belong to one program;
// programs are found in its folder.
namespace rmlcell::lsp {

// The uses in this program that mean the same as `use`, in order of the text: a sequence number and
// the jumps to it, a name, a variable, a program number, a process word alone.
std::vector<const Use*> SameUses(const ProgramIndex& index, const Use& use);

// Locations: the sequence number of a jump, the DECLARE of a name, the file of a called program,
// the WORKDEF of a WORK. Empty when it is nowhere.
Json Definition(const OpenProgram& program, std::size_t offset);

// Locations in this program; of a program number in all programs of the folder.
Json References(const OpenProgram& program, std::size_t offset, bool with_declaration);

// DocumentHighlight objects of the same thing in this program.
Json Highlights(const OpenProgram& program, std::size_t offset);

}  // namespace rmlcell::lsp
