#include "engine/simulation/material/mill_tool.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

// What is above the cutting end.
Status CheckShank(const MillTool& tool) {
  for (const double value :
       {tool.flute_mm, tool.shank_radius_mm, tool.holder_radius_mm, tool.holder_from_mm}) {
    if (!(value >= 0.0) || !std::isfinite(value))
      return InvalidArgument("measures of a tool are above 0 mm");
  }
  constexpr double kLastDigits_mm = 1e-9;  // a ball of 3 mm may cut for 1.5 mm
  if (tool.flute_mm > 0.0 && tool.flute_mm < ShapeHeight(tool) - kLastDigits_mm) {
    return InvalidArgument(
        "the tool cuts for " + Told("length", tool.flute_mm, "mm", ShortestText(tool.flute_mm)) +
        " mm, and its end alone is " +
        Told("least", ShapeHeight(tool), "mm", TrimmedText(ShapeHeight(tool), 3)) +
        " mm high: make flute longer");
  }
  if (tool.shank_radius_mm > 0.0 && !(tool.flute_mm > 0.0))
    return InvalidArgument("a shank begins where the tool ceases to cut: say flute=LENGTH, too");
  if (tool.holder_radius_mm > 0.0 && tool.holder_from_mm < tool.flute_mm)
    return InvalidArgument("the holder begins below the end of what cuts");
  return {};
}

}  // namespace

double ShapeHeight(const MillTool& tool) {
  switch (tool.shape) {
    case MillTool::Shape::kFlat:
      return 0.0;
    case MillTool::Shape::kBall:
      return tool.radius_mm;
    case MillTool::Shape::kVee:
      return (tool.radius_mm - tool.tip_radius_mm) / std::tan(tool.half_angle_rad);
  }
  return 0.0;
}

double WidthAt(const MillTool& tool, double height_mm) {
  const double height = std::min(height_mm, ShapeHeight(tool));
  switch (tool.shape) {
    case MillTool::Shape::kFlat:
      return 2.0 * tool.radius_mm;
    case MillTool::Shape::kBall:
      return 2.0 * std::sqrt(height * (2.0 * tool.radius_mm - height));
    case MillTool::Shape::kVee:
      return 2.0 * (tool.tip_radius_mm + height * std::tan(tool.half_angle_rad));
  }
  return 0.0;
}

Status CheckTool(const MillTool& tool) {
  if (!(tool.radius_mm > 0.0) || !std::isfinite(tool.radius_mm))
    return InvalidArgument("the radius of a tool is above 0 mm");
  if (tool.shape != MillTool::Shape::kVee) return CheckShank(tool);
  if (!(tool.half_angle_rad > 0.0) || !(tool.half_angle_rad < 0.5 * kPi))
    return InvalidArgument("half the angle of a vee tool lies between 0 and 90 degrees");
  if (!(tool.tip_radius_mm >= 0.0) || !(tool.tip_radius_mm <= tool.radius_mm))
    return InvalidArgument("the tip of a vee tool is no wider than its shaft");
  return CheckShank(tool);
}

ToolPass::ToolPass(const MillTool& tool, const motion::MachinePoint& from,
                   const motion::MachinePoint& to)
    : from_(from),
      to_(to),
      radius_(tool.radius_mm),
      tip_radius_(tool.tip_radius_mm),
      length_(LengthOf(PlanOf(to - from))),
      z_(from.z()) {
  if (tool.shape == MillTool::Shape::kVee) rise_ = 1.0 / std::tan(tool.half_angle_rad);
  if (!(length_ > 0.0)) {
    z_ = std::min(from.z(), to.z());
    return;
  }
  way_ = PlanOf(to - from) / length_;
  slope_ = (to.z() - from.z()) / length_;
  lead_ = slope_ / std::sqrt(1.0 + slope_ * slope_);
}

double ToolPass::LeastBefore(double along, double across, double cutter_radius) const {
  const double half = std::sqrt(HalfChord2(radius_, across));
  const double low = Kept(along - half);
  const double high = std::max(low, Kept(along + half));
  const auto lower_of = [&](double a, double b) { return z_ + std::min(slope_ * a, slope_ * b); };
  if (std::abs(across) > cutter_radius + kOnEdge_mm) return lower_of(low, high);
  const double cutter_half = std::sqrt(HalfChord2(cutter_radius, across));
  const double cut_from = std::max(0.0, along - cutter_half);
  if (cut_from > std::min(length_, along + cutter_half) + kOnEdge_mm) return lower_of(low, high);
  return length_ > 0.0 ? lower_of(std::min(low, cut_from), cut_from) : HUGE_VAL;
}

std::optional<double> SweptHeight(const MillTool& tool, const motion::MachinePoint& from,
                                  const motion::MachinePoint& to, double x, double y) {
  const ToolPass pass(tool, from, to);
  const double along = pass.AlongOf(x - from.x(), y - from.y());
  const double across = pass.AcrossOf(x - from.x(), y - from.y());
  if (!pass.Covers(along, across)) return std::nullopt;
  switch (tool.shape) {
    case MillTool::Shape::kFlat:
      return to.z() > from.z() ? pass.LeastOfFlatUp(along, across)
                               : pass.LeastOfFlatDown(along, across);
    case MillTool::Shape::kBall:
      return pass.plunges() ? pass.LeastOfPlungedBall(along, across)
                            : pass.LeastOfBall(along, across);
    case MillTool::Shape::kVee:
      return pass.LeastOfVee(along, across);
  }
  return std::nullopt;
}

}  // namespace rmlcell::simulation
