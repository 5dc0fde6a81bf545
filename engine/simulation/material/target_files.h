#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "engine/simulation/material/height_field.h"
#include "engine/simulation/material/height_map.h"
#include "engine/simulation/material/stl_reader.h"

// Target heights over the cells of a block (Target::heights) out of what other programs write.
// Precondition of all: CheckStock(stock) is well.
namespace rmlcell::simulation {

// The heights of a map under the centres of the cells; it says nothing beyond its edges.
std::vector<float> TargetOfMap(const HeightMap& map, const Stock& stock);

// Asked now and then: false gives the target up. Empty: it is wanted whatever happens.
using StillWanted = std::function<bool()>;

// The highest point of a body over the centre of each cell, in mm from the work origin. Within the
// body's extent in X and Y, cells that it does not cover are to be cut through; beyond, it says
// nothing. Errors: CellTooLarge for a body that lies over itself so often that it would take
// for ever, CellInvalidArgument for one that lies beside the block, CellCancelled when it is not
// wanted any more.
Result<std::vector<float>> TargetOfBody(const std::vector<StlTriangle>& body, const Stock& stock,
                                        const StillWanted& wanted = {});

// Either, of the bytes of a file: a PNG as WriteHeightMap writes it, or an STL. Errors: theirs.
Result<std::vector<float>> ReadTarget(std::string_view bytes, const Stock& stock,
                                      const StillWanted& wanted = {});
bool IsPng(std::string_view bytes);

// Whether a target is such a file; else it is a program.
bool IsTargetFile(std::string_view bytes, std::string_view file_name);

}  // namespace rmlcell::simulation
