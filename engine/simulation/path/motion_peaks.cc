#include "engine/simulation/path/motion_peaks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/units.h"
#include "engine/motion/geometry/corner_table.h"
#include "engine/motion/ride/trajectory.h"
#include "engine/simulation/path/part_curve.h"
#include "engine/simulation/path/peak_bounds.h"
#include "engine/simulation/path/profile_phases.h"

namespace rmlcell::simulation {
namespace {

using motion::AxisValues;
using motion::MachinePoint;
using motion::MachineVector;
using motion::PathDerivatives;
using motion::PathPiece;

constexpr int kSamplesMin = 4;    // of a phase: ends and three between
constexpr int kSamplesMax = 512;  // 25 rad of turning

void Raise(double& peak, double value) { peak = std::max(peak, std::abs(value)); }

// What the axes do when they go as the tip does.
AxisValues FollowingTip(const MachinePoint& tip, double a, double b) {
  return {tip.x(), tip.y(), tip.z(), a, b};
}

struct Instant {
  MachineVector tip_velocity;
  MachineVector tip_acceleration;
  AxisValues axis_velocity{};
  AxisValues axis_acceleration{};
};

void Add(MotionPeaks& peaks, const Instant& at) {
  Raise(peaks.tip_speed, at.tip_velocity.norm());
  Raise(peaks.tip_acceleration, at.tip_acceleration.norm());
  for (int i = 0; i < motion::kAxisCount; ++i) {
    Raise(peaks.axis_speed[i], at.axis_velocity[i]);
    Raise(peaks.axis_acceleration[i], at.axis_acceleration[i]);
  }
}

// The mean jerk between two instants of one phase.
void AddJerk(MotionPeaks& peaks, const Instant& before, const Instant& after, double duration_s) {
  Raise(peaks.tip_jerk, (after.tip_acceleration - before.tip_acceleration).norm() / duration_s);
  for (int i = 0; i < motion::kAxisCount; ++i) {
    Raise(peaks.axis_jerk[i],
          (after.axis_acceleration[i] - before.axis_acceleration[i]) / duration_s);
  }
}

// The derivatives by s are the same everywhere: only speed and acceleration count.
MotionPeaks Straight(const motion::PlannedMotion& motion, bool five_axis, double from_s,
                     double to_s) {
  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  ForEachPhase(motion.speed, from_s, to_s, [&](const PhasePart& part) {
    const double end = part.duration_s;
    Raise(speed, part.start.speed);
    Raise(speed, part.SpeedAt(end));
    Raise(acceleration, part.start.acceleration);
    Raise(acceleration, part.AccelerationAt(end));
    Raise(jerk, part.jerk);
    const double level = part.LevelAt();
    if (level > 0.0 && level < end) Raise(speed, part.SpeedAt(level));
  });
  const motion::PathDerivatives first = motion.path.First(0.0);
  const bool stands = motion.path.kind() == PathPiece::Kind::kRotary;
  const MachineVector tip = stands ? MachineVector{} : first.point;
  const AxisValues axes = FollowingTip(tip, first.a, five_axis ? first.b : 0.0);
  MotionPeaks peaks;
  peaks.tip_speed = tip.norm() * speed;
  peaks.tip_acceleration = tip.norm() * acceleration;
  peaks.tip_jerk = tip.norm() * jerk;
  peaks.axis_speed = axes.cwiseAbs() * speed;
  peaks.axis_acceleration = axes.cwiseAbs() * acceleration;
  peaks.axis_jerk = axes.cwiseAbs() * jerk;
  return peaks;
}

// An arc whose axes go as the tip does: what does not change along it is worked out once.
class PlainArc {
 public:
  explicit PlainArc(const PathPiece& path)
      : along_(path.Tangent(0.0)),
        inward_(path.Curvature(0.0) * path.radius_mm()),
        per_radius_(1.0 / path.radius_mm()),
        a_(path.a_rate()) {}

  Instant At(const motion::PathState& state) const {
    const double sine = std::sin(state.s * per_radius_);
    const double cosine = std::cos(state.s * per_radius_);
    const MachineVector tangent = along_ * cosine + inward_ * sine;
    const MachineVector normal = (inward_ * cosine - along_ * sine) * per_radius_;
    Instant at;
    at.tip_velocity = tangent * state.speed;
    at.tip_acceleration = tangent * state.acceleration + normal * (state.speed * state.speed);
    at.axis_velocity = FollowingTip(at.tip_velocity, a_ * state.speed, 0.0);
    at.axis_acceleration = FollowingTip(at.tip_acceleration, a_ * state.acceleration, 0.0);
    return at;
  }

