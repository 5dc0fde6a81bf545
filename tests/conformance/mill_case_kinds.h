#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tests/conformance/motion_case_kinds.h"

namespace rmlcell::motion {

// The figures of a case of the mill: paths, clipping, material. Nothing when `f` is no such kind.
// Throws SenselessCase for input that no machine could have.
std::optional<Figures> ComputeMill(const std::string& f, const nlohmann::json& input);

}  // namespace rmlcell::motion
