#pragma once

#include <string>

#include "engine/machine/family.h"

namespace rmlcell::server {

// Which lines the steps of its programs are, as far as their texts are here, as a
// GetStepMapResponse; nothing for streams, which have no steps.
std::string StepMapOf(const machine::MachineFamily& family, const machine::RunSetup& setup);

}  // namespace rmlcell::server
