#pragma once

#include <optional>

#include "engine/core/result.h"
#include "engine/motion/vec3.h"

namespace rmlcell::simulation {

// The cutting end of a milling tool, a body of revolution; its lowest point is the programmed one.
// motion.md section 9.
struct MillTool {
  enum class Shape { kFlat, kBall, kVee };
  Shape shape = Shape::kFlat;
  double radius_mm = 0.0;       // of the shaft: nothing is cut beyond it
  double half_angle_rad = 0.0;  // kVee: between axis and flank, below a quarter turn
  double tip_radius_mm = 0.0;   // kVee: of the flat at its tip
};

// Error: CellInvalidArgument for a tool that cannot be: a radius that is not above 0, a half angle
// not between 0 and a quarter turn, a tip wider than the shaft.
Status CheckTool(const MillTool& tool);

// The least height that the tool's surface has above the point (x, y) while the tool moves straight
// from `from` to `to`; nothing where it does not come over the point. Closed form.
std::optional<double> SweptHeight(const MillTool& tool, const motion::Vec3& from,
                                  const motion::Vec3& to, double x, double y);

}  // namespace rmlcell::simulation
