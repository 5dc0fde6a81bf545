#include "engine/motion/profile/speed_profile.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace rmlcell::motion {
namespace {

// Ramp lengths are compared against lengths that other formulas gave: this much relative room.
constexpr double kRoundingRoom = 1e-12;

struct Ramp {
  double duration_s = 0.0;
  double edge_s = 0.0;        // of each jerk phase; 0 for a trapezoid
  double acceleration = 0.0;  // in the middle, without sign
};

Ramp RampOf(double change, const PathLimits& limits) {
  const double a = limits.acceleration;
  const double j = limits.jerk;
  if (!(change > 0.0)) return {};
  if (std::isinf(j)) return {change / a, 0.0, a};
  if (change <= a * a / j) {
    const double edge = std::sqrt(change / j);
    return {2.0 * edge, edge, edge * j};
  }
  return {change / a + a / j, a / j, a};
}

// The root of f(y) = want for f increasing and convex or nearly so, from an upper bound: Newton
// steps, halved whenever they leave the bracket. `f` returns value and derivative.
template <class F>
double Root(F f, double want, double high) {
  constexpr int kStepsMax = 200;  // bisection alone ends after 64
  double low = 0.0;
  double y = high;
  for (int step = 0; step < kStepsMax; ++step) {
    const auto [value, slope] = f(y);
    const double miss = value - want;
    if (miss > 0.0) {
      high = y;
    } else {
      low = y;
    }
    double next = slope > 0.0 ? y - miss / slope : low;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - y) <= 4e-16 * high || next == low || next == high) return next;
    y = next;
  }
  return y;
}

struct ValueAndSlope {
  double value;
  double slope;
};

// Length of a ramp between `low` and low + change.
double RampLengthBy(double low, double change, const PathLimits& limits) {
  const double a = limits.acceleration;
  const double j = limits.jerk;
  const double mean = low + 0.5 * change;
  if (std::isinf(j)) return mean * change / a;
  if (change <= a * a / j) return 2.0 * mean * std::sqrt(change / j);
  return mean * (change / a + a / j);
}

// The same with its derivative by y, where the change grows with y^2: smooth in y, increasing and
// convex. With a limit on jerk.
class RampLengthByRoot {
 public:
  explicit RampLengthByRoot(const PathLimits& limits)
      : a_(limits.acceleration),
        j_(limits.jerk),
        short_(a_ * a_ / j_),
        edge_(a_ / j_),
        root_(std::sqrt(j_)) {}

  // From `top` up by y^2.
  ValueAndSlope Up(double top, double y) const {
    const double up = y * y;
    const double mean = top + 0.5 * up;
    if (up <= short_) {
      // The slope is that of (2 top + y^2) y / sqrt(j).
      return {2.0 * mean * std::sqrt(up / j_), (2.0 * top + 3.0 * up) / root_};
    }
    const double time = up / a_ + edge_;
    return {mean * time, (0.5 * time + mean / a_) * 2.0 * y};
  }
  // Down by `drop` + y^2 to `low`; y above 0.
  ValueAndSlope Down(double low, double drop, double y) const {
    const double down = drop + y * y;
    const double mean = low + 0.5 * down;
    if (down <= short_) {
      const double root = std::sqrt(down / j_);
      return {2.0 * mean * root, (root + mean / (root * j_)) * 2.0 * y};
    }
    const double time = down / a_ + edge_;
    return {mean * time, (0.5 * time + mean / a_) * 2.0 * y};
  }

 private:
  double a_, j_;
  double short_;  // changes up to here never reach the acceleration
  double edge_;
  double root_;
};

