#include "engine/simulation/report/beam_work.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/simulation/path/profile_phases.h"

namespace rmlcell::simulation {
namespace {

constexpr double kFull_percent = 100.0;
constexpr double kBin_percent = 5.0;

// Times within a phase at which the speed passes one of the values that matter: bounds of classes
// and of a pace, and where the power reaches 0 or 100 %. Each value is passed at most twice.
class Crossings {
 public:
  explicit Crossings(const PhasePart& part) : part_(part) {
    low_ = high_ = part.start.speed;
    Extend(part.SpeedAt(part.duration_s));
    Extend(part.SpeedAt(part.LevelAt()));
  }

  void Add(double speed) {
    if (!(speed > low_ && speed < high_)) return;
    const double a = 0.5 * part_.jerk;
    const double b = part_.start.acceleration;
    const double c = part_.start.speed - speed;
    if (a == 0.0) {
      if (b != 0.0) Keep(-c / b);
      return;
    }
    const double square = b * b - 4.0 * a * c;
    if (square < 0.0) return;
    const double q = -0.5 * (b + std::copysign(std::sqrt(square), b));
    Keep(q / a);
    if (q != 0.0) Keep(c / q);
  }

  // The values first + k * step for k in 0..count-1. Precondition: step > 0.
  void AddGrid(double first, double step, int count) {
    const double begin = std::max(0.0, std::ceil((low_ - first) / step));
    const double end = std::min(count - 1.0, std::floor((high_ - first) / step));
    for (double k = begin; k <= end; ++k) Add(first + step * k);
  }

  // In order.
  std::span<const double> Sorted() {
    std::sort(times_.begin(), times_.begin() + static_cast<std::ptrdiff_t>(count_));
    return {times_.data(), count_};
  }

 private:
  void Extend(double speed) {
    low_ = std::min(low_, speed);
    high_ = std::max(high_, speed);
  }
  void Keep(double t) {
    if (t > 0.0 && t < part_.duration_s && count_ < times_.size()) times_[count_++] = t;
  }

  const PhasePart& part_;
  double low_ = 0.0;
  double high_ = 0.0;
  std::array<double, 2 * (kSpeedBins + kPowerBins + 2 + CutPace::kBounds)> times_{};
  std::size_t count_ = 0;
};

// Seconds to whole nanoseconds with a given sum: rounding errors go to the greatest.
template <std::size_t N>
std::array<SimTime, N> Rounded(const std::array<motion::LongSum, N>& sums, SimTime total) {
  std::array<SimTime, N> times{};
  SimTime left = total;
  for (std::size_t i = 0; i < N; ++i) {
    times[i] = FromSeconds(sums[i].value());
    left -= times[i];
  }
  *std::max_element(times.begin(), times.end()) += left;
  return times;
}

}  // namespace

double BeamWork::Moving(const motion::SpeedProfile& profile, double from_s, double to_s,
                        double tip_per_s, const machine::PowerBySpeed& power, CutPace* pace) {
  motion::LongSum percent_s;
  ForEachPhase(profile, from_s, to_s, [&](const PhasePart& part) {
    Crossings crossings(part);
    if (tip_per_s > 0.0) {
      const double class_width = speed_max_ * kBin_percent / kFull_percent / tip_per_s;
      if (class_width > 0.0) crossings.AddGrid(class_width, class_width, kSpeedBins - 2);
      const double slope = power.percent_per_mm_s * tip_per_s;
      const double width = kBin_percent / std::abs(slope);
      const double zero = -power.constant_percent / slope;
      if (slope > 0.0) crossings.AddGrid(zero, width, kPowerBins + 1);
      if (slope < 0.0) crossings.AddGrid(zero - kPowerBins * width, width, kPowerBins + 1);
      if (pace != nullptr) {
        for (const double bound : pace->bounds()) crossings.Add(bound / tip_per_s);
      }
    }
    double begin = 0.0;
    const auto stretch = [&](double end) {
      if (!(end > begin)) return;
      const double duration = end - begin;
      // Mean speed: the stretch lies in one class, and the power is linear in the speed or
      // constant.
      const double speed = tip_per_s * (part.PlaceAt(end) - part.PlaceAt(begin)) / duration;
      const double percent = power.PercentAt(speed);
      percent_s.Add(percent * duration);
      Count(duration, speed, percent);
      if (pace != nullptr) pace->Add(duration, speed, percent);
      begin = end;
    };
    for (const double t : crossings.Sorted()) stretch(t);
    stretch(part.duration_s);
  });
  return watts_ * percent_s.value() / kFull_percent;
}

double BeamWork::Standing(double duration_s, double power_percent) {
  const double percent = std::clamp(power_percent, 0.0, kFull_percent);
  Count(duration_s, 0.0, percent);
  return watts_ * percent * duration_s / kFull_percent;
}

void BeamWork::Count(double duration_s, double tip_speed, double power_percent) {
  std::size_t speed_bin = 0;
  if (tip_speed > 0.0 && speed_max_ > 0.0) {
    const double share = tip_speed / speed_max_ * (kSpeedBins - 1);
    speed_bin = 1 + static_cast<std::size_t>(std::clamp(share, 0.0, kSpeedBins - 2.0));
  }
  const double bin = std::clamp(power_percent / kBin_percent, 0.0, kPowerBins - 1.0);
  const auto power_bin = static_cast<std::size_t>(bin);
  for (BeamTimes* times : {&all_, also_}) {
    if (times == nullptr) continue;
    times->by_speed[speed_bin].Add(duration_s);
    times->by_power[power_bin].Add(duration_s);
  }
}

BeamHistogram BeamTimes::Histogram(SimTime beam_on) const {
  return {.by_speed = Rounded(by_speed, beam_on), .by_power = Rounded(by_power, beam_on)};
}

}  // namespace rmlcell::simulation
