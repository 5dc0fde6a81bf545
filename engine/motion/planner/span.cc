#include "engine/motion/planner/span.h"

#include <algorithm>
#include <cmath>

#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {

PlainCorner PlainCornerAt(const LegStage& legs, LegStage::Number corner_move, double cut_mm) {
  const Ring<LegStage::Move>& moves = legs.moves();
  const PathPiece& in = moves[corner_move].path;
  return {in.to(), in.Tangent(0.0), moves[corner_move + 1].path.Tangent(0.0), cut_mm};
}

CurveAround CurveAroundEnd(const LegStage& legs, const LegStage::Leg& leg, double cut) {
  const Ring<LegStage::Move>& moves = legs.moves();
  LegStage::Number before = leg.last_move;
  double left = cut;
  while (left > moves[before].path.length()) {
    left -= moves[before].path.length();
    --before;
  }
  const PathPiece& in = moves[before].path;
  LegStage::Number after = leg.last_move + 1;
  double right = cut;
  while (right > moves[after].path.length()) {
    right -= moves[after].path.length();
    ++after;
  }
  const PathPiece& out = moves[after].path;
  const bool head_steady =
      in.a_rate() == 0.0 && in.b_rate() == 0.0 && out.a_rate() == 0.0 && out.b_rate() == 0.0;
  const CurveEnd begin = EndAt(in, in.length() - left);
  const CurveEnd end = EndAt(out, right);
  return {leg.in_axes ? CornerCurve::InAxes(begin, end, cut) : CornerCurve(begin, end, cut),
          head_steady};
}

PathLimits LimitsOnCurve(const LegStage& legs, LegStage::Number corner_move, double cut) {
  const Ring<LegStage::Move>& moves = legs.moves();
  const MachineLimits& machine = legs.machine();
  PathLimits limits = moves[corner_move].limits;
  const auto lower = [&](const LegStage::Move& move) {
    limits.acceleration = std::min(limits.acceleration, move.limits.acceleration);
    limits.jerk = std::min(limits.jerk, move.limits.jerk);
    return move.path.length();
  };
  limits.acceleration =
      std::min(limits.acceleration, machine.curve_tangential * machine.tip_acceleration_mm_s2);
  double left = cut;
  for (LegStage::Number k = corner_move; left > 0.0; --k) {
    left -= lower(moves[k]);
    if (k == moves.first()) break;
  }
  left = cut;
  for (LegStage::Number k = corner_move + 1; left > 0.0 && k < moves.end(); ++k)
    left -= lower(moves[k]);
  return limits;
}

PathLimits LimitsInStretches(const LegStage& legs, const Span& span) {
  const MachineLimits& machine = legs.machine();
  PathLimits limits = LimitsOnCurve(legs, span.corner_move, span.report.cut_mm);
  limits.speed = span.stretches.open;
  if (span.may_vary) return limits;
  // No axis moves by more than its speed over that of the tip for a mm of the way.
  const double whole = limits.speed / kLeavesRoom;
  for (const std::size_t i : kAxes) {
    const double per_axis = whole / machine.axes.speed[i];
    limits.acceleration =
        std::min(limits.acceleration,
                 (1.0 - kLeavesRoom * kLeavesRoom) * machine.axes.acceleration[i] * per_axis);
    if (std::isfinite(limits.jerk)) {
      limits.jerk = std::min(limits.jerk, machine.axes.jerk[i] * per_axis);
    }
  }
  return limits;
}

BendSpeeds SpeedsAlong(const LegStage& legs, const Span& span) {
  const Ring<LegStage::Move>& moves = legs.moves();
  Corner corner;
  corner.Assign(moves[span.corner_move].path, moves[span.corner_move + 1].path);
  return corner.PlainSpeeds(span.report.cut_mm, span.stretches.open, legs.machine());
}

Stretches StretchesIn(const LegStage& legs, const Span& span) {
  const BendStretches& most = span.stretches;
  Stretches stretches;
  for (std::size_t k = 0; k < most.count; ++k) {
    const bool last = k + 1 == most.count;
    stretches[k] = {
        .end = span.curve_end(k), .end_cap = last ? most.start : most.middle, .most = most.open};
  }
  if (most.count < BendStretches::kAbrupt) return stretches;
  const auto speeds = AbruptSpeeds(SpeedsAlong(legs, span));
  for (std::size_t k = 0; k < most.count; ++k) {
    stretches[k].most = speeds[k];
    stretches[k].end_cap = std::min(speeds[k], k + 1 < most.count ? speeds[k + 1] : most.start);
  }
  return stretches;
}

}  // namespace rmlcell::motion
