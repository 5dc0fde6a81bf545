#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/motion/geometry/frames.h"

namespace rmlcell::simulation {

// How far `p` is from the nearest place of the segment. Number by number: tests are not optimised,
// and expressions of vectors take ten times as long there.
inline double DistanceToSegment(const motion::MachinePoint& p, const motion::MachinePoint& from,
                                const motion::MachinePoint& to) {
  const double* const at = p.data();
  const double* const a = from.data();
  const double* const b = to.data();
  double squared = 0.0;
  double along = 0.0;
  for (int i = 0; i < 3; ++i) {
    squared += (b[i] - a[i]) * (b[i] - a[i]);
    along += (at[i] - a[i]) * (b[i] - a[i]);
  }
  const double t = squared > 0.0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
  double apart = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double off = at[i] - (a[i] + (b[i] - a[i]) * t);
    apart += off * off;
  }
  return std::sqrt(apart);
}

inline double DistanceToPolyline(const motion::MachinePoint& p,
                                 const std::vector<motion::MachinePoint>& points) {
  double best = HUGE_VAL;
  for (std::size_t i = 1; i < points.size(); ++i)
    best = std::min(best, DistanceToSegment(p, points[i - 1], points[i]));
  return best;
}

}  // namespace rmlcell::simulation
