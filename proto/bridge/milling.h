#pragma once

#include <string>

#include "engine/simulation/material/milling_recorder.h"

namespace rmlcell::v1 {
class Milling;
}  // namespace rmlcell::v1

// Block and tool of a job, as the engine and as people have them.
namespace rmlcell::bridge {

inline constexpr double kCellStandard_mm = 0.1;

// Errors: CellInvalidArgument that begins with the field below the message that is wrong: "stock",
// "tool.shape". A milling without error can be simulated.
Result<simulation::Milling> FromProto(const v1::Milling& milling);

// Block and tool from the texts of the command line (material/milling_text.h). Errors:
// CellInvalidArgument.
Status SetBlockAndTool(const std::string& stock, const std::string& tool, v1::Milling& milling);

// How far the body of the job may be off, mm.
double StlToleranceOf(const v1::Milling& milling);

}  // namespace rmlcell::bridge
