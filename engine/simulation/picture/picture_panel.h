#pragma once

#include <string>

#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture_path.h"
#include "engine/simulation/picture/picture_view.h"

namespace rmlcell::simulation {

// Room on a page of panels, px: their rulers, and the gap to the column of figures.
inline constexpr double kRulerLeft = 58.0;
inline constexpr double kRulerBelow = 44.0;
inline constexpr double kColumnGap = 34.0;

// What all panels of a page have in common.
struct PanelContent {
  const PathSketch& sketch;
  const machine::MachineShape& shape;
  DepthRange depth;
  bool completed = true;
  std::size_t elements_max = 0;  // of one panel
};

// Opens a panel: paper, grid and rulers, travel of the machine. What is drawn then is clipped to
// it.
void BeginPanel(const machine::MachineShape& shape, const Panel& panel, int id, std::string& out);
// Closes it: frame, title, axes or scale bar. `nothing`: says that nothing moved.
void EndPanel(const Panel& panel, bool nothing, std::string& out);

// Appends one panel: frame, grid and rulers, envelope of the machine, path, dots, start and end,
// scale bar. `id` is unique on the page. Returns the number of path elements.
std::size_t DrawPanel(const PanelContent& content, const Panel& panel, int id, std::string& out);

}  // namespace rmlcell::simulation
