#include "engine/simulation/motion_peaks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/motion/axis_demand.h"
#include "engine/simulation/path_extent.h"
#include "engine/simulation/profile_phases.h"

namespace rmlcell::simulation {
namespace {

using motion::AxisValues;
using motion::PathPiece;
using motion::Vec3;

constexpr int kSamplesMin = 4;    // of a phase: ends and two between
constexpr int kSamplesMax = 512;  // 25 rad of turning

void Raise(double& peak, double value) { peak = std::max(peak, std::abs(value)); }

// Second derivative of the tip by s where the head turns in COORD ROBOT: from the first at two
// places, since only a peak is asked for.
Vec3 TipSecondRate(const PathPiece& path, const motion::Head& head, double s) {
  if (path.kind() != PathPiece::Kind::kJoint) return path.Curvature(s);
  constexpr double kStep = 1e-5;  // of sigma: error 1e-9 of the swing
  const double low = std::max(0.0, s - kStep);
  const double high = std::min(path.length(), s + kStep);
  return (TipRate(path, head, high) - TipRate(path, head, low)) * (1.0 / (high - low));
}

// What path and tool give at one place, by s.
struct Rates {
  Vec3 tip;
  Vec3 tip_second;
  AxisValues axes{};
  AxisValues axes_second{};
};

// The axes go as the tip does.
void FollowTip(Rates& rates, const PathPiece& path) {
  rates.axes = {rates.tip.x, rates.tip.y, rates.tip.z, path.a_rate(), path.b_rate()};
  rates.axes_second = {rates.tip_second.x, rates.tip_second.y, rates.tip_second.z, 0.0, 0.0};
}

Rates RatesAt(const motion::PlannedMotion& motion, bool five_axis, double s) {
  const PathPiece& path = motion.path;
  Rates rates;
  rates.tip = TipRate(path, motion.head, s);
  rates.tip_second = TipSecondRate(path, motion.head, s);
  if (five_axis && Turns(path)) {
    const motion::AxisDerivatives axes = motion::DerivativesAt(path, motion.head, s);
    rates.axes = axes.first;
    rates.axes_second = axes.second;
  } else {
    FollowTip(rates, path);
  }
  return rates;
}

// The same on an arc whose axes go as the tip does: what does not change is worked out once.
class ArcRates {
 public:
  explicit ArcRates(const PathPiece& path)
      : path_(path),
        along_(path.Tangent(0.0)),
        inward_(path.Curvature(0.0) * path.radius_mm()),
        per_radius_(1.0 / path.radius_mm()) {}

  Rates At(double s) const {
    const double sine = std::sin(s * per_radius_);
    const double cosine = std::cos(s * per_radius_);
    Rates rates;
    rates.tip = along_ * cosine + inward_ * sine;
    rates.tip_second = (inward_ * cosine - along_ * sine) * per_radius_;
    FollowTip(rates, path_);
    return rates;
  }

 private:
  const PathPiece& path_;
  Vec3 along_;
  Vec3 inward_;
  double per_radius_;
};

void AddSample(MotionPeaks& peaks, const Rates& rates, double speed, double acceleration) {
  const double squared = speed * speed;
  Raise(peaks.tip_speed, Norm(rates.tip) * speed);
  Raise(peaks.tip_acceleration, Norm(rates.tip * acceleration + rates.tip_second * squared));
  for (std::size_t i = 0; i < peaks.axis_speed.size(); ++i) {
    Raise(peaks.axis_speed[i], rates.axes[i] * speed);
    Raise(peaks.axis_acceleration[i],
          rates.axes[i] * acceleration + rates.axes_second[i] * squared);
  }
}

// The derivatives by s are the same everywhere: only speed and acceleration count.
MotionPeaks Straight(const motion::PlannedMotion& motion, bool five_axis, double from_s,
                     double to_s) {
  double speed = 0.0;
  double acceleration = 0.0;
  ForEachPhase(motion.speed, from_s, to_s, [&](const PhasePart& part) {
    const double end = part.duration_s;
    Raise(speed, part.start.speed);
    Raise(speed, part.SpeedAt(end));
    Raise(acceleration, part.start.acceleration);
    Raise(acceleration, part.AccelerationAt(end));
    const double level = part.jerk != 0.0 ? -part.start.acceleration / part.jerk : 0.0;
    if (level > 0.0 && level < end) Raise(speed, part.SpeedAt(level));
  });
  MotionPeaks peaks;
  const Rates rates = RatesAt(motion, five_axis, 0.0);
  peaks.tip_speed = Norm(rates.tip) * speed;
  peaks.tip_acceleration = Norm(rates.tip) * acceleration;
  for (std::size_t i = 0; i < peaks.axis_speed.size(); ++i) {
    peaks.axis_speed[i] = std::abs(rates.axes[i]) * speed;
    peaks.axis_acceleration[i] = std::abs(rates.axes[i]) * acceleration;
  }
  return peaks;
}

}  // namespace

MotionPeaks PeaksOf(const motion::PlannedMotion& motion, bool five_axis, double from_s,
                    double to_s) {
  const PathPiece& path = motion.path;
  const bool curved =
      path.kind() == PathPiece::Kind::kArc || path.kind() == PathPiece::Kind::kBlend;
  if (!curved && !(five_axis && Turns(path))) return Straight(motion, five_axis, from_s, to_s);

  const auto over_all = [&](auto rates_at) {
    const double turning = std::abs(path.a_rate()) + std::abs(path.b_rate()) +
                           (path.kind() == PathPiece::Kind::kArc ? 1.0 / path.radius_mm() : 0.0);
    MotionPeaks peaks;
    ForEachPhase(motion.speed, from_s, to_s, [&](const PhasePart& part) {
      const double way = part.PlaceAt(part.duration_s) - part.start.s;
      const double wanted = std::ceil(turning * std::abs(way) / kPeakSampleAngle_rad);
      const int samples =
          static_cast<int>(std::clamp(wanted, double{kSamplesMin}, double{kSamplesMax}));
      for (int k = 0; k <= samples; ++k) {
        const double t = part.duration_s * k / samples;
        AddSample(peaks, rates_at(part.PlaceAt(t)), part.SpeedAt(t), part.AccelerationAt(t));
      }
    });
    return peaks;
  };
  if (path.kind() == PathPiece::Kind::kArc && !(five_axis && Turns(path))) {
    const ArcRates arc(path);
    return over_all([&](double s) { return arc.At(s); });
  }
  return over_all([&](double s) { return RatesAt(motion, five_axis, s); });
}

}  // namespace rmlcell::simulation
