#include "engine/motion/kinematics/axis_demand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/core/units.h"
#include "engine/motion/geometry/least.h"
#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr double kSampleAngle_rad = 0.05;  // motion.md 5.1: at most this much turning per interval
constexpr int kIntervalsMin = 16;
constexpr double kTurningMax_rad =
    60.0;  // more than any travel: bounds will do, a search would last

using OfAxes = std::array<double, kAxisCount>;

template <std::size_t kCount>
double Least(const std::array<double, kCount>& limits) {
  double least = HUGE_VAL;
  for (const double limit : limits) least = std::min(least, limit);
  return least;
}

// What each axis allows. By its speed, and by its acceleration in the bend.
SpeedsOfAxes SpeedsAllowed(const AxisDerivatives& q, const AxisLimits& axes,
                           const AxisShares& shares) {
  SpeedsOfAxes speeds;
  for (const std::size_t i : kAxes) {
    speeds[i] = shares.speed * axes.speed[i] / std::abs(q.first[i]);
    speeds[kAxisCount + i] =
        std::sqrt(0.5 * shares.acceleration * axes.acceleration[i] / std::abs(q.second[i]));
  }
  return speeds;
}

OfAxes AccelerationsAllowed(const AxisDerivatives& q, const AxisLimits& axes,
                            const AxisShares& shares, double speed) {
  OfAxes accelerations;
  for (const std::size_t i : kAxes) {
    const double taken = std::abs(q.second[i]) * speed * speed;
    accelerations[i] = (shares.acceleration * axes.acceleration[i] - taken) / std::abs(q.first[i]);
  }
  return accelerations;
}

OfAxes JerksAllowed(const AxisDerivatives& q, const AxisLimits& axes, const AxisShares& shares) {
  OfAxes jerks;
  for (const std::size_t i : kAxes) {
    jerks[i] = shares.acceleration * axes.jerk[i] / std::abs(q.first[i]);
  }
  return jerks;
}

// Whether no axis is asked for more than it can, without a division: nearly always so.
bool Allows(const AxisDerivatives& q, const AxisLimits& axes, const AxisShares& shares,
            const PathLimits& limits) {
  const double square = limits.speed * limits.speed;
  bool enough = true;
  for (const std::size_t i : kAxes) {
    const double along = std::abs(q.first[i]);
    const double across = std::abs(q.second[i]) * square;
    const double acceleration = shares.acceleration * axes.acceleration[i];
    enough = enough && along * limits.speed <= shares.speed * axes.speed[i] &&
             2.0 * across <= acceleration && across + along * limits.acceleration <= acceleration &&
             (along * limits.jerk <= shares.acceleration * axes.jerk[i] || std::isinf(limits.jerk));
  }
  return enough;
}

// Upper bounds of both derivatives over the whole piece, cheap: enough for most moves.
AxisDerivatives Bounds(const PathPiece& path, const Head& head) {
  const double arm = head.reach_mm();
  const double a = std::abs(path.a_rate());
  const double b = std::abs(path.b_rate());
  const double swing = arm * (a + b);
  const double whirl = arm * (a + b) * (a + b);
  AxisDerivatives q;
  MachineVector first = path.Tangent(0.0);
  MachineVector second;
  if (path.kind() == PathPiece::Kind::kArc) {
    const MachineVector& n = path.normal();
    first = {std::sqrt(std::max(0.0, 1.0 - n.x() * n.x())),
             std::sqrt(std::max(0.0, 1.0 - n.y() * n.y())),
             std::sqrt(std::max(0.0, 1.0 - n.z() * n.z()))};
    second = first * (1.0 / path.radius_mm());
  }
  q.first = {std::abs(first.x()) + swing, std::abs(first.y()) + swing, std::abs(first.z()) + swing,
             a, b};
  q.second = {second.x() + whirl, second.y() + whirl, second.z() + whirl, 0.0, 0.0};
  return q;
}

// The limits on a line along which the head turns a little, from places in the middle of a few
// parts and how far the derivatives can get away from them: within 1 % of what there is,
// motion.md 5.1. Nothing where that does not tell enough.
std::optional<PathLimits> LimitsOnShortTurn(const PathPiece& path, const Head& head,
                                            const AxisLimits& axes, const AxisShares& shares,
                                            const PathLimits& limits) {
  constexpr double kRoom = 0.004;
  constexpr std::size_t kPartsMax = 8;
  const PathDerivatives first = path.First(0.0);  // and everywhere: there is no second one
  const double rate = std::abs(first.a) + std::abs(first.b);
  const double half = 0.5 * path.length();
  const double drift = half * head.reach_mm() * rate * rate;
  const double wanted = std::ceil(std::max(drift / first.point.norm(), half * rate) / kRoom);
  if (!(wanted <= static_cast<double>(kPartsMax))) return std::nullopt;
  const auto parts = static_cast<std::size_t>(std::max(wanted, 1.0));
  const double share = 1.0 / static_cast<double>(parts);
  std::array<AxisDerivatives, kPartsMax> at;
  std::array<AxisDerivatives, kPartsMax> around;
  PathLimits sure = limits;  // kept all along
  PathLimits most = limits;  // more than the places looked at allow there is not
  for (std::size_t k = 0; k < parts; ++k) {
    const double s = path.length() * (static_cast<double>(k) + 0.5) * share;
    at[k] = around[k] = ThroughHead(head, path.At(s), first, {});
    AxisDerivatives& q = around[k];
    for (const std::size_t i : kLinearAxes) {
      q.first[i] = std::abs(q.first[i]) + drift * share;
      q.second[i] = std::abs(q.second[i]) + drift * share * rate;
    }
    if (Allows(q, axes, shares, limits)) continue;
    sure.speed = std::min(sure.speed, Least(SpeedsAllowed(q, axes, shares)));
    most.speed = std::min(most.speed, Least(SpeedsAllowed(at[k], axes, shares)));
    if (std::isinf(limits.jerk)) continue;
    sure.jerk = std::min(sure.jerk, Least(JerksAllowed(q, axes, shares)));
    most.jerk = std::min(most.jerk, Least(JerksAllowed(at[k], axes, shares)));
  }
  for (std::size_t k = 0; k < parts; ++k) {
    if (Allows(around[k], axes, shares, sure)) continue;
    const auto allowed = [&](const AxisDerivatives& q) {
      return Least(AccelerationsAllowed(q, axes, shares, sure.speed));
    };
    sure.acceleration = std::min(sure.acceleration, allowed(around[k]));
    most.acceleration = std::min(most.acceleration, allowed(at[k]));
  }
  // An axis that moves little beside the others may be told too little of: then it is searched.
  constexpr double kNear = 0.99;
  if (sure.speed >= kNear * most.speed && sure.acceleration >= kNear * most.acceleration &&
      sure.jerk >= kNear * most.jerk) {
    return sure;
  }
  return std::nullopt;
}

}  // namespace

