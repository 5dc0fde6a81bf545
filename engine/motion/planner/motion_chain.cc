#include "engine/motion/planner/motion_chain.h"

namespace rmlcell::motion {

void MotionChain::Append(const MoveCommand& move, const PathLimits& limits, bool goes_on) {
  const bool work = legs().Add(move, limits, goes_on);
  if (legs().begins_moving()) [[unlikely]] {
    const double speed = legs().TakeEntrySpeed();
    spans().BeginAt(speed);
    items_.BeginAt(speed);
  }
  if (!spreads_work_) {
    if (work) ResolveAll();
  } else if (!move.fly) {
    Finish();
  } else {
    items_.AllowMore();
    if (work || spans().CanResolve()) Work();
  }
}

// A batch of legs is decided at once, and takes a hundred times as long as one: what it gives to do
// is done a little with each of the moves that follow.
void MotionChain::Work() {
  legs().Settle();
  // A corner at which the head turns takes ten times as long as one of two lines: one of those, two
  // of these.
  if (spans().Resolve(false) && spans().AllPlain()) spans().Resolve(false);
  spans().Settle();
  if (IsFull()) ResolveAll();
}

// The machine stands behind the last move: all that was appended comes out.
void MotionChain::Finish() {
  ResolveAll();
  items_.AllowAll();
}

void MotionChain::ResolveAll() {
  legs().Settle();
  while (spans().Resolve(false)) {
  }
  spans().Settle();
  if (IsFull()) Starve();
}

bool MotionChain::IsFull() const {
  return legs().moves().end() - spans().OldestOpenMove() >= legs().window();
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
