#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"

namespace rmlcell::cli {

// Findings with the source line of each and a caret below it; `source` may be empty.
// To standard output: they are what was asked for.
void PrintFindings(const std::vector<Diagnostic>& findings, std::uint64_t dropped, std::string_view source);
// To standard error: something else was asked for.
void ComplainOf(const std::vector<Diagnostic>& findings, std::uint64_t dropped, std::string_view source);

}  // namespace rmlcell::cli
