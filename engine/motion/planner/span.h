#pragma once

#include <array>

#include "engine/motion/corner/corner.h"
#include "engine/motion/planner/leg_stage.h"

// What is left of the legs between the curves at corners, and what the curve behind it is made of:
// that follows from the span, the moves that wait and the machine. Private to the folder.
namespace rmlcell::motion {

// From place x_from of one move to place x_to of another, and what ends it.
struct Span {
  LegStage::Number first_move = 0;
  LegStage::Number last_move = 0;
  double x_from = 0.0;
  double x_to = 0.0;
  double length = 0.0;
  PathLimits limits;
  LegStage::Number corner_move = 0;  // the last move before the passage; differs from last_move
                                     // when the curve begins in an earlier one
  double settling_s = 0.0;
  double cap = 0.0;  // of the speed at its end, and on the curve behind it or at both its ends
  // The speed on the curve behind it may change within the limits of the tip alone: the head does
  // not turn there, and the axes follow.
  bool may_vary = false;
  // The curve behind it is passed in stretches, with changing speed: a knot at the end of each.
  // Else it is passed steadily, or belongs to the ramps that run across the knot before it.
  bool in_stretches = false;
  BendStretches stretches{};
  CornerReport report;
  // When the report says blend:
  double curve_length = 0.0;
  PathPose curve_middle;  // at half of its length
  bool plain = false;     // the curve follows from corner and cut; else it waits beside the span

  double curve_end(std::size_t stretch) const {  // arc length from the start of the curve
    const std::size_t count = stretches.count;
    return stretch + 1 == count
               ? curve_length
               : curve_length * static_cast<double>(stretch + 1) / static_cast<double>(count);
  }
  std::size_t curve_knots() const { return in_stretches ? stretches.count : 0; }
  std::size_t knots() const { return 1 + curve_knots(); }
};

// One stretch of the curve behind a span.
struct Stretch {
  double end = 0.0;      // arc length from the start of the curve
  double end_cap = 0.0;  // of the speed there
  double most = 0.0;     // of the speed on the way
};
using Stretches = std::array<Stretch, BendStretches::kAbrupt>;  // the first curve_knots()

// The curve at a corner of two lines with a steady head.
PlainCorner PlainCornerAt(const LegStage& legs, LegStage::Number corner_move, double cut_mm);

// Any other curve, between the place at the distance `cut` before the end of `leg` and that behind
// it; both may lie some moves away.
struct CurveAround {
  CornerCurve curve;
  bool head_steady = true;
};
CurveAround CurveAroundEnd(const LegStage& legs, const LegStage::Leg& leg, double cut);

// Those of every move that a curve touches.
PathLimits LimitsOnCurve(const LegStage& legs, LegStage::Number corner_move, double cut);

// The same for a curve that is passed in stretches: with room for a speed that changes.
PathLimits LimitsInStretches(const LegStage& legs, const Span& span);

// How fast the curve behind a span may be passed from place to place. Precondition: it is plain.
BendSpeeds SpeedsAlong(const LegStage& legs, const Span& span);

// Precondition: it is passed in stretches.
Stretches StretchesIn(const LegStage& legs, const Span& span);

// A bend that takes all that the axes have takes nine tenths of it at this share of its speed.
inline constexpr double kLeavesRoom = 0.95;

}  // namespace rmlcell::motion
