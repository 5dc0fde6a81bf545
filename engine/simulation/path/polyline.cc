#include "engine/simulation/path/polyline.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::simulation {

int ChordCount(double radius_mm, double sweep_rad, double tolerance_mm) {
  // acos(1 - x) = 2 asin(sqrt(x / 2)), which keeps its digits when x is small.
  const double share = std::min(0.5, 0.5 * tolerance_mm / radius_mm);
  const double chord_rad = 4.0 * std::asin(std::sqrt(share));
  const double wanted = std::ceil(sweep_rad / chord_rad - 1e-9);
  return static_cast<int>(std::clamp(wanted, 1.0, double{kChordsMax}));
}

}  // namespace rmlcell::simulation
