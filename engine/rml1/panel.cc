#include "engine/rml1/panel.h"

namespace rmlcell::rml1 {

machine::Panel ShowMillPanel(const machine::MachineStatus& status) {
  machine::Panel panel;
  if (status.state == machine::MachineState::kOff) return panel;
  panel.lamps.push_back("POWER");
  if (status.state == machine::MachineState::kHeld) panel.lamps.push_back("PAUSE");
  if (status.run.spindle_on) panel.lamps.push_back("SPINDLE");
  return panel;
}

}  // namespace rmlcell::rml1
