#pragma once

#include <span>
#include <string_view>

#include "engine/machine/family.h"

// The product's own programs 1, 2, 4 and 90. The control delivers none, and the manual's programs
// call Amada's: these do what the manual says of them (OPT-10.12, OPT-B.82 to B.84). Stored only
// when asked for.
namespace rmlcell::optimo {

// SENSOR CALIBRATION (1), Z-UP (2), HOME RETURN (4) and TCP (90), by slot; metric.
std::span<const machine::SpecialProgram> HousePrograms();

// Whether a text is the one of this slot, to the byte.
bool IsHouseProgram(int slot, std::string_view text);

}  // namespace rmlcell::optimo
