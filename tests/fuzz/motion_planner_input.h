#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace rmlcell::motion {

// Reads bytes as moves, plans them, and looks at what comes out. Empty when nothing is wrong.
std::string PlanBytes(std::span<const std::uint8_t> bytes);

}  // namespace rmlcell::motion
