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
// A stage owns the one that it takes from: the chain is one value, and a copy of it a copy of all.
class LegStage {
 public:
  using Number = std::uint64_t;  // of a move, a leg, a span: counted from the first of the chain

  static constexpr std::size_t kBatchMin = 32;  // knots before a backward pass is worth its while
  // Behind a corner that takes longer than a pass: what is known is worked out early, and does not
  // wait for the last move of a chain.
  static constexpr std::size_t kBatchOfTurns = 16;  // two lines, the head turns
  static constexpr std::size_t kBatchOfCurves = 1;  // beside an arc, or of the axes

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

  // In: moves. The speed at which the first one begins, by its own s; and once it is added, by that
  // of its leg.
  void BeginAt(double speed) { entry_speed_ = speed; }
  bool begins_moving() const { return entry_speed_ > 0.0; }
  double TakeEntrySpeed() { return std::exchange(entry_speed_, 0.0); }

  // The move has passed all checks and has a length above zero. `goes_on`: it begins exactly at
  // end(). True: a leg is closed, or there are many moves: there may be something to decide.
  bool Add(const MoveCommand& move, const PathLimits& limits, bool goes_on);
  // A move that goes nowhere stood here.
  void AddNothing(const PathPose& here, bool fly);
  // The machine stands behind the last move. False: it does already.
  bool End();

  // The passes over legs, when there is enough for them to do; else what is known must do.
  void Settle() {
    if (!running_.ends_at_rest() && running_.open_count() < running_next_) return;
    running_.Settle();
    left_open_ = running_.open_count();
    running_next_ = std::max(kBatchMin, 2 * left_open_);
  }
  void AcceptHalf();

  // Out: legs, from the first one of the present run on.
  const Ring<Leg>& legs() const { return legs_; }
  bool closed(Number leg) const { return leg + 1 < legs_.end() || !open_; }
  // The oldest leg whose running speed was not taken, and whether its speed and those of later ones
  // are final.
  Number next() const { return next_; }
  bool knows_speed_of(Number leg) const { return leg - next_ < running_.final_count(); }
  // Precondition: it is known.
  double speed_of(Number leg) const {
    return running_.speed(static_cast<std::size_t>(leg - next_));
  }
  void TakeSpeed() {
    running_.Pop();
    ++next_;
  }
  // Of the next leg: its run must end there; its end is passed at this speed at most.
  void EndRun() { legs_[next_].ends_run = true; }
  void LowerCap(double speed) { legs_[next_].cap = std::min(legs_[next_].cap, speed); }
  // The legs whose speed was taken.
  void DropTaken() {
    while (legs_.first() < next_) legs_.PopFront();
  }

  // The moves that a leg, a span or an item to come needs.
  const Ring<Move>& moves() const { return moves_; }
  bool open() const { return open_; }  // the last leg may still grow, the chain goes on
  void DropOldestMove() { moves_.PopFront(); }

  const MachineLimits& machine() const { return machine_; }
  std::size_t window() const { return window_; }
  std::uint64_t starved() const { return starved_; }  // legs that were ended too early

  // LimitsOf, without asking the axes where the answer is known.
  PathLimits LimitsFor(const MoveCommand& move) const {
    const PathPiece& path = move.path;
    const bool simple = lines_follow_tip_ && path.kind() == PathPiece::Kind::kLine &&
                        move.kind == MoveCommand::Kind::kContour &&
                        path.from().a_rad == path.to().a_rad &&
                        path.from().b_rad == path.to().b_rad;
    return simple ? TipLimits(move, machine_) : LimitsOf(move, machine_);
  }

  // Where the last accepted move ended; null before the first.
  const PathPose* end() const { return end_known_ ? &end_ : nullptr; }

  // The legs that wait, and the running speeds at their ends as far as they are final, a line each.
  std::string Dump() const;

 private:
  static double MeasureByTime(Move& move);
  bool Join(bool goes_on);
  void CloseLeg(Passage passage, bool ends_run, double cap);
  void SettleAt(std::size_t batch) {
    running_next_ = std::min(running_next_, std::max(batch, 2 * left_open_));
  }

  MachineLimits machine_;
  std::size_t window_;
  std::uint64_t starved_ = 0;

  Ring<Move> moves_;
  bool open_ = false;
  Ring<Leg> legs_;
  SpeedPasses running_;  // over legs, from the next one on
  Number next_ = 0;

  bool lines_follow_tip_;
  bool stands_ = false;  // although the last move has /FLY: a move that goes nowhere came after it
  PathPose end_;
  bool end_known_ = false;
  double entry_speed_ = 0.0;
  std::size_t running_next_ = 0;  // settle again at this many open knots
  std::size_t left_open_ = 0;     // by the last time
};

// Here, because it is the hot path of MotionChain::Append.
[[gnu::always_inline]] inline bool LegStage::Add(const MoveCommand& move, const PathLimits& limits,
                                                 bool goes_on) {
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
