#pragma once

#include <string_view>

#include "engine/simulation/material/milling_recorder.h"

// How people write a block and a tool. Errors: CellInvalidArgument, with an example.
namespace rmlcell::simulation {

// "100x80x10": 100 mm along X and 80 along Y from the work origin, its top at Z 0 and 10 mm thick.
// "100x80x10@-5,-5,2": its corner of least X and Y at (-5, -5), its top at Z 2.
Result<Stock> ParseStock(std::string_view text);

// "flat:3" and "ball:3" by diameter; "vee:6:60" by diameter and the angle between its flanks in
// degrees, "vee:6:60:0.2" with the diameter of its flat tip. mm. "cone" and "engrave" are other
// words for "vee", "end" for "flat". What is above may follow: "flat:3:flute=12:shank=6" cuts for
// 12 mm and is 6 mm wide above them, ":holder=20@25" adds a holder of 20 mm that begins at 25 mm.
Result<MillTool> ParseTool(std::string_view text);

}  // namespace rmlcell::simulation
