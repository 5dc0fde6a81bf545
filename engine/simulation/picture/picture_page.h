#pragma once

#include <string>

#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture_view.h"

namespace rmlcell::simulation {

// One SVG document: title and result above, the panels, and beside them figures, legend and where
// on the machine the part lies.
std::string PicturePage(const PathSketch& sketch, const machine::MachineShape& shape,
                        const RunReport& report, const PictureOptions& options);

// "12.345 s", "4 min 05.2 s", "2 h 03 min 04 s".
std::string DurationText(SimTime time);

}  // namespace rmlcell::simulation
