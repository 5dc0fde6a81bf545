#include "engine/motion/feed_steps.h"

#include <cmath>

namespace rmlcell::motion {

double FeedSteps::Nearest(double wanted_mm_s) const {
  if (!(wanted_mm_s > minimum_mm_s)) return minimum_mm_s;
  if (wanted_mm_s >= maximum_mm_s) return maximum_mm_s;
  const double step = wanted_mm_s < coarse_from_mm_s ? fine_step_mm_s : coarse_step_mm_s;
  constexpr double kRoom = 1e-9;  // 0.7 is seven steps of 0.1, although 0.7 / 0.1 is a little less
  const double steps = std::floor(wanted_mm_s / step + kRoom);
  const double steps_per_mm_s = std::round(1.0 / step);
  const double nearest = step < 1.0 ? steps / steps_per_mm_s : steps * step;
  return nearest < minimum_mm_s ? minimum_mm_s : nearest;
}

}  // namespace rmlcell::motion
