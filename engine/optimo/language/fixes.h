#pragma once

#include <optional>
#include <string_view>

#include "engine/core/diagnostic.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// The change that takes an attribute out of a statement, with its '/' and the blanks before it;
// nothing when the statement does not have it.
std::optional<Fix> AttributeRemoval(const ParsedProgram& program, const Instruction& instruction,
                                    Word word);

}  // namespace rmlcell::optimo
