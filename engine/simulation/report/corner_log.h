#pragma once

#include "engine/machine/observer.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// How the moves of a run or a program passed into each other. A move may be told as several motions
// (blends) and in several parts (stops); it counts once, when its last motion is over.
class CornerLog {
 public:
  void Add(const machine::MotionDone& done);

  const CornerFigures& corners() const { return corners_; }

 private:
  CornerFigures corners_;
};

}  // namespace rmlcell::simulation
