#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "engine/simulation/material/height_field.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// What should be left of a block.
struct Target {
  // A height over each cell, row by row from y_min on, as HeightField::heights; not a number where
  // it says nothing.
  std::shared_ptr<const std::vector<float>> heights;
  double tolerance_mm = 0.1;
};

// Cell by cell: a cell is too deep when it is below all target heights of its own cell and the
// eight around it, and has too much on it when it is above all of them. So a wall may stand off by
// a cell, which is as exact as the heights are. Precondition: the target has the cells of the
// field.
TargetFigures CompareWithTarget(const HeightField& field, const Target& target);

// The same as a picture (PNG), the greatest Y above: red where it is too deep and blue where
// material is left, the stronger the more, grey within the tolerance, white where the target says
// nothing. The bytes are valid during the call of `sink`; it returns false when it wants no more,
// and so does this.
bool WriteDifference(const HeightField& field, const Target& target,
                     const std::function<bool(std::string_view)>& sink);

}  // namespace rmlcell::simulation