SpeedsOfAxes SpeedsWithinAxes(const AxisDerivatives& q, const AxisLimits& axes) {
  SpeedsOfAxes speeds;
  for (const std::size_t i : kAxes) {
    speeds[i] = axes.speed[i] / std::abs(q.first[i]);
    speeds[kAxisCount + i] =
        q.second[i] == 0.0 ? HUGE_VAL : std::sqrt(axes.acceleration[i] / std::abs(q.second[i]));
  }
  return speeds;
}

AxisDerivatives DerivativesAt(const PathPiece& path, const Head& head, double s) {
  const PathDerivatives first = path.First(s);
  const PathDerivatives second = path.Second(s);
  if (path.in_axes()) {
    return {.first = {first.point.x(), first.point.y(), first.point.z(), first.a, first.b},
            .second = {second.point.x(), second.point.y(), second.point.z(), second.a, second.b}};
  }
  if (first.a == 0.0 && first.b == 0.0 && second.a == 0.0 && second.b == 0.0) {
    return {.first = {first.point.x(), first.point.y(), first.point.z(), 0.0, 0.0},
            .second = {second.point.x(), second.point.y(), second.point.z(), 0.0, 0.0}};
  }
  return ThroughHead(head, path.At(s), first, second);
}

AxisDerivatives ThroughHead(const Head& head, const PathPose& pose, const PathDerivatives& first,
                            const PathDerivatives& second) {
  const BothAxisRates rates = head.RatesOfBoth(
      pose.a_rad, pose.b_rad, {first.point, first.a, first.b}, {second.point, second.a, second.b});
  return {.first = rates.first, .second = rates.second};
}

PathLimits WithinAxes(const PathPiece& path, const Head& head, const AxisLimits& axes,
                      const AxisShares& shares, PathLimits limits) {
  const bool turns = path.a_rate() != 0.0 || path.b_rate() != 0.0;
  const bool arc = path.kind() == PathPiece::Kind::kArc;
  const bool constant = path.kind() == PathPiece::Kind::kJoint || (!arc && !turns);
  const AxisDerivatives bounds = constant ? DerivativesAt(path, head, 0.0) : Bounds(path, head);
  const auto by_bounds = [&] {
    limits.speed = std::min(limits.speed, Least(SpeedsAllowed(bounds, axes, shares)));
    limits.acceleration = std::min(limits.acceleration,
                                   Least(AccelerationsAllowed(bounds, axes, shares, limits.speed)));
    if (std::isfinite(limits.jerk))
      limits.jerk = std::min(limits.jerk, Least(JerksAllowed(bounds, axes, shares)));
    return limits;
  };
  if (constant) return by_bounds();
  if (Allows(bounds, axes, shares, limits)) return limits;

  if (!arc) {
    if (const auto near = LimitsOnShortTurn(path, head, axes, shares, limits)) return *near;
  }

  const double turning = std::abs(path.to().a_rad - path.from().a_rad) +
                         std::abs(path.to().b_rad - path.from().b_rad) +
                         (arc ? path.sweep_rad() : 0.0);
  if (!(turning <= kTurningMax_rad)) return by_bounds();
  const int intervals =
      std::max(static_cast<int>(std::ceil(turning / kSampleAngle_rad)), kIntervalsMin);
  const auto least = [&](auto allowed) {
    return LeastOfAll([&](double s) { return allowed(DerivativesAt(path, head, s)); },
                      path.length(), intervals);
  };
  limits.speed =
      std::min(limits.speed,
               least([&](const AxisDerivatives& q) { return SpeedsAllowed(q, axes, shares); }));
  limits.acceleration = std::min(limits.acceleration, least([&](const AxisDerivatives& q) {
                                   return AccelerationsAllowed(q, axes, shares, limits.speed);
                                 }));
  if (std::isfinite(limits.jerk)) {
    limits.jerk =
        std::min(limits.jerk,
                 least([&](const AxisDerivatives& q) { return JerksAllowed(q, axes, shares); }));
  }
  return limits;
}

}  // namespace rmlcell::motion
