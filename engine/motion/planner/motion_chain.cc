#include "engine/motion/planner/motion_chain.h"

#include <algorithm>
#include <cmath>

#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr std::size_t kThroughLegMax = 16;  // moves: most of what one leg of all would save
constexpr double kEqualLimits = 1e-9;       // relative
constexpr double kContiguous_mm = 1e-6;

bool Equal(double a, double b) { return a == b || std::abs(a - b) <= kEqualLimits * std::abs(b); }
bool Equal(const PathLimits& a, const PathLimits& b) {
  return Equal(a.speed, b.speed) && Equal(a.acceleration, b.acceleration) && Equal(a.jerk, b.jerk);
}

bool Contiguous(const TipPose& a, const TipPose& b) {
  return a.a_rad == b.a_rad && a.b_rad == b.b_rad &&
         (a.tip == b.tip || (a.tip - b.tip).norm() <= kContiguous_mm);
}

bool AxesKeepUp(const MachineLimits& machine) {
  bool enough = true;
  for (const std::size_t i : kLinearAxes) {
    enough = enough && machine.axes.speed[i] >= machine.tip_speed_mm_s &&
             machine.axes.acceleration[i] >= machine.normal_acceleration();
  }
  return enough;
}

// The tip's acceleration is at most that of the machine, whatever its speed does on a curve.
bool AxesFollowRamps(const MachineLimits& machine) {
  bool enough = AxesKeepUp(machine);
  for (const std::size_t i : kLinearAxes) {
    enough = enough && machine.axes.acceleration[i] >= machine.tip_acceleration_mm_s2 &&
             (std::isinf(machine.tip_jerk_mm_s3) || machine.axes.jerk[i] >= machine.tip_jerk_mm_s3);
  }
  return enough;
}

}  // namespace

MotionChain::MotionChain(const MachineLimits& machine, std::size_t window)
    : machine_(machine),
      window_(std::max(window, kBatchMin)),
      lines_follow_tip_(LinesFollowTip(machine)),
      axes_keep_up_(AxesKeepUp(machine)),
      axes_follow_ramps_(AxesFollowRamps(machine)) {}

void MotionChain::Append(const MoveCommand& move, const PathLimits& limits, bool goes_on) {
  const Number number = moves_.end();
  Move& slot = moves_.PushSlot();
  slot.path = move.path;
  slot.head = move.head;
  slot.limits = limits;
  const double length =
      slot.path.kind() == PathPiece::Kind::kJoint ? MeasureByTime(slot) : move.path.length();
  if (entry_speed_ > 0.0) {
    const double speed = entry_speed_ * length / move.path.length();
    running_.BeginAt(speed);
    speeds_.BeginAt(speed);
    last_speed_ = speed;
    entry_speed_ = 0.0;
  }
  // What is no number makes no passage.
  slot.acceleration_share = move.acceleration_fraction;
  slot.overshoot = move.overshoot_fraction > 0.0 ? std::min(move.overshoot_fraction, 1.0) : 0.0;
  slot.passage_speed = move.passage_speed_mm_s;
  slot.settling_s = move.settles ? machine_.settling_s : 0.0;
  slot.tag = move.tag;
  slot.fly = move.fly;
  const bool merged = open_ && !Join(goes_on);
  end_ = move.path.to();
  end_known_ = true;
  open_ = true;
  if (merged) {
    legs_.back().last_move = number;
    legs_.back().length += length;
  } else {
    Leg& leg = legs_.PushSlot();  // CloseLeg sets the rest
    leg.first_move = leg.last_move = number;
    leg.length = length;
  }
  if (!move.fly) {
    CloseLeg(Passage::kStop, false, 0.0);
    open_ = false;
  }
  if (!merged || !open_ || number % kBatchMin == 0) Work();
}

// A move in COORD ROBOT is measured by the time that it takes at full speed: then one share of it
// holds on both sides of a corner (motion.md 4.5). Returns its length.
double MotionChain::MeasureByTime(Move& move) {
  PathLimits& limits = move.limits;
  const double length = move.path.length() / limits.speed;
  move.path.MeasureBy(length);
  limits = {1.0, limits.acceleration / limits.speed, limits.jerk / limits.speed};
  return length;
}

