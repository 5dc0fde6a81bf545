#pragma once

#include "engine/core/units.h"
#include "engine/motion/planner/planner.h"

namespace rmlcell::motion {

// A planned motion and the virtual time in which a machine rides it. Nothing here lets time pass:
// whoever does asks where the machine is at a time from `start` to `end`.
struct MotionUnderWay {
  PlannedMotion motion{};
  SimTime start{0};    // of its speed profile
  SimTime arrival{0};  // end of the profile
  SimTime end{0};      // with the standstill after it
  SimTime told{0};     // whoever reports it in parts: up to here it was
  bool ended = false;  // it was brought to rest before its end, and its move is over there

  // Its profile begins now.
  void Begin(SimTime now);
  // The same for a machine whose clock has its own end of it.
  void Begin(SimTime now, SimTime until);

  PathState At(SimTime time) const { return motion.speed.At(ToSeconds(time - start)); }
  // How far along its path. Once it has arrived exactly the end: times are rounded to 1 ns, and the
  // profile may be a little longer.
  double PlaceAt(SimTime time) const;
  TipPose TipAt(SimTime time) const;
  AxisPose AxesAt(SimTime time) const;
  // Of the tip; 0 where the head turns about it.
  double TipSpeedAt(SimTime time) const;
};

}  // namespace rmlcell::motion
