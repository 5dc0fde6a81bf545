#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/core/result.h"

namespace rmlcell::motion {

using Figures = std::map<std::string, double>;

// The figures of one case of motion.md section 12, computed by the engine from its input. Errors:
// CellInvalidArgument for a kind of case that there is not, and for input that no machine could
// have, such as a speed of 0. Throws nlohmann::json::exception on malformed input.
Result<Figures> Compute(const nlohmann::json& input);

}  // namespace rmlcell::motion
