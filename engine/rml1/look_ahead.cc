#include "engine/rml1/look_ahead.h"

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"
#include "engine/rml1/timing.h"

namespace rmlcell::rml1 {
namespace {

// Speeds whose squares differ by less, relative to the one at the start, differ by rounding.
constexpr double kRoom = 1e-9;

// The speed that full braking over `length` leaves of `speed`.
double Braked(double speed, double length, double acceleration) {
  const double square = speed * speed - 2.0 * acceleration * length;
  return square > kRoom * speed * speed ? std::sqrt(square) : 0.0;
}

motion::PathPiece LineBetween(const Profile& profile, const Point& from, const Point& to) {
  return motion::PathPiece::Line(PoseOf(profile, from), PoseOf(profile, to));
}

}  // namespace

LookAhead::LookAhead(const Profile& profile, const Point& tool, double override_percent)
    : profile_(&profile),
      limits_(MillLimits(profile)),
      end_(tool),
      override_percent_(override_percent),
      planner_(limits_) {}

void LookAhead::Add(const Action& motion) {
  const bool joins = motion.chain != Chain::kAlone && motion.chain == chain_;
  if (!joins) EndChain();
  Motion& added = motions_.PushSlot();
  added = {.action = motion, .from = end_};
  end_ = motion.to;
  chain_ = motion.chain;
  if (chain_ == Chain::kAlone) added.ends_chain = true;
}

void LookAhead::EndChain() {
  if (chain_ == Chain::kAlone) return;
  chain_ = Chain::kAlone;
  if (motions_.empty()) return;
  motions_.back().ends_chain = true;
  if (fed_ == motions_.end()) planner_.Stop();
}

bool LookAhead::NextLeg(motion::PlannedMotion& ride, Leg& leg) {
  if (motions_.empty()) return false;
  if (intent_ == motion::RideIntent::kStop) {
    Brake(ride, leg);
    return true;
  }
  for (;;) {
    if (const motion::PlannedItem* item = planner_.NextInPlace()) {
      ride = std::get<motion::PlannedMotion>(*item);
      RMLCELL_CHECK(ride.tag >> 1U == motions_.first());
      ride.ends_move = (ride.tag & 1U) != 0;
      leg = {.feed_mm_s = motions_.front().feed_mm_s};
      return true;
    }
    if (fed_ == motions_.end()) return false;
    Feed();
  }
}

motion::PathPiece LookAhead::RestOf(const motion::PathPiece& path, bool oldest) const {
  if (!oldest || ridden_ <= 0.0 || path.by_sigma()) return path;
  return path.Part(std::min(ridden_, path.length()), path.length());
}

// Gives the planner one motion more. A tool that is faster than the motion may be, because the
// override was lowered, brakes fully until it is not: no faster than that curve, and what lies
// behind can be met from it, as the old plan could.
void LookAhead::Feed() {
  RMLCELL_CHECK(!held_);
  const bool oldest = fed_ == motions_.first();
  Motion& motion = motions_[fed_];
  const MotionPlan plan = PlanMotion(*profile_, motion.from, motion.action, override_percent_);
  motion.feed_mm_s = plan.feed_mm_s;
  const motion::PathPiece path = RestOf(plan.path, oldest);
  const double length = path.length();
  const double a = plan.limits.acceleration;
  const double braked = Braked(brake_speed_, length, a);
  motion::PathLimits braking = plan.limits;
  braking.speed = brake_speed_;
  if (brake_speed_ * brake_speed_ <= plan.limits.speed * plan.limits.speed * (1.0 + kRoom)) {
    Append(path, plan.limits, true, motion::kLargest);
  } else if (braked > plan.limits.speed) {
    Append(path, braking, true, braked);
  } else {
    const double over =
        (brake_speed_ * brake_speed_ - plan.limits.speed * plan.limits.speed) / (2.0 * a);
    const double way = std::min(over, length * (1.0 - kRoom));
    Append(path.Part(0.0, way), braking, false, motion::kLargest);
    Append(path.Part(way, length), plan.limits, true, motion::kLargest);
  }
  brake_speed_ = braked;
  ++fed_;
  held_ = intent_ == motion::RideIntent::kHold && braked == 0.0;
  if (!motion.ends_chain && !held_) return;
  planner_.Stop();
  brake_speed_ = 0.0;
}

void LookAhead::Append(const motion::PathPiece& path, const motion::PathLimits& limits,
                       bool ends_motion, double passage_speed) {
  motion::MoveCommand move;
  move.path = path;
  move.head = motion::MillHead{};
  move.limits = limits;
  move.fly = true;
  move.settles = false;
  move.passage_speed_mm_s = passage_speed;
  move.tag = fed_ << 1U | (ends_motion ? 1U : 0U);
  RMLCELL_CHECK(planner_.Append(move).ok());
}

// The part of the oldest motion on the ramp to rest: the limits of each motion on the way are its
// own, so that nowhere the tool is faster than it was planned to be.
void LookAhead::Brake(motion::PlannedMotion& ride, Leg& leg) {
  const Motion& motion = motions_.front();
  const MotionPlan plan = PlanMotion(*profile_, motion.from, motion.action, override_percent_);
  const double a = plan.limits.acceleration;
  ride = {};
  ride.path = RestOf(plan.path, true);
  ride.head = motion::MillHead{};
  ride.limits = plan.limits;
  const double length = ride.path.length();
  const double ramp = speed_ * speed_ / (2.0 * a);
  double end = motion.ends_chain ? 0.0 : Braked(speed_, length, a);
  leg = {.feed_mm_s = plan.feed_mm_s, .halts = end == 0.0 && ramp < length * (1.0 - kRoom)};
  ride.ends_move = !leg.halts;
  if (ride.ends_move) {
    ride.corner.passage = end > 0.0 ? motion::Passage::kThrough : motion::Passage::kStop;
    ride.corner.speed = end;
  }
  if (!(speed_ > 0.0)) return;  // it stands
  motion::PathLimits limits = plan.limits;
  limits.speed = speed_;
  ride.speed = motion::SpeedProfile::Span(leg.halts ? ramp : length, speed_, end, limits);
}

// A turn by itself begins anew where the tool is: by mm a speed stays what it is, by the share of a
// turn it counts for the turn that is left.
void LookAhead::Ride(const Ridden& part) {
  Motion& motion = motions_.front();
  speed_ = part.speed;
  if (!LineBetween(*profile_, motion.from, motion.action.to).by_sigma()) {
    ridden_ += part.length;
    return;
  }
  const double left = std::abs(motion.action.to.a - part.tool.a);
  speed_ = left > 0.0 ? speed_ * std::abs(motion.action.to.a - motion.from.a) / left : 0.0;
  motion.from = part.tool;
}

bool LookAhead::NothingLeft() {
  if (motions_.empty()) return false;
  const Motion& motion = motions_.front();
  const motion::PathPiece path = LineBetween(*profile_, motion.from, motion.action.to);
  return path.length() - ridden_ <= kNothing_mm;
}

void LookAhead::Finish(double speed) {
  speed_ = motions_.front().ends_chain ? 0.0 : speed;
  ridden_ = 0.0;
  motions_.PopFront();
}

void LookAhead::Replan(motion::RideIntent intent, double override_percent) {
  intent_ = intent;
  override_percent_ = override_percent;
  starved_ += planner_.lookahead_starved();
  planner_ = motion::Planner(limits_);
  planner_.BeginMoving(speed_);
  brake_speed_ = speed_;
  fed_ = motions_.first();
  held_ = false;
}

}  // namespace rmlcell::rml1
