#pragma once

#include <string>

#include "engine/machine/family.h"

namespace rmlcell::server {

// Whether the name of a program's file may stand for a program of this family: its extension is
// none of another one's. Error: CellInvalidArgument.
Status CheckFileFamily(const std::string& file_name, const machine::MachineFamily& family);

}  // namespace rmlcell::server
