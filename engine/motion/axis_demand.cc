#include "engine/motion/axis_demand.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::motion {
namespace {

constexpr double kSampleAngle_rad = 0.05;  // motion.md 5.1: at most this much turning per interval
constexpr int kIntervalsMin = 16;
constexpr int kIntervalsMax = 4096;  // 200 rad of turning: 16 turns of the widest head
constexpr double kCandidate = 0.95;  // sample maxima below this share of the best cannot win

std::size_t At(int axis) { return static_cast<std::size_t>(axis); }

// The least of the axes' answers to `ask`, which gives a limit for one axis.
template <class Ask>
double Least(Ask ask) {
  double least = HUGE_VAL;
  for (int axis = 0; axis < kAxisCount; ++axis) least = std::min(least, ask(At(axis)));
  return least;
}

double SpeedAllowed(const AxisDerivatives& q, const AxisLimits& axes, const AxisShares& shares) {
  return Least([&](std::size_t i) {
    const double by_speed = shares.speed * axes.speed[i] / std::abs(q.first[i]);
    if (q.second[i] == 0.0) return by_speed;
    return std::min(by_speed, std::sqrt(0.5 * shares.acceleration * axes.acceleration[i] /
                                        std::abs(q.second[i])));
  });
}

double AccelerationAllowed(const AxisDerivatives& q, const AxisLimits& axes,
                           const AxisShares& shares, double speed) {
  return Least([&](std::size_t i) {
    const double taken = std::abs(q.second[i]) * speed * speed;
    return (shares.acceleration * axes.acceleration[i] - taken) / std::abs(q.first[i]);
  });
}

double JerkAllowed(const AxisDerivatives& q, const AxisLimits& axes, const AxisShares& shares) {
  return Least(
      [&](std::size_t i) { return shares.acceleration * axes.jerk[i] / std::abs(q.first[i]); });
}

// Upper bounds of both derivatives over the whole piece, cheap: enough for most moves.
AxisDerivatives Bounds(const PathPiece& path, const Head& head) {
  const double arm =
      std::sqrt(head.tool.x_mm * head.tool.x_mm + head.tool.y_mm * head.tool.y_mm +
                (head.length_mm - head.tool.z_mm) * (head.length_mm - head.tool.z_mm));
  const double a = std::abs(path.a_rate());
  const double b = std::abs(path.b_rate());
  const double swing = arm * (a + b);
  const double whirl = arm * (a + b) * (a + b);
  AxisDerivatives q;
  Vec3 first = path.Tangent(0.0);
  Vec3 second;
  if (path.kind() == PathPiece::Kind::kArc) {
    const Vec3& n = path.normal();
    first = {std::sqrt(std::max(0.0, 1.0 - n.x * n.x)), std::sqrt(std::max(0.0, 1.0 - n.y * n.y)),
             std::sqrt(std::max(0.0, 1.0 - n.z * n.z))};
    second = first * (1.0 / path.radius_mm());
  }
  q.first = {std::abs(first.x) + swing, std::abs(first.y) + swing, std::abs(first.z) + swing, a, b};
  q.second = {second.x + whirl, second.y + whirl, second.z + whirl, 0.0, 0.0};
  return q;
}

// The least value of `f` over [0, length], given its values at equal steps: every sample minimum
// that could win is refined by golden sections.
template <class F, class Samples>
double Minimum(F f, const Samples& samples, int intervals, double length) {
  double best = HUGE_VAL;
  for (int k = 0; k <= intervals; ++k) best = std::min(best, f(samples(k)));
  const double worth_a_look = best / kCandidate;
  for (int k = 0; k <= intervals; ++k) {
    const double here = f(samples(k));
    if (here > worth_a_look) continue;
    if (k > 0 && f(samples(k - 1)) < here) continue;
    if (k < intervals && f(samples(k + 1)) < here) continue;
    double low = length * std::max(k - 1, 0) / intervals;
    double high = length * std::min(k + 1, intervals) / intervals;
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kSections = 40;  // 0.618^40 = 4e-9 of the bracket; the value is flat there
    double left = high - kGolden * (high - low);
    double right = low + kGolden * (high - low);
    double at_left = f.At(left);
    double at_right = f.At(right);
    for (int section = 0; section < kSections; ++section) {
      if (at_left < at_right) {
        high = right;
        right = left;
        at_right = at_left;
        left = high - kGolden * (high - low);
        at_left = f.At(left);
      } else {
        low = left;
        left = right;
        at_left = at_right;
        right = low + kGolden * (high - low);
        at_right = f.At(right);
      }
    }
    best = std::min({best, at_left, at_right});
  }
  return best;
}

// A limit as a function of the derivatives, also callable at a place of the path.
template <class Limit>
struct AlongPath {
  const PathPiece& path;
  const Head& head;
  Limit limit;
  double operator()(const AxisDerivatives& q) const { return limit(q); }
  double At(double s) const { return limit(DerivativesAt(path, head, s)); }
};

}  // namespace

