#pragma once

#include "engine/machine/observer.h"
#include "engine/simulation/report.h"

namespace rmlcell::simulation {

// How the moves of a run went: passages into the next move, and feed rates that were not reached.
// A move may be told as several motions (blends) and in several parts (stops); it counts once, when
// its last motion is over.
class CornerLog {
 public:
  void Add(const machine::MotionDone& done);

  const CornerFigures& corners() const { return corners_; }
  const SpeedShortfall& shortfall() const { return shortfall_; }

 private:
  void AddCorner(const machine::MotionDone& done);
  void AddShortfall(const machine::MotionDone& done);

  CornerFigures corners_;
  SpeedShortfall shortfall_;
  double move_peak_mm_s_ = 0.0;  // of the move under way
};

}  // namespace rmlcell::simulation
