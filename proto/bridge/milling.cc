#include "proto/bridge/milling.h"

#include "engine/core/number_text.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/stl.h"
#include "rmlcell/v1/milling.pb.h"

namespace rmlcell::bridge {
namespace {

constexpr double kStlToleranceMax_mm = 1000.0;

Error Within(const std::string& field, const Error& error) {
  return InvalidArgument(field + ": " + error.detail);
}

Result<simulation::MillTool> FromProto(const v1::MillTool& tool) {
  simulation::MillTool made{.radius_mm = 0.5 * tool.diameter_mm(),
                            .flute_mm = tool.flute_mm(),
                            .shank_radius_mm = 0.5 * tool.shank_diameter_mm(),
                            .holder_radius_mm = 0.5 * tool.holder_diameter_mm(),
                            .holder_from_mm = tool.holder_from_mm()};
  switch (tool.shape()) {
    case v1::MillTool::SHAPE_FLAT:
      made.shape = simulation::MillTool::Shape::kFlat;
      break;
    case v1::MillTool::SHAPE_BALL:
      made.shape = simulation::MillTool::Shape::kBall;
      break;
    case v1::MillTool::SHAPE_VEE:
      made.shape = simulation::MillTool::Shape::kVee;
      made.half_angle_rad = 0.5 * tool.angle_rad();
      made.tip_radius_mm = 0.5 * tool.tip_diameter_mm();
      break;
    default:
      return InvalidArgument("tool.shape is missing: SHAPE_FLAT, SHAPE_BALL or SHAPE_VEE");
  }
  if (made.shape != simulation::MillTool::Shape::kVee &&
      (tool.angle_rad() != 0.0 || tool.tip_diameter_mm() != 0.0))
    return InvalidArgument("tool: angle_rad and tip_diameter_mm are for SHAPE_VEE");
  if (const Status sound = simulation::CheckTool(made); !sound)
    return Within("tool", sound.error());
  return made;
}

simulation::Stock FromProto(const v1::Stock& stock, double cell_mm) {
  return {.x_min = stock.left_mm(),
          .x_max = stock.left_mm() + stock.size_x_mm(),
          .y_min = stock.front_mm(),
          .y_max = stock.front_mm() + stock.size_y_mm(),
          .bottom = stock.top_mm() - stock.size_z_mm(),
          .top = stock.top_mm(),
          .cell = cell_mm};
}

v1::MillTool::Shape ToProto(simulation::MillTool::Shape shape) {
  switch (shape) {
    case simulation::MillTool::Shape::kFlat:
      return v1::MillTool::SHAPE_FLAT;
    case simulation::MillTool::Shape::kBall:
      return v1::MillTool::SHAPE_BALL;
    case simulation::MillTool::Shape::kVee:
      return v1::MillTool::SHAPE_VEE;
  }
  return v1::MillTool::SHAPE_UNSPECIFIED;
}

}  // namespace

Result<simulation::Milling> FromProto(const v1::Milling& milling) {
  if (!milling.has_stock()) return InvalidArgument("stock is missing: say how large the block is");
  if (!milling.has_tool()) return InvalidArgument("tool is missing: say what mills the block");
  const v1::Stock& block = milling.stock();
  for (const double size_mm : {block.size_x_mm(), block.size_y_mm(), block.size_z_mm()}) {
    if (!(size_mm > 0.0))
      return InvalidArgument("stock: size_x_mm, size_y_mm and size_z_mm are above 0");
  }
  if (!(milling.cell_mm() >= 0.0))
    return InvalidArgument("cell_mm is " + ShortestText(milling.cell_mm()) +
                           ": above 0, or 0 for 0.1");
  const double tolerance_mm = StlToleranceOf(milling);
  if (!(tolerance_mm >= 0.0 && tolerance_mm <= kStlToleranceMax_mm))
    return InvalidArgument("stl_tolerance_mm is " + ShortestText(tolerance_mm) +
                           ", allowed are 0 to 1000");
  const Result<simulation::MillTool> tool = FromProto(milling.tool());
  if (!tool) return tool.error();
  const double cell_mm = milling.cell_mm() > 0.0 ? milling.cell_mm() : kCellStandard_mm;
  simulation::Milling made{.stock = FromProto(block, cell_mm), .tool = *tool};
  if (const Status sound = simulation::CheckMilling(made); !sound)
    return Within("stock", sound.error());
  return made;
}

Status SetBlockAndTool(const std::string& stock, const std::string& tool, v1::Milling& milling) {
  const Result<simulation::Stock> block = simulation::ParseStock(stock);
  if (!block) return block.error();
  const Result<simulation::MillTool> made = simulation::ParseTool(tool);
  if (!made) return made.error();
  v1::Stock& block_out = *milling.mutable_stock();
  block_out.set_size_x_mm(block->x_max - block->x_min);
  block_out.set_size_y_mm(block->y_max - block->y_min);
  block_out.set_size_z_mm(block->top - block->bottom);
  block_out.set_left_mm(block->x_min);
  block_out.set_front_mm(block->y_min);
  block_out.set_top_mm(block->top);
  v1::MillTool& tool_out = *milling.mutable_tool();
  tool_out.set_shape(ToProto(made->shape));
  tool_out.set_diameter_mm(2.0 * made->radius_mm);
  tool_out.set_angle_rad(2.0 * made->half_angle_rad);
  tool_out.set_tip_diameter_mm(2.0 * made->tip_radius_mm);
  tool_out.set_flute_mm(made->flute_mm);
  tool_out.set_shank_diameter_mm(2.0 * made->shank_radius_mm);
  tool_out.set_holder_diameter_mm(2.0 * made->holder_radius_mm);
  tool_out.set_holder_from_mm(made->holder_from_mm);
  return {};
}

double StlToleranceOf(const v1::Milling& milling) {
  return milling.has_stl_tolerance_mm() ? milling.stl_tolerance_mm() : simulation::kStlTolerance_mm;
}

}  // namespace rmlcell::bridge
