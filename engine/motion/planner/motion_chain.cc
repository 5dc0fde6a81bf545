#include "engine/motion/planner/motion_chain.h"

namespace rmlcell::motion {

void MotionChain::Append(const MoveCommand& move, const PathLimits& limits, bool goes_on) {
  const bool work = legs().Add(move, limits, goes_on);
  if (legs().begins_moving()) [[unlikely]] {
    const double speed = legs().TakeEntrySpeed();
    spans().BeginAt(speed);
    items_.BeginAt(speed);
  }
  if (work) Work();
}

void MotionChain::Work() {
  legs().Settle();
  while (spans().Resolve(false)) {
  }
  spans().Settle();
  if (legs().moves().end() - spans().OldestOpenMove() >= legs().window()) Starve();
}

// The window is full: what is there must do.
void MotionChain::Starve() {
  ++starved_;
  legs().AcceptHalf();
  while (spans().Resolve(true)) {
  }
  spans().AcceptHalf();
}

}  // namespace rmlcell::motion
