#include "engine/rml1/timing.h"

#include <algorithm>
#include <cmath>

#include "engine/rml1/carriage.h"

namespace rmlcell::rml1 {

motion::TipPose PoseOf(const Profile& profile, const Point& at) {
  const double mm = 1.0 / profile.units_per_mm;
  const double sense = profile.rotary_reversed ? -1.0 : 1.0;
  return {.tip = {at.x * mm, at.y * mm, at.z * mm},
          .a_rad = sense * at.a * kRadPerDegree,
          .b_rad = 0.0};
}

MotionPlan PlanMotion(const Profile& profile, const Point& from, const Action& action,
                      double override_percent) {
  MotionPlan plan;
  plan.path = motion::PathPiece::Line(PoseOf(profile, from), PoseOf(profile, action.to));
  plan.feed_mm_s = action.speed_mm_s;
  if (!action.rapid && override_percent != 100.0) {
    const double lowest = std::min(profile.xy_speeds.minimum_mm_s, profile.z_speeds.minimum_mm_s);
    const double wanted = std::max(action.speed_mm_s * override_percent / 100.0, lowest);
    plan.feed_mm_s = LimitedSpeed(profile, from, action.to, wanted);
  }
  plan.limits.speed = plan.feed_mm_s;
  plan.limits.acceleration = profile.acceleration_mm_s2;
  const double turn_deg = std::abs(action.to.a - from.a);
  if (turn_deg <= 0.0) return plan;
  // Degrees per unit of the path variable: mm of the line, or the whole turn.
  const double rate = turn_deg / plan.path.length();
  const double rotary = profile.rotary_acceleration_deg_s2 / rate;
  if (plan.path.kind() == motion::PathPiece::Kind::kRotary) {
    plan.limits = {.speed = profile.rotary_speed_deg_s / rate, .acceleration = rotary};
  } else {
    plan.limits.acceleration = std::min(plan.limits.acceleration, rotary);
  }
  return plan;
}

motion::PlannedMotion Ride(const motion::PathPiece& path, double v0, double v1,
                           const motion::PathLimits& limits) {
  motion::PlannedMotion planned;
  planned.path = path;
  planned.limits = limits;
  const double start = std::min(v0, motion::Reach(v1, path.length(), limits));
  motion::PathLimits span = limits;
  span.speed = std::max({limits.speed, start, v1});
  planned.speed = motion::SpeedProfile::Span(path.length(), start, v1, span);
  return planned;
}

}  // namespace rmlcell::rml1