// How far a profile between `top` and top - drop rises above the top when it never cruises.
double PeakRise(double length, double top, double drop, const PathLimits& limits) {
  const double a = limits.acceleration;
  const double j = limits.jerk;
  if (top == 0.0) {  // rest to rest: closed
    if (length < 2.0 * a * a * a / (j * j)) return std::cbrt(0.25 * j * length * length);
    const double b = a * a / j;  // 0 without a limit on jerk
    return 0.5 * (std::sqrt(b * b + 4.0 * a * length) - b);
  }
  // By y = sqrt(rise) both ramp lengths are smooth, increasing and convex.
  const double low = top - drop;
  const double high = std::sqrt(std::max(limits.speed - top, 0.0));
  if (std::isinf(j)) {
    const auto both = [&](double root) {
      const double up = root * root;
      const double down = drop + up;
      return ValueAndSlope{(top + 0.5 * up) * up / a + (low + 0.5 * down) * down / a,
                           (top + up) / a * 2.0 * root + (low + down) / a * 2.0 * root};
    };
    const double y = Root(both, length, high);
    return y * y;
  }
  const RampLengthByRoot ramp(limits);
  const auto both = [&](double root) {
    const ValueAndSlope up = ramp.Up(top, root);
    const ValueAndSlope down = ramp.Down(low, drop, root);
    return ValueAndSlope{up.value + down.value, up.slope + down.slope};
  };
  const double y = Root(both, length, high);
  return y * y;
}

}  // namespace

double Reach(double v0, double length, const PathLimits& limits) {
  const double a = limits.acceleration;
  const double j = limits.jerk;
  if (!(length > 0.0)) return v0;
  const double b = a * a / j;  // 0 without a limit on jerk: then v^2 = v0^2 + 2 a length
  if ((v0 + 0.5 * b) * (2.0 * a / j) <= length) {
    const double c = v0 * b - v0 * v0 - 2.0 * a * length;
    return 0.5 * (std::sqrt(b * b - 4.0 * c) - b);
  }
  // y^3 + 2 v0 y = length sqrt(j): Newton from above, where the cubic is convex. Leaving out either
  // term gives an upper bound, and the lower of the two is within a factor 1.5 of the root.
  const double want = length * std::sqrt(j);
  double y = want / (2.0 * v0);  // infinite from rest
  if (!(y * y <= 2.0 * v0)) y = std::cbrt(want);
  if (v0 > 0.0) {
    constexpr int kStepsMax = 8;  // 5 do, with the guess above
    for (int step = 0; step < kStepsMax; ++step) {
      const double square = y * y;
      const double next = (2.0 * square * y + want) / (3.0 * square + 2.0 * v0);
      const bool done = std::abs(next - y) <= 1e-15 * y;
      y = next;
      if (done) break;
    }
  }
  return v0 + y * y;
}

double ReachMinimum(double v0_low, double v0_high, double length, const PathLimits& limits) {
  const double a = limits.acceleration;
  const double j = limits.jerk;
  const double b = a * a / j;
  // Where the derivative of Reach by v0 is 0: y^2 = 2 v0 in the short regime, v0 = b / 2 in the
  // other.
  double worst = 0.5 * b;
  if (length < b * 2.0 * a / j) {
    const double y = std::cbrt(0.5 * length * std::sqrt(j));
    worst = 0.5 * y * y;
  }
  return Reach(std::clamp(worst, v0_low, v0_high), length, limits);
}

SpeedProfile SpeedProfile::Span(double length, double v0, double v1, const PathLimits& limits) {
  // Most spans of a contour of short lines.
  if (v0 == v1 && v0 >= limits.speed && length > 0.0) return Steady(length, v0);
  SpeedProfile profile;
  profile.end_ = {std::max(length, 0.0), v1, 0.0};
  PathState state{0.0, v0, 0.0};
  if (length > 0.0) profile.AddSpan(state, length, v1, limits);
  return profile;
}

SpeedProfile SpeedProfile::OneRamp(double v0, double v1, const PathLimits& limits) {
  SpeedProfile profile;
  profile.peak_speed_ = std::max(v0, v1);
  profile.end_ = {RampLength(v0, v1, limits), v1, 0.0};
  PathState state{0.0, v0, 0.0};
  profile.AddRamp(state, std::abs(v1 - v0), std::copysign(1.0, v1 - v0), v1, limits);
  return profile;
}

