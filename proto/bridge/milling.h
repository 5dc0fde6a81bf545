#pragma once

#include <string>

#include "engine/simulation/material/height_tiles.h"
#include "engine/simulation/material/milling_recorder.h"

namespace rmlcell::v1 {
class HeightGrid;
class HeightTile;
class MillTarget;
class Milling;
}  // namespace rmlcell::v1

// Block, tool and target of a job, as the engine and as people have them.
namespace rmlcell::bridge {

inline constexpr double kTargetToleranceStandard_mm = 0.1;

// Without the target: its heights are not in the message, they are made where the job is. Errors:
// CellInvalidArgument that begins with the field below the message that is wrong: "stock",
// "tool.shape". A milling without error can be simulated.
Result<simulation::Milling> FromProto(const v1::Milling& milling);

// A target as it is handed in, with its bytes; whether they can be read to their end shows when the
// job begins. Errors begin with the field likewise, "target.file": CellInvalidArgument,
// CellEmptyProgram, CellBadText for a file that does not begin as it says.
Status CheckTarget(const v1::MillTarget& target);

// A file of the command line: heights, a body, or else a program for this target alone.
void SetTargetFile(std::string file_name, std::string bytes, v1::MillTarget& target);

// "image/png", "model/stl". Precondition: CheckTarget was well.
std::string TargetMediaType(const v1::MillTarget& target);

double TargetToleranceOf(const v1::MillTarget& target);

// Block and tool from the texts of the command line (material/milling_text.h). Errors:
// CellInvalidArgument.
Status SetBlockAndTool(const std::string& stock, const std::string& tool, v1::Milling& milling);

// How far the body of the job may be off, mm.
double StlToleranceOf(const v1::Milling& milling);

// Heights of a block at a level.
v1::HeightGrid ToProto(const simulation::HeightGridHead& head, int level);
v1::HeightTile ToProto(simulation::HeightTile tile);

}  // namespace rmlcell::bridge
