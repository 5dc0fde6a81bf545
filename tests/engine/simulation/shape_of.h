#pragma once

#include "engine/simulation/path/motion_peaks.h"
#include "engine/simulation/path/polyline.h"

// What is asked of one part alone, with the shape of that.
namespace rmlcell::simulation {

inline PointSweep TipSweepOf(const PathPart& part) {
  PartShape shape(part);
  return TipSweep(shape);
}
inline PointSweep ColumnSweepOf(const PathPart& part) {
  PartShape shape(part);
  return ColumnSweep(shape);
}
inline double TipLengthOf(const PathPart& part) {
  PartShape shape(part);
  return TipLength(shape);
}
inline MotionPeaks PeaksBetween(const motion::PlannedMotion& motion, bool five_axis, double from_s,
                                double to_s) {
  PartShape shape({motion.path, motion.head, 0.0, motion.path.length()});
  return PeaksOf(motion, shape, five_axis, from_s, to_s);
}

}  // namespace rmlcell::simulation
