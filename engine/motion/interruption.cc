#include "engine/motion/interruption.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

bool FromFits(const PathState& state, double end_s, double v1, const PathLimits& limits) {
  constexpr double kRoom = 1e-9;  // lengths that other formulas gave
  double speed = state.speed;
  double left = end_s - state.s;
  const double a = state.acceleration;
  if (a != 0.0 && std::isfinite(limits.jerk)) {
    const double time = std::abs(a) / limits.jerk;
    left -= time * (speed + a * time / 3.0);
    speed += 0.5 * a * time;
  }
  const double room = kRoom * std::max(end_s - state.s, 0.0);
  if (speed < -kRoom * state.speed || left < -room) return false;
  // Between speeds that differ by rounding a ramp needs no way.
  if (std::abs(speed - v1) <= kRoom * std::max(speed, v1)) return true;
  return RampLength(std::max(speed, 0.0), v1, limits) <= left + room;
}

StopOnPath StopAlong(std::span<const PlannedMotion> ahead, double t_s) {
  StopOnPath stop;
  const double s_from = ahead[0].speed.At(t_s).s;
  if (t_s >= ahead[0].speed.duration_s() && SpeedAtEnd(ahead[0]) == 0.0) {  // it settles already
    stop.s = ahead[0].path.length();
    return stop;
  }
  // The weakest of the motions on the way sets the ramp, and a weaker ramp may reach one motion
  // more.
  PathLimits limits = ahead[0].limits;
  SpeedProfile ramp = ahead[0].speed.StopFrom(t_s, limits);
  for (std::size_t seen = 1; seen < Touched(ahead, ramp.end().s); ++seen) {
    limits.acceleration = std::min(limits.acceleration, ahead[seen].limits.acceleration);
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

std::vector<PlannedMotion> RestartAlong(std::span<const PlannedMotion> ahead, double s) {
  const auto left_of = [&](std::size_t k) { return ahead[k].path.length() - (k == 0 ? s : 0.0); };
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
      caps[k] = SpeedAtEnd(ahead[k]);
      if (k == last || caps[k] <= caps[k + 1]) continue;
      caps[k] = std::min(caps[k], Reach(caps[k + 1], left_of(k + 1), ahead[k + 1].limits));
    }
    for (; next <= last; ++next) {
      PlannedMotion motion = ahead[next];
      const double left = left_of(next);
      double end = caps[next];
      if (end > speed && RampLength(speed, end, motion.limits) > left) {
        end = std::min(end, Reach(speed, left, motion.limits));
      }
      if (left > 0.0) {
        if (next == 0) motion.path = PartOf(ahead[0].path, s, motion.path.length());
        motion.speed = SpeedProfile::Span(left, speed, end, motion.limits);
      } else {
        motion.path = PathPiece::Line(ahead[next].path.to(), ahead[next].path.to());
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
  motions.insert(motions.end(), ahead.begin() + static_cast<std::ptrdiff_t>(next), ahead.end());
  return motions;
}

}  // namespace rmlcell::motion
