#pragma once

#include <vector>

#include "engine/machine/run.h"
#include "engine/optimo/control/program_context.h"
#include "engine/optimo/machine/machine_state.h"

namespace rmlcell::optimo {

// What holds until it is changed, as the language writes it: COORD, PATH, SPEED, ACCEL, OVERSH,
// UPDATE, IMAGE of a program; TCP and SYSDEF of the machine.
std::vector<machine::ModalValue> ModalValuesOf(const Modal& modal);
std::vector<machine::ModalValue> ModalValuesOf(const ToolState& tool,
                                               const WorkOffsetState& offset);

}  // namespace rmlcell::optimo
