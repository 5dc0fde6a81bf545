#include "engine/simulation/report/move_speeds.h"

#include <algorithm>
#include <cmath>

#include "engine/motion/kinematics/speed_bound.h"
#include "engine/simulation/report/axis_log.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;

// A motion reached a speed when it came this near: rounding is no shortfall.
constexpr double kReached = 1.0 - 1e-6;

bool IsBend(const PathPiece& path) { return path.kind() == PathPiece::Kind::kBlend; }

}  // namespace

bool EndsMove(const machine::MotionDone& done) {
  const double length = done.motion->path.length();
  if (!done.motion->ends_move || done.travelled < length) return false;
  return !(length > 0.0 && done.from >= length);
}

std::optional<SlowMove> MoveSpeeds::Add(const machine::MotionDone& done) {
  const motion::PlannedMotion& motion = *done.motion;
  if (!motion.path.by_sigma()) {
    if (!move_.begun) move_.entry_mm_s = motion.speed.At(done.profile_start_s).speed;
    move_.begun = true;
    move_.peak_mm_s = std::max(move_.peak_mm_s, motion.speed.peak_speed());
    move_.length_mm += done.travelled - done.from;
    if (!IsBend(motion.path) && done.programmed_mm_s > 0.0) {
      move_.path = motion.path;
      move_.head = motion.head;
      move_.limits = motion.limits;
    }
  }
  if (!EndsMove(done)) return std::nullopt;
  std::optional<SlowMove> slow;
  if (move_.peak_mm_s > 0.0 && move_.peak_mm_s < done.programmed_mm_s * kReached) {
    slow = Judge(done);
  }
  move_ = {};
  return slow;
}

SlowMove MoveSpeeds::Judge(const machine::MotionDone& done) const {
  SlowMove slow{.place = done.place,
                .cause = SlowCause::kShort,
                .axis = {},
                .wanted_mm_s = done.programmed_mm_s,
                .allowed_mm_s = done.programmed_mm_s,
                .reached_mm_s = move_.peak_mm_s};
  if (!move_.path || !shape_.limits) return slow;  // nothing but bends: shorter than they are wide
  slow.allowed_mm_s = std::min(move_.limits.speed, slow.wanted_mm_s);
  if (slow.reached_mm_s < slow.allowed_mm_s * kReached) {
    const double exit_mm_s = done.motion->speed.end().speed;
    if (WouldReachWithMore(slow.allowed_mm_s, exit_mm_s)) slow.cause = SlowCause::kAcceleration;
    return slow;
  }
  const motion::SpeedBound bound =
      motion::TightestBound(*move_.path, move_.head, *shape_.limits, slow.wanted_mm_s);
  if (bound.cause == motion::SpeedBound::Cause::kRadius) slow.cause = SlowCause::kRadius;
  if (bound.cause == motion::SpeedBound::Cause::kAxis) {
    slow.cause = SlowCause::kAxis;
    slow.axis = AxisName(bound.axis);
  }
  return slow;
}

// Whether the way would do with all the acceleration of the tip: ACCEL, or an axis, takes some of
// it.
bool MoveSpeeds::WouldReachWithMore(double speed, double exit_mm_s) const {
  const motion::MachineLimits& machine = *shape_.limits;
  const bool arc = move_.path->kind() == PathPiece::Kind::kArc;
  const motion::PathLimits full{
      .speed = speed,
      .acceleration = machine.tip_acceleration_mm_s2 * (arc ? machine.curve_tangential : 1.0),
      .jerk = machine.tip_jerk_mm_s3};
  const bool had_it_all = move_.limits.acceleration >= full.acceleration * kReached &&
                          (move_.limits.jerk >= full.jerk * kReached || std::isinf(full.jerk));
  if (had_it_all) return false;
  const double entry = std::min(move_.entry_mm_s, speed);
  const double exit = std::min(exit_mm_s, speed);
  const bool fits = motion::Reach(entry, move_.length_mm, full) >= exit &&
                    motion::Reach(exit, move_.length_mm, full) >= entry;
  if (!fits || !(move_.length_mm > 0.0)) return false;
  const motion::SpeedProfile best = motion::SpeedProfile::Span(move_.length_mm, entry, exit, full);
  return best.peak_speed() >= speed * kReached;
}

}  // namespace rmlcell::simulation
