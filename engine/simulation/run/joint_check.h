#pragma once

#include <span>

#include "engine/simulation/run/rehearsal.h"

namespace rmlcell::simulation {

// One of several programs that are checked together.
struct JointProgram {
  MemoryProgram program{};  // translated without errors; slot 0: it may stand in any
  MotionCheck motion{};     // what the check found in it, and up to where it was followed
};

// The motion of programs of one family that may call each other, as the files of a command line do:
// they make one program memory, each in its slot or in a free one (its `slot` tells afterwards). Of
// several that want the same slot the first is there for the others; each of the rest is looked at
// alone in its place. Errors: those of MachineFamily::NewRun.
Status CheckTogether(const machine::MachineFamily& family, const machine::Parameters& parameters,
                     std::span<JointProgram> programs, const machine::InputScript& inputs);

}  // namespace rmlcell::simulation
