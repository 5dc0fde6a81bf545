#pragma once

#include <deque>
#include <vector>

#include "engine/core/units.h"
#include "engine/machine/hand_motion.h"
#include "engine/machine/hand_way.h"
#include "engine/motion/geometry/pose.h"
#include "engine/motion/ride/motion_under_way.h"

namespace rmlcell::machine {

// Places that a key of a panel sends the machine to, one after the other: straight, at rest at each
// of them, as fast as its axes go by hand. Of a mill, whose tool stands in its column.
class HandTravel final : public HandWay {
 public:
  HandTravel(const std::vector<motion::AxisPose>& way, const HandMotion& how,
             const motion::AxisPose& at, SimTime now);

  void Advance(SimTime until) override;
  void Brake() override;

  bool rests() const override { return legs_.empty(); }
  bool brakes() const override { return brakes_; }
  motion::AxisPose axes() const override;
  double tip_speed_mm_s() const override;

 private:
  SimTime now_;
  motion::AxisPose at_;  // where it stands, or the leg under way began
  bool brakes_ = false;
  std::deque<motion::MotionUnderWay> legs_;
};

}  // namespace rmlcell::machine
