#pragma once

#include <optional>
#include <vector>

#include "engine/machine/observer.h"
#include "engine/motion/planner/planner.h"
#include "engine/optimo/language/ast.h"
#include "engine/optimo/ride/travel.h"

namespace rmlcell::optimo {

// What is told when a motion begins and when it is over.
struct MoveNote {
  machine::Place place{};
  motion::ProgramPoint program_point{};
  double program_a = 0.0;
  double feed_mm_s = 0.0;
  PathType path = PathType::kPtp;
  bool last = true;  // of its MOVE; false: the lead of a hole
  bool fly = false;
  bool approach = false;  // to the step where the run begins; LIVE-6.09
  motion::MoveCommand::Kind kind = motion::MoveCommand::Kind::kContour;
  double speed_percent = 0.0;  // as programmed; for a change of the override on the way
  double accel_fraction = 1.0;
  std::optional<motion::MachinePoint> via{};  // of an arc: through it, wherever it begins
  std::vector<BeyondTravel> beyond{};         // a forecast: told when the motion begins
};

}  // namespace rmlcell::optimo