SpeedProfile SpeedProfile::From(const PathState& state, double end_s, double v1,
                                const PathLimits& limits) {
  SpeedProfile profile;
  profile.end_ = {end_s, v1, 0.0};
  profile.peak_speed_ = state.speed;
  PathState now = state;
  if (now.acceleration != 0.0 && std::isfinite(limits.jerk)) {
    const double sign = std::copysign(1.0, now.acceleration);
    profile.AddPhase(now, sign * now.acceleration / limits.jerk, now.acceleration,
                     -sign * limits.jerk);
  }
  now.speed = std::max(now.speed, 0.0);  // rounding
  profile.peak_speed_ = std::max(profile.peak_speed_, now.speed);
  PathLimits span = limits;
  const double left = end_s - now.s;
  const double slow = limits.speed;
  if (now.speed > slow) {
    const double down = RampLength(now.speed, slow, limits);
    if (down + RampLength(slow, v1, limits) <= left) {
      // The last part is one ramp more, of which the cruise at the new speed takes what is left.
      profile.AddRamp(now, now.speed - slow, -1.0, slow, limits);
    } else {
      span.speed = now.speed;
    }
  }
  if (end_s > now.s) profile.AddSpan(now, end_s, v1, span);
  return profile;
}

// From state.s, with acceleration zero, to end_s.
void SpeedProfile::AddSpan(PathState& state, double end_s, double v1, const PathLimits& limits) {
  const double length = end_s - state.s;
  const double v0 = state.speed;
  const double top = std::max(v0, v1);
  const double drop = std::abs(v1 - v0);
  const double direct = RampLength(v0, v1, limits);
  if (direct > length * (1.0 + kRoundingRoom)) {
    // The ends come from Reach, whose last digits the length of a ramp hangs on. The same ramp in
    // the time that there is; but where the ends differ by nothing else (the ramp between two
    // neighbouring numbers near 500 mm/s is longer than 1e-6 mm), one speed, the mean of both.
    peak_speed_ = std::max(peak_speed_, top);
    const double time = 2.0 * length / (v0 + v1);
    const Ramp ramp = RampOf(drop, limits);
    const double squeeze = time / ramp.duration_s;
    constexpr double kSameRamp = 1.0 - 1e-6;  // its acceleration and jerk are above by that at most
    if (squeeze < kSameRamp) {
      state.speed = 0.5 * (v0 + v1);
      AddPhase(state, time, 0.0, 0.0);
      state.speed = v1;
      return;
    }
    const double edge = ramp.edge_s * squeeze;
    const double a = std::copysign(ramp.acceleration, v1 - v0) / squeeze;
    AddPhase(state, edge, 0.0, a / edge);
    AddPhase(state, time - 2.0 * edge, a, 0.0);
    AddPhase(state, edge, a, -a / edge);
    return;
  }

  // The peak as a rise above the higher end: where the two are close, their difference has no
  // digits.
  double rise = std::max(limits.speed - top, 0.0);
  double cruise =
      length - RampLength(top, top + rise, limits) - RampLengthBy(top - drop, drop + rise, limits);
  if (cruise < 0.0) {
    rise = direct >= length * (1.0 - kRoundingRoom) ? 0.0 : PeakRise(length, top, drop, limits);
    cruise = 0.0;
  }
  const double peak = top + rise;
  peak_speed_ = std::max(peak_speed_, peak);
  if (!(peak > 0.0)) return;  // a length that underflows

  AddRamp(state, rise + std::max(v1 - v0, 0.0), 1.0, peak, limits);
  if (cruise > kRoundingRoom * length) AddPhase(state, cruise / peak, 0.0, 0.0);
  AddRamp(state, rise + std::max(v0 - v1, 0.0), -1.0, v1, limits);
}

// Nothing where it takes no time.
void SpeedProfile::AddPhase(PathState& state, double duration_s, double acceleration, double jerk) {
  if (!(duration_s > 0.0)) return;
  state.acceleration = acceleration;
  phases_[static_cast<std::size_t>(count_++)] = {duration_s, jerk, state};
  const double t = duration_s;
  const double bend = jerk == 0.0 ? 0.0 : t * jerk / 6.0;  // spares the division
  state.s += t * (state.speed + t * (0.5 * acceleration + bend));
  state.speed += t * (acceleration + 0.5 * t * jerk);
  duration_s_ += duration_s;
}

