#pragma once

#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "rmlcell/v1/report.pb.h"

// A toolpath as it is kept (frames of blocks, proto/bridge/framing.h) at other levels of detail
// (motion.md section 9).
namespace rmlcell::server {

// Error: CellInvalidArgument.
Status CheckToolpathLevel(int level);

// Level 0 is the one that is kept, made with `stored_mm`. One that is cut off ends where it does.
std::string ToolpathAtLevel(std::string_view frames, double stored_mm, int level);

// What the header says of a toolpath of `bytes` at `level`.
void SetLevel(double stored_mm, int level, std::size_t bytes, v1::ToolpathHeader& header);
// How large each level is: all of them are made for it.
void AddLevels(std::string_view frames, double stored_mm, v1::ToolpathHeader& header);

}  // namespace rmlcell::server
