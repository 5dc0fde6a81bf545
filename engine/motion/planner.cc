#include "engine/motion/planner.h"

#include <cmath>

#include "engine/core/check.h"
#include "engine/core/number_text.h"
#include "engine/motion/motion_chain.h"

namespace rmlcell::motion {
namespace {

// ACCEL below 0.1 % would take hours to arrive: "little or no motion" in the manual. motion.md 5.1.
constexpr double kAccelerationFractionMin = 0.001;

// Lengths in mm or angles in rad that no machine can have would only overflow later.
bool IsUsable(double value) { return std::abs(value) <= kLargest; }
bool IsUsable(const TipPose& pose) {
  return IsUsable(pose.tip.x) && IsUsable(pose.tip.y) && IsUsable(pose.tip.z) &&
         IsUsable(pose.a_rad) && IsUsable(pose.b_rad);
}

// A motion of more than 30 years is one that never arrives.
constexpr double kDurationMax_s = 1e9;

bool IsAboveZero(const PathLimits& limits) {
  return limits.speed > 0.0 && limits.acceleration > 0.0 && limits.jerk > 0.0;
}

// Moves too short to be made leave a gap between where the machine is and where the next move
// believes it begins: a line begins where the machine is.
bool NeedsAnchor(const PathPiece& path, const TipPose* end) {
  constexpr double kGap_mm = 1e-3;  // a thousand such moves
  if (end == nullptr) return false;
  const bool straight = path.kind() == PathPiece::Kind::kLine ||
                        path.kind() == PathPiece::Kind::kRotary || !(path.length() > 0.0);
  return straight && Distance(end->tip, path.from().tip) <= kGap_mm &&
         end->a_rad == path.from().a_rad && end->b_rad == path.from().b_rad;
}

}  // namespace

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
  const TipPose* end = chain_->end();
  const bool goes_on = end != nullptr && move.path.from() == *end;  // from where all is well
  if ((!goes_on && !IsUsable(move.path.from())) || !IsUsable(move.path.to()) ||
      !IsUsable(move.path.length())) {
    return Error{ErrorCode::kTargetOutOfTravel, "a coordinate is not a usable number", {}};
  }
  if (!goes_on && NeedsAnchor(move.path, end)) {
    MoveCommand anchored = move;
    anchored.path = PathPiece::Line(*chain_->end(), move.path.to());
    return AppendChecked(anchored);
  }
  return AppendChecked(move);
}

Status Planner::AppendChecked(const MoveCommand& move) {
  if (!(move.path.length() > 0.0)) {
    chain_->Nothing(move.path.from(), move.fly);
    return {};
  }
  if (move.limits) {
    RMLCELL_CHECK(IsAboveZero(*move.limits));
    chain_->Append(move, *move.limits);
    return {};
  }
  if (!(move.speed_fraction > 0.0)) return Error{ErrorCode::kNoMotion, "the speed is 0", {}};
  if (!(move.acceleration_fraction >= kAccelerationFractionMin)) {
    return Error{ErrorCode::kNoMotion,
                 "the acceleration is " + ShortestText(100.0 * move.acceleration_fraction) + " %",
                 {}};
  }
  const PathLimits limits = chain_->LimitsFor(move);
  if (!(move.path.length() <= limits.speed * kDurationMax_s) || !IsAboveZero(limits)) {
    return Error{ErrorCode::kNoMotion, "the speed is too low to ever arrive", {}};
  }
  chain_->Append(move, limits);
  return {};
}

void Planner::BeginMoving(double speed_mm_s) { chain_->BeginMoving(speed_mm_s); }
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
