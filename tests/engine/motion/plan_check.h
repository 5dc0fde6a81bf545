#pragma once

#include <string>
#include <vector>

#include "engine/motion/ride/trajectory.h"

namespace rmlcell::motion {

// Looks at a plan from outside: positions at dense times, and what their differences say about
// speed, acceleration and jerk. motion.md section 10, properties 1 to 4.
struct PlanCheck {
  const std::vector<MoveCommand>& chain;
  const std::vector<PlannedMotion>& motions;
  const MachineLimits& machine;
  int samples_per_phase = 3;
  bool arcs = true;  // the chain has some: its blends need not lie in a plane

  // The first violations found, as text; empty when there is none.
  std::vector<std::string> Violations() const;
};

}  // namespace rmlcell::motion
