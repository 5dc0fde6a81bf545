#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// The change that takes an attribute out of a statement, with its '/' and the blanks before it;
// nothing when the statement does not have it.
std::optional<Fix> AttributeRemoval(const ParsedProgram& program, const Instruction& instruction,
                                    Word word);

// Which findings are repaired in one go: those with fixes that fit into the text and do not touch
// those of an earlier one. A finding is repaired whole or not at all.
std::vector<std::size_t> RepairableFindings(std::string_view text,
                                            std::span<const Diagnostic> diagnostics);

// The text with the fixes of these findings applied. Linear in text and fixes, but for their
// sorting.
std::string ApplyFixes(std::string_view text, std::span<const Diagnostic> diagnostics);

}  // namespace rmlcell::optimo
