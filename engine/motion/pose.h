#pragma once

#include "engine/motion/vec3.h"

namespace rmlcell::motion {

// Tool tip in the machine frame (mm) and the two head angles (rad). Mills use the tip alone, and
// a_rad for their rotary axis.
struct TipPose {
  Vec3 tip;
  double a_rad = 0.0;
  double b_rad = 0.0;

  bool operator==(const TipPose&) const = default;
};

}  // namespace rmlcell::motion
