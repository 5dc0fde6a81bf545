#pragma once

#include <optional>

#include "engine/machine/observer.h"
#include "engine/machine/shape.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// Whether a move is over with what was told: its last motion, to its end, and not its settling
// alone, told in parts.
bool EndsMove(const machine::MotionDone& done);

// Finds the moves that never reach the speed asked for, and why. A move may be told as several
// motions (blends) and in several parts (stops); it is judged when its last motion is over.
// motion.md 8.2.
class MoveSpeeds {
 public:
  explicit MoveSpeeds(const machine::MachineShape& shape) : shape_(shape) {}

  // The move that is over and was too slow.
  std::optional<SlowMove> Add(const machine::MotionDone& done);

 private:
  // The move under way.
  struct Move {
    double peak_mm_s = 0.0;
    double length_mm = 0.0;
    double entry_mm_s = 0.0;
    bool begun = false;
    // Its line or arc, which alone has the limits of the move: bends have their own.
    std::optional<motion::PathPiece> path{};
    motion::Head head{};
    motion::PathLimits limits{};
  };
  SlowMove Judge(const machine::MotionDone& done) const;
  bool WouldReachWithMore(double speed, double exit_mm_s) const;

  machine::MachineShape shape_;
  Move move_;
};

}  // namespace rmlcell::simulation
