#pragma once

#include <cstddef>
#include <ranges>

#include "engine/motion/kinematics.h"

namespace rmlcell::motion {

// All axes, and those that move the column, for loops over AxisValues.
inline constexpr auto kAxes = std::views::iota(std::size_t{0}, std::size_t{kAxisCount});
inline constexpr auto kLinearAxes = std::views::iota(std::size_t{0}, std::size_t{3});  // X Y Z

}  // namespace rmlcell::motion