void SpeedProfile::AddRamp(PathState& state, double change, double sign, double to_speed,
                           const PathLimits& limits) {
  const Ramp ramp = RampOf(change, limits);
  const double a = sign * ramp.acceleration;
  AddPhase(state, ramp.edge_s, 0.0, sign * limits.jerk);
  AddPhase(state, ramp.duration_s - 2.0 * ramp.edge_s, a, 0.0);
  AddPhase(state, ramp.edge_s, a, -sign * limits.jerk);
  state.speed = to_speed;  // exactly, whatever the phases added up to
}

PathState SpeedProfile::At(double t_s) const {
  if (count_ == 0 || t_s >= duration_s_) return end_;
  double t = std::max(t_s, 0.0);
  int index = 0;
  while (index + 1 < count_ && t >= phases_[static_cast<std::size_t>(index)].duration_s) {
    t -= phases_[static_cast<std::size_t>(index)].duration_s;
    ++index;
  }
  const Phase& p = phases_[static_cast<std::size_t>(index)];
  t = std::min(t, p.duration_s);
  PathState state;
  const double bend = p.jerk == 0.0 ? 0.0 : t * p.jerk / 6.0;
  state.s = p.start.s + t * (p.start.speed + t * (0.5 * p.start.acceleration + bend));
  state.speed = p.start.speed + t * (p.start.acceleration + 0.5 * t * p.jerk);
  state.acceleration = p.start.acceleration + t * p.jerk;
  // Rounding must not carry the last phase past its end.
  state.s = std::min(state.s, end_.s);
  state.speed = std::max(state.speed, 0.0);
  return state;
}

void SpeedProfile::Advance(Place& place, double s) const {
  place.s = s;
  place.time_s = Place::kNotAsked;
  while (place.phase < count_ && s >= PhaseEnd(place.phase)) {
    place.phase_start_s += phases_[static_cast<std::size_t>(place.phase)].duration_s;
    ++place.phase;
  }
}

// Within a phase v^2 changes by twice the acceleration for each mm, and that is largest at one of
// its ends.
double SpeedProfile::SpeedAtMost(const Place& place) const {
  if (place.phase >= count_) return end_.speed;
  const Phase& phase = phases_[static_cast<std::size_t>(place.phase)];
  const double from = phase.start.acceleration;
  const double to = from + phase.duration_s * phase.jerk;
  const bool last = place.phase + 1 == count_;
  const PathState& end = last ? end_ : phases_[static_cast<std::size_t>(place.phase) + 1].start;
  // Up from the start and down from the end; a little more, for what rounding leaves of places and
  // ends.
  constexpr double kMore = 1.0 + 1e-10;
  const double up = std::max({from, to, 0.0}) * std::max(place.s - phase.start.s, 0.0);
  const double down = std::max({-from, -to, 0.0}) * std::max(end.s - place.s, 0.0);
  const double square = std::min(phase.start.speed * phase.start.speed + 2.0 * up,
                                 end.speed * end.speed + 2.0 * down);
  return std::sqrt(square) * kMore;
}

// How long after the start of a phase it has gone `wanted`.
double SpeedProfile::TimeWithin(const Phase& phase, double wanted) {
  if (wanted <= 0.0) return 0.0;
  const double v = phase.start.speed;
  if (phase.jerk == 0.0) {  // closed: most of most profiles
    const double a = phase.start.acceleration;
    const double root = a == 0.0 ? v : std::sqrt(std::max(v * v + 2.0 * a * wanted, 0.0));
    return std::min(2.0 * wanted / (v + root), phase.duration_s);
  }
  const auto travelled = [&](double t) {
    const double speed = v + t * (phase.start.acceleration + 0.5 * t * phase.jerk);
    const double way = t * (v + t * (0.5 * phase.start.acceleration + t * phase.jerk / 6.0));
    return ValueAndSlope{way, speed};
  };
  return Root(travelled, wanted, phase.duration_s);
}

double SpeedProfile::TimeAt(double s) const {
  Place place;
  Advance(place, s);
  return TimeOf(place);
}

