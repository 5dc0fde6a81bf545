#pragma once

#include "engine/core/units.h"
#include "engine/motion/geometry/path.h"
#include "engine/motion/kinematics/machine_limits.h"
#include "engine/motion/profile/speed_profile.h"
#include "engine/rml1/action.h"
#include "engine/rml1/profile.h"

namespace rmlcell::rml1 {

// The override as the panel offers it, in percent. Values beyond are limited: 0 would never end.
inline constexpr double kOverrideMin = 10.0;
inline constexpr double kOverrideMax = 200.0;

// The tool in the machine frame: mm, and rad for the rotary axis.
motion::TipPose PoseOf(const Profile& profile, const Point& at);

// What a mill can do, for the planner and for reports: trapezoids, polylines kept exactly, and a
// vertex passed where no axis has to jump by more than SPEED_JUMP; motion.md section 7. The rotary
// axis may jump by what its own acceleration makes in the same time.
motion::MachineLimits MillLimits(const Profile& profile);

// The path of one motion and its limits, whatever comes before and behind. The override acts on
// F/VS and V/!VZ speeds, within what the axes can do, and not on the travel speed.
struct MotionPlan {
  motion::PathPiece path;
  motion::PathLimits limits;
  double feed_mm_s = 0.0;  // what limits.speed stands for, override included
};
MotionPlan PlanMotion(const Profile& profile, const Point& from, const Action& action,
                      double override_percent);

// Virtual time as a sum of durations, compensated, so that a million short motions add up.
class VirtualClock {
 public:
  void Add(double seconds) {
    const double sum = seconds_ + seconds;
    const double larger = seconds_ >= seconds ? seconds_ : seconds;
    const double smaller = seconds_ >= seconds ? seconds : seconds_;
    lost_ += (larger - sum) + smaller;
    seconds_ = sum;
  }
  SimTime time() const { return FromSeconds(seconds_ + lost_); }
  // After a halt, or a motion that was cut: the event's own time.
  void Set(SimTime time) {
    seconds_ = ToSeconds(time);
    lost_ = 0.0;
  }

 private:
  double seconds_ = 0.0;
  double lost_ = 0.0;
};

}  // namespace rmlcell::rml1
