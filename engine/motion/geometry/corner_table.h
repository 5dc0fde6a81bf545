#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/motion/geometry/corner_curve.h"

namespace rmlcell::motion {

// The curve between two lines passed with a steady head (PlainCorner) depends on the angle alone,
// but for its scale, the cut: its figures at cut 1, some of them from tables (corner_nodes.h).
// motion.md 4.2, 4.3. `half_sine` and `half_cosine` are
// those of half the turn.
inline double CornerRho(double half_cosine) { return 2.0 * std::sqrt(half_cosine); }

// K: peak curvature.
inline double CornerCurvature(double half_sine, double half_cosine, double rho) {
  const double middle = half_cosine * (15.0 / 8.0 - 7.0 * rho / 16.0);
  return 0.75 * rho * half_sine / (middle * middle);
}

// J: bounds path jerk per speed cubed from above.
inline double CornerJerk(double half_sine, double half_cosine, double curvature) {
  const double t = half_sine / half_cosine;
  return std::max(t * std::min(3.0 + 1.2 * t, 4.75), 1.04 * curvature * curvature);
}

// The true peak of that; never below it.
double CornerJerkPeak(double half_sine, double half_cosine, double curvature);

// What the local limits of speed along the first half of the curve are made of, at equal steps of
// arc length: the curvature there is curvature / by_curvature^2 for a curve of cut 1, and path jerk
// per speed cubed is curvature / by_jerk^3. Rounded down.
struct HalfCorner {
  static constexpr std::size_t kSteps = 24;
  std::array<double, kSteps + 1> by_curvature;
  std::array<double, kSteps + 1> by_jerk;
};
HalfCorner CornerHalf(double half_sine, double half_cosine);

// Arc length of the whole curve.
double CornerArcLength(double rho);

// Which parameter u of the curve is how far along it: by polynomials whose coefficients stand in a
// table by angle, for turns up to 145 degrees. Within 3e-9 of the length, 1e-12 up to 90 degrees;
// both ends and the middle are met exactly.
class PlainMeasure {
 public:
  explicit PlainMeasure(const PlainCorner& corner);
  bool known() const { return known_; }  // false: a sharper turn, to be measured (CornerLength)

  // `share` of the arc length, 0 to 1. Precondition: known().
  double ParameterAt(double share) const {
    const double y = 2.0 * share - 1.0;
    const double z = y * y;
    const double fourth = z * z;
    const double eighth = fourth * fourth;
    // Estrin's order: short chains.
    const auto& c = coefficients_;
    const double low = (c[0] + c[1] * z) + (c[2] + c[3] * z) * fourth;
    const double middle = (c[4] + c[5] * z) + (c[6] + c[7] * z) * fourth;
    const double high = (c[8] + c[9] * z) + (c[10] + c[11] * z) * fourth;
    const double sum = low + (middle + high * eighth) * eighth;
    return 0.5 + 0.5 * y * (1.0 + (1.0 - z) * sum);
  }

  static constexpr std::size_t kTerms = 12;

 private:
  std::array<double, kTerms> coefficients_;  // by z = (2 share - 1)^2
  bool known_ = false;
};

}  // namespace rmlcell::motion
