#include "engine/motion/corner/bend_speed.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace rmlcell::motion {
namespace {

constexpr double kLastDigits = 1e-9;  // last digits must not decide
constexpr double kWorthwhile = 1.01;  // less to gain than this is not worth more stretches

// Whether the ramp between these speeds keeps below those that stand at equal steps of `length`.
bool RampFits(std::span<const double> most, double length, double from, double to,
              const PathLimits& limits) {
  const SpeedProfile ramp =
      SpeedProfile::Span(RampLength(from, to, limits), from, to,
                         {.speed = to, .acceleration = limits.acceleration, .jerk = limits.jerk});
  const double steps = static_cast<double>(most.size() - 1);
  const double per_mm = steps / length;
  constexpr int kPlaces = 8;  // of each phase, closer where it begins
  // Between the steps, rounded down where the speeds bend upwards; from the first on they may begin
  // flat.
  const auto most_at = [&](std::size_t step, double share) {
    const double rise = most[step + 1] - most[step];
    const double bend = step == 0 ? 2.0 * rise : rise - (most[step] - most[step - 1]);
    return most[step] + rise * share - std::max(bend, 0.0) * 0.5 * share * (1.0 - share);
  };
  for (int k = 0; k < ramp.phase_count(); ++k) {
    const SpeedProfile::Phase& phase = ramp.phase(k);
    for (int i = 1; i <= kPlaces; ++i) {
      const double t = phase.duration_s * (i * i) / (kPlaces * kPlaces);
      const double a = phase.start.acceleration;
      const double x =
          (phase.start.s + t * (phase.start.speed + t * (0.5 * a + t * phase.jerk / 6.0))) * per_mm;
      if (x >= steps) return true;  // the rest lies beyond
      const double speed = phase.start.speed + t * (a + 0.5 * t * phase.jerk);
      const auto step = static_cast<std::size_t>(x);
      const double here = most_at(step, x - static_cast<double>(step));
      if (speed > here * (1.0 + kLastDigits)) return false;
    }
  }
  const auto reached = static_cast<std::size_t>(std::clamp(ramp.end().s * per_mm, 0.0, steps));
  return std::ranges::all_of(most.subspan(reached + 1),
                             [&](double here) { return to <= here * (1.0 + kLastDigits); });
}

// From lower speeds too. Who starts slower has more time on the way and is nearly everywhere
// behind, but not where the bend opens slowly.
bool SlowerRampsFit(std::span<const double> most, double length, double to,
                    const PathLimits& limits) {
  for (const double share : {0.0, 0.25, 0.5, 0.75}) {
    if (!RampFits(most, length, most.front() * share, to, limits)) return false;
  }
  return true;
}

// The highest speed to which there are ramps from any speed up to most[0]; most[0] when there is
// none above it.
double HighestAfter(std::span<const double> most, double length, double high,
                    const PathLimits& limits) {
  const double start = most.front();
  if (!(high > start)) return start;
  const auto highest = [&](auto fits) {
    if (fits(high)) return high;
    double low = start;
    double above = high;
    constexpr int kHalvings = 6;  // to 1 % of the gain
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + above);
      (fits(middle) ? low : above) = middle;
    }
    return low;
  };
  const auto from_start = [&](double to) { return RampFits(most, length, start, to, limits); };
  const double found = highest(from_start);  // nearly always good for slower ones
  if (SlowerRampsFit(most, length, found, limits)) return found;
  return highest(
      [&](double to) { return from_start(to) && SlowerRampsFit(most, length, to, limits); });
}

}  // namespace

std::array<double, BendStretches::kAbrupt> AbruptSpeeds(const BendSpeeds& speeds) {
  constexpr std::size_t kHalf = BendStretches::kAbrupt / 2;
  constexpr std::size_t kEach = BendSpeeds::kSteps / kHalf;
  static_assert(kEach * kHalf == BendSpeeds::kSteps && 2 * kHalf == BendStretches::kAbrupt);
  std::array<double, BendStretches::kAbrupt> most;
  for (std::size_t k = 0; k < kHalf; ++k) {
    const auto first = speeds.most.begin() + static_cast<std::ptrdiff_t>(k * kEach);
    most[k] = *std::min_element(first, first + kEach + 1);
    most[most.size() - 1 - k] = most[k];
  }
  return most;
}

BendStretches StretchesOf(const BendSpeeds& speeds, double half_length_mm,
                          const PathLimits& limits) {
  constexpr std::size_t kSteps = BendSpeeds::kSteps;
  const std::span<const double> most(speeds.most);
  const double step_mm = half_length_mm / kSteps;
  const auto top = static_cast<std::size_t>(std::ranges::max_element(most) - most.begin());
  const double least = *std::ranges::min_element(most);
  const BendStretches steady{.start = least, .open = least, .middle = least};
  if (most[top] < kWorthwhile * most[0]) return steady;
  if (most[top] < kWorthwhile * most[kSteps]) {  // most open in the middle
    const double high = HighestAfter(most, half_length_mm, most[kSteps], limits);
    if (!(high > most[0])) return steady;
    return {.start = most[0], .open = high, .middle = high};
  }
  // Up from the start and up from the middle: what a ramp over the half does is below both.
  std::array<double, kSteps + 1> back;
  std::ranges::reverse_copy(most, back.begin());
  const auto steps_back = kSteps - top;
  const double high = std::min(
      HighestAfter(most.first(top + 1), step_mm * static_cast<double>(top), most[top], limits),
      HighestAfter(std::span(back).first(steps_back + 1), step_mm * static_cast<double>(steps_back),
                   most[top], limits));
  if (high < std::max(most[0], most[kSteps])) return steady;
  return {.count = 2, .start = most[0], .open = high, .middle = most[kSteps]};
}

}  // namespace rmlcell::motion
