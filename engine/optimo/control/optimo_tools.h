#pragma once

#include "engine/machine/tools.h"

namespace rmlcell::optimo {

// The tools of language and programmer (optimo.md chapters 1, 6, 8 and 9) behind the interface of
// machine families.
const machine::Tools& OptimoTools();

}  // namespace rmlcell::optimo
