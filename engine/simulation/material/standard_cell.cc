#include "engine/simulation/material/standard_cell.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::simulation {

double StandardCell(const Stock& block, const MillTool& tool) {
  constexpr double kUsual_mm = 0.1;
  constexpr double kCellsAcross = 4.0;  // the verdict wants three, and a rounded one is left over
  constexpr double kCells = 4194304.0;  // 16 MiB of heights
  const double least_mm =
      2.0 * (tool.shape == MillTool::Shape::kVee ? tool.tip_radius_mm : tool.radius_mm);
  if (!(least_mm > 0.0)) return kUsual_mm;
  const double area_mm2 = (block.x_max - block.x_min) * (block.y_max - block.y_min);
  return std::min(kUsual_mm, std::max(least_mm / kCellsAcross, std::sqrt(area_mm2 / kCells)));
}

}  // namespace rmlcell::simulation
