#pragma once

#include <array>
#include <optional>
#include <string>

#include "engine/motion/planner/leg_stage.h"

namespace rmlcell::motion {

// The middle stage of the chain. Corners get their curves, and what those leave of the legs becomes
// spans, each with the curve behind it. A second pair of passes gives the speeds of the knots: the
// ends of spans, and those of the stretches of bends that are passed with changing speed.
class SpanStage {
 public:
  using Number = LegStage::Number;  // of a move, a leg, a span

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
    PathPose curve_middle;  // at half of its length
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

  SpanStage(const MachineLimits& machine, std::size_t window);

  // The stage before, which it takes from.
  LegStage& leg_stage() { return leg_stage_; }
  const LegStage& leg_stage() const { return leg_stage_; }

  // The machine passes the start of the first span at this speed.
  void BeginAt(double speed) { speeds_.BeginAt(speed); }

  // The end of the next leg becomes a corner with its curve, and its run spans, where that can be
  // decided. False: not yet.
  bool Resolve(bool accept_what_is_there);
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

  // What the motions of a span are made of.
  PlainCorner PlainCornerAt(Number corner_move, double cut) const;
  PathLimits LimitsOnCurve(Number corner_move, double cut) const;
  PathLimits LimitsInStretches(const Span& span) const;
  Stretches StretchesIn(const Span& span) const;
  BendSpeeds SpeedsAlong(const Span& span) const;
  // Whether the speed on the curve behind it may change although it has no stretches.
  bool MayVary(const Span& span) const { return span.head_steady && axes_follow_ramps_; }

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
  CornerCurve CurveAround(const Leg& leg, double cut, bool& head_steady) const;
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
  bool axes_follow_ramps_;         // on curves without head rotation, whatever the tip does
  double run_length_ = 0.0;        // of the legs before the next one in its run
  double run_cut_ = 0.0;           // what the curve at the start of the run takes of it
  std::size_t speeds_next_ = 0;    // settle again at this many open knots
  Number decided_ = 0;             // the first span with a knot that is not final
  std::size_t decided_knots_ = 0;  // of the spans before it
};

}  // namespace rmlcell::motion
