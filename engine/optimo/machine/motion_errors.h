#pragma once

#include "engine/core/result.h"

namespace rmlcell::optimo {

// An error of engine/motion with the number that the Optimo gives it (optimo.md section C): 348,
// 7301, 7305, 7307, 7309. Any other is as it was.
[[gnu::cold]] Error OnOptimo(Error of_motion);

}  // namespace rmlcell::optimo
