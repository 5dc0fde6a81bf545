#pragma once

#include "engine/motion/corner/corner.h"

namespace rmlcell::motion {

// The corner between two moves in COORD ROBOT, passed on a curve of the axes by time: motion.md
// 4.5. Both pieces are measured by the time that they take at their own full speed, so that one
// share of it holds on both sides and "speed" means that share.
class AxesCorner {
 public:
  AxesCorner() = default;

  // Of every axis no more than `acceleration_share` of its acceleration and jerk is taken.
  AxesCorner(const PathPiece& before, const PathPiece& after, double acceleration_share,
             const MachineLimits& machine);

  // kThrough where no axis changes its speed; kStopReversal where they turn back, by more than 175
  // degrees between the speeds of the axes as shares of their highest (4.4); else kBlend.
  Passage passage() const { return passage_; }

  // How far from the corner the curve begins at the share `w` of full speed, and the highest share
  // that is possible where it begins `cut` before. Half of T_b lies on each side.
  double CutFor(double w) const;
  double SpeedFor(double cut) const;

 private:
  Passage passage_ = Passage::kStop;
  double by_acceleration_s_ = 0.0;  // the largest change of speed over the acceleration of an axis
  double by_jerk_s2_ = 0.0;         // over its jerk; 0 without a limit
};

}  // namespace rmlcell::motion