SpeedProfile SpeedProfile::Scaled(double factor) const {
  const auto scale = [&](PathState& state) {
    state = {state.s * factor, state.speed * factor, state.acceleration * factor};
  };
  SpeedProfile scaled = *this;
  for (Phase& phase : std::span(scaled.phases_).first(static_cast<std::size_t>(count_))) {
    phase.jerk *= factor;
    scale(phase.start);
  }
  scale(scaled.end_);
  scaled.peak_speed_ *= factor;
  return scaled;
}

SpeedProfile SpeedProfile::Part(double s_from, double s_to) const {
  Place place;
  Advance(place, s_from);
  SpeedProfile part;
  PartTo(place, s_to, part);
  return part;
}

void SpeedProfile::TakeChangingPartTo(Place& place, double s_to, SpeedProfile& part) const {
  part = ChangingPartTo(place, s_to);
}

SpeedProfile SpeedProfile::ChangingPartTo(Place& place, double s_to) const {
  const Place begin = place;
  const double t_from = TimeOf(begin);
  Advance(place, s_to);
  const double t_to = s_to >= end_.s ? duration_s_ : TimeOf(place);
  if (s_to < end_.s) place.time_s = t_to;  // where the next part begins
  SpeedProfile part;
  double time = begin.phase_start_s;
  for (int k = begin.phase; k < count_ && time < t_to; ++k) {
    const Phase& phase = phases_[static_cast<std::size_t>(k)];
    const double from = std::max(t_from - time, 0.0);
    const double to = std::min(t_to - time, phase.duration_s);
    time += phase.duration_s;
    if (!(to > from)) continue;
    const PathState& start = phase.start;
    PathState state;
    const double bend = phase.jerk == 0.0 ? 0.0 : from * phase.jerk / 6.0;  // spares the division
    state.s = start.s + from * (start.speed + from * (0.5 * start.acceleration + bend)) - begin.s;
    state.speed = start.speed + from * (start.acceleration + 0.5 * from * phase.jerk);
    part.peak_speed_ = std::max(part.peak_speed_, state.speed);
    part.AddPhase(state, to - from, start.acceleration + from * phase.jerk, phase.jerk);
    part.peak_speed_ = std::max(part.peak_speed_, state.speed);
  }
  part.end_ = At(t_to);
  part.end_.s = s_to - begin.s;
  return part;
}

SpeedProfile SpeedProfile::StopFrom(double t_s, const PathLimits& limits) const {
  SpeedProfile stop;
  PathState state = At(t_s);
  stop.peak_speed_ = state.speed;
  const double a = state.acceleration;
  const double j = limits.jerk;
  if (std::isinf(j)) {
    stop.AddRamp(state, state.speed, -1.0, 0.0, limits);
  } else if (a >= 0.0) {
    stop.AddPhase(state, a / j, a, -j);
    stop.peak_speed_ = state.speed;
    stop.AddRamp(state, state.speed, -1.0, 0.0, limits);
  } else {
    // Already slowing down: the rest of the ramp that began at a higher speed. A ramp to
    // acceleration zero first would take more room than a motion that is about to end has left.
    const double began = state.speed + a * a / (2.0 * j);
    const double share = -a;
    Ramp ramp = RampOf(began, limits);
    ramp.acceleration = std::max(ramp.acceleration, share);
    if (state.speed <= a * a / (2.0 * j)) {
      stop.AddPhase(state, 2.0 * state.speed / share, a, a * a / (2.0 * state.speed));
    } else {
      const double grow = (ramp.acceleration - share) / j;
      const double release = ramp.acceleration / j;
      stop.AddPhase(state, grow, a, -j);
      const double left = state.speed - 0.5 * ramp.acceleration * release;
      stop.AddPhase(state, std::max(left, 0.0) / ramp.acceleration, -ramp.acceleration, 0.0);
      stop.AddPhase(state, release, -ramp.acceleration, j);
    }
  }
  stop.end_ = {state.s, 0.0, 0.0};
  return stop;
}

}  // namespace rmlcell::motion
