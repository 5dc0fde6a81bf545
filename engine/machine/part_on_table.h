#pragma once

#include "engine/machine/observer.h"
#include "engine/motion/geometry/frames.h"

namespace rmlcell::machine {

// The part on the table, for who knows it: told of a run it is cut by it, and then it says what
// stands in a way. LIVE-6.07
class PartOnTable : public RunObserver {
 public:
  // Where program zero and the tip are before a run cuts it; machine frame.
  virtual void BeginAt(const motion::MachinePoint& work_origin, const motion::MachinePoint& at) = 0;
  // The run is left in the middle of a motion, which is told at its end: it has come to here.
  virtual void EndAt(const motion::MachinePoint& at) = 0;

  // How deep the tool would go into it on a straight way of its tip, machine frame; mm. 0: it stays
  // clear.
  virtual double DepthOf(const motion::MachinePoint& from,
                         const motion::MachinePoint& to) const = 0;
};

}  // namespace rmlcell::machine
