#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "engine/core/ring.h"
#include "engine/motion/corner/axes_corner.h"
#include "engine/motion/planner/planner.h"
#include "engine/motion/profile/speed_passes.h"

namespace rmlcell::motion {

// The first stage of the chain. Moves that are one to the speed passes are one leg: a line split by
// points that change nothing. A first pair of passes runs over legs at their full length and gives
// each corner its running speed w, and with it the size of its curve (motion.md 4.3).
//
// A run is a sequence of legs joined by passages straight on; a curve may take up to half of a run,
// hence more than the leg next to it.
//
// The stages of the chain are one value, each on top of the one before: a copy is a copy of all,
// and what a stage keeps for itself is private to it.
class LegStage {
 public:
  // The legs that wait, and what of their speeds is final, a line each.
  void DumpLegs(std::string& out) const;

 protected:
  using Number = std::uint64_t;  // of a move, a leg, a span: counted from the first of the chain

  static constexpr std::size_t kBatchMin = 32;  // knots before a backward pass is worth its while

  struct Move {
    PathPiece path;
    Head head;
    PathLimits limits;
    double overshoot = 0.0;
    double acceleration_share = 1.0;  // ACCEL
    double passage_speed = 0.0;       // mills
    double settling_s = 0.0;
    std::uint64_t tag = 0;
    bool fly = false;
  };
  struct Leg {
    Number first_move = 0;
    Number last_move = 0;
    double length = 0.0;
    Corner corner{};         // at its end, when that may be a curve
    AxesCorner axes_corner;  // instead, when in_axes
    bool in_axes = false;    // both sides of its end are in COORD ROBOT
    Passage passage = Passage::kStop;
    bool ends_run = true;
    double cap = 0.0;    // OVERSH x the lower limit of both sides, lowered to what level 1 reaches
    double limit = 0.0;  // not lowered
  };

  LegStage(const MachineLimits& machine, std::size_t window);

  // The speed at which the first move begins, by its own s; and once it is added, by that of its
  // leg.
  void BeginLegsAt(double speed) { entry_speed_ = speed; }
  bool begins_moving() const { return entry_speed_ > 0.0; }
  double TakeEntrySpeed() { return std::exchange(entry_speed_, 0.0); }

  // The move has passed all checks and has a length above zero. `goes_on`: it begins exactly at
  // end(). True: a leg is closed, or there are many moves: there may be something to decide.
  bool AddMove(const MoveCommand& move, const PathLimits& limits, bool goes_on);
  // A move that goes nowhere stood here.
  void AddNothing(const PathPose& here, bool fly);
  // The machine stands behind the last move. False: it does already.
  bool EndLegs();

  static std::size_t OpenKnots(const SpeedPasses& passes) {
    return passes.size() - passes.final_count();
  }
  // The passes over legs, when there is enough for them to do; else what is known must do.
  void SettleLegs() {
    if (!running_.ends_at_rest() && OpenKnots(running_) < running_next_) return;
    running_.Settle();
    running_next_ = std::max(kBatchMin, 2 * OpenKnots(running_));
  }
  void AcceptHalfOfLegs();

  // LimitsOf, without asking the axes where the answer is known.
  PathLimits LimitsOfMove(const MoveCommand& move) const {
    const PathPiece& path = move.path;
    const bool simple = lines_follow_tip_ && path.kind() == PathPiece::Kind::kLine &&
                        move.kind == MoveCommand::Kind::kContour &&
                        path.from().a_rad == path.to().a_rad &&
                        path.from().b_rad == path.to().b_rad;
    return simple ? TipLimits(move, machine_) : LimitsOf(move, machine_);
  }

  // Where the last accepted move ended; null before the first.
  const PathPose* last_end() const { return end_known_ ? &end_ : nullptr; }

  MachineLimits machine_;
  std::size_t window_;
  std::uint64_t starved_ = 0;  // knots that were decided too early

  Ring<Move> moves_;     // those that a leg, a span or an item to come needs
  bool open_ = false;    // the last leg may still grow, the chain goes on
  Ring<Leg> legs_;       // from the first leg of the present run on
  SpeedPasses running_;  // over legs

 private:
  static double MeasureByTime(Move& move);
  bool Join(bool goes_on);
  void CloseLeg(Passage passage, bool ends_run, double cap);

  bool lines_follow_tip_;
  bool stands_ = false;  // although the last move has /FLY: a move that goes nowhere came after it
  PathPose end_;
  bool end_known_ = false;
  double entry_speed_ = 0.0;
  std::size_t running_next_ = 0;  // settle again at this many open knots
};

// Here, because it is the hot path of MotionChain::Append.
[[gnu::always_inline]] inline bool LegStage::AddMove(const MoveCommand& move,
                                                     const PathLimits& limits, bool goes_on) {
  const Number number = moves_.end();
  Move& slot = moves_.PushSlot();
  slot.path = move.path;
  slot.head = move.head;
  slot.limits = limits;
  const double length =
      slot.path.kind() == PathPiece::Kind::kJoint ? MeasureByTime(slot) : move.path.length();
  if (begins_moving()) {
    entry_speed_ = entry_speed_ * length / move.path.length();
    running_.BeginAt(entry_speed_);
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
  return !merged || !open_ || number % kBatchMin == 0;
}

// "BLEND", for dumps.
std::string_view NameOf(Passage passage);

}  // namespace rmlcell::motion
