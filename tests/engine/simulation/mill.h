#pragma once

#include "engine/families/families.h"

namespace rmlcell::simulation {

inline const machine::MachineFamily& Mill() { return *families::FindFamily("rml1"); }

}  // namespace rmlcell::simulation
