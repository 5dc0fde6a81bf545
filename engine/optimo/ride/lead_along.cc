#include "engine/optimo/ride/lead_along.h"

#include <algorithm>

#include "engine/motion/ride/interruption.h"
#include "engine/optimo/ride/lead.h"

namespace rmlcell::optimo {
namespace {

constexpr double kRounding = 1.0 + 1e-9;

}  // namespace

LeadAlong::LeadAlong(const motion::PlannedMotion& first, const motion::PathState& state)
    : state_{.speed = state.speed, .acceleration = state.acceleration},
      passed_(state.s),
      limits_(first.limits),
      motions_{first},
      ends_{first.path.length() - state.s} {}

void LeadAlong::Add(const motion::PlannedMotion& next) {
  limits_.acceleration = std::min(limits_.acceleration, next.limits.acceleration);
  limits_.jerk = std::min(limits_.jerk, next.limits.jerk);
  motions_.push_back(next);
  ends_.push_back(ends_.back() + next.path.length());
}

bool LeadAlong::SlowsTo(double speed) const {
  const double level = LeadFrom(state_, limits_, motion::kLargest).speed;
  return level > speed && level <= motions_.front().limits.speed * kRounding;
}

std::optional<LeadAlong::End> LeadAlong::EndOnLast(double speed) const {
  const Lead lead = LeadFrom(state_, limits_, speed);
  const double begin = BeginOfLast();
  const double end = std::max(lead.length, begin);
  motion::PathLimits limits = limits_;
  limits.speed = lead.speed;
  if (end > ends_.back() || !motion::FromFits(state_, end, lead.speed, limits)) return std::nullopt;
  return End{.s = end - begin, .speed = lead.speed};
}

std::vector<motion::PlannedMotion> LeadAlong::MotionsTo(const End& end,
                                                        const motion::AxisLimits& axes) const {
  motion::PathLimits limits = limits_;
  limits.speed = end.speed;
  const motion::SpeedProfile ramp =
      motion::SpeedProfile::From(state_, BeginOfLast() + end.s, end.speed, limits);
  const std::size_t count = motions_.size() - (end.s > 0.0 ? 0 : 1);
  std::vector<motion::PlannedMotion> motions;
  double begin = 0.0;
  for (std::size_t k = 0; k < count; begin = ends_[k++]) {
    const motion::PlannedMotion& planned = motions_[k];
    const bool whole = k + 1 < motions_.size();
    const double to = whole ? std::min(ends_[k], ramp.end().s) : ramp.end().s;
    if (!(to > begin)) return {};
    motion::PlannedMotion part = planned;
    part.speed = ramp.Part(begin, to);
    if (part.speed.peak_speed() > std::min(planned.limits.speed, planned.restart_speed) * kRounding)
      return {};
    if (whole && part.speed.end().speed > planned.speed.end().speed * kRounding) return {};
    const double from = k == 0 ? passed_ : 0.0;
    const double length = whole ? part.path.length() : from + (to - begin);
    if (from > 0.0 || !whole) part.path = part.path.Part(from, length);
    part.limits.speed = part.speed.peak_speed();  // a START on the way goes no faster again
    part.settling_s = 0.0;
    if (!whole) {
      part.ends_move = false;
      part.corner = {};
    } else if (part.ends_move) {
      part.corner.speed = part.speed.end().speed;
    }
    motions.push_back(part);
  }
  if (!motion::AxesCan(motions, axes)) return {};
  return motions;
}

}  // namespace rmlcell::optimo
