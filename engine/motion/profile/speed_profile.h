#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace rmlcell::motion {

// Limits along a path: mm/s, mm/s2, mm/s3, or the same by sigma. Every figure above zero; an
// infinite jerk makes trapezoids. motion.md 5.1, 5.2.
struct PathLimits {
  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = std::numeric_limits<double>::infinity();
};

// Where and how fast along a piece.
struct PathState {
  double s = 0.0;
  double speed = 0.0;
  double acceleration = 0.0;
};

// The time-optimal ramp-cruise-ramp from `v0` to `v1` over `length`, with zero acceleration at both
// ends: at most seven phases of constant jerk. A value of fixed size.
class SpeedProfile {
 public:
  struct Phase {
    double duration_s;
    double jerk;
    PathState start;
  };
  static constexpr int kPhasesMax = 8;  // From: one more than a span

  SpeedProfile() = default;  // takes no time
  SpeedProfile(const SpeedProfile& other) { *this = other; }
  SpeedProfile& operator=(const SpeedProfile& other);  // only the phases there are

  // Precondition: length >= 0, limits above zero, v0 and v1 within limits.speed, and the change
  // from v0 to v1 fits into the length (see Reach).
  static SpeedProfile Span(double length, double v0, double v1, const PathLimits& limits);

  // The ramp from `v0` to `v1`, over the length that it takes.
  static SpeedProfile OneRamp(double v0, double v1, const PathLimits& limits);

  // From any state on, to speed `v1` at `end_s`: first the acceleration is brought to zero, then
  // over to the speed of `limits`, which may be below the present one (override, motion.md
  // section 6). Where the way left is too short for that the present speed is kept for as long as
  // it can be. Precondition: v1 can be reached, and it is not above limits.speed nor the present
  // speed.
  static SpeedProfile From(const PathState& state, double end_s, double v1,
                           const PathLimits& limits);

  // `length` at one speed above 0.
  static SpeedProfile Steady(double length, double speed) {
    SpeedProfile profile;
    profile.SetSteady(length, speed);
    return profile;
  }
  void SetSteady(double length, double speed) {
    count_ = 1;
    duration_s_ = length / speed;
    phases_[0] = {duration_s_, 0.0, {0.0, speed, 0.0}};
    peak_speed_ = speed;
    end_ = {length, speed, 0.0};
  }

  // The part between two places, s counted from the first. 0 <= s_from < s_to <= end().s.
  SpeedProfile Part(double s_from, double s_to) const;

  // A place that is only ever moved forward: many parts one behind the other cost as much as they
  // are long, whatever came before them. Good for one profile.
  struct Place {
    double s = 0.0;
    int phase = 0;               // the one that s lies in
    double phase_start_s = 0.0;  // when it begins
    double time_s = kNotAsked;   // when s is passed, once a part has ended there
    static constexpr double kNotAsked = -1.0;
  };
  void Advance(Place& place, double s) const;
  // The speed there, as At(TimeAt(s)) has it; and what it is at most, without looking for the time.
  double SpeedAt(const Place& place) const { return At(TimeOf(place)).speed; }
  double SpeedAtMost(const Place& place) const;
  // Sets `part` to the part from `place` to `s_to`, where `place` is afterwards.
  [[gnu::always_inline]] void PartTo(Place& place, double s_to, SpeedProfile& part) const {
    const Phase& phase = phases_[static_cast<std::size_t>(place.phase)];
    if (place.phase < count_ && phase.jerk == 0.0 && phase.start.acceleration == 0.0 &&
        s_to < PhaseEnd(place.phase) && place.s >= phase.start.s) {
      const double length = s_to - place.s;
      place.s = s_to;
      place.time_s = Place::kNotAsked;
      part.SetSteady(length, phase.start.speed);
    } else {
      TakeChangingPartTo(place, s_to, part);
    }
  }

  // The same in time, where each s becomes `factor` of them.
  SpeedProfile Scaled(double factor) const;

  double duration_s() const { return duration_s_; }
  const PathState& end() const { return end_; }  // s of the end, and the speed there
  double peak_speed() const { return peak_speed_; }
  int phase_count() const { return count_; }
  const Phase& phase(int index) const { return phases_[static_cast<std::size_t>(index)]; }