// Decides how the move before the last one passes into the last. False when both are one leg.
bool MotionChain::Join(bool goes_on) {
  const Move& before = moves_[moves_.end() - 2];
  const Move& move = moves_.back();
  Leg& leg = legs_.back();
  Passage passage = Passage::kStop;
  double cap = 0.0;
  const bool through = machine_.corners == MachineLimits::Corners::kThrough;
  const bool joins =
      before.head == move.head && (goes_on || Contiguous(before.path.to(), move.path.from()));
  using Kind = PathPiece::Kind;
  leg.in_axes = before.path.kind() == Kind::kJoint && move.path.kind() == Kind::kJoint;
  // A curve must not reach over it, although without a limit on jerk it is passed.
  bool bends = false;
  if (before.overshoot <= 0.0 || stands_) {
    passage = Passage::kStopNoSpeed;
  } else if (leg.in_axes && joins) {
    cap = before.overshoot;
    leg.axes_corner =
        AxesCorner(before.path, move.path,
                   std::min({before.acceleration_share, move.acceleration_share, 1.0}), machine_);
    passage = leg.axes_corner.passage();
  } else if (before.path.by_sigma() || move.path.by_sigma()) {
    passage = Passage::kStopNeighbour;
  } else if (joins) {
    cap = before.overshoot * std::min(before.limits.speed, move.limits.speed);
    if (through) {
      passage = Passage::kThrough;
      cap = std::min({cap, before.passage_speed,
                      JunctionSpeed(before.path.Tangent(before.path.length()),
                                    move.path.Tangent(0.0), machine_.junction_jump_mm_s)});
      const double turn = std::abs(move.path.a_rate() - before.path.a_rate());
      if (turn > 0.0) cap = std::min(cap, machine_.junction_jump_a_rad_s / turn);
    } else {
      leg.corner.Assign(before.path, move.path);
      passage = leg.corner.passage();
      bends = passage == Passage::kBlend;
      if (bends && leg.corner.straight() && std::isinf(machine_.tip_jerk_mm_s3)) {
        passage = Passage::kThrough;  // without a limit on jerk a jump of curvature needs no curve
      }
    }
  }
  stands_ = false;
  if (passage == Passage::kThrough && !bends && Equal(cap, move.limits.speed) &&
      Equal(before.limits, move.limits)) {
    // A line without end must not fill the window as one leg. Passed through it need not even wait:
    // without a limit on jerk a leg may be cut anywhere.
    if (leg.last_move - leg.first_move < (through ? kThroughLegMax : window_ / 2)) return false;
    if (!through) ++starved_;
    bends = true;
  }
  CloseLeg(passage, bends, cap);
  return true;
}

void MotionChain::Nothing(const TipPose& here, bool fly) {
  if (!end_known_) end_ = here;
  end_known_ = true;
  if (open_ && !fly) stands_ = true;
}

void MotionChain::Mark(std::uint64_t tag) {
  if (!open_ && moves_.empty()) {
    items_.Push(PlannedMark{tag});
  } else {
    marks_.Push({tag, moves_.end() - 1});
  }
}

void MotionChain::Stop() {
  if (!open_) return;
  CloseLeg(Passage::kStop, false, 0.0);
  open_ = false;
  stands_ = false;
  Work();
}

void MotionChain::CloseLeg(Passage passage, bool ends_run, double cap) {
  Leg& leg = legs_.back();
  leg.passage = passage;
  leg.ends_run = passage != Passage::kThrough || ends_run;
  leg.cap = leg.limit = IsStop(passage) ? 0.0 : cap;
  running_.Push(leg.length, moves_[leg.first_move].limits, leg.cap);
}

void MotionChain::Work() {
  const auto open_knots = [](const SpeedPasses& passes) {
    return passes.size() - passes.final_count();
  };
  if (running_.ends_at_rest() || open_knots(running_) >= running_next_) {
    running_.Settle();
    running_next_ = std::max(kBatchMin, 2 * open_knots(running_));
  }
  while (Resolve(false)) {
  }
  if (speeds_.ends_at_rest() || open_knots(speeds_) >= speeds_next_) {
    speeds_.Settle();
    speeds_next_ = std::max(kBatchMin, 2 * open_knots(speeds_));
  }
  SeeDecided();
  const Number oldest = decided_ < spans_.end() ? spans_[decided_].first_move
                        : legs_.empty()         ? moves_.end()
                                                : legs_.front().first_move;
  if (moves_.end() - oldest >= window_) Starve();
}

void MotionChain::Starve() {
  ++starved_;
  running_.Settle();
  running_.Accept(running_.size() / 2);
  while (Resolve(true)) {
  }
  LetBendsVary();
  speeds_.Settle();
  speeds_.Accept(speeds_.size() / 2);
}

void MotionChain::SeeDecided() {
  while (decided_ < spans_.end() &&
         decided_knots_ + spans_[decided_].knots() <= speeds_.final_count()) {
    decided_knots_ += spans_[decided_++].knots();
  }
}

}  // namespace rmlcell::motion
