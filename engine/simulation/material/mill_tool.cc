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
      upright_(!(length_ > 0.0)),
      z_(upright_ ? std::min(from.z(), to.z()) : from.z()) {
  if (tool.shape == MillTool::Shape::kVee) rise_ = 1.0 / std::tan(tool.half_angle_rad);
  if (upright_) return;
  way_ = PlanOf(to - from) / length_;
  slope_ = (to.z() - from.z()) / length_;
  lead_ = slope_ / std::sqrt(1.0 + slope_ * slope_);
}

// The height over the point is convex in the tool's place: its least is at an end, where it stands
// still, or where the flat tip begins.
double ToolPass::LeastOfVee(double along, double across) const {
  const Reach r = ReachOf(along, across);
  if (!r.hit) return HUGE_VAL;
  const auto at = [&](double place) {
    const double t = std::clamp(place, r.low, r.high);
    const double distance = std::hypot(along - t, across);
    return z_ + slope_ * t + std::max(0.0, distance - tip_radius_) * rise_;
  };
  double least = std::min(at(r.low), at(r.high));
  const double steepness = slope_ / rise_;
  if (std::abs(steepness) < 1.0) {
    const double ahead = across * steepness / std::sqrt(1.0 - steepness * steepness);
    least = std::min(least, at(along - ahead));
  }
  const double flat_2 = tip_radius_ * tip_radius_ - across * across;
  if (flat_2 > 0.0) {
    least = std::min(least, at(along - std::sqrt(flat_2)));
    least = std::min(least, at(along + std::sqrt(flat_2)));
  }
  return least;
}

double ToolPass::LeastBefore(double along, double across, double cutter_radius) const {
  const Reach r = ReachOf(along, across);
  if (!r.hit) return HUGE_VAL;
  const auto lower_of = [&](double a, double b) { return z_ + std::min(slope_ * a, slope_ * b); };
  const double half_2 = cutter_radius * cutter_radius - across * across;
  if (half_2 < 0.0) return lower_of(r.low, r.high);
  const double half = std::sqrt(half_2);
  const double cut_from = std::max(0.0, along - half);
  if (cut_from > std::min(length_, along + half)) return lower_of(r.low, r.high);
  return upright_ ? HUGE_VAL : lower_of(std::min(r.low, cut_from), cut_from);
}

std::optional<double> SweptHeight(const MillTool& tool, const motion::MachinePoint& from,
                                  const motion::MachinePoint& to, double x, double y) {
  const ToolPass pass(tool, from, to);
  const double along = pass.AlongOf(x - from.x(), y - from.y());
  const double across = pass.AcrossOf(x - from.x(), y - from.y());
  const double least = tool.shape == MillTool::Shape::kFlat   ? pass.LeastOfFlat(along, across)
                       : tool.shape == MillTool::Shape::kBall ? pass.LeastOfBall(along, across)
                                                              : pass.LeastOfVee(along, across);
  if (std::isinf(least)) return std::nullopt;
  return least;
}

}  // namespace rmlcell::simulation
