#include "engine/simulation/mill_tool.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

// Height of the surface above the lowest point, at distance `d` from the axis.
double SurfaceAt(const MillTool& tool, double d) {
  switch (tool.shape) {
    case MillTool::Shape::kFlat:
      return 0.0;
    case MillTool::Shape::kBall:
      return tool.radius_mm - std::sqrt(std::max(0.0, tool.radius_mm * tool.radius_mm - d * d));
    case MillTool::Shape::kVee:
      return std::max(0.0, d - tool.tip_radius_mm) / std::tan(tool.half_angle_rad);
  }
  return 0.0;
}

// The point in the axes of the move: `along` it from its start, and `across`. The tool is over the
// point while its own place t along the move lies in low..high.
struct Passing {
  double along = 0.0;
  double across = 0.0;
  double slope = 0.0;  // of z by t
  double z = 0.0;      // at t = 0
  double low = 0.0;
  double high = 0.0;
};

double LeastAt(const MillTool& tool, const Passing& p, double t) {
  const double inside = std::clamp(t, p.low, p.high);
  return p.z + p.slope * inside + SurfaceAt(tool, std::hypot(p.along - inside, p.across));
}

}  // namespace

Status CheckTool(const MillTool& tool) {
  if (!(tool.radius_mm > 0.0) || !std::isfinite(tool.radius_mm))
    return InvalidArgument("the radius of a tool is above 0 mm");
  if (tool.shape != MillTool::Shape::kVee) return {};
  if (!(tool.half_angle_rad > 0.0) || !(tool.half_angle_rad < 0.5 * kPi))
    return InvalidArgument("half the angle of a vee tool lies between 0 and 90 degrees");
  if (!(tool.tip_radius_mm >= 0.0) || !(tool.tip_radius_mm <= tool.radius_mm))
    return InvalidArgument("the tip of a vee tool is no wider than its shaft");
  return {};
}

std::optional<double> SweptHeight(const MillTool& tool, const motion::Vec3& from,
                                  const motion::Vec3& to, double x, double y) {
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double length = std::hypot(dx, dy);
  const double px = x - from.x;
  const double py = y - from.y;
  if (length <= 0.0) {
    const double distance = std::hypot(px, py);
    if (distance > tool.radius_mm) return std::nullopt;
    return std::min(from.z, to.z) + SurfaceAt(tool, distance);
  }
  Passing p;
  p.along = (px * dx + py * dy) / length;
  p.across = std::abs(py * dx - px * dy) / length;
  if (p.across > tool.radius_mm) return std::nullopt;
  const double half = std::sqrt(tool.radius_mm * tool.radius_mm - p.across * p.across);
  p.low = std::max(0.0, p.along - half);
  p.high = std::min(length, p.along + half);
  if (p.low > p.high) return std::nullopt;
  p.slope = (to.z - from.z) / length;
  p.z = from.z;

  // The height over the point is convex in t: its least is at an end, or where it stands still.
  double least = std::min(LeastAt(tool, p, p.low), LeastAt(tool, p, p.high));
  const auto try_at = [&](double ahead) {
    least = std::min(least, LeastAt(tool, p, p.along - ahead));
  };
  if (tool.shape == MillTool::Shape::kBall) {
    try_at(p.slope * half / std::sqrt(1.0 + p.slope * p.slope));
  } else if (tool.shape == MillTool::Shape::kVee) {
    const double steepness = p.slope * std::tan(tool.half_angle_rad);
    if (std::abs(steepness) < 1.0)
      try_at(p.across * steepness / std::sqrt(1.0 - steepness * steepness));
    const double flat_2 = tool.tip_radius_mm * tool.tip_radius_mm - p.across * p.across;
    if (flat_2 > 0.0) {
      try_at(std::sqrt(flat_2));
      try_at(-std::sqrt(flat_2));
    }
  }
  return least;
}

}  // namespace rmlcell::simulation
