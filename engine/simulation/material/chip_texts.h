#pragma once

#include <string_view>

namespace rmlcell::simulation {

// chip_loads.toml as it was when this was built.
std::string_view ChipLoadText();

}  // namespace rmlcell::simulation