AxisDerivatives DerivativesAt(const PathPiece& path, const Head& head, double s) {
  const TipRates first{path.Tangent(s), path.a_rate(), path.b_rate()};
  AxisDerivatives q;
  if (path.kind() == PathPiece::Kind::kJoint) {
    q.first = {first.tip.x, first.tip.y, first.tip.z, first.a, first.b};
    return q;
  }
  const TipRates second{path.Curvature(s), 0.0, 0.0};
  if (first.a == 0.0 && first.b == 0.0) {
    q.first = {first.tip.x, first.tip.y, first.tip.z, 0.0, 0.0};
    q.second = {second.tip.x, second.tip.y, second.tip.z, 0.0, 0.0};
    return q;
  }
  const TipPose pose = path.At(s);
  q.first = AxisRates(head, pose.a_rad, pose.b_rad, first);
  q.second = AxisSecondRates(head, pose.a_rad, pose.b_rad, first, second);
  return q;
}

PathLimits WithinAxes(const PathPiece& path, const Head& head, const AxisLimits& axes,
                      const AxisShares& shares, PathLimits limits) {
  const bool turns = path.a_rate() != 0.0 || path.b_rate() != 0.0;
  const bool arc = path.kind() == PathPiece::Kind::kArc;
  const bool constant = path.kind() == PathPiece::Kind::kJoint || (!arc && !turns);
  const AxisDerivatives bounds = constant ? DerivativesAt(path, head, 0.0) : Bounds(path, head);
  const double by_bound = SpeedAllowed(bounds, axes, shares);
  if (constant || by_bound >= limits.speed) {
    limits.speed = std::min(limits.speed, by_bound);
    const double acceleration = AccelerationAllowed(bounds, axes, shares, limits.speed);
    const double jerk = JerkAllowed(bounds, axes, shares);
    if (constant || (acceleration >= limits.acceleration && jerk >= limits.jerk)) {
      limits.acceleration = std::min(limits.acceleration, acceleration);
      if (std::isfinite(limits.jerk)) limits.jerk = std::min(limits.jerk, jerk);
      return limits;
    }
  }

  const double turning = std::abs(path.to().a_rad - path.from().a_rad) +
                         std::abs(path.to().b_rad - path.from().b_rad) +
                         (arc ? path.sweep_rad() : 0.0);
  const double wanted = std::ceil(turning / kSampleAngle_rad);
  const int intervals = static_cast<int>(
      std::clamp(wanted, static_cast<double>(kIntervalsMin), static_cast<double>(kIntervalsMax)));
  const auto sample = [&](int k) {
    return DerivativesAt(path, head, path.length() * k / intervals);
  };

  const auto speed = [&](const AxisDerivatives& q) { return SpeedAllowed(q, axes, shares); };
  limits.speed = std::min(limits.speed, Minimum(AlongPath<decltype(speed)>{path, head, speed},
                                                sample, intervals, path.length()));
  const auto acceleration = [&](const AxisDerivatives& q) {
    return AccelerationAllowed(q, axes, shares, limits.speed);
  };
  limits.acceleration = std::min(
      limits.acceleration, Minimum(AlongPath<decltype(acceleration)>{path, head, acceleration},
                                   sample, intervals, path.length()));
  if (std::isfinite(limits.jerk)) {
    const auto jerk = [&](const AxisDerivatives& q) { return JerkAllowed(q, axes, shares); };
    limits.jerk = std::min(limits.jerk, Minimum(AlongPath<decltype(jerk)>{path, head, jerk}, sample,
                                                intervals, path.length()));
  }
  return limits;
}

}  // namespace rmlcell::motion
