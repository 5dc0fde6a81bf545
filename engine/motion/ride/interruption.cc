#include "engine/motion/ride/interruption.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/motion/kinematics/axes.h"
#include "engine/motion/kinematics/axis_demand.h"

namespace rmlcell::motion {
namespace {

PathPiece PartOf(const PathPiece& path, double s_from, double s_to) {
  if (s_from == 0.0 && s_to == path.length()) return path;
  return path.Part(s_from, s_to);
}

// How many motions the way from the start of ahead[0] to `s` touches.
std::size_t Touched(std::span<const PlannedMotion> ahead, double s) {
  std::size_t count = 1;
  double end = ahead[0].path.length();
  while (end < s && count < ahead.size()) end += ahead[count++].path.length();
  return count;
}

double SpeedAtEnd(const PlannedMotion& motion) { return motion.speed.end().speed; }

// Shares of the limits to try in turn where the axes are asked for too much: what the bend takes of
// them falls with the square of the speed.
constexpr std::array<double, 5> kEases{1.0, 0.5, 0.25, 0.125, 0.0625};

bool AxesCan(const PlannedMotion& motion, const AxisLimits& axes) {
  if (motion.path.kind() != PathPiece::Kind::kBlend) return true;
  constexpr double kAsksMost = 1.0 + 1e-3;  // plans use up the limits; 0.1 % is no harm
  constexpr int kPlaces = 32;
  for (int k = 0; k <= kPlaces; ++k) {
    const PathState state = motion.speed.At(motion.speed.duration_s() * k / kPlaces);
    const AxisDerivatives q = DerivativesAt(motion.path, motion.head, state.s);
    for (const std::size_t i : kAxes) {
      const double asked =
          q.first[i] * state.acceleration + q.second[i] * state.speed * state.speed;
      if (std::abs(asked) > axes.acceleration[i] * kAsksMost) return false;
    }
  }
  return true;
}

// The first motion at whose end the plan stands by itself; their number: none.
std::size_t RestOf(std::span<const PlannedMotion> ahead) {
  const auto rest = std::ranges::find_if(
      ahead, [](const PlannedMotion& motion) { return SpeedAtEnd(motion) == 0.0; });
  return static_cast<std::size_t>(rest - ahead.begin());
}

// What changes after a halt, and from which motion on nothing does.
struct Restart {
  std::vector<PlannedMotion> motions;
  std::size_t next = 0;
};

// With `ease` of the limits.
StopOnPath StopWith(std::span<const PlannedMotion> ahead, double t_s, double ease) {
  StopOnPath stop;
  const double s_from = ahead[0].speed.At(t_s).s;
  // The weakest of the motions on the way sets the ramp, and a weaker ramp may reach one motion
  // more.
  PathLimits limits = ahead[0].limits;
  limits.acceleration *= ease;
  SpeedProfile ramp = ahead[0].speed.StopFrom(t_s, limits);
  for (std::size_t seen = 1; seen < Touched(ahead, ramp.end().s); ++seen) {
    limits.acceleration = std::min(limits.acceleration, ease * ahead[seen].limits.acceleration);
    limits.jerk = std::min(limits.jerk, ahead[seen].limits.jerk);
    ramp = ahead[0].speed.StopFrom(t_s, limits);
  }
  const double s_to = ramp.end().s;
  double begin = 0.0;  // of the motion, from the start of ahead[0]
  for (std::size_t k = 0; k < ahead.size(); ++k) {
    const double length = ahead[k].path.length();
    const double from = std::max(s_from, begin);
    const double to = std::min(s_to, begin + length);
    if (to > from) {
      PlannedMotion part = ahead[k];
      part.path = PartOf(ahead[k].path, from - begin, std::min(to - begin, length));
      part.speed = ramp.Part(from, to);
      part.settling_s = 0.0;
      part.ends_move = ahead[k].ends_move && to == begin + length;
      stop.motions.push_back(part);
    }
    stop.index = k;
    stop.s = std::clamp(to - begin, 0.0, length);
    if (s_to <= begin + length) return stop;
    begin += length;
  }
  stop.complete = false;
  return stop;
}

// With `ease` of the limits on bends.
Restart RestartWith(std::span<const PlannedMotion> ahead, double s, double ease) {
  const auto left_of = [&](std::size_t k) { return ahead[k].path.length() - (k == 0 ? s : 0.0); };
  const auto limits_of = [&](std::size_t k) {
    PathLimits limits = ahead[k].limits;
    limits.speed = std::min(limits.speed, ahead[k].restart_speed);
    if (ahead[k].path.kind() == PathPiece::Kind::kBlend) {
      limits.acceleration *= ease;
      limits.jerk *= ease;
      limits.speed *= std::sqrt(ease);
    }
    return limits;
  };
  std::vector<PlannedMotion> motions;
  std::vector<double> caps(ahead.size());  // of the speeds at the ends
  double speed = 0.0;
  std::size_t next = 0;
  bool as_planned = false;  // from here on nothing differs
  while (next < ahead.size() && !as_planned) {
    // Up to the next place where the plan neither speeds up nor slows down: the ramps of the plan
    // run across the ends of motions, those from rest end at each of them.
    std::size_t last = next;
    while (last + 1 < ahead.size() && ahead[last].speed.end().acceleration != 0.0) ++last;
    for (std::size_t k = last + 1; k-- > next;) {
      caps[k] = std::min(SpeedAtEnd(ahead[k]), limits_of(k).speed);
      if (k + 1 < ahead.size()) caps[k] = std::min(caps[k], limits_of(k + 1).speed);
      if (k == last) continue;
      caps[k] = std::min(caps[k], Reach(caps[k + 1], left_of(k + 1), limits_of(k + 1)));
    }
    for (; next <= last; ++next) {
      PlannedMotion motion = ahead[next];  // its limits are not eased: the next STOP begins anew
      const PathLimits limits = limits_of(next);
      const double left = left_of(next);
      double end = caps[next];
      if (RampLength(speed, end, limits) > left) {
        end = std::min(end, Reach(speed, left, limits));
      }
      if (left > 0.0) {
        if (next == 0) motion.path = PartOf(ahead[0].path, s, motion.path.length());
        motion.speed = SpeedProfile::Span(left, speed, end, limits);
      } else {
        motion.path = ahead[next].path.Standing(ahead[next].path.length());
        motion.speed = SpeedProfile();  // it stood at the end: only its settling is left
        end = 0.0;
      }
      if (motion.ends_move) motion.corner.speed = end;
      speed = end;
      if (left <= 0.0 && motion.settling_s == 0.0) continue;
      motions.push_back(motion);
    }
    as_planned = speed == SpeedAtEnd(ahead[last]) && ahead[last].speed.end().acceleration == 0.0;
  }
  return {std::move(motions), next};
}

}  // namespace

bool AxesCan(std::span<const PlannedMotion> motions, const AxisLimits& axes) {
  return std::ranges::all_of(motions, [&](const PlannedMotion& m) { return AxesCan(m, axes); });
}

bool FromFits(const PathState& state, double end_s, double v1, const PathLimits& limits) {
  constexpr double kRoomOfFits = 1e-9;  // lengths that other formulas gave
  double speed = state.speed;
  double left = end_s - state.s;
  const double room = kRoomOfFits * std::max(left, 0.0);
  const double a = state.acceleration;
  if (a != 0.0 && std::isfinite(limits.jerk)) {
    const double time = std::abs(a) / limits.jerk;
    left -= time * (speed + a * time / 3.0);
    speed += 0.5 * a * time;
  }
  if (speed < -kRoomOfFits * state.speed || left < -room) return false;
  // Between speeds that differ by rounding a ramp needs no way.
  if (std::abs(speed - v1) <= kRoomOfFits * std::max(speed, v1)) return true;
  return RampLength(std::max(speed, 0.0), v1, limits) <= left + room;
}

StopOnPath StopAlong(std::span<const PlannedMotion> ahead, double t_s, const AxisLimits& axes) {
  if (t_s >= ahead[0].speed.duration_s() && SpeedAtEnd(ahead[0]) == 0.0) {  // it settles already
    StopOnPath stop;
    stop.s = ahead[0].path.length();
    return stop;
  }
  // The motions as planned, one after the other, until it is possible to brake; at the latest the
  // plan itself comes to rest.
  std::vector<PlannedMotion> planned;
  double planned_s = 0.0;
  // Braking gently at once may take longer than to brake behind the bend: the soonest rest counts.
  std::optional<StopOnPath> best;
  double best_s = HUGE_VAL;
  for (std::size_t first = 0; first < ahead.size() && planned_s < best_s; ++first, t_s = 0.0) {
    const std::span<const PlannedMotion> from_here = ahead.subspan(first);
    const std::size_t rest = RestOf(from_here);
    for (const double ease : kEases) {
      StopOnPath stop = StopWith(from_here, t_s, ease);
      const bool beyond = stop.index > rest || (!stop.complete && rest < from_here.size());
      if (beyond || !AxesCan(stop.motions, axes)) continue;
      if (!stop.complete) return best ? *best : stop;  // more is to be planned first
      double stop_s = planned_s;
      for (const PlannedMotion& motion : stop.motions) stop_s += motion.speed.duration_s();
      if (stop_s < best_s) {
        stop.index += first;
        stop.motions.insert(stop.motions.begin(), planned.begin(), planned.end());
        best = std::move(stop);
        best_s = stop_s;
      }
      if (first == 0 && ease == 1.0) return *best;
      break;
    }
    PlannedMotion part = ahead[first];
    const double s = part.speed.At(t_s).s;
    const double length = part.path.length();
    part.settling_s = 0.0;
    if (s < length) {
      if (s > 0.0) {
        part.path = PartOf(part.path, s, length);
        part.speed = part.speed.Part(s, length);
      }
      planned.push_back(part);
      planned_s += part.speed.duration_s();
    }
    if (SpeedAtEnd(ahead[first]) == 0.0) {
      if (best) break;
      return {.motions = planned, .index = first, .s = length, .complete = true};
    }
  }
  if (best) return *best;
  StopOnPath stop;
  stop.complete = false;
  return stop;
}

std::vector<PlannedMotion> RestartAlong(std::span<const PlannedMotion> ahead, double s,
                                        const AxisLimits& axes) {
  Restart restart;
  for (const double ease : kEases) {
    restart = RestartWith(ahead, s, ease);
    if (AxesCan(restart.motions, axes)) break;
  }
  std::vector<PlannedMotion> motions = std::move(restart.motions);
  motions.insert(motions.end(), ahead.begin() + static_cast<std::ptrdiff_t>(restart.next),
                 ahead.end());
  return motions;
}

}  // namespace rmlcell::motion
