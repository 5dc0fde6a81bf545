#include "engine/motion/planner/planner.h"

#include <cmath>

#include "engine/core/check.h"
#include "engine/core/number_text.h"
#include "engine/motion/planner/motion_chain.h"

namespace rmlcell::motion {
namespace {

// ACCEL below 0.1 % would take hours to arrive: "little or no motion" in the manual. motion.md 5.1.
constexpr double kAccelerationFractionMin = 0.001;

// Lengths in mm or angles in rad that no machine can have would only overflow later.
bool IsUsable(double value) { return std::abs(value) <= kLargest; }
bool IsUsable(const PathPose& pose) {
  return std::abs(pose.point.x()) + std::abs(pose.point.y()) + std::abs(pose.point.z()) +
             std::abs(pose.a_rad) + std::abs(pose.b_rad) <=
         kLargest;
}

// A motion of more than 30 years is one that never arrives.
constexpr double kDurationMax_s = 1e9;

bool IsAboveZero(const PathLimits& limits) {
  return limits.speed > 0.0 && limits.acceleration > 0.0 && limits.jerk > 0.0;
}

// Moves too short to be made leave a gap between where the machine is and where the next move
// believes it begins: a line begins where the machine is.
bool NeedsAnchor(const PathPiece& path, const PathPose* end) {
  constexpr double kGap_mm = 1e-3;  // a thousand such moves
  if (end == nullptr) return false;
  const bool straight = path.kind() == PathPiece::Kind::kLine ||
                        path.kind() == PathPiece::Kind::kRotary || !(path.length() > 0.0);
  return straight && (end->point - path.from().point).norm() <= kGap_mm &&
         end->a_rad == path.from().a_rad && end->b_rad == path.from().b_rad;
}

// Errors are made elsewhere, so that the moves without one pay nothing for them.
[[gnu::cold, gnu::noinline]] Status NotUsable() {
  return Error{ErrorCode::kCellTargetUnusable, "a coordinate is not a usable number", {}};
}
[[gnu::cold, gnu::noinline]] Status NoMotion(const char* why) {
  return Error{ErrorCode::kCellNoMotion, why, {}};
}
[[gnu::cold, gnu::noinline]] Status TooLittleAcceleration(double share) {
  const double percent = 100.0 * share;
  return Error{
      ErrorCode::kCellNoMotion,
      "the acceleration is " + Told("acceleration", percent, "%", ShortestText(percent) + " %"),
      {}};
}

}  // namespace

void PlannedMotion::MeasureBy(double factor) {
  path.MeasureBy(path.length() * factor);
  speed = speed.Scaled(factor);
  limits = {limits.speed * factor, limits.acceleration * factor, limits.jerk * factor};
  if (restart_speed < kLargest) restart_speed *= factor;
}

Planner::Planner(const MachineLimits& limits, std::size_t window)
    : chain_(std::make_unique<MotionChain>(limits, window)) {}
Planner::~Planner() = default;
Planner::Planner(const Planner& other) : chain_(std::make_unique<MotionChain>(*other.chain_)) {}
Planner& Planner::operator=(const Planner& other) {
  if (this != &other) chain_ = std::make_unique<MotionChain>(*other.chain_);
  return *this;
}
Planner::Planner(Planner&&) noexcept = default;
Planner& Planner::operator=(Planner&&) noexcept = default;

Status Planner::Append(const MoveCommand& move) {
  const PathPose* end = chain_->end();
  const bool goes_on = end != nullptr && move.path.from() == *end;  // from where all is well
  if (!goes_on) {
    if (!IsUsable(move.path.from())) return NotUsable();
    if (NeedsAnchor(move.path, end)) {
      MoveCommand anchored = move;
      anchored.path = move.path.StraightFrom(*end);
      return Append(anchored);
    }
  }
  const bool line = move.path.kind() == PathPiece::Kind::kLine;  // as long as its ends say
  if (!IsUsable(move.path.to()) || (!line && !IsUsable(move.path.length()))) return NotUsable();
  if (!(move.path.length() > 0.0)) {
    if (!IsUsable(move.path.length())) return NotUsable();
    chain_->Nothing(move.path.from(), move.fly);
    return {};
  }
  if (move.limits) {
    RMLCELL_CHECK(IsAboveZero(*move.limits));
    chain_->Append(move, *move.limits, goes_on);
    return {};
  }
  if (!(move.speed_fraction > 0.0)) return NoMotion("the speed is 0");
  if (!(move.acceleration_fraction >= kAccelerationFractionMin)) {
    return TooLittleAcceleration(move.acceleration_fraction);
  }
  const PathLimits limits = chain_->LimitsFor(move);
  if (!(move.path.length() <= limits.speed * kDurationMax_s) || !IsAboveZero(limits)) {
    return NoMotion("the speed is too low to ever arrive");
  }
  chain_->Append(move, limits, goes_on);
  return {};
}

void Planner::BeginMoving(double speed) { chain_->BeginMoving(speed); }
bool Planner::starts_too_fast() const { return chain_->starts_too_fast(); }
void Planner::Mark(std::uint64_t tag) { chain_->Mark(tag); }
void Planner::Stop() { chain_->Stop(); }
const PlannedItem* Planner::NextInPlace() { return chain_->Next(); }
std::optional<PlannedItem> Planner::Next() {
  const PlannedItem* item = chain_->Next();
  return item == nullptr ? std::nullopt : std::optional<PlannedItem>(*item);
}
const MachineLimits& Planner::limits() const { return chain_->machine(); }
std::uint64_t Planner::lookahead_starved() const { return chain_->starved(); }

}  // namespace rmlcell::motion
