#include "engine/simulation/material/standard_cell.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::simulation {

namespace {

double NarrowestCut(const MillTool& tool) {
  constexpr double kEngraved_mm = 0.1;  // deep: a circuit board
  if (tool.shape != MillTool::Shape::kVee) return 2.0 * tool.radius_mm;
  return tool.tip_radius_mm > 0.0 ? 2.0 * tool.tip_radius_mm : WidthAt(tool, kEngraved_mm);
}

}  // namespace

double StandardCell(const Stock& block, const MillTool& tool) {
  constexpr double kUsual_mm = 0.1;
  constexpr double kCellsAcross = 4.0;  // the verdict wants three, and a rounded one is left over
  constexpr double kCells = 4194304.0;  // 16 MiB of heights
  const double least_mm = NarrowestCut(tool);
  const double area_mm2 = (block.x_max - block.x_min) * (block.y_max - block.y_min);
  return std::min(kUsual_mm, std::max(least_mm / kCellsAcross, std::sqrt(area_mm2 / kCells)));
}

}  // namespace rmlcell::simulation
