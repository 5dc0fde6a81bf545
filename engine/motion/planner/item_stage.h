#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "engine/motion/planner/span_stage.h"
#include "engine/motion/profile/ramp_plan.h"

namespace rmlcell::motion {

// The last stage of the chain. Spans are cut back into moves, on demand, and become motions and
// marks. Spans between two knots that are passed as fast as they may be are a section: they are
// timed together, and ramps run across the knots between (motion.md 5.4).
class ItemStage {
 public:
  ItemStage(const MachineLimits& machine, std::size_t window) : span_stage_(machine, window) {}

  // The stage before, which it takes from.
  SpanStage& span_stage() { return span_stage_; }
  const SpanStage& span_stage() const { return span_stage_; }

  // The machine passes the start of the first motion at this speed.
  void BeginAt(double speed) { last_speed_ = speed; }
  void AddMark(std::uint64_t tag);
  bool starts_too_fast() const { return starts_too_fast_; }  // see Planner::BeginMoving
  const PlannedItem* Next();                                 // see Planner::NextInPlace

  // What may be worked on: a little more, or all there is.
  void AllowMore() {
    const Number waiting = spans().end() - spans().first();
    allowance_ = std::min(allowance_, 0) + kWorkEach;
    if (waiting >= kFewWait) allowance_ += kWorkEach * static_cast<int>(waiting / kFewWait);
  }
  void AllowAll() { allowed_to_ = std::max(allowed_to_, spans().end()); }
  void AllowAlways() { allowed_to_ = std::numeric_limits<Number>::max(); }

  // The section that is given out and the items and marks that wait, a line each.
  std::string Dump() const;

 private:
  using Number = SpanStage::Number;
  using Move = LegStage::Move;

  // What is worked with each move, in cells timed by themselves (RampPlan::GoOn): more than lines
  // take in the mean whose bends use them up. Where more than a few spans wait it grows, so that
  // they never become many.
  static constexpr int kWorkEach = 14;
  static constexpr Number kFewWait = 128;

  struct WaitingMark {
    std::uint64_t tag = 0;
    Number after_move = 0;
  };
  // The stretches of a curve that ramps pass; none: it is passed steadily.
  struct CurveCells {
    std::size_t count = 0;
    std::size_t at = 0;  // the present one
    std::array<double, BendStretches::kAbrupt> end{};
  };
  // One half of a corner curve, `begin` behind its start, and which part of it belongs to a move.
  struct Half {
    const PathPose& from;
    const PathPose& to;
    double length;
    double begin;
  };
  struct HalfPart {
    double s_from;
    double s_to;
    bool ends_move;
  };

  const Ring<Span>& spans() const { return span_stage_.spans(); }
  const SpeedPasses& speeds() const { return span_stage_.speeds(); }
  const LegStage& legs() const { return span_stage_.leg_stage(); }
  const Ring<Move>& moves() const { return legs().moves(); }
  const MachineLimits& machine() const { return legs().machine(); }

  bool MayGoOn() const { return spans().first() < allowed_to_ || allowance_ > 0; }
  std::size_t SectionSize();
  bool EndsSection(const Span& span, std::size_t last_knot) const;
  void BeginSection();
  int PlanSection();
  bool section_planned() const {
    return alone_ || (built_ == section_size_ && section_.plan.done());
  }
  void AddSpan(const Span& span, bool last);
  void AddCurve(const Span& span, std::size_t knot);
  void TakeRamp(SpeedProfile& speed, const SpeedProfile& ramp, double to);
  const SpeedProfile& PresentRamp();
  void TakePart(SpeedProfile& speed, double to, bool to_end);
  void TakeStretches(SpeedProfile& speed, CurveCells& cells, double& to);
  void EmitMove();
  void EmitCurve(const Span& span);
  template <class Shape>  // PlainCorner or CornerCurve
  void EmitHalves(const Span& span, const Shape& shape, const Half& first, const Half& second,
                  CurveCells& cells);
  template <class Shape>
  void EmitCurvePart(const Span& span, Number move, const Shape& shape, const Half& half,
                     const HalfPart& part, CurveCells& cells);
  PlannedMotion& NewMotion(const Span& span, const Move& source);
  void EndMove(const Span& span, Number move, PlannedMotion& motion);
  void FinishMotion(const Span& span, Number move, PlannedMotion& motion, bool ends_move);

  SpanStage span_stage_;
  double last_speed_ = 0.0;   // at the end of the last emitted span
  double curve_speed_ = 0.0;  // in the middle of the curve that is given out
  bool starts_too_fast_ = false;
  std::size_t section_seen_ = 0;   // spans known not to end the next section
  std::size_t section_knots_ = 0;  // theirs

  // The section that is given out move by move, so that a span of thousands of them takes no room.
  std::size_t section_left_ = 0;  // its spans from the oldest one on
  bool alone_ = false;            // it has but one span, timed by lone_; else by section_
  SpeedProfile lone_;
  std::size_t section_size_ = 0;  // spans, with those that are out
  std::size_t built_ = 0;         // of them, whose cells are there
  std::size_t built_knots_ = 0;
  // A copy looks at its own cells, and they at their own speeds.
  struct Ramps {
    std::vector<RampCell> cells;
    std::vector<double> most;  // of the bends among them: RampCell::most
    RampPlan plan;

    Ramps() = default;
    Ramps(const Ramps& other) { *this = other; }
    Ramps& operator=(const Ramps& other);
  };
  Ramps section_;
  std::size_t section_cell_ = 0;  // the present one of its cells
  std::size_t place_ramp_ = 0;    // of its ramps
  SpeedProfile::Place place_;     // on it, or on lone_: where the last part ended
  bool emitting_ = false;         // some moves of the oldest span are out already
  Number emit_move_ = 0;          // its next
  double emit_done_ = 0.0;        // length of those that are out
  Number ended_before_ = 0;       // moves that end on the last curve, and those before them

  // Spans are timed and given out a few with each move: the rest of a batch waits for those that
  // follow.
  int allowance_ = 0;      // in the work of RampPlan::GoOn
  Number allowed_to_ = 0;  // spans before it are not counted

  Ring<WaitingMark> marks_;
  Ring<PlannedItem> items_;  // final, not yet taken: those of one move and the curve behind it
};

}  // namespace rmlcell::motion
