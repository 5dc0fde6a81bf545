#pragma once

#include <string>

#include "rmlcell/v1/cell.pb.h"

namespace rmlcell::cli {

// What happened at a machine, as a line of its log without the time: "anna: override 55 %". Empty:
// nothing that belongs there, such as what a job tells of inputs, which its machine tells, too.
std::string MachineLogLine(const v1::CellEvent& event);

}  // namespace rmlcell::cli
