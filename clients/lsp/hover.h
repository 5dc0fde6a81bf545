#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "clients/lsp/open_program.h"
#include "clients/lsp/protocol.h"
#include "engine/core/diagnostic.h"

namespace rmlcell::lsp {

// What stands at a place and what is wrong with it: instruction, attribute or function with its
// form and rule; sequence number; name; variable and what it is for; program that is called;
// laser process with its WORKDEF. `findings` are those of this text, or none.
// Null when there is nothing to say.
Json Hover(const OpenProgram& program, std::size_t offset, std::span<const Diagnostic> findings);

// The findings at a place alone; for documents that are no Optimo program.
Json HoverFindings(const Document& document, std::size_t offset,
                   std::span<const Diagnostic> findings);

}  // namespace rmlcell::lsp
