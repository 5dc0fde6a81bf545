#pragma once

#include <string>

#include "rmlcell/v1/cell.pb.h"

namespace rmlcell::cli {

// "override 55 %": what acted on a machine, whoever did it.
std::string InputText(const v1::AppliedInput& input);

// What happened at a machine, as a line of its log without the time of day: "anna: override 55 %
// [12.5 s]". Empty: nothing that belongs there, such as a change of its record.
std::string MachineLogLine(const v1::CellEvent& event);

}  // namespace rmlcell::cli
