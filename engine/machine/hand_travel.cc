#include "engine/machine/hand_travel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rmlcell::machine {
namespace {

motion::TipPose TipOf(const motion::AxisPose& axes) {
  return {.tip = axes.column, .a_rad = axes.a_rad, .b_rad = axes.b_rad};
}

// So that no axis is asked for more than it can.
motion::PathLimits LimitsAlong(const motion::MachineVector& way, const HandMotion& how) {
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  motion::PathLimits limits{.speed = kNoEnd, .acceleration = kNoEnd};
  const double length = way.norm();
  for (int axis = 0; axis < 3; ++axis) {
    const double share = std::abs(way[axis]) / length;  // 0: the axis stands, and is no bound
    limits.speed = std::min(limits.speed, how.plus[axis] / share);
    limits.acceleration =
        std::min(limits.acceleration, how.machine.axes.acceleration[axis] / share);
  }
  return limits;
}

}  // namespace

HandTravel::HandTravel(const std::vector<motion::AxisPose>& way, const HandMotion& how,
                       const motion::AxisPose& at, SimTime now)
    : now_(now), at_(at) {
  motion::AxisPose from = at;
  SimTime begins = now;
  for (const motion::AxisPose& to : way) {
    const motion::MachineVector along = to.column - from.column;
    if (!(along.norm() > 0.0)) continue;
    motion::MotionUnderWay& leg = legs_.emplace_back();
    leg.motion.path = motion::PathPiece::Line(TipOf(from), TipOf(to));
    leg.motion.head = how.machine.head;
    leg.motion.limits = LimitsAlong(along, how);
    leg.motion.speed =
        motion::SpeedProfile::Span(leg.motion.path.length(), 0.0, 0.0, leg.motion.limits);
    leg.Begin(begins);
    begins = leg.end;
    from = to;
  }
}

void HandTravel::Advance(SimTime until) {
  now_ = until;
  while (!legs_.empty() && legs_.front().end <= now_) {
    const motion::PathPose end = legs_.front().motion.path.to();
    at_ = {.column = end.point, .a_rad = end.a_rad, .b_rad = end.b_rad};
    legs_.pop_front();
  }
}

void HandTravel::Brake() {
  if (legs_.empty() || brakes_) return;
  brakes_ = true;
  legs_.resize(1);
  motion::MotionUnderWay& leg = legs_.front();
  const motion::SpeedProfile ramp =
      leg.motion.speed.StopFrom(ToSeconds(now_ - leg.start), leg.motion.limits);
  const double here = leg.At(now_).s;
  const double rest = std::min(ramp.end().s, leg.motion.path.length());
  if (!(rest > here)) {
    at_ = leg.AxesAt(now_);
    return legs_.clear();
  }
  leg.motion.path = leg.motion.path.Part(here, rest);
  leg.motion.speed = ramp.Part(here, rest);
  leg.Begin(now_);
}

motion::AxisPose HandTravel::axes() const {
  return legs_.empty() ? at_ : legs_.front().AxesAt(now_);
}

double HandTravel::tip_speed_mm_s() const {
  return legs_.empty() ? 0.0 : legs_.front().TipSpeedAt(now_);
}

}  // namespace rmlcell::machine
