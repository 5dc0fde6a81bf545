#pragma once

#include "engine/motion/geometry/frames.h"

namespace rmlcell::motion {

// Tool tip in the machine frame (mm) and the two head angles (rad). Mills use the tip alone, and
// a_rad for their rotary axis.
struct TipPose {
  MachinePoint tip;
  double a_rad = 0.0;
  double b_rad = 0.0;

  bool operator==(const TipPose& other) const {
    return tip.x() == other.tip.x() && tip.y() == other.tip.y() && tip.z() == other.tip.z() &&
           a_rad == other.a_rad && b_rad == other.b_rad;
  }
};

}  // namespace rmlcell::motion
