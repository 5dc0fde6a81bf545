#pragma once

#include <cstdint>
#include <string>

#include "engine/motion/planner/item_stage.h"

namespace rmlcell::motion {

// The inside of the planner: moves pass three stages, each a queue (leg_stage.h, span_stage.h,
// item_stage.h). This decides when each has something to do.
class MotionChain final : public ItemStage {
 public:
  MotionChain(const MachineLimits& machine, std::size_t window) : ItemStage(machine, window) {}

  PathLimits LimitsFor(const MoveCommand& move) const { return LimitsOfMove(move); }

  // The move has passed all checks and has a length above zero. `goes_on`: it begins exactly at
  // end().
  void Append(const MoveCommand& move, const PathLimits& limits, bool goes_on);

  // A move that goes nowhere stood here: the passage before it is a stop unless it had /FLY itself.
  void Nothing(const PathPose& here, bool fly) { AddNothing(here, fly); }
  void BeginMoving(double speed) { BeginLegsAt(speed); }
  bool starts_too_fast() const { return item_starts_too_fast(); }
  void Mark(std::uint64_t tag) { AddMark(tag); }
  void Stop() {
    if (EndLegs()) Work();
  }

  const MachineLimits& machine() const { return machine_; }
  std::uint64_t starved() const { return starved_; }

  // Where the last accepted move ended; null before the first.
  const PathPose* end() const { return last_end(); }

  // All that waits in the three stages, for people and tests.
  std::string Dump() const;

 private:
  void Work();
  void Starve();
};

}  // namespace rmlcell::motion
