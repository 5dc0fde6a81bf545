#include "engine/motion/corner/bend_speed.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "engine/core/indices.h"

namespace rmlcell::motion {
namespace {

constexpr double kLastDigits = 1e-9;  // last digits must not decide
constexpr double kWorthwhile = 1.01;  // less to gain than this is not worth more stretches

// Ramps below the speeds that stand at equal steps of `length`.
class RampsBelow {
 public:
  RampsBelow(std::span<const double> most, double length, const PathLimits& limits)
      : most_(most),
        steps_(static_cast<double>(most.size() - 1)),
        per_mm_(steps_ / length),
        step_mm_(length / steps_),
        limits_(limits) {}

  // The highest speed to which there are ramps from any speed up to the first of them; that one
  // when there is none above it.
  // Precondition: more than that.
  double HighestUpTo(double high) {
    const double start = most_.front();
    if (BoundsFit(start, high)) return high;
    const auto from_start = [&](double to) { return Fits(start, to); };
    const double found = Highest(high, from_start);  // nearly always good for slower ones
    if (SlowerFit(found)) return found;
    return Highest(high, [&](double to) { return from_start(to) && SlowerFit(to); });
  }

 private:
  // A place of a ramp: of one of its phases, closer where that begins.
  struct Place {
    int phase = 0;
    int part = 1;
  };
  static constexpr int kParts = 8;

  template <class Fits>
  double Highest(double high, Fits fits) {
    if (fits(high)) return high;
    double low = most_.front();
    double above = high;
    constexpr int kHalvings = 6;  // to 1 % of the gain
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + above);
      (fits(middle) ? low : above) = middle;
    }
    return low;
  }

  // Between the steps, rounded down where the speeds bend upwards; from the first on they may begin
  // flat.
  double MostAt(std::size_t step, double share) const {
    const double rise = most_[step + 1] - most_[step];
    const double bend = step == 0 ? 2.0 * rise : rise - (most_[step] - most_[step - 1]);
    return most_[step] + rise * share - std::max(bend, 0.0) * 0.5 * share * (1.0 - share);
  }

  enum class Look { kBelow, kAbove, kBeyond };  // the last step
  Look At(const SpeedProfile& ramp, const Place& place) const {
    const SpeedProfile::Phase& phase = ramp.phase(place.phase);
    const double t = phase.duration_s * (place.part * place.part) / (kParts * kParts);
    const double a = phase.start.acceleration;
    const double x =
        (phase.start.s + t * (phase.start.speed + t * (0.5 * a + t * phase.jerk / 6.0))) * per_mm_;
    if (x >= steps_) return Look::kBeyond;
    const double speed = phase.start.speed + t * (a + 0.5 * t * phase.jerk);
    const auto step = static_cast<std::size_t>(x);
    const double here = MostAt(step, x - static_cast<double>(step));
    return speed > here * (1.0 + kLastDigits) ? Look::kAbove : Look::kBelow;
  }

  // Whether the ramp between these speeds keeps below.
  bool Fits(double from, double to) {
    const SpeedProfile ramp = SpeedProfile::OneRamp(from, to, limits_);
    // What was too fast last is most often so again, and one place is enough to say no.
    if (worst_.phase < ramp.phase_count() && At(ramp, worst_) == Look::kAbove) return false;
    for (Place place; place.phase < ramp.phase_count(); ++place.phase) {
      for (place.part = 1; place.part <= kParts; ++place.part) {
        const Look look = At(ramp, place);
        if (look == Look::kBeyond) return true;  // the rest lies there too
        if (look == Look::kBelow) continue;
        worst_ = place;
        return false;
      }
    }
    const auto reached = static_cast<std::size_t>(std::clamp(ramp.end().s * per_mm_, 0.0, steps_));
    return std::ranges::all_of(most_.subspan(reached + 1),
                               [&](double here) { return to <= here * (1.0 + kLastDigits); });
  }

