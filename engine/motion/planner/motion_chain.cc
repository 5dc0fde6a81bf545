#include "engine/motion/planner/motion_chain.h"

namespace rmlcell::motion {

void MotionChain::Append(const MoveCommand& move, const PathLimits& limits, bool goes_on) {
  const bool work = AddMove(move, limits, goes_on);
  if (begins_moving()) [[unlikely]] {
    const double speed = TakeEntrySpeed();
    BeginSpansAt(speed);
    BeginItemsAt(speed);
  }
  if (work) Work();
}

void MotionChain::Work() {
  SettleLegs();
  while (Resolve(false)) {
  }
  SettleSpans();
  if (moves_.end() - OldestOpenMove() >= window_) Starve();
}

// The window is full: what is there must do.
void MotionChain::Starve() {
  ++starved_;
  AcceptHalfOfLegs();
  while (Resolve(true)) {
  }
  AcceptHalfOfSpans();
}

std::string MotionChain::Dump() const {
  std::string out;
  DumpLegs(out);
  DumpSpans(out);
  DumpItems(out);
  return out;
}

}  // namespace rmlcell::motion
