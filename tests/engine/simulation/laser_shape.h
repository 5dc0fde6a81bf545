#pragma once

#include "engine/machine/shape.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::simulation {

// The five-axis laser as delivered, without limits of travel.
inline machine::MachineShape Laser() {
  machine::MachineShape shape;
  shape.five_axis = true;
  shape.limits = motion::StandardMachine();
  shape.laser_watts = 1500.0;
  return shape;
}

}  // namespace rmlcell::simulation
