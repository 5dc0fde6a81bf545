#pragma once

#include <string>
#include <string_view>

#include "engine/machine/family.h"

namespace rmlcell::server {

// Whether the name of a program's file may stand for a program of this family: its extension is
// none of another one's. Error: CellInvalidArgument.
Status CheckFileFamily(const std::string& file_name, const machine::MachineFamily& family);

// Whether it is short enough for what file systems take. Error: CellInvalidArgument.
Status CheckFileName(std::string_view file_name, std::string_view field);

}  // namespace rmlcell::server
