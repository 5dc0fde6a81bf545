#include "engine/motion/planner/leg_stage.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"

namespace rmlcell::motion {
namespace {

constexpr std::size_t kThroughLegMax = 16;  // moves: most of what one leg of all would save
constexpr double kEqualLimits = 1e-9;       // relative
constexpr double kContiguous_mm = 1e-6;

bool Equal(double a, double b) { return a == b || std::abs(a - b) <= kEqualLimits * std::abs(b); }
bool Equal(const PathLimits& a, const PathLimits& b) {
  return Equal(a.speed, b.speed) && Equal(a.acceleration, b.acceleration) && Equal(a.jerk, b.jerk);
}

bool Contiguous(const PathPose& a, const PathPose& b) {
  return a.a_rad == b.a_rad && a.b_rad == b.b_rad &&
         (a.point == b.point || (a.point - b.point).norm() <= kContiguous_mm);
}

}  // namespace

LegStage::LegStage(const MachineLimits& machine, std::size_t window)
    : machine_(machine),
      window_(std::max(window, kBatchMin)),
      lines_follow_tip_(LinesFollowTip(machine)) {}

// A move in COORD ROBOT is measured by the time that it takes at full speed: then one share of it
// holds on both sides of a corner (motion.md 4.5). Returns its length.
double LegStage::MeasureByTime(Move& move) {
  PathLimits& limits = move.limits;
  const double length = move.path.length() / limits.speed;
  move.path.MeasureBy(length);
  limits = {1.0, limits.acceleration / limits.speed, limits.jerk / limits.speed};
  return length;
}

// Decides how the move before the last one passes into the last. False when both are one leg.
bool LegStage::Join(bool goes_on) {
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
    SettleAt(kBatchOfCurves);
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
      cap = std::min(cap, machine_.junction_jump_a_rad_s / turn);  // no turn, no bound
    } else {
      leg.corner.Assign(before.path, move.path);
      passage = leg.corner.passage();
      bends = passage == Passage::kBlend;
      if (bends && leg.corner.straight() && std::isinf(machine_.tip_jerk_mm_s3)) {
        passage = Passage::kThrough;  // without a limit on jerk a jump of curvature needs no curve
      }
      if (passage == Passage::kBlend && !leg.corner.plain()) {
        SettleAt(leg.corner.lines() ? kBatchOfTurns : kBatchOfCurves);
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

void LegStage::AddNothing(const PathPose& here, bool fly) {
  if (!end_known_) end_ = here;
  end_known_ = true;
  if (open_ && !fly) stands_ = true;
}

bool LegStage::End() {
  if (!open_) return false;
  CloseLeg(Passage::kStop, false, 0.0);
  open_ = false;
  stands_ = false;
  return true;
}

void LegStage::CloseLeg(Passage passage, bool ends_run, double cap) {
  Leg& leg = legs_.back();
  leg.passage = passage;
  leg.ends_run = passage != Passage::kThrough || ends_run;
  leg.cap = leg.limit = IsStop(passage) ? 0.0 : cap;
  running_.Push(leg.length, moves_[leg.first_move].limits, leg.cap);
}

void LegStage::AcceptHalf() {
  running_.Settle();
  running_.Accept(running_.size() / 2);
}

std::string_view NameOf(Passage passage) {
  switch (passage) {
    case Passage::kThrough:
      return "THROUGH";
    case Passage::kBlend:
      return "BLEND";
    case Passage::kBlendCapped:
      return "BLEND_CAPPED";
    default:
      return "STOP";
  }
}

std::string LegStage::Dump() const {
  std::string out;
  for (Number k = legs_.first(); k < legs_.end(); ++k) {
    const Leg& leg = legs_[k];
    out += "leg " + std::to_string(k) + ": moves " + std::to_string(leg.first_move) + " to " +
           std::to_string(leg.last_move) + ", length " + FixedText(leg.length, 3);
    if (closed(k)) out += ", " + std::string(NameOf(leg.passage)) + " at " + FixedText(leg.cap, 3);
    if (!closed(k)) out += ", open";
    if (closed(k) && leg.ends_run) out += ", ends the run";
    if (k >= next_ && knows_speed_of(k)) out += ", speed " + FixedText(speed_of(k), 3);
    out += '\n';
  }
  return out;
}

}  // namespace rmlcell::motion
