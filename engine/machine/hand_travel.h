#pragma once

#include <deque>
#include <vector>

#include "engine/core/units.h"
#include "engine/machine/hand_motion.h"
#include "engine/motion/geometry/pose.h"
#include "engine/motion/ride/motion_under_way.h"

namespace rmlcell::machine {

// Places that a key of a panel sends the machine to, one after the other: straight, at rest at each
// of them, as fast as its axes go by hand. Of a mill, whose tool stands in its column. How the
// caller divides time changes nothing.
class HandTravel {
 public:
  HandTravel(const std::vector<motion::AxisPose>& way, const HandMotion& how,
             const motion::AxisPose& at, SimTime now);

  void Advance(SimTime until);
  void Brake();  // on the way, where it was advanced to; nothing follows

  bool rests() const { return legs_.empty(); }
  bool brakes() const { return brakes_; }
  motion::AxisPose axes() const;
  double tip_speed_mm_s() const;

 private:
  SimTime now_;
  motion::AxisPose at_;  // where it stands, or the leg under way began
  bool brakes_ = false;
  std::deque<motion::MotionUnderWay> legs_;
};

}  // namespace rmlcell::machine
