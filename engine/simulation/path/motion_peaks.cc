#include "engine/simulation/path/motion_peaks.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/ride/trajectory.h"
#include "engine/simulation/path/part_curve.h"
#include "engine/simulation/path/profile_phases.h"

namespace rmlcell::simulation {
namespace {

using motion::AxisValues;
using motion::MachinePoint;
using motion::MachineVector;
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
    const double level = part.jerk != 0.0 ? -part.start.acceleration / part.jerk : 0.0;
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

// `look(t, state)` gives the machine at a time of the profile and the state of the path there.
template <class Look>
MotionPeaks Sampled(const motion::PlannedMotion& motion, double from_s, double to_s, Look look) {
  const PathPiece& path = motion.path;
  const PathPart whole{path, motion.head, 0.0, path.length()};
  const double turning = PartCurve(whole).turning_rad() / path.length();
  MotionPeaks peaks;
  double phase_start = from_s;
  ForEachPhase(motion.speed, from_s, to_s, [&](const PhasePart& part) {
    const double way = part.PlaceAt(part.duration_s) - part.start.s;
    const double wanted = std::ceil(turning * std::abs(way) / kPeakSampleAngle_rad);
    const int samples =
        static_cast<int>(std::clamp(wanted, double{kSamplesMin}, double{kSamplesMax}));
    Instant before;
    for (int k = 0; k <= samples; ++k) {
      const double t = part.duration_s * k / samples;
      const motion::PathState state{part.PlaceAt(t), part.SpeedAt(t), part.AccelerationAt(t)};
      const Instant here = look(phase_start + t, state);
      Add(peaks, here);
      if (k > 0) AddJerk(peaks, before, here, part.duration_s / samples);
      before = here;
    }
    phase_start += part.duration_s;
  });
  return peaks;
}

}  // namespace

MotionPeaks PeaksOf(const motion::PlannedMotion& motion, bool five_axis, double from_s,
                    double to_s) {
  const PathPiece& path = motion.path;
  const bool curved =
      path.kind() == PathPiece::Kind::kArc || path.kind() == PathPiece::Kind::kBlend;
  const bool head_turns = five_axis && Turns(path);
  if (!curved && !head_turns) return Straight(motion, five_axis, from_s, to_s);
  if (path.kind() == PathPiece::Kind::kArc && !head_turns) {
    const PlainArc arc(path);
    return Sampled(motion, from_s, to_s,
                   [&](double /*t*/, const motion::PathState& state) { return arc.At(state); });
  }
  const motion::MotionView view(motion);
  return Sampled(motion, from_s, to_s, [&](double t, const motion::PathState&) {
    const motion::TrajectoryPoint point = view.At(t);
    Instant at{point.tip_velocity, point.tip_acceleration, point.axis_velocity,
               point.axis_acceleration};
    if (!five_axis) {
      at.axis_velocity = FollowingTip(at.tip_velocity, point.axis_velocity[3], 0.0);
      at.axis_acceleration = FollowingTip(at.tip_acceleration, point.axis_acceleration[3], 0.0);
    }
    return at;
  });
}

}  // namespace rmlcell::simulation
