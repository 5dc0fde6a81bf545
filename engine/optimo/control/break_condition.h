#pragma once

#include <string_view>

#include "engine/core/result.h"
#include "engine/optimo/control/program_context.h"

namespace rmlcell::optimo {

// The condition of a breakpoint as an expression of the language: "VI[3] > 10". It has no names of
// a program; its PAR are those of the module in execution. Errors: CellInvalidArgument.
Result<Condition> ReadCondition(std::string_view text);

}  // namespace rmlcell::optimo
