#pragma once

#include <nlohmann/json_fwd.hpp>

#include "clients/lsp/open_program.h"
#include "clients/lsp/protocol.h"

namespace rmlcell::lsp {

// What may stand at a place, as a CompletionList: instructions where a statement begins, then
// attributes of that instruction behind a slash, sequence numbers behind a jump, programs of the
// folder behind CALL, kinds of path, variables and names in expressions. What is typed already
// narrows the list. In comments only the directives for compensation and silencing.
Json Complete(const OpenProgram& program, std::size_t offset);

}  // namespace rmlcell::lsp
