#pragma once

#include <algorithm>
#include <cmath>

#include "engine/motion/planner/planner.h"

namespace rmlcell::simulation {

// A time of the motion's speed profile. A run tells times in whole nanoseconds, which may lie
// behind the end of it: a motion that passes on does not stand there.
inline double TimeWithin(const motion::PlannedMotion& motion, double t_s) {
  return motion.speed.end().speed > 0.0 ? std::min(t_s, motion.speed.duration_s()) : t_s;
}

// A stretch of a speed profile with constant jerk, from its own time zero on.
struct PhasePart {
  double duration_s = 0.0;
  double jerk = 0.0;
  motion::PathState start;

  double SpeedAt(double t) const { return start.speed + t * (start.acceleration + 0.5 * t * jerk); }
  double AccelerationAt(double t) const { return start.acceleration + t * jerk; }
  double PlaceAt(double t) const {
    return start.s + t * (start.speed + t * (0.5 * start.acceleration + t * jerk / 6.0));
  }
  // Where the speed turns round on the way; an end of the stretch where it does not.
  double LevelAt() const {
    return jerk != 0.0 ? std::clamp(-start.acceleration / jerk, 0.0, duration_s) : 0.0;
  }
};

// Calls `take` with every stretch of the speed profile between two of its times, in order.
template <class Take>
void ForEachPhase(const motion::SpeedProfile& profile, double from_s, double to_s, Take take) {
  double begin = 0.0;
  for (int k = 0; k < profile.phase_count(); ++k) {
    const motion::SpeedProfile::Phase& phase = profile.phase(k);
    const double end = begin + phase.duration_s;
    const double low = std::max(from_s, begin);
    const double high = std::min(to_s, end);
    if (high > low) {
      PhasePart part{phase.duration_s, phase.jerk, phase.start};
      const double skipped = low - begin;
      part.start = {part.PlaceAt(skipped), part.SpeedAt(skipped), part.AccelerationAt(skipped)};
      part.duration_s = high - low;
      take(part);
    }
    begin = end;
  }
}

}  // namespace rmlcell::simulation
