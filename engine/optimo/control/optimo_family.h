#pragma once

#include "engine/machine/family.h"

namespace rmlcell::optimo {

// The Amada OPTIMO 5-axis laser.
const machine::MachineFamily& OptimoFamily();

}  // namespace rmlcell::optimo
