#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/ring.h"
#include "engine/motion/corner/axes_corner.h"
#include "engine/motion/planner/planner.h"
#include "engine/motion/profile/ramp_plan.h"
#include "engine/motion/profile/speed_passes.h"

namespace rmlcell::motion {

// The inside of the planner. Moves pass three stages, each a queue:
//
//   legs   moves that are one to the speed passes: a line split by points that change nothing.
//          The first pair of passes runs over legs at their full length and gives each corner its
//          running speed w, and with it the size of its curve (motion.md 4.3).
//   spans  what the curves leave of the legs, each with the curve behind it. The second pair of
//          passes gives the speeds of the knots.
//   items  spans cut back into moves, on demand. Spans between two knots that are passed as fast as
//          they may be are timed together: ramps run across the knots between (motion.md 5.4).
//
// A run is a sequence of legs joined by passages straight on; a curve may take up to half of a run,
// hence more than the leg next to it.
class MotionChain {
 public:
  MotionChain(const MachineLimits& machine, std::size_t window);

  // LimitsOf, without asking the axes where the answer is known.
  PathLimits LimitsFor(const MoveCommand& move) const {
    const PathPiece& path = move.path;
    const bool simple = lines_follow_tip_ && path.kind() == PathPiece::Kind::kLine &&
                        move.kind == MoveCommand::Kind::kContour &&
                        path.from().a_rad == path.to().a_rad &&
                        path.from().b_rad == path.to().b_rad;
    return simple ? TipLimits(move, machine_) : LimitsOf(move, machine_);
  }

  // The move has passed all checks and has a length above zero. `goes_on`: it begins exactly at
  // end().
  void Append(const MoveCommand& move, const PathLimits& limits, bool goes_on);

  // A move that goes nowhere stood here: the passage before it is a stop unless it had /FLY itself.
  void Nothing(const TipPose& here, bool fly);
  void BeginMoving(double speed) { entry_speed_ = speed; }
  bool starts_too_fast() const { return starts_too_fast_; }
  void Mark(std::uint64_t tag);
  void Stop();
  const PlannedItem* Next();  // see Planner::NextInPlace

  const MachineLimits& machine() const { return machine_; }
  std::uint64_t starved() const { return starved_; }

  // Where the last accepted move ended; null before the first.
  const TipPose* end() const { return end_known_ ? &end_ : nullptr; }

 private:
  using Number = std::uint64_t;

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
  // From place x_from of one move to place x_to of another, and what ends it.
  struct Span {
    Number first_move = 0;
    Number last_move = 0;
    double x_from = 0.0;
    double x_to = 0.0;
    double length = 0.0;
    PathLimits limits;
    Number corner_move = 0;  // the last move before the passage; differs from last_move when the
                             // curve begins in an earlier one
    double settling_s = 0.0;
    double cap = 0.0;  // of the speed at its end, and on the curve behind it or at both its ends
    bool head_steady = true;  // on the curve behind it
    // The curve behind it is passed in stretches, with changing speed: a knot at the end of each.
    // Else it is passed steadily, or belongs to the ramps that run across the knot before it.
    bool in_stretches = false;
    BendStretches stretches{};
    CornerReport report;
    // When the report says blend:
    double curve_length = 0.0;
    TipPose curve_middle;  // at half of its length
    bool plain = false;  // the curve follows from the corner and the cut; else it waits in curves_

    double curve_end(std::size_t stretch) const {  // arc length from the start of the curve
      const std::size_t count = stretches.count;
      return stretch + 1 == count
                 ? curve_length
                 : curve_length * static_cast<double>(stretch + 1) / static_cast<double>(count);
    }
    std::size_t curve_knots() const { return in_stretches ? stretches.count : 0; }
    std::size_t knots() const { return 1 + curve_knots(); }
  };
  // One stretch of a curve, from its start.
  struct Stretch {
    double end = 0.0;      // arc length from the start of the curve
    double end_cap = 0.0;  // of the speed there
    double most = 0.0;     // of the speed on the way
  };
  using Stretches = std::array<Stretch, BendStretches::kAbrupt>;  // the first curve_knots()
  struct WaitingMark {
    std::uint64_t tag = 0;
    Number after_move = 0;
  };

