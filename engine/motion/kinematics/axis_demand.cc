#include "engine/motion/kinematics/axis_demand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/core/indices.h"
#include "engine/core/units.h"
#include "engine/motion/geometry/least.h"
#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr double kSampleAngle_rad = 0.05;  // motion.md 5.1: at most this much turning per interval
constexpr int kIntervalsMin = 16;
constexpr double kTurningMax_rad =
    60.0;  // more than any travel: bounds will do, a search would last
constexpr std::size_t kPlacesMax = 1202;  // of a search: 60 rad in parts of 0.05, and a rounding

using OfAxes = std::array<double, kAxisCount>;

template <std::size_t kCount>
double Least(const std::array<double, kCount>& limits) {
  double least = HUGE_VAL;
  for (const double limit : limits) least = std::min(least, limit);
  return least;
}

// What an axis allows: the speed by its own, and by its acceleration in the bend; the acceleration
// that is left at a speed; the jerk.
double SpeedAllowed(std::size_t axis, const AxisDerivatives& q, const AxisLimits& axes,
                    const AxisShares& shares) {
  return shares.speed * axes.speed[axis] / std::abs(q.first[axis]);
}
double BendSpeedAllowed(std::size_t axis, const AxisDerivatives& q, const AxisLimits& axes,
                        const AxisShares& shares) {
  return std::sqrt(0.5 * shares.acceleration * axes.acceleration[axis] / std::abs(q.second[axis]));
}
double AccelerationAllowed(std::size_t axis, const AxisDerivatives& q, const AxisLimits& axes,
                           const AxisShares& shares, double speed) {
  const double taken = std::abs(q.second[axis]) * speed * speed;
  return (shares.acceleration * axes.acceleration[axis] - taken) / std::abs(q.first[axis]);
}
double JerkAllowed(std::size_t axis, const AxisDerivatives& q, const AxisLimits& axes,
                   const AxisShares& shares) {
  return shares.acceleration * axes.jerk[axis] / std::abs(q.first[axis]);
}

// What each axis allows. By its speed, and by its acceleration in the bend.
using SpeedsOfAxes = std::array<double, 2 * kAxisCount>;
SpeedsOfAxes SpeedsAllowed(const AxisDerivatives& q, const AxisLimits& axes,
                           const AxisShares& shares) {
  SpeedsOfAxes speeds;
  for (const std::size_t i : kAxes) {
    speeds[i] = SpeedAllowed(i, q, axes, shares);
    speeds[kAxisCount + i] = BendSpeedAllowed(i, q, axes, shares);
  }
  return speeds;
}

OfAxes AccelerationsAllowed(const AxisDerivatives& q, const AxisLimits& axes,
                            const AxisShares& shares, double speed) {
  OfAxes accelerations;
  for (const std::size_t i : kAxes) {
    accelerations[i] = AccelerationAllowed(i, q, axes, shares, speed);
  }
  return accelerations;
}

