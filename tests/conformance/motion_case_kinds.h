#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace rmlcell::motion {

using Figures = std::map<std::string, double>;

// The figures of one case of motion.md section 12, computed by the engine from its input; nothing
// when the kind of case belongs to another room (clip, sweep). Throws nlohmann::json::exception on
// malformed input.
std::optional<Figures> Compute(const nlohmann::json& input);

}  // namespace rmlcell::motion
