#include "engine/motion/planner.h"

#include <cmath>

#include "engine/core/number_text.h"

namespace rmlcell::motion {
namespace {

// ACCEL below 0.1 % would take hours to arrive: "little or no motion" in the manual. motion.md 5.1.
constexpr double kAccelerationFractionMin = 0.001;

bool IsFinite(const TipPose& pose) {
  return std::isfinite(pose.tip.x) && std::isfinite(pose.tip.y) && std::isfinite(pose.tip.z) &&
         std::isfinite(pose.a_rad) && std::isfinite(pose.b_rad);
}

}  // namespace

Planner::Planner(const MachineLimits& limits) : limits_(limits) {}

Status Planner::Append(const MoveCommand& move) {
  if (!IsFinite(move.path.from()) || !IsFinite(move.path.to()) ||
      !std::isfinite(move.path.length())) {
    return Error{ErrorCode::kTargetOutOfTravel, "a coordinate is not a finite number", {}};
  }
  if (!(move.path.length() > 0.0)) return {};
  if (!(move.speed_fraction > 0.0)) return Error{ErrorCode::kNoMotion, "the speed is 0", {}};
  if (!(move.acceleration_fraction >= kAccelerationFractionMin)) {
    return Error{ErrorCode::kNoMotion,
                 "the acceleration is " + ShortestText(100.0 * move.acceleration_fraction) + " %",
                 {}};
  }
  const PathLimits limits = LimitsOf(move, limits_);
  if (!(limits.speed > 0.0) || !(limits.acceleration > 0.0) || !(limits.jerk > 0.0)) {
    return Error{ErrorCode::kNoMotion, "the speed is too low to ever arrive", {}};
  }
  Release(0.0);
  PlannedMotion motion;
  motion.tag = move.tag;
  motion.path = move.path;
  motion.head = move.head;
  motion.limits = limits;
  motion.speed = SpeedProfile::Span(move.path.length(), 0.0, 0.0, limits);
  motion.settling_s = move.settles ? limits_.settling_s : 0.0;
  motion.upper_bound = move.fly && move.overshoot_fraction > 0.0;
  if (move.fly) {
    passing_ = std::move(motion);
  } else {
    final_.emplace_back(std::move(motion));
  }
  return {};
}

void Planner::Mark(std::uint64_t tag) {
  if (passing_) {
    marks_.push_back({tag});
  } else {
    final_.emplace_back(PlannedMark{tag});
  }
}

void Planner::Stop() {
  if (!passing_) return;
  passing_->upper_bound = false;  // the machine does stand here
  Release(passing_->settling_s);
}

void Planner::Release(double settling_s) {
  if (!passing_) return;
  passing_->settling_s = settling_s;
  final_.emplace_back(*std::move(passing_));
  passing_.reset();
  for (const PlannedMark& mark : marks_) final_.emplace_back(mark);
  marks_.clear();
}

std::optional<PlannedItem> Planner::Next() {
  if (final_.empty()) return std::nullopt;
  PlannedItem item = std::move(final_.front());
  final_.pop_front();
  return item;
}

}  // namespace rmlcell::motion
