#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

#include "clients/lsp/open_program.h"
#include "clients/lsp/protocol.h"

// A new name for a declared name, a new number for a sequence number: everywhere in the program,
// and only where the program stays the same. Everything else is refused with the reason: reserved
// words, variables of the machine, program numbers (the file has the number), a name that is
// reserved or taken in its first eight characters (OPT-7.46 to 7.48), a number that is taken.
namespace rmlcell::lsp {

// What can be renamed at a place: range and present name.
std::variant<Json, RequestError> PrepareRename(const OpenProgram& program, std::size_t offset);

// A WorkspaceEdit.
std::variant<Json, RequestError> Rename(const OpenProgram& program, std::size_t offset,
                                        const std::string& new_name);

}  // namespace rmlcell::lsp