  // When `s` is passed for the first time; clamped to the profile.
  double TimeAt(double s) const;

  // 0 <= t <= duration_s(); outside it is clamped.
  PathState At(double t_s) const;

  // Its s alone.
  double PlaceAt(double t_s) const {
    if (count_ == 0 || t_s >= duration_s_) return end_.s;
    double t = std::max(t_s, 0.0);
    std::size_t k = 0;
    for (const auto last = static_cast<std::size_t>(count_ - 1);
         k < last && t >= phases_[k].duration_s; ++k) {
      t -= phases_[k].duration_s;
    }
    const Phase& p = phases_[k];
    t = std::min(t, p.duration_s);
    const double from_jerk = p.jerk == 0.0 ? 0.0 : t * p.jerk / 6.0;
    // Rounding must not carry the last phase past its end.
    return std::min(p.start.s + t * (p.start.speed + t * (0.5 * p.start.acceleration + from_jerk)),
                    end_.s);
  }

  // The ramp to rest that begins at `t_s`, at once and with the limits: a motion that speeds up
  // first brings its acceleration to zero, one that slows down goes on slowing down, so that a STOP
  // never passes the place where the motion would have ended by itself. Its s counts from the same
  // origin. motion.md section 6 (STOP, /END).
  SpeedProfile StopFrom(double t_s, const PathLimits& limits) const;

 private:
  static double TimeWithin(const Phase& phase, double wanted);
  SpeedProfile ChangingPartTo(Place& place, double s_to) const;
  // Apart, so that who takes steady parts has no room to make for one that changes.
  [[gnu::noinline]] void TakeChangingPartTo(Place& place, double s_to, SpeedProfile& part) const;
  double PhaseEnd(int index) const {
    return index + 1 < count_ ? phases_[static_cast<std::size_t>(index) + 1].start.s : end_.s;
  }
  double TimeOf(const Place& place) const {
    if (place.time_s != Place::kNotAsked) return place.time_s;
    if (place.phase >= count_) return place.phase_start_s;
    const Phase& phase = phases_[static_cast<std::size_t>(place.phase)];
    return place.phase_start_s + TimeWithin(phase, place.s - phase.start.s);
  }
  void AddPhase(PathState& state, double duration_s, double acceleration, double jerk);
  void AddSpan(PathState& state, double end_s, double v1, const PathLimits& limits);
  void AddRamp(PathState& state, double change, double sign, double to_speed,
               const PathLimits& limits);

  std::array<Phase, kPhasesMax> phases_;  // the first count_
  int count_ = 0;
  double duration_s_ = 0.0;
  double peak_speed_ = 0.0;
  PathState end_;
};

inline SpeedProfile& SpeedProfile::operator=(const SpeedProfile& other) {
  count_ = other.count_;
  duration_s_ = other.duration_s_;
  peak_speed_ = other.peak_speed_;
  end_ = other.end_;
  for (int k = 0; k < count_; ++k) {
    phases_[static_cast<std::size_t>(k)] = other.phases_[static_cast<std::size_t>(k)];
  }
  return *this;
}

// The highest speed that can be reached from `v0` within `length`. motion.md 5.2.
double Reach(double v0, double length, const PathLimits& limits);

// The least of Reach over all starting speeds from `v0_low` to `v0_high`. It is not at 0: who
// starts from rest has more time on the way, and with a limit on jerk time is worth more than speed
// until y^2 = 2 v0 (see Reach); at most 6 % below Reach(0).
double ReachMinimum(double v0_low, double v0_high, double length, const PathLimits& limits);

// Time and length of the ramp between two speeds.
inline double RampTime(double v0, double v1, const PathLimits& limits) {
  const double change = std::abs(v1 - v0);
  const double a = limits.acceleration;
  const double j = limits.jerk;
  if (!(change > 0.0)) return 0.0;
  if (std::isinf(j)) return change / a;
  if (change <= a * a / j) return 2.0 * std::sqrt(change / j);
  return change / a + a / j;
}
inline double RampLength(double v0, double v1, const PathLimits& limits) {
  return 0.5 * (v0 + v1) * RampTime(v0, v1, limits);
}

}  // namespace rmlcell::motion
