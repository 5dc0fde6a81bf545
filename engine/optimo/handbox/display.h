#pragma once

#include "engine/machine/machine_status.h"
#include "engine/machine/panel.h"

namespace rmlcell::optimo {

// Display and lamps of the handbox. The display has 20 characters, blanks while there is no power:
// program, step and instruction (OPT-4.02), or the number of the message in their place (OPT-4.06).
machine::Panel ShowHandbox(const machine::MachineStatus& status);

}  // namespace rmlcell::optimo
