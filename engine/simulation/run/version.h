#pragma once

#include <string_view>

namespace rmlcell::simulation {

// The version of the engine, which every report carries: the same inputs give the same report
// within one version. A test compares it with the version of the project.
inline constexpr std::string_view kEngineVersion = "0.1.0";

}  // namespace rmlcell::simulation
