#pragma once

#include <functional>
#include <string_view>

#include "engine/simulation/material/height_field.h"

namespace rmlcell::simulation {

// Writes what is left of a block as binary STL, little-endian, mm: a closed body with a vertex over
// the centre of each cell, walls and a flat base. motion.md section 9. The bytes are valid during
// the call of `sink`; it returns false when it wants no more, and so does this.
bool WriteStl(const HeightField& field, const std::function<bool(std::string_view)>& sink);

}  // namespace rmlcell::simulation