 private:
  MachineVector along_;
  MachineVector inward_;
  double per_radius_;
  double a_;  // rotary axis of a mill
};

// What the machine does where a path has this pose and these derivatives by s: as
// motion::PointAt, but for where it is.
Instant Passed(const motion::PathPose& pose, const PathDerivatives& first,
               const PathDerivatives& second, const motion::Head& head,
               const motion::PathState& state) {
  const double square = state.speed * state.speed;
  Instant at;
  at.tip_velocity = first.point * state.speed;
  at.tip_acceleration = first.point * state.acceleration + second.point * square;
  const double a = first.a * state.speed;
  const double b = first.b * state.speed;
  const double a_change = first.a * state.acceleration + second.a * square;
  const double b_change = first.b * state.acceleration + second.b * square;
  at.axis_velocity = FollowingTip(at.tip_velocity, a, b);
  at.axis_acceleration = FollowingTip(at.tip_acceleration, a_change, b_change);
  if (a == 0.0 && b == 0.0 && a_change == 0.0 && b_change == 0.0) return at;
  const motion::BothAxisRates swing =
      head.RatesOfBoth(pose.a_rad, pose.b_rad, {{}, a, b}, {{}, a_change, b_change});
  for (int i = 0; i < 3; ++i) {
    at.axis_velocity[i] += swing.first[i];
    at.axis_acceleration[i] += swing.second[i];
  }
  return at;
}

// The curve of a blend, whose derivatives are by its parameter.
class Bend {
 public:
  Bend(const motion::PlannedMotion& motion, PartShape& shape)
      : path_(motion.path), head_(motion.head) {
    if (const PathPiece::PlainPart* plain = path_.plain_corner()) {
      measure_.emplace(plain->corner);
      if (measure_->known()) {
        curve_ = path_.curve();
        per_mm_ = 1.0 / plain->total;
        return;
      }
    }
    part_ = &shape.curve();
    curve_ = part_->curve();
  }

  Instant At(const motion::PathState& state) const {
    const double u = part_ != nullptr
                         ? part_->ParameterAt(state.s)
                         : measure_->ParameterAt((path_.curve_start() + state.s) * per_mm_);
    const PathDerivatives d = curve_.Derivative(u, 1);
    const PathDerivatives e = curve_.Derivative(u, 2);
    // motion::CornerCurve::FirstByLength and SecondByLength
    const double per_mm = 1.0 / d.point.norm();
    const double square = 1.0 / d.point.dot(d.point);
    const double along = d.point.dot(e.point) * square;
    const PathDerivatives first{d.point * per_mm, d.a * per_mm, d.b * per_mm};
    const PathDerivatives second{(e.point - d.point * along) * square, (e.a - d.a * along) * square,
                                 (e.b - d.b * along) * square};
    const bool turns = d.a != 0.0 || d.b != 0.0 || e.a != 0.0 || e.b != 0.0;
    return Passed(turns ? curve_.At(u) : path_.from(), first, second, head_, state);
  }

