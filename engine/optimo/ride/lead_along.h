#pragma once

#include <optional>
#include <vector>

#include "engine/motion/planner/planner.h"

namespace rmlcell::optimo {

// The way to a lower speed over as many planned motions as it takes, for chains of moves that are
// all shorter than that way. The weakest of them sets the ramp. Not for motions in the axes, which
// have measures of their own. motion.md 6
class LeadAlong {
 public:
  // From this state on, which lies before the end of the motion.
  LeadAlong(const motion::PlannedMotion& first, const motion::PathState& state);
  void Add(const motion::PlannedMotion& next);

  // False: it has nothing to slow down from, or takes so long to end its acceleration that it comes
  // to rest, or is faster than it may be, before. More motions do not change that.
  bool SlowsTo(double speed) const;

  struct End {
    double s = 0.0;  // of the last motion that was added
    double speed = 0.0;
  };
  // Where `speed` is reached and held; nothing: behind the last motion.
  std::optional<End> EndOnLast(double speed) const;

  // The motions to that place, the last of them left out where it is its begin. None: they would be
  // passed faster than they may, or the axes cannot brake so on a bend.
  std::vector<motion::PlannedMotion> MotionsTo(const End& end,
                                               const motion::AxisLimits& axes) const;

 private:
  double BeginOfLast() const { return ends_.size() > 1 ? ends_[ends_.size() - 2] : 0.0; }

  motion::PathState state_;    // s from there
  double passed_ = 0.0;        // of the first motion
  motion::PathLimits limits_;  // of all; the speed has none
  std::vector<motion::PlannedMotion> motions_;
  std::vector<double> ends_;  // s from there
};

}  // namespace rmlcell::optimo