  // From lower speeds too. Who starts slower has more time on the way and is nearly everywhere
  // behind, but not where the bend opens slowly.
  bool SlowerFit(double to) {
    constexpr double kFastest = 0.75;
    if (BoundsFit(kFastest * most_.front(), to)) return true;
    for (const double share : {0.0, 0.25, 0.5, kFastest}) {
      if (!Fits(most_.front() * share, to)) return false;
    }
    return true;
  }

  bool BoundsFit(double fastest, double to) const {
    return RampsFitByBounds(most_, step_mm_, limits_.jerk, fastest, to);
  }

  std::span<const double> most_;
  double steps_;
  double per_mm_;
  double step_mm_;
  const PathLimits& limits_;
  Place worst_{.phase = SpeedProfile::kPhasesMax};
};

// The fastest ramp from the first of these speeds up to the last; where none leads up there, the
// least of them all along.
struct Rise {
  double from = 0.0;
  double to = 0.0;
};
Rise RiseBelow(std::span<const double> most, double length, const PathLimits& limits) {
  const double high = RampsBelow(most, length, limits).HighestUpTo(most.back());
  if (high > most.front()) return {most.front(), high};
  const double least = *std::ranges::min_element(most);
  return {least, least};
}

}  // namespace

// Where x of the way from the speed f is gone the time is at most x / f, so the speed is at
// most f + j x^2 / (2 f^2), and from rest (4.5 j x^2)^(1/3). At one place it falls with f while it
// is above 2 f and rises from there on: the larger one of the two bounds all starts between.
bool RampsFitByBounds(std::span<const double> most, double step_mm, double jerk, double fastest,
                      double to) {
  const double square_mm2 = step_mm * step_mm;
  const double growth = jerk * square_mm2 / (2.0 * fastest * fastest);
  const double from_rest = 4.5 * jerk * square_mm2;  // cubed, after one step
  const double start = most[0];
  // The first step: limits and bound both begin flat.
  double rise = most[1] - start;
  double room = most[1] - fastest - growth;
  if (!(rise >= 0.0 && room >= 0.0 && from_rest <= start * start * start)) return false;
  for (std::size_t k = 2; k < most.size(); ++k) {
    const auto square = static_cast<double>(k * k);
    const double rise_before = std::exchange(rise, most[k] - most[k - 1]);
    const double room_before = std::exchange(room, most[k] - fastest - growth * square);
    // Between the steps both sag.
    const double bend = std::max(rise - rise_before, 0.0);
    const double least = std::min(most[k], most[k - 1]) - 0.125 * bend;
    if (least >= to) continue;  // no ramp is faster
    if (!(std::min(room_before, room) >= 0.25 * std::max(0.5 * bend - growth, 0.0))) return false;
    if (!(from_rest * square <= least * least * least)) return false;
  }
  return true;
}

std::array<double, BendStretches::kAbrupt> AbruptSpeeds(const BendSpeeds& speeds) {
  constexpr std::size_t kHalf = BendStretches::kAbrupt / 2;
  constexpr std::size_t kEach = BendSpeeds::kSteps / kHalf;
  static_assert(kEach * kHalf == BendSpeeds::kSteps && 2 * kHalf == BendStretches::kAbrupt);
  std::array<double, BendStretches::kAbrupt> most;
  for (const std::size_t k : Indices(kHalf)) {
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
    const double high = RampsBelow(most, half_length_mm, limits).HighestUpTo(most[kSteps]);
    if (!(high > most[0])) return steady;
    return {.start = most[0], .open = high, .middle = high};
  }
  // Up from the start and up from the middle: what a ramp over the half does is below both.
  std::array<double, kSteps + 1> back;
  std::ranges::reverse_copy(most, back.begin());
  const auto steps_back = kSteps - top;
  const Rise up = RiseBelow(most.first(top + 1), step_mm * static_cast<double>(top), limits);
  const Rise down = RiseBelow(std::span<const double>(back).first(steps_back + 1),
                              step_mm * static_cast<double>(steps_back), limits);
  const double high = std::min(up.to, down.to);
  if (high < std::max(up.from, down.from)) return steady;
  return {.count = 2, .start = up.from, .open = high, .middle = down.from};
}

}  // namespace rmlcell::motion
