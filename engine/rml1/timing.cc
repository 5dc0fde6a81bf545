#include "engine/rml1/timing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/rml1/carriage.h"

namespace rmlcell::rml1 {

motion::TipPose PoseOf(const Profile& profile, const Point& at) {
  const double mm = 1.0 / profile.units_per_mm;
  const double sense = profile.rotary_reversed ? -1.0 : 1.0;
  return {.tip = {at.x * mm, at.y * mm, at.z * mm},
          .a_rad = sense * at.a * kRadPerDegree,
          .b_rad = 0.0};
}

motion::MachineLimits MillLimits(const Profile& profile) {
  const double xy = std::max(profile.xy_speeds.maximum_mm_s, profile.travel_speed);
  const double z = profile.z_speeds.maximum_mm_s;
  const double a = profile.acceleration_mm_s2;
  const double rotary = profile.rotary_acceleration_deg_s2 * kRadPerDegree;
  motion::MachineLimits limits;
  limits.tip_speed_mm_s = xy;
  limits.tip_acceleration_mm_s2 = a;
  limits.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  limits.settling_s = 0.0;
  limits.corners = motion::MachineLimits::Corners::kThrough;
  limits.junction_jump_mm_s = profile.speed_jump_mm_s;
  limits.junction_jump_a_rad_s = rotary * profile.speed_jump_mm_s / a;
  limits.axes.speed = {xy, xy, z, profile.rotary_speed_deg_s * kRadPerDegree, 0.0};
  limits.axes.acceleration = {a, a, a, rotary, 0.0};
  return limits;
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
  if (turn_deg == 0.0) return plan;
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

}  // namespace rmlcell::rml1