OfAxes JerksAllowed(const AxisDerivatives& q, const AxisLimits& axes, const AxisShares& shares) {
  OfAxes jerks;
  for (const std::size_t i : kAxes) jerks[i] = JerkAllowed(i, q, axes, shares);
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
  for (const std::size_t k : Indices(parts)) {
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
  for (const std::size_t k : Indices(parts)) {
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

// The extremes along a piece at which the head turns, searched for at the same places for all
// limits. On a line the ends alone tell them wherever it is proven that what an axis is asked for
// rises or falls all the way, or stays below what counts: the search would find the same. Nor is an
// axis searched that is proven, from what is asked of it at those places and how much that can
// change between them, to allow more than others do.
class AxisSearch {
 public:
  AxisSearch(const PathPiece& path, const Head& head, const AxisLimits& axes,
             const AxisShares& shares, int intervals)
      : path_(path),
        head_(head),
        axes_(axes),
        shares_(shares),
        intervals_(intervals),
        line_(path.kind() != PathPiece::Kind::kArc),
        start_(DerivativesAt(path, head, 0.0)),
        end_(DerivativesAt(path, head, Place(intervals))) {
    const double arm = head.reach_mm();
    const double rate = std::abs(path.a_rate()) + std::abs(path.b_rate());
    const double square = path.length() * path.length();
    const double angles = 1.0 + std::max(std::abs(path.from().a_rad), std::abs(path.to().a_rad)) +
                          std::max(std::abs(path.from().b_rad), std::abs(path.to().b_rad));
    const double whirl = arm * rate * rate;
    const double bend = line_ ? 0.0 : 1.0 / path.radius_mm();
    change_ = {.first = bend + whirl, .second = bend * bend + whirl * rate};
    first_ = {.bend = whirl * rate * square,
              .margin = kMargin * angles * (path.First(0.0).point.norm() + arm * rate)};
    second_ = {.bend = whirl * rate * rate * square, .margin = kMargin * angles * whirl};
  }

  // The lower of `most` and what the axes allow: speed, then acceleration at that speed, jerk.
  double Speed(double most) {
    const auto allowed = [&](const AxisDerivatives& q) { return SpeedsAllowed(q, axes_, shares_); };
    const double least = std::min({most, Least(allowed(start_)), Least(allowed(end_))});
    bool known = line_;
    for (const std::size_t i : kLinearAxes) {
      const double bend = 0.5 * shares_.acceleration * axes_.acceleration[i];
      known = known &&
              EndsTell(start_.first[i], end_.first[i], first_,
                       shares_.speed * axes_.speed[i] / least) &&
              EndsTell(start_.second[i], end_.second[i], second_, bend / (least * least));
    }
    if (known) return least;
    const double by_speed = LeastOf(least, [&](std::size_t i, const AxisDerivatives& q) {
      return SpeedAllowed(i, q, axes_, shares_);
    });
    return LeastOf(by_speed, [&](std::size_t i, const AxisDerivatives& q) {
      return BendSpeedAllowed(i, q, axes_, shares_);
    });
  }
  double Acceleration(double most, double speed) {
    const auto allowed = [&](const AxisDerivatives& q) {
      return AccelerationsAllowed(q, axes_, shares_, speed);
    };
    const double least = std::min({most, Least(allowed(start_)), Least(allowed(end_))});
    bool known = line_;
    for (const std::size_t i : kLinearAxes) known = known && EndsTellRoom(i, speed, least);
    if (known) return least;
    return LeastOf(least, [&](std::size_t i, const AxisDerivatives& q) {
      return AccelerationAllowed(i, q, axes_, shares_, speed);
    });
  }
  double Jerk(double most) {
    const auto allowed = [&](const AxisDerivatives& q) { return JerksAllowed(q, axes_, shares_); };
    const double least = std::min({most, Least(allowed(start_)), Least(allowed(end_))});
    bool known = line_;
    for (const std::size_t i : kLinearAxes) {
      known = known && EndsTell(start_.first[i], end_.first[i], first_,
                                shares_.acceleration * axes_.jerk[i] / least);
    }
    if (known) return least;
    return LeastOf(least, [&](std::size_t i, const AxisDerivatives& q) {
      return JerkAllowed(i, q, axes_, shares_);
    });
  }

 private:
  // Of a derivative along the line: how much its own second derivative may bend it over the length,
  // and by how much more it must change from end to end for its course to show above rounding at
  // the place next to an end that a search looks at, 7e-10 of the length away.
  struct Drift {
    double bend;
    double margin;
  };
  static constexpr double kMargin = 3e-5;
  static constexpr double kSurely = 1.0 + 1e-9;

  double Place(int k) const { return path_.length() * k / intervals_; }

  static bool EndsTell(double start, double end, const Drift& drift, double enough) {
    const double high = std::max(std::abs(start), std::abs(end));
    if ((high + 0.125 * drift.bend) * kSurely <= enough) return true;
    const double low = std::min(std::abs(start), std::abs(end));
    return start * end > 0.0 && high - low - drift.bend > drift.margin;
  }

  // The same of (a - |q''| v^2) / |q'|: where one end has the least, what is above that by cross
  // products is bent no more than its parts are.
  bool EndsTellRoom(std::size_t axis, double speed, double least) const {
    const double square = speed * speed;
    const double most = shares_.acceleration * axes_.acceleration[axis];
    const double along[] = {std::abs(start_.first[axis]), std::abs(end_.first[axis])};
    const double across[] = {std::abs(start_.second[axis]), std::abs(end_.second[axis])};
    const double taken = (std::max(across[0], across[1]) + 0.125 * second_.bend) * square;
    if ((std::max(along[0], along[1]) + 0.125 * first_.bend) * least * kSurely <= most - taken) {
      return true;
    }
    const double left[] = {most - across[0] * square, most - across[1] * square};
    const int low = left[0] * along[1] < left[1] * along[0] ? 0 : 1;
    const double above = left[1 - low] * along[low] - left[low] * along[1 - low];
    const double bend = square * second_.bend * along[low] + left[low] * first_.bend;
    const double margin = square * second_.margin * along[low] + left[low] * first_.margin;
    return left[low] > 0.0 && start_.first[axis] * end_.first[axis] > 0.0 &&
           std::min(along[0], along[1]) > first_.bend &&
           start_.second[axis] * end_.second[axis] > 0.0 &&
           std::min(across[0], across[1]) > second_.bend && above - bend > margin;
  }

  // The lower of `low` and what any axis allows: `allowed(axis, q)`, the less the more is asked.
  template <class Allowed>
  double LeastOf(double low, Allowed allowed) {
    Sample();
    for (const std::size_t i : kAxes) {
      if (allowed(i, bound_) >= low) continue;
      const auto at = [&](int k) {
        return std::array{allowed(i, AsKept(kept_[static_cast<std::size_t>(k)]))};
      };
      const auto one = [&](std::size_t, double s) {
        return allowed(i, DerivativesAt(path_, head_, s));
      };
      low = std::min(low,
                     LeastOfSampled<Closing::kParabolas>(at, one, path_.length(), intervals_, low));
    }
    return low;
  }

  // The derivatives at all places, and what they are nowhere above.
  void Sample() {
    if (sampled_) return;
    sampled_ = true;
    for (int k = 0; k <= intervals_; ++k) {
      const AxisDerivatives q = DerivativesAt(path_, head_, Place(k));
      kept_[static_cast<std::size_t>(k)] = ToKeep(q);
      for (const std::size_t i : kAxes) {
        bound_.first[i] = std::max(bound_.first[i], std::abs(q.first[i]));
        bound_.second[i] = std::max(bound_.second[i], std::abs(q.second[i]));
      }
    }
    const double half = 0.5 * path_.length() / intervals_;
    for (const std::size_t i : kLinearAxes) {
      bound_.first[i] = (bound_.first[i] + half * change_.first) * kSurely;
      bound_.second[i] = (bound_.second[i] + half * change_.second) * kSurely;
    }
  }

  const PathPiece& path_;
  const Head& head_;
  const AxisLimits& axes_;
  const AxisShares& shares_;
  int intervals_;
  bool line_;
  AxisDerivatives start_;
  AxisDerivatives end_;
  Drift first_;
  Drift second_;
  // How fast the derivatives of the column change along the piece, at most.
  struct Change {
    double first;
    double second;
  };
  Change change_;
  // Bare numbers, which cost nothing before they are there.
  using Kept = std::array<double, 2 * kAxisCount>;
  static Kept ToKeep(const AxisDerivatives& q) {
    Kept kept;
    for (const std::size_t i : kAxes) {
      kept[i] = q.first[i];
      kept[kAxisCount + i] = q.second[i];
    }
    return kept;
  }
  static AxisDerivatives AsKept(const Kept& kept) {
    AxisDerivatives q;
    for (const std::size_t i : kAxes) {
      q.first[i] = kept[i];
      q.second[i] = kept[kAxisCount + i];
    }
    return q;
  }
  bool sampled_ = false;
  AxisDerivatives bound_;
  std::array<Kept, kPlacesMax> kept_;
};

}  // namespace

AxisDerivatives DerivativesAt(const PathPiece& path, const Head& head, double s) {
  if (path.kind() == PathPiece::Kind::kArc) {
    const PathPiece::OnArc at = path.ArcAt(s);
    if (at.first.a != 0.0 || at.first.b != 0.0) {
      return ThroughHead(head, {{}, at.a_rad, at.b_rad}, at.first, at.second);
    }
  }
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
  AxisSearch search(path, head, axes, shares, intervals);
  limits.speed = search.Speed(limits.speed);
  limits.acceleration = search.Acceleration(limits.acceleration, limits.speed);
  if (std::isfinite(limits.jerk)) limits.jerk = search.Jerk(limits.jerk);
  return limits;
}

}  // namespace rmlcell::motion
