#include "engine/optimo/ride/lead_along.h"

#include <algorithm>

#include "engine/motion/ride/interruption.h"
#include "engine/optimo/ride/lead.h"

namespace rmlcell::optimo {

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

std::optional<LeadAlong::End> LeadAlong::EndOnLast(double speed) const {
  const Lead lead = LeadFrom(state_, limits_, speed);
  const double begin = BeginOfLast();
  const double end = std::max(lead.length, begin);
  if (end > ends_.back() || !(lead.speed > 0.0)) return std::nullopt;
  motion::PathLimits limits = limits_;
  limits.speed = lead.speed;
  if (!motion::FromFits(state_, end, lead.speed, limits)) return std::nullopt;
  return End{.s = end - begin, .speed = lead.speed};
}

std::vector<motion::PlannedMotion> LeadAlong::MotionsTo(const End& end,
                                                        const motion::AxisLimits& axes) const {
  constexpr double kRounding = 1.0 + 1e-9;
  motion::PathLimits limits = limits_;
  limits.speed = end.speed;
  const motion::SpeedProfile ramp =
      motion::SpeedProfile::From(state_, BeginOfLast() + end.s, end.speed, limits);
  std::vector<motion::PlannedMotion> motions;
  double begin = 0.0;
  for (std::size_t k = 0; k < motions_.size() && begin < ramp.end().s; begin = ends_[k++]) {
    const bool last = k + 1 == motions_.size();
    const double to = last ? ramp.end().s : std::min(ends_[k], ramp.end().s);
    motion::PlannedMotion part = motions_[k];
    part.speed = ramp.Part(begin, to);
    if (!last && part.speed.end().speed > motions_[k].speed.end().speed * kRounding) return {};
    const double from = k == 0 ? passed_ : 0.0;
    const double length = last ? from + (to - begin) : part.path.length();
    if (from > 0.0 || last) part.path = part.path.Part(from, length);
    part.settling_s = 0.0;
    if (last) {
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
