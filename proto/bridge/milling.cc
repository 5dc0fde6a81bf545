#include "proto/bridge/milling.h"

#include <cmath>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/standard_cell.h"
#include "engine/simulation/material/stl.h"
#include "engine/simulation/material/target_files.h"
#include "rmlcell/v1/milling.pb.h"

namespace rmlcell::bridge {
namespace {

constexpr double kToleranceMax_mm = 1000.0;
constexpr int kFlutesMax = 100;
constexpr double kRpmMin = 1.0;
constexpr double kRpmMax = 1e6;
constexpr std::string_view kPngType = "image/png";
constexpr std::string_view kStlType = "model/stl";

Status CheckTolerance(const std::string& field, double tolerance_mm) {
  if (tolerance_mm >= 0.0 && tolerance_mm <= kToleranceMax_mm) return {};
  return InvalidArgument(Told("name", field) + " is " +
                         Told("value", tolerance_mm, "mm", ShortestText(tolerance_mm)) +
                         ", allowed are 0 to 1000");
}

Error Within(const std::string& field, const Error& error) {
  return {error.code, field + ": " + error.detail, {}};
}

Result<simulation::MillTool> FromProto(const v1::MillTool& tool) {
  simulation::MillTool made{.radius_mm = 0.5 * tool.diameter_mm(),
                            .flute_mm = tool.flute_mm(),
                            .shank_radius_mm = 0.5 * tool.shank_diameter_mm(),
                            .holder_radius_mm = 0.5 * tool.holder_diameter_mm(),
                            .holder_from_mm = tool.holder_from_mm(),
                            .flutes = tool.flutes()};
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
  if (tool.flutes() < 0 || tool.flutes() > kFlutesMax) {
    return InvalidArgument("tool.flutes is " + Told("value", tool.flutes()) +
                           ", allowed are 1 to 100, or 0 when it is not known");
  }
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

// What judges the chips of a tool. Errors: CellInvalidArgument.
Status SetChips(const v1::Milling& milling, simulation::Milling& made) {
  made.rpm = milling.rpm();
  if (made.rpm != 0.0 && !(made.rpm >= kRpmMin && made.rpm <= kRpmMax)) {
    return InvalidArgument("rpm is " + Told("speed", made.rpm, "rpm", ShortestText(made.rpm)) +
                           ", allowed are 1 to 1,000,000, or 0 for what the program says");
  }
  if (milling.material().empty()) return {};
  const auto chips = simulation::ChipsOf(milling.material(), 2.0 * made.tool.radius_mm);
  if (!chips) return Within("material", chips.error());
  made.chips = *chips;
  if (made.tool.flutes > 0) return {};
  return InvalidArgument(
      "tool.flutes is missing: what an edge takes off needs the edges of the tool (flutes=2)");
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
    return InvalidArgument("cell_mm is " +
                           Told("value", milling.cell_mm(), "mm", ShortestText(milling.cell_mm())) +
                           ": above 0, or 0 for what fits the tool");
  if (const Status body = CheckTolerance("stl_tolerance_mm", StlToleranceOf(milling)); !body)
    return body.error();
  const Result<simulation::MillTool> tool = FromProto(milling.tool());
  if (!tool) return tool.error();
  simulation::Milling made{.stock = FromProto(block, milling.cell_mm()), .tool = *tool};
  if (!(milling.cell_mm() > 0.0)) made.stock.cell = simulation::StandardCell(made.stock, *tool);
  if (const Status chips = SetChips(milling, made); !chips) return chips.error();
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
  tool_out.set_flutes(made->flutes);
  return {};
}

Status CheckTarget(const v1::MillTarget& target) {
  if (const Status tolerance = CheckTolerance("target.tolerance_mm", TargetToleranceOf(target));
      !tolerance)
    return tolerance.error();
  switch (target.source_case()) {
    case v1::MillTarget::kFile:
      break;
    case v1::MillTarget::kInlineProgram:
      if (!target.inline_program().content().empty()) return {};
      return Error{ErrorCode::kCellEmptyProgram, "target.inline_program", {}};
    case v1::MillTarget::kSlot:
      if (IsSlot(target.slot())) return {};
      return InvalidArgument("target.slot is " + Told("program", target.slot()) +
                             ", allowed are 1 to 99");
    case v1::MillTarget::SOURCE_NOT_SET:
      return InvalidArgument("target is missing: file, inline_program or slot");
  }
  const v1::TargetFile& file = target.file();
  if (file.content().empty()) return InvalidArgument("target.file.content is empty");
  const std::string& type = file.media_type();
  if (!type.empty() && type != kPngType && type != kStlType) {
    return InvalidArgument(
        "target.file.media_type: image/png or model/stl; a program stands in inline_program");
  }
  const bool is_png = simulation::IsPng(file.content());
  const bool named_png = type == kPngType || (type.empty() && file.file_name().ends_with(".png"));
  if (named_png && !is_png) {
    return Error{ErrorCode::kCellBadText, "target.file: no height map: it is no PNG", {}};
  }
  if (is_png && type != kStlType) return {};
  const Status begins = simulation::CheckStlBeginning(file.content());
  return begins ? begins : Within("target.file", begins.error());
}

void SetTargetFile(std::string file_name, std::string bytes, v1::MillTarget& target) {
  if (simulation::IsTargetFile(bytes, file_name)) {
    target.mutable_file()->set_file_name(std::move(file_name));
    target.mutable_file()->set_content(std::move(bytes));
  } else {
    target.mutable_inline_program()->set_file_name(std::move(file_name));
    target.mutable_inline_program()->set_content(std::move(bytes));
  }
}

std::string TargetMediaType(const v1::MillTarget& target) {
  return std::string(simulation::IsPng(target.file().content()) ? kPngType : kStlType);
}

double TargetToleranceOf(const v1::MillTarget& target) {
  return target.has_tolerance_mm() ? target.tolerance_mm() : kTargetToleranceStandard_mm;
}

double StlToleranceOf(const v1::Milling& milling) {
  return milling.has_stl_tolerance_mm() ? milling.stl_tolerance_mm() : simulation::kStlTolerance_mm;
}

v1::HeightGrid ToProto(const simulation::HeightGridHead& head, int level) {
  const simulation::HeightField::Size size = simulation::SizeAtLevel(head.size, level);
  v1::HeightGrid grid;
  grid.set_level(level);
  grid.set_columns(static_cast<int>(size.columns));
  grid.set_rows(static_cast<int>(size.rows));
  grid.set_left_mm(head.left);
  grid.set_front_mm(head.front);
  grid.set_cell_mm(std::ldexp(head.cell, level));
  grid.set_bottom_mm(head.bottom);
  grid.set_top_mm(head.top);
  return grid;
}

v1::HeightTile ToProto(simulation::HeightTile tile) {
  v1::HeightTile message;
  message.set_column(static_cast<int>(tile.column));
  message.set_row(static_cast<int>(tile.row));
  message.set_columns(static_cast<int>(tile.columns));
  message.set_rows(static_cast<int>(tile.rows));
  message.set_heights(std::move(tile.heights));
  return message;
}

}  // namespace rmlcell::bridge
