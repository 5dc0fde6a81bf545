#include "engine/motion/ride/laser_power.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rmlcell::motion {
namespace {

constexpr double kFull_percent = 100.0;

double Slope(const PowerLaw& law) {  // percent of power per mm/s
  return law.power_percent * kFull_percent / (law.tip_speed_max_mm_s * law.speed_percent);
}

// Where within a phase its speed passes `speed`, in order; unused places hold an end of it.
std::array<double, 2> Crossings(const SpeedProfile::Phase& phase, double speed) {
  const double end = phase.duration_s;
  std::array<double, 2> found{end, end};
  const double a = 0.5 * phase.jerk;
  const double b = phase.start.acceleration;
  const double c = phase.start.speed - speed;
  std::size_t count = 0;
  const auto keep = [&](double t) { found[count++] = std::clamp(t, 0.0, end); };
  if (a == 0.0) {
    if (b != 0.0) keep(-c / b);
  } else if (const double square = b * b - 4.0 * a * c; square >= 0.0) {
    const double root = std::sqrt(square);
    const double q = -0.5 * (b + std::copysign(root, b));
    keep(q / a);
    if (q != 0.0) keep(c / q);
  }
  if (found[1] < found[0]) std::swap(found[0], found[1]);
  return found;
}

double Advance(const SpeedProfile::Phase& phase, double t) {
  return t * (phase.start.speed + t * (0.5 * phase.start.acceleration + t * phase.jerk / 6.0));
}

double SpeedIn(const SpeedProfile::Phase& phase, double t) {
  return phase.start.speed + t * (phase.start.acceleration + 0.5 * t * phase.jerk);
}

}  // namespace

double PowerLaw::PercentAt(double tip_speed_mm_s) const {
  return std::clamp(Slope(*this) * tip_speed_mm_s, 0.0, kFull_percent);
}

double EnergyOf(const SpeedProfile& profile, const PowerLaw& law, double rated_W) {
  const double slope = Slope(law);
  const double saturates_mm_s = kFull_percent / slope;
  double percent_s = 0.0;
  for (int k = 0; k < profile.phase_count(); ++k) {
    const SpeedProfile::Phase& phase = profile.phase(k);
    const std::array<double, 2> cross = Crossings(phase, saturates_mm_s);
    double from = 0.0;
    for (const double to : {cross[0], cross[1], phase.duration_s}) {
      const bool full = SpeedIn(phase, 0.5 * (from + to)) > saturates_mm_s;
      percent_s +=
          full ? kFull_percent * (to - from) : slope * (Advance(phase, to) - Advance(phase, from));
      from = to;
    }
  }
  return rated_W * percent_s / kFull_percent;
}

}  // namespace rmlcell::motion
