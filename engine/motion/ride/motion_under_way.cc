#include "engine/motion/ride/motion_under_way.h"

#include "engine/motion/ride/trajectory.h"

namespace rmlcell::motion {

void MotionUnderWay::Begin(SimTime now) {
  start = told = now;
  arrival = now + FromSeconds(motion.speed.duration_s());
  end = arrival + FromSeconds(motion.settling_s);
}

void MotionUnderWay::Begin(SimTime now, SimTime until) {
  start = told = now;
  arrival = end = until;
}

double MotionUnderWay::PlaceAt(SimTime time) const {
  return time >= arrival ? motion.path.length() : At(time).s;
}

TipPose MotionUnderWay::TipAt(SimTime time) const {
  return TipOn(motion.path, motion.head, motion.path.At(At(time).s));
}

AxisPose MotionUnderWay::AxesAt(SimTime time) const {
  return AxesOn(motion.path, motion.head, motion.path.At(At(time).s));
}

double MotionUnderWay::TipSpeedAt(SimTime time) const {
  const PathState here = At(time);
  if (!motion.path.by_sigma()) return here.speed;
  if (motion.path.kind() == PathPiece::Kind::kRotary) return 0.0;
  return PointAt(motion.path, motion.head, here).tip_speed();
}

}  // namespace rmlcell::motion