  static double MeasureByTime(Move& move);
  bool Join(bool goes_on);
  void CloseLeg(Passage passage, bool ends_run, double cap);
  void Work();
  void Starve();
  bool Resolve(bool accept_what_is_there);
  std::optional<double> LengthAfter(Number leg, double enough, bool accept_what_is_there);
  std::optional<double> SpeedWithin(Number leg, double cut, bool accept_what_is_there);
  void MakeCurve(Span& span, const Leg& leg, double cut);
  CornerCurve CurveAround(const Leg& leg, double cut, bool& head_steady);
  double SpeedOn(const Span& span, const Leg& leg, double cut, double most, bool capped);
  PlainCorner PlainCornerAt(Number corner_move, double cut);
  void ChooseStretches(Span& span, const Leg& leg, double cut, double most);
  void CloseRun(Number last_leg, double total, const Span& closing, double speed_cap);
  PathLimits LimitsOnCurve(Number corner_move, double cut);
  PathLimits LimitsInStretches(const Span& span);
  Stretches StretchesIn(const Span& span);
  BendSpeeds SpeedsAlong(const Span& span);
  void PushKnots(const Span& span, std::size_t first);
  void LetBendsVary();
  void SeeDecided();

  // The stretches of a curve that ramps pass; none: it is passed steadily.
  struct CurveCells {
    std::size_t count = 0;
    std::size_t at = 0;  // the present one
    std::array<double, BendStretches::kAbrupt> end{};
  };
  // One half of a corner curve, `begin` behind its start, and which part of it belongs to a move.
  struct Half {
    const TipPose& from;
    const TipPose& to;
    double length;
    double begin;
  };
  struct HalfPart {
    double s_from;
    double s_to;
    bool ends_move;
  };

  std::size_t SectionSize();
  bool EndsSection(const Span& span, std::size_t last_knot) const;
  void PlanSection();
  void AddCurve(const Span& span, std::size_t knot);
  void TakeRamp(SpeedProfile& speed, const SpeedProfile& ramp, double to);
  const SpeedProfile& PresentRamp();
  void TakePart(SpeedProfile& speed, double to, bool to_end);
  void TakeStretches(SpeedProfile& speed, CurveCells& cells, double& to);
  void EmitMove();
  void EmitCurve(Span& span);
  template <class Shape>  // PlainCorner or CornerCurve
  void EmitHalves(const Span& span, const Shape& shape, const Half& first, const Half& second,
                  CurveCells& cells);
  template <class Shape>
  void EmitCurvePart(const Span& span, Number move, const Shape& shape, const Half& half,
                     const HalfPart& part, CurveCells& cells);
  PlannedMotion& NewMotion(const Span& span, const Move& source);
  void EndMove(const Span& span, Number move, PlannedMotion& motion);
  void FinishMotion(const Span& span, Number move, PlannedMotion& motion, bool ends_move);

  MachineLimits machine_;
  std::size_t window_;
  bool lines_follow_tip_;
  bool axes_keep_up_;  // the axes allow whatever the tip may do on a curve without head rotation
  std::uint64_t starved_ = 0;

  Ring<Move> moves_;
  bool open_ = false;    // the last leg may still grow, the chain goes on
  bool stands_ = false;  // although the last move has /FLY: a move that goes nowhere came after it
  TipPose end_;
  bool end_known_ = false;

  Ring<Leg> legs_;                // from the first leg of the present run on
  SpeedPasses running_;           // over legs
  std::size_t running_next_ = 0;  // settle again at this many open knots
  Number resolving_ = 0;          // the leg whose end is to be decided next
  double run_length_ = 0.0;       // of the legs before it in its run
  double run_cut_ = 0.0;          // what the curve at the start of the run takes of it

  Ring<Span> spans_;
  Ring<CornerCurve> curves_;  // of those spans whose curve is not plain
  SpeedPasses speeds_;        // over spans
  std::size_t speeds_next_ = 0;
  double last_speed_ = 0.0;   // at the end of the last emitted span
  double entry_speed_ = 0.0;  // of the first move, by its own s
  bool starts_too_fast_ = false;
  std::size_t section_seen_ = 0;   // spans known not to end the next section
  std::size_t section_knots_ = 0;  // theirs
  Number decided_ = 0;             // the first span with a knot that is not final
  std::size_t decided_knots_ = 0;  // of the spans before it
  bool axes_follow_ramps_;         // on curves without head rotation, whatever the tip does

  // The section that is given out move by move, so that a span of thousands of them takes no room.
  std::size_t section_left_ = 0;  // its spans from the oldest one on
  bool alone_ = false;            // it has but one span, timed by lone_; else by ramps_
  SpeedProfile lone_;
  std::vector<RampCell> cells_;
  std::vector<double> most_;  // of the bends among them: RampCell::most
  RampPlan ramps_;
  std::size_t section_cell_ = 0;  // the present one of cells_
  std::size_t place_ramp_ = 0;    // of ramps_
  SpeedProfile::Place place_;     // on it, or on lone_: where the last part ended
  bool emitting_ = false;         // some moves of the oldest span are out already
  Number emit_move_ = 0;          // its next
  double emit_done_ = 0.0;        // length of those that are out

  Ring<WaitingMark> marks_;
  Ring<PlannedItem> items_;  // final, not yet taken: those of one move and the curve behind it
};

}  // namespace rmlcell::motion
