#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"

namespace rmlcell {

// Which findings are repaired in one go: those with fixes that fit into the text and do not touch
// those of an earlier one. A finding is repaired whole or not at all.
std::vector<std::size_t> RepairableFindings(std::string_view text,
                                            std::span<const Diagnostic> diagnostics);

// The text with the fixes of these findings applied. Linear in text and fixes, but for their
// sorting.
std::string ApplyFixes(std::string_view text, std::span<const Diagnostic> diagnostics);

}  // namespace rmlcell
