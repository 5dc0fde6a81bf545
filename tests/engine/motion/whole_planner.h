#pragma once

#include <vector>

#include "engine/motion/planner/planner.h"

namespace rmlcell::motion {

// Level 1 of motion.md 4.3 and 5.3 as it stands there, over a whole program at once: arrays instead
// of queues, nothing decided early. Slow, and for lines without head rotation only; the planner
// must agree.
struct WholePlan {
  double duration_s = 0.0;
  double length_mm = 0.0;
  std::vector<CornerReport> corners;  // one for each move, as the planner reports them
};
WholePlan PlanWhole(const std::vector<MoveCommand>& chain, const MachineLimits& machine);

// Of all motions, s.
double Duration(const std::vector<PlannedMotion>& motions);

}  // namespace rmlcell::motion
