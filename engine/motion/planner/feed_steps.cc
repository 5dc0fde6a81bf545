#include "engine/motion/planner/feed_steps.h"

#include <cmath>

namespace rmlcell::motion {

double FeedSteps::Nearest(double wanted_mm_s) const {
  if (!(wanted_mm_s > minimum_mm_s)) return minimum_mm_s;
  if (wanted_mm_s >= maximum_mm_s) return maximum_mm_s;
  const double step = wanted_mm_s < coarse_from_mm_s ? fine_step_mm_s : coarse_step_mm_s;
  const double steps_per_mm_s = std::round(1.0 / step);
  const auto speed_of = [&](double steps) {
    return step < 1.0 ? steps / steps_per_mm_s : steps * step;
  };
  // Speeds are compared and not their quotients: 0.7 is seven steps of 0.1, although 0.7 / 0.1 is a
  // little less, and 0.9999999999 is nine.
  const double steps = std::round(wanted_mm_s / step);
  const double nearest = speed_of(steps) > wanted_mm_s ? speed_of(steps - 1.0) : speed_of(steps);
  return nearest < minimum_mm_s ? minimum_mm_s : nearest;
}

}  // namespace rmlcell::motion
