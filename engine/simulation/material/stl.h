#pragma once

#include <functional>
#include <string_view>

#include "engine/simulation/material/height_field.h"
#include "engine/simulation/material/parallel_for.h"

namespace rmlcell::simulation {

// As coarse as a mill's own steps: finer is neither seen nor felt.
inline constexpr double kStlTolerance_mm = 0.01;

// Writes what is left of a block as binary STL, little-endian, mm: a closed body of the outer
// measures of its cells, with walls and a flat base, seen counter-clockwise from outside. Its
// surface is nowhere further than the tolerance above or below that of the heights, which lie over
// the centres of the cells; plane ground is two triangles (surface_patches.h). motion.md section 9.
// The bytes are valid during the call of `sink`; it returns false when it wants no more, and so
// does this. While nothing is ready yet it is asked with no bytes, some times a second. `parallel`
// looks at several parts of the surface at the same time; null: one after the other. The bytes are
// the same. Precondition: the tolerance is not below 0.
bool WriteStl(const HeightField& field, double tolerance_mm,
              const std::function<bool(std::string_view)>& sink, ParallelFor* parallel = nullptr);

}  // namespace rmlcell::simulation
