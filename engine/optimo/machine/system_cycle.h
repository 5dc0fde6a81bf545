#pragma once

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

// The times at which the control looks around. OPT-B.30
namespace rmlcell::optimo {

// The instant so many seconds from `now`; far beyond any run when there is no such instant.
inline SimTime After(SimTime now, double seconds) {
  constexpr SimTime kFar = kForever / 4;  // a halt may still be added
  return std::min(now, kFar) + std::min(FromSeconds(seconds), kFar);
}

// The system cycle, CYCLE: inputs are sampled and conditions tested at its ticks, which are counted
// from the instant that whoever waits began at.
class SystemCycle {
 public:
  explicit SystemCycle(double seconds) : seconds_(seconds), time_(FromSeconds(seconds)) {}

  double seconds() const { return seconds_; }

  // The first tick behind `now`, counted from `since`.
  SimTime NextTick(SimTime now, SimTime since) const {
    return since + ((now - since) / time_ + 1) * time_;
  }
  bool IsTick(SimTime now, SimTime since) const { return (now - since) % time_ == SimTime(0); }

  // The first tick, counted from `now`, at which so many seconds are over.
  SimTime TickAfter(SimTime now, double seconds) const {
    constexpr double kSame = 1e-9;  // of a cycle: a whole number of cycles stays one
    return After(now, std::ceil(seconds / seconds_ - kSame) * seconds_);
  }

 private:
  double seconds_;
  SimTime time_;
};

}  // namespace rmlcell::optimo
