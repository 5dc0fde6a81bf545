#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "engine/motion/planner/item_stage.h"

namespace rmlcell::motion {

// The inside of the planner: moves pass three stages, each a queue (leg_stage.h, span_stage.h,
// item_stage.h). This decides when each has something to do.
class MotionChain final {
 public:
  MotionChain(const MachineLimits& machine, std::size_t window)
      : items_(machine, window), spreads_work_(std::isfinite(machine.tip_jerk_mm_s3)) {
    if (!spreads_work_) items_.AllowAlways();
  }

  PathLimits LimitsFor(const MoveCommand& move) const { return legs().LimitsFor(move); }

  // The move has passed all checks and has a length above zero. `goes_on`: it begins exactly at
  // end().
  void Append(const MoveCommand& move, const PathLimits& limits, bool goes_on);

  // A move that goes nowhere stood here: the passage before it is a stop unless it had /FLY itself.
  void Nothing(const PathPose& here, bool fly) { legs().AddNothing(here, fly); }
  void BeginMoving(double speed) { legs().BeginAt(speed); }
  bool starts_too_fast() const { return items_.starts_too_fast(); }
  void Mark(std::uint64_t tag) { items_.AddMark(tag); }
  void Stop() {
    if (legs().End()) Finish();
  }
  const PlannedItem* Next() { return items_.Next(); }  // see Planner::NextInPlace

  const MachineLimits& machine() const { return legs().machine(); }
  // How often something was decided too early, for want of room.
  std::uint64_t starved() const { return starved_ + legs().starved() + spans().starved(); }

  // Where the last accepted move ended; null before the first.
  const PathPose* end() const { return legs().end(); }

  // All that waits in the three stages, for people and tests.
  std::string Dump() const { return legs().Dump() + spans().Dump() + items_.Dump(); }

 private:
  SpanStage& spans() { return items_.span_stage(); }
  const SpanStage& spans() const { return items_.span_stage(); }
  LegStage& legs() { return spans().leg_stage(); }
  const LegStage& legs() const { return spans().leg_stage(); }

  void Work();
  void Finish();
  void ResolveAll();
  bool IsFull() const;
  void Starve();

  ItemStage items_;    // which owns the stage before it, and that the first one
  bool spreads_work_;  // over the moves: without a limit on jerk a batch is done at once sooner
  std::uint64_t starved_ = 0;
};

}  // namespace rmlcell::motion
