#pragma once

#include <nlohmann/json_fwd.hpp>

#include "clients/lsp/document.h"
#include "clients/lsp/program_index.h"
#include "clients/lsp/protocol.h"

namespace rmlcell::lsp {

// Steps are listed in the outline of a program of at most so many: more is no outline any more.
inline constexpr std::uint32_t kOutlineStepsMax = 2000;

// DocumentSymbol objects: declared names, then the part before the first sequence number and a part
// for each sequence number, with their steps inside. `nested` false: SymbolInformation, flat.
Json Symbols(const Document& document, const ProgramIndex& index, bool nested);

// FoldingRange objects: comments in a row, statements over several lines, declarations in a row,
// WORK ON to its OFF, subroutines from their sequence number to RETURN.
Json FoldingRanges(const Document& document, const ProgramIndex& index);

}  // namespace rmlcell::lsp
