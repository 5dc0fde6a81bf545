#pragma once

#include "engine/machine/machine_status.h"
#include "engine/machine/panel.h"

namespace rmlcell::rml1 {

// The lamps of a mill: POWER, PAUSE (a run is open and stands), SPINDLE (turns). What their
// displays show the manuals do not say.
machine::Panel ShowMillPanel(const machine::MachineStatus& status);

}  // namespace rmlcell::rml1
