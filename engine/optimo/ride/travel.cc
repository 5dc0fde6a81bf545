#include "engine/optimo/ride/travel.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "engine/core/number_text.h"
#include "engine/motion/kinematics/speed_bound.h"

namespace rmlcell::optimo {
namespace {

constexpr int kFirstRotaryAxis = 3;

// A program names the end of a travel with 24 bits (12.6 rad is 4e-7 less), and the head's
// kinematics round: neither is a violation.
constexpr double kTravelSlack = 1e-6;  // mm, rad; the tolerance of motion.md section 1

// A plan comes this near to the speed asked for: rounding is no shortfall.
constexpr double kFullSpeed = 1.0 - 1e-6;

double SlackOf(double limit) {
  return kTravelSlack + std::abs(limit) * std::numeric_limits<float>::epsilon();
}

std::string_view NameOfAxis(int axis) {
  constexpr std::array<std::string_view, motion::kAxisCount> kNames = {"X", "Y", "Z", "A", "B"};
  return kNames[static_cast<std::size_t>(axis)];
}

// "X of the target leaves its travel by 5400.000 mm, A on the way by 0.200 rad"
Detail TextOf(const std::vector<BeyondTravel>& beyond) {
  Detail text;
  for (const BeyondTravel& one : beyond) {
    const bool first = text.empty();
    if (!first) text += ", ";
    text += Told("axis", NameOfAxis(one.axis));
    text += one.at_target ? " of the target" : " on the way";
    text += first ? " leaves its travel by " : " by ";
    const std::string unit = one.axis < kFirstRotaryAxis ? "mm" : "rad";
    text += Told("excess", one.excess, unit, FixedText(one.excess, 3) + " " + unit);
  }
  return text;
}

Detail ToldSpeed(std::string_view name, double speed_mm_s, std::string_view unit) {
  return Told(name, speed_mm_s, "mm/s", FixedText(speed_mm_s, 3).append(unit));
}

// Whether no axis can leave its travel on the way, seen from the ends alone: straight ways in the
// axes or with a steady head are inside where their ends are, and the column stands off the tip by
// no more than its reach. False says nothing.
bool StaysInside(const motion::PathPiece& path, const motion::Head& head,
                 const motion::AxisLimits& limits) {
  using Way = motion::PathPiece::Kind;
  // Each of them is looked at: one that is no number is outside.
  const auto within = [&](std::size_t axis, double one, double other, double around) {
    const double least = limits.travel_min[axis] + around;
    const double most = limits.travel_max[axis] - around;
    return one >= least && one <= most && other >= least && other <= most;
  };
  const auto inside = [&](const motion::MachinePoint& one, const motion::MachinePoint& other,
                          double around) {
    return within(0, one.x(), other.x(), around) && within(1, one.y(), other.y(), around) &&
           within(2, one.z(), other.z(), around);
  };
  const motion::PathPose &from = path.from(), &to = path.to();
  if (!within(3, from.a_rad, to.a_rad, 0.0) || !within(4, from.b_rad, to.b_rad, 0.0)) return false;
  if (path.kind() == Way::kJoint) return inside(from.point, to.point, 0.0);
  if (path.kind() != Way::kLine && path.kind() != Way::kRotary) return false;
  if (inside(from.point, to.point, head.reach_mm())) return true;
  const bool steady = from.a_rad == to.a_rad && from.b_rad == to.b_rad;
  return steady &&
         inside(head.ColumnOf(path.tip_from()).column, head.ColumnOf(path.tip_to()).column, 0.0);
}

}  // namespace

// Every axis that leaves its travel, the target first where that lies outside. A motion that comes
// back from where the one before it should not have gone is not to blame for its start.
std::vector<BeyondTravel> Travel::BeyondTravelOf(const motion::PathPiece& path) const {
  const motion::AxisLimits& limits = parameters_.limits.axes;
  const motion::Head head = HeadOf(situation_.tool, parameters_);
  const auto axes_at = [&](const motion::PathPose& place) {
    return motion::AxesOn(path, head, place);
  };
  if (StaysInside(path, head, limits)) return {};
  const auto worst = motion::ExcessOfEach(path, head, limits);
  std::vector<BeyondTravel> beyond;
  for (int axis = 0; axis < motion::kAxisCount; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const double slack = std::max(SlackOf(limits.travel_min[i]), SlackOf(limits.travel_max[i]));
    if (worst[i].excess <= slack) continue;
    const double at_target = motion::ExcessOfAxis(axis, axes_at(path.to()), limits);
    const double at_start = motion::ExcessOfAxis(axis, axes_at(path.from()), limits);
    const bool inherited = s_.violations > 0 && at_start > slack;
    if (at_target <= slack && inherited && worst[i].excess <= at_start + slack) continue;
    beyond.push_back({.axis = axis,
                      .excess = worst[i].excess,
                      .at_target = at_target > slack,
                      .axes = axes_at(path.At(worst[i].s))});
  }
  return beyond;
}

Result<std::vector<BeyondTravel>> Travel::Look(const motion::PathPiece& path,
                                               const machine::Place& place) {
  std::vector<BeyondTravel> beyond = BeyondTravelOf(path);
  if (beyond.empty() || forecast_) return beyond;
  // The target is looked at first, and only then the way to it.
  const auto outside = [](const BeyondTravel& one) { return one.at_target; };
  if (std::ranges::any_of(beyond, outside)) std::erase_if(beyond, std::not_fn(outside));
  TellViolations(place, beyond);
  return Error{ErrorCode::kTargetOutOfTravel, TextOf(beyond), {}};
}

void Travel::TellViolations(const machine::Place& place, const std::vector<BeyondTravel>& beyond) {
  if (beyond.empty()) return;
  for (const BeyondTravel& one : beyond) {
    telling_.observer().OnViolation({.at = situation_.now,
                                     .place = place,
                                     .axis = one.axis,
                                     .excess = one.excess,
                                     .at_target = one.at_target,
                                     .by_work_offset = one.by_work_offset,
                                     .axes = one.axes,
                                     .tip = HeadOf(situation_.tool, parameters_).TipOf(one.axes)});
  }
  if (!forecast_) return;  // the alarm says the rest
  const Diagnostic finding{.code = ErrorCode::kTargetOutOfTravel,
                           .severity = Severity::kProgram,
                           .detail = TextOf(beyond),
                           .rule = "OPT-B.08",
                           .where = {.line = place.line},
                           .program = place.program,
                           .step = place.step,
                           .at = situation_.now};
  ++s_.violations;
  if (!s_.first_violation) s_.first_violation = finding;
  telling_.Tell(finding);
}

void Travel::Judge(machine::Outcome& outcome) const {
  const bool went_well = outcome.kind == machine::OutcomeKind::kCompleted ||
                         outcome.kind == machine::OutcomeKind::kStopped;
  if (!s_.first_violation || !went_well) return;
  const Diagnostic& first = *s_.first_violation;
  Detail detail = first.detail;
  if (s_.violations > 1) {
    detail = Told("count", s_.violations) + " motions leave the travel; the first: " + detail;
  }
  outcome = {.kind = machine::OutcomeKind::kFailed,
             .code = first.code,
             .detail = std::move(detail),
             .place = {.program = first.program, .step = first.step, .line = first.where.line}};
}

void Travel::TellSpeedHeld(const motion::PlannedMotion& motion, const machine::Place& place,
                           double feed_mm_s) {
  const auto kind = motion.path.kind();
  const bool contour =
      kind == motion::PathPiece::Kind::kLine || kind == motion::PathPiece::Kind::kArc;
  if (!contour || motion.limits.speed >= feed_mm_s * kFullSpeed) {
    return;
  }
  if (s_.held_by_axis.contains({place.program, place.step})) return;
  const motion::SpeedBound bound =
      motion::TightestBound(motion.path, motion.head, parameters_.limits, feed_mm_s);
  if (bound.cause != motion::SpeedBound::Cause::kAxis) return;
  s_.held_by_axis.emplace(place.program, place.step);
  telling_.Tell({.code = ErrorCode::kSpeedHeldByAxis,
                 .severity = Lookup(ErrorCode::kSpeedHeldByAxis).severity,
                 .detail = "axis " + Told("axis", NameOfAxis(bound.axis)) + " allows " +
                           ToldSpeed("limit", motion.limits.speed, " mm/s") + " of " +
                           ToldSpeed("feed_rate", feed_mm_s, "") + "; reached " +
                           ToldSpeed("speed", motion.speed.peak_speed(), " mm/s"),
                 .rule = "OPT-2.16",
                 .where = {.line = place.line},
                 .program = place.program,
                 .step = place.step,
                 .at = situation_.now});
}

}  // namespace rmlcell::optimo
