#pragma once

#include <optional>
#include <string>

#include "engine/motion/planner/span.h"

namespace rmlcell::motion {

// The middle stage of the chain. Corners get their curves, and what those leave of the legs becomes
// spans, each with the curve behind it. A second pair of passes gives the speeds of the knots: the
// ends of spans, and those of the stretches of bends that are passed with changing speed.
class SpanStage {
 public:
  using Number = LegStage::Number;  // of a move, a leg, a span

  SpanStage(const MachineLimits& machine, std::size_t window);

  // The stage before, which it takes from.
  LegStage& leg_stage() { return leg_stage_; }
  const LegStage& leg_stage() const { return leg_stage_; }

  // The machine passes the start of the first span at this speed.
  void BeginAt(double speed) { speeds_.BeginAt(speed); }

  // The end of the next leg becomes a corner with its curve, and its run spans, where that can be
  // decided. False: not yet.
  bool Resolve(bool accept_what_is_there);
  // Whether the next leg may be ready for that.
  bool CanResolve() const { return leg_stage_.knows_speed_of(leg_stage_.next()); }
  // Whether all corners that wait are of two lines and passed with a steady head.
  bool AllPlain() const { return curves_.empty(); }
  // The passes over spans, when there is enough for them to do; else what is known must do.
  void Settle() {
    if (speeds_.ends_at_rest() || speeds_.open_count() >= speeds_next_) {
      speeds_.Settle();
      speeds_next_ = std::max(LegStage::kBatchMin, 2 * speeds_.open_count());
    }
    SeeDecided();
  }
  void AcceptHalf();
  // The oldest move that is not decided.
  Number OldestOpenMove() const {
    const Ring<Leg>& legs = leg_stage_.legs();
    return decided_ < spans_.end() ? spans_[decided_].first_move
           : legs.empty()          ? leg_stage_.moves().end()
                                   : legs.front().first_move;
  }
  std::uint64_t starved() const { return starved_; }  // runs that were ended too early

  // Out: spans, the speeds of their knots from the oldest one on as far as they are final, and the
  // curves of those spans whose curve is not plain.
  const Ring<Span>& spans() const { return spans_; }
  const SpeedPasses& speeds() const { return speeds_; }
  const CornerCurve& oldest_curve() const { return curves_.front(); }
  // The oldest span, its knots and its curve are out.
  void DropOldest() {
    const Span& oldest = spans_.front();
    const std::size_t knots = oldest.knots();
    if (decided_ > spans_.first()) {
      decided_knots_ -= knots;
    } else {
      ++decided_;
    }
    if (IsBlend(oldest.report.passage) && !oldest.plain) curves_.PopFront();
    spans_.PopFront();
    for (std::size_t k = 0; k < knots; ++k) speeds_.Pop();
  }

  // The spans that wait, and the speeds of their knots as far as they are final, a line each.
  std::string Dump() const;

 private:
  using Move = LegStage::Move;
  using Leg = LegStage::Leg;

  // All by the length from the start of the run.
  struct LegPart {
    double leg_start;
    double leg_end;
    double from;
    double to;
  };

  const Ring<Move>& moves() const { return leg_stage_.moves(); }
  const MachineLimits& machine() const { return leg_stage_.machine(); }

  std::optional<double> LengthAfter(Number leg, double enough, bool accept_what_is_there) const;
  std::optional<double> SpeedWithin(Number leg, double cut, bool accept_what_is_there) const;
  std::optional<double> TakeCurve(Span& closing, const Leg& leg, double total,
                                  bool accept_what_is_there);
  void MakeCurve(Span& span, const Leg& leg, double cut);
  double SpeedOn(const Span& span, const Leg& leg, double cut, double most, bool capped) const;
  void ChooseStretches(Span& span, const Leg& leg, double cut, double most) const;
  void TakeMoves(Span& span, const Leg& leg, const LegPart& part) const;
  void CloseRun(Number last_leg, double total, const Span& closing, double speed_cap);
  void PushKnots(const Span& span, std::size_t first);
  void LetBendsVary();

  void SeeDecided() {
    while (decided_ < spans_.end() &&
           decided_knots_ + spans_[decided_].knots() <= speeds_.final_count()) {
      decided_knots_ += spans_[decided_++].knots();
    }
  }

  LegStage leg_stage_;
  Ring<Span> spans_;
  Ring<CornerCurve> curves_;  // of those spans whose curve is not plain
  SpeedPasses speeds_;        // over spans
  std::uint64_t starved_ = 0;

  bool axes_keep_up_;  // the axes allow whatever the tip may do on a curve without head rotation
  bool axes_follow_ramps_;         // the same, whatever the speed of the tip does there
  double run_length_ = 0.0;        // of the legs before the next one in its run
  double run_cut_ = 0.0;           // what the curve at the start of the run takes of it
  std::size_t speeds_next_ = 0;    // settle again at this many open knots
  Number decided_ = 0;             // the first span with a knot that is not final
  std::size_t decided_knots_ = 0;  // of the spans before it
};

}  // namespace rmlcell::motion
