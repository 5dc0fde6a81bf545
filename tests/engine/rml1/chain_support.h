#pragma once

#include <string>
#include <vector>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {

// The motion test profile of motion.md section 7: 0.5 to 15 mm/s, travel at 15 mm/s, 200 mm/s2,
// speed jump 3 mm/s, the spindle needs 2 s.
machine::Parameters MotionTestProfile();

// A vertex of a polyline in the machine frame, mm and degrees, and the speed at which the tool is
// to come there.
struct Vertex {
  motion::MachinePoint at;
  double a_deg = 0.0;
  double speed = 0.0;
};

// What the spec says about a chain from rest to rest, worked out with arrays that hold all of it:
// the speed at every vertex (motion.md section 7, corners; 5.2, 5.3 with infinite jerk), and the
// time. The first vertex is where the chain begins.
struct ChainPlan {
  std::vector<double> speeds;
  double time_s = 0.0;
};
ChainPlan PlanOf(const std::vector<Vertex>& chain, double acceleration, double jump);

// Velocity of the tool at a time within a motion, from its places just before and after: mm/s, and
// deg/s of the rotary axis.
struct Velocity {
  motion::MachinePoint tip;
  double a_deg_s = 0.0;
};
Velocity VelocityAt(const RunRecord::Motion& motion, double time_s);

// Largest difference of any axis, tip only.
double LargestJump(const Velocity& before, const Velocity& after);

}  // namespace rmlcell::rml1