 private:
  const PathPiece& path_;
  const motion::Head& head_;
  motion::CornerCurve curve_;
  std::optional<motion::PlainMeasure> measure_;
  double per_mm_ = 0.0;
  const PartCurve* part_ = nullptr;  // where the measure is not known
};

// When a motion is ridden, and where of that peaks are looked for.
struct Ridden {
  double from_s;
  double to_s;
  const OpenSlices& open;
};

// `look(state)` gives the machine at a state of the path. That is of the phase which is looked at:
// asked by its time, the end of a phase is the beginning of the next one, where the acceleration
// may be another.
// Samples that lie in no open slice are passed over, and so is what is between two of them.
template <class Look>
MotionPeaks Sampled(const motion::PlannedMotion& motion, const Ridden& ridden, Look look) {
  const PathPiece& path = motion.path;
  const double turning = TurningOf({path, motion.head, 0.0, path.length()}) / path.length();
  MotionPeaks peaks;
  std::size_t phases = 0;
  ForEachPhase(motion.speed, ridden.from_s, ridden.to_s, [&](const PhasePart& part) {
    const std::size_t phase = phases++;
    const double way = part.PlaceAt(part.duration_s) - part.start.s;
    const double wanted = std::ceil(turning * std::abs(way) / kPeakSampleAngle_rad);
    const int samples =
        static_cast<int>(std::clamp(wanted, double{kSamplesMin}, double{kSamplesMax}));
    const auto open_before = [&](int k) {  // between the sample before and this one
      if (k < 1 || k > samples) return false;
      constexpr auto kOf = static_cast<int>(OpenSlices::kOfPhase);
      for (int slice = (k - 1) * kOf / samples; slice * samples < k * kOf; ++slice) {
        if (ridden.open.IsOpen(phase, static_cast<std::size_t>(slice))) return true;
      }
      return false;
    };
    Instant before;
    for (int k = 0; k <= samples; ++k) {
      const bool from_before = open_before(k);
      if (!from_before && !open_before(k + 1)) continue;
      const double t = part.duration_s * k / samples;
      const Instant here = look({part.PlaceAt(t), part.SpeedAt(t), part.AccelerationAt(t)});
      Add(peaks, here);
      if (from_before) AddJerk(peaks, before, here, part.duration_s / samples);
      before = here;
    }
  });
  return peaks;
}

Instant Passed(const motion::TrajectoryPoint& point) {
  return {point.tip_velocity, point.tip_acceleration, point.axis_velocity, point.axis_acceleration};
}

// Where axes do not follow the tip, or derivatives change along the way.
MotionPeaks Curved(const motion::PlannedMotion& motion, PartShape& shape, bool five_axis,
                   const Ridden& ridden) {
  const PathPiece& path = motion.path;
  const auto of_machine = [&](Instant at) {
    if (five_axis) return at;
    at.axis_velocity = FollowingTip(at.tip_velocity, at.axis_velocity[3], 0.0);
    at.axis_acceleration = FollowingTip(at.tip_acceleration, at.axis_acceleration[3], 0.0);
    return at;
  };
  const bool blend = path.kind() == PathPiece::Kind::kBlend;
  if (path.in_axes()) {
    return Sampled(motion, ridden, [&](const motion::PathState& state) {
      if (!blend) return of_machine(Passed(motion::PointAt(path, motion.head, state)));
      const motion::CornerCurve& curve = shape.curve().curve();
      const double u = shape.curve().ParameterAt(state.s);
      const motion::PathPlace place{true, curve.At(u), curve.FirstByLength(u),
                                    curve.SecondByLength(u)};
      return of_machine(Passed(motion::PointAt(place, motion.head, state)));
    });
  }
  if (blend) {
    const Bend bend(motion, shape);
    return Sampled(motion, ridden,
                   [&](const motion::PathState& state) { return of_machine(bend.At(state)); });
  }
  return Sampled(motion, ridden, [&](const motion::PathState& state) {
    return of_machine(
        Passed(path.At(state.s), path.First(state.s), path.Second(state.s), motion.head, state));
  });
}

MotionPeaks PeaksIn(const motion::PlannedMotion& motion, PartShape& shape, bool five_axis,
                    const Ridden& ridden) {
  const PathPiece& path = motion.path;
  const bool curved =
      path.kind() == PathPiece::Kind::kArc || path.kind() == PathPiece::Kind::kBlend;
  const bool head_turns = five_axis && shape.turns();
  if (!curved && !head_turns) return Straight(motion, five_axis, ridden.from_s, ridden.to_s);
  if (path.kind() == PathPiece::Kind::kArc && !head_turns) {
    const PlainArc arc(path);
    return Sampled(motion, ridden, [&](const motion::PathState& state) { return arc.At(state); });
  }
  return Curved(motion, shape, five_axis, ridden);
}

}  // namespace

void MotionPeaks::Raise(const MotionPeaks& other) {
  tip_speed = std::max(tip_speed, other.tip_speed);
  tip_acceleration = std::max(tip_acceleration, other.tip_acceleration);
  tip_jerk = std::max(tip_jerk, other.tip_jerk);
  for (std::size_t i = 0; i < motion::kAxisCount; ++i) {
    axis_speed[i] = std::max(axis_speed[i], other.axis_speed[i]);
    axis_acceleration[i] = std::max(axis_acceleration[i], other.axis_acceleration[i]);
    axis_jerk[i] = std::max(axis_jerk[i], other.axis_jerk[i]);
  }
}

MotionPeaks PeaksBeyond(const MotionPeaks& known, const motion::PlannedMotion& motion,
                        PartShape& shape, bool five_axis, double from_s, double to_s) {
  const OpenSlices open = MayExceed(known, motion, shape, five_axis, from_s, to_s);
  if (!open.any()) return {};
  return PeaksIn(motion, shape, five_axis, {from_s, to_s, open});
}

MotionPeaks PeaksOf(const motion::PlannedMotion& motion, PartShape& shape, bool five_axis,
                    double from_s, double to_s) {
  return PeaksIn(motion, shape, five_axis, {from_s, to_s, OpenSlices::All()});
}

}  // namespace rmlcell::simulation
