#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"

namespace rmlcell::cli {

// Findings with the source line of each and a caret below it; `source` may be empty.
// To standard output: they are what was asked for.
void PrintFindings(const std::vector<Diagnostic>& findings, std::uint64_t dropped,
                   std::string_view source);
// To standard error: something else was asked for.
void ComplainOf(const std::vector<Diagnostic>& findings, std::uint64_t dropped,
                std::string_view source);

// Says why nothing is done, and gives the exit code of a wrong use or an unreadable file.
int Refuse(const Error& error);

}  // namespace rmlcell::cli
