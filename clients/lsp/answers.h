#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clients/lsp/document.h"
#include "clients/lsp/protocol.h"
#include "engine/machine/editing.h"

// What a family says about a text (machine::EditedProgram), in the objects of the protocol.
namespace rmlcell::lsp {

// A Hover: the note on what stands at `offset`, and the findings there with what to do about them;
// null when there is neither. `editing` null: a stream, which has findings alone.
Json HoverAnswer(const Document& document, std::size_t offset,
                 const std::optional<machine::HoverNote>& note,
                 std::span<const Diagnostic> findings, const machine::Editing* editing);

Json Locations(const Document& document, const machine::Places& places);
Json Highlights(const Document& document, std::span<const machine::Highlight> highlights);
// A CompletionList.
Json CompletionList(const Document& document, const machine::Suggestions& suggestions);
// A range and what stands there.
Json RenamePlace(const Document& document, const machine::TextSpan& span);
// A WorkspaceEdit.
Json RenameEdits(const Document& document, std::span<const machine::TextSpan> places,
                 std::string_view name);
// DocumentSymbol objects; `nested` false: SymbolInformation, flat.
Json Symbols(const Document& document, std::span<const machine::OutlinePart> outline, bool nested);
Json FoldingRanges(std::span<const machine::FoldedLines> folds);

}  // namespace rmlcell::lsp
