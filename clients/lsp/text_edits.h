#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "clients/lsp/check.h"
#include "clients/lsp/document.h"
#include "clients/lsp/protocol.h"

// Changes to a document that the editor carries out.
namespace rmlcell::lsp {

// TextEdit objects that bring a program into canonical layout, line by line, so that cursors and
// marks of the editor stay; empty when it is, when it cannot be parsed, and for streams.
Json FormattingEdits(const Document& document);

// CodeAction objects for `range`: the fixes of findings there, all fixes of the text as `rmlcell
// check --fix` applies them in one go, and a directive that silences a warning on its line.
// `only`: kinds of action that are wanted; null or empty: all.
Json CodeActions(const Document& document, const Findings& findings, const Range& range,
                 const Json* only);

}  // namespace rmlcell::lsp
