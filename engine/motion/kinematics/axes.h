#pragma once

#include <array>
#include <cstddef>

#include "engine/motion/kinematics/kinematics.h"

namespace rmlcell::motion {

// All axes, and those that move the column, for loops over AxisValues.
inline constexpr std::array<std::size_t, kAxisCount> kAxes{0, 1, 2, 3, 4};  // X Y Z A B
inline constexpr std::array<std::size_t, 3> kLinearAxes{0, 1, 2};

}  // namespace rmlcell::motion
