#include "engine/motion/planner/span_stage.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/motion/geometry/least.h"
#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr double kCutMin_mm = 1e-4;  // a smaller curve is a stop, motion.md 4.4
constexpr double kSameLimit = 1e-9;  // relative

// How near the tip comes to where it would be at the end of `path`, on a curve behind it. Both are
// of the axes.
double TipDistance(const CornerCurve& curve, const Head& head, const PathPiece& path) {
  const auto tip_of = [&](const PathPose& axes) -> MachinePoint {
    return TipOn(path, head, axes).tip;
  };
  constexpr int kIntervals = 32;
  const MachinePoint tip = tip_of(path.to());
  return LeastAlong([&](double u) { return (tip_of(curve.At(u)) - tip).norm(); }, 1.0, kIntervals);
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

SpanStage::SpanStage(const MachineLimits& machine, std::size_t window)
    : leg_stage_(machine, window),
      axes_keep_up_(AxesKeepUp(machine)),
      axes_follow_ramps_(AxesFollowRamps(machine)) {}

// The length of the run that begins behind `leg`, or at least `enough` of it; nothing when that is
// not known yet.
std::optional<double> SpanStage::LengthAfter(Number leg, double enough,
                                             bool accept_what_is_there) const {
  const Ring<Leg>& legs = leg_stage_.legs();
  double length = 0.0;
  for (Number k = leg + 1; k < legs.end(); ++k) {
    length += legs[k].length;
    if (length >= enough) return length;
    if (leg_stage_.closed(k) && legs[k].ends_run) return length;
  }
  if (accept_what_is_there) return length;
  return std::nullopt;
}

// Points passed straight on that the curve of `cut` at the end of `leg` swallows or ends at keep
// their speed: the least of them; nothing when they are not known yet.
std::optional<double> SpanStage::SpeedWithin(Number leg, double cut,
                                             bool accept_what_is_there) const {
  const Ring<Leg>& legs = leg_stage_.legs();
  double least = HUGE_VAL;
  double beyond = 0.0;
  for (Number k = leg + 1; k < legs.end() && beyond + legs[k].length <= cut; ++k) {
    beyond += legs[k].length;
    const bool known = leg_stage_.knows_speed_of(k);
    if (!known && !accept_what_is_there) return std::nullopt;
    least = std::min(least, known ? leg_stage_.speed_of(k) : legs[k].cap);
  }
  return least;
}

// The curve at the end of the next leg, behind a run of length `total`, and the speed there: 0
// where it turns out to be a stop. Nothing when that is not known yet.
std::optional<double> SpanStage::TakeCurve(Span& closing, const Leg& leg, double total,
                                           bool accept_what_is_there) {
  const Number number = leg_stage_.next();
  const double wanted = closing.report.wanted_speed;
  // A curve of the axes takes half of the way by time, and so a quarter on each side.
  const double share = leg.in_axes ? 0.25 : 0.5;
  const double uncapped =
      leg.in_axes ? leg.axes_corner.CutFor(wanted) : leg.corner.CutFor(wanted, machine());
  const double want = leg.in_axes ? uncapped : std::min(uncapped, leg.corner.cut_max_mm());
  const std::optional<double> after = LengthAfter(number, want / share, accept_what_is_there);
  if (!after) return std::nullopt;
  const double cut = std::min({want, share * total, share * *after});
  if (!leg.in_axes && cut < kCutMin_mm) {
    closing.report.passage = Passage::kStopShort;
    return 0.0;
  }
  double swallowed = HUGE_VAL;  // the speed of what the curve takes whole
  if (leg_stage_.legs()[number + 1].length <= cut) {
    const auto within = SpeedWithin(number, cut, accept_what_is_there);
    if (!within) return std::nullopt;
    swallowed = *within;
  }
  closing.report.cut_mm = cut;
  MakeCurve(closing, leg, cut);
  if (!leg.in_axes && !leg.corner.lines() && curves_.back().HasCusp(cut)) {
    curves_.PopBack();
    closing.curve_length = closing.report.cut_mm = closing.report.deviation_mm = 0.0;
    closing.report.passage = Passage::kStopReversal;
    return 0.0;
  }
  if (!(cut > 0.0)) return 0.0;
  const bool capped = cut < uncapped;
  double speed_cap = SpeedOn(closing, leg, cut, wanted, capped);
  const bool slower = speed_cap < wanted * (1.0 - kSameLimit);
  closing.report.passage = capped || slower ? Passage::kBlendCapped : Passage::kBlend;
  speed_cap = std::min(speed_cap, swallowed);
  ChooseStretches(closing, leg, speed_cap, std::min(leg.limit, swallowed));
  return closing.in_stretches ? closing.stretches.start : speed_cap;
}

bool SpanStage::Resolve(bool accept_what_is_there) {
  const Number number = leg_stage_.next();
  if (!leg_stage_.knows_speed_of(number)) return false;
  const Leg& leg = leg_stage_.legs()[number];
  const double wanted = leg_stage_.speed_of(number);
  const double total = run_length_ + leg.length;
  // Nor may a run fill the window; but it holds what the curve before it takes. Where corners are
  // passed through there is no curve at its end to wait for.
  const bool through = machine().corners == MachineLimits::Corners::kThrough;
  const std::size_t longest = through ? LegStage::kBatchMin : leg_stage_.window() / 2;
  if (!leg.ends_run && number - leg_stage_.legs().first() >= longest && total >= run_cut_) {
    leg_stage_.EndRun();
    if (!through) ++starved_;
  }
  if (!leg.ends_run) {
    leg_stage_.LowerCap(wanted);
    run_length_ = total;
    leg_stage_.TakeSpeed();
    return true;
  }

  Span closing;
  closing.report.passage = leg.passage;
  closing.report.wanted_speed = wanted;
  double speed_cap = leg.passage == Passage::kThrough ? wanted : 0.0;
  if (IsBlend(leg.passage)) {
    const std::optional<double> on_curve = TakeCurve(closing, leg, total, accept_what_is_there);
    if (!on_curve) return false;
    speed_cap = *on_curve;
  }
  if (closing.report.passage == Passage::kStop)
    closing.settling_s = moves()[leg.last_move].settling_s;
  leg_stage_.TakeSpeed();
  CloseRun(number, total, closing, speed_cap);
  run_length_ = 0.0;
  run_cut_ = closing.report.cut_mm;
  leg_stage_.DropTaken();
  return true;
}

// The highest steady speed up to `wanted` on the curve that was just made.
double SpanStage::SpeedOn(const Span& span, const Leg& leg, double cut, double wanted,
                          bool capped) const {
  if (leg.in_axes) return capped ? std::min(wanted, leg.axes_corner.SpeedFor(cut)) : wanted;
  double speed = wanted;
  if (leg.corner.lines() && capped) speed = std::min(speed, leg.corner.PlainSpeed(cut, machine()));
  const Head& head = moves()[leg.last_move].head;
  const bool axes_follow =
      leg.corner.plain() ? axes_keep_up_
                         : leg.corner.lines() && AxesFollow(curves_.back(), head, machine(), speed,
                                                            leg.corner.PlainCurvature(cut));
  if (axes_follow) return speed;
  const CornerCurve curve =
      span.plain ? CornerCurve(PlainCornerAt(leg_stage_, leg.last_move, cut)) : curves_.back();
  return std::min(speed, SpeedOnCurve(curve, head, machine(), speed, leg.corner.lines()));
}

void SpanStage::MakeCurve(Span& span, const Leg& leg, double cut) {
  const Move& in = moves()[leg.last_move];
  span.plain = !leg.in_axes && leg.corner.plain();
  span.may_vary = axes_follow_ramps_;
  if (span.plain) {
    const PathPiece& out = moves()[leg.last_move + 1].path;
    span.curve_length = leg.corner.PlainLength(cut);
    span.curve_middle = in.path.to();
    span.curve_middle.point =
        in.path.to().point + (out.Tangent(0.0) - in.path.Tangent(0.0)) * leg.corner.PlainBow(cut);
    span.report.deviation_mm = leg.corner.PlainDeviation(cut);
    return;
  }
  const CurveAround around = CurveAroundEnd(leg_stage_, leg, cut);
  const CornerCurve& curve = around.curve;
  curves_.Push(curve);
  span.may_vary = axes_follow_ramps_ && around.head_steady;
  if (leg.in_axes) {
    span.may_vary = false;  // whatever it does: the speed is not that of the tip
    span.curve_length = curve.way_s();
    span.curve_middle = curve.At(0.5);
    span.report.deviation_mm = TipDistance(curve, in.head, in.path);
    return;
  }
  if (leg.corner.lines()) {
    // The tip's way is the same whether the head turns or not.
    span.curve_length = leg.corner.PlainLength(cut);
    span.curve_middle = curve.At(0.5);
    span.report.deviation_mm = leg.corner.PlainDeviation(cut);
    return;
  }
  const CornerLength length(curve);
  span.curve_length = length.total();
  span.curve_middle = curve.At(length.ParameterAt(curve, 0.5 * span.curve_length));
  span.report.deviation_mm = curve.DistanceFrom(in.path.to().point);
}

// A bend that cannot be passed at OVERSH x Vb but at `steady` may be faster where it is less tight,
// up to `most`. motion.md 5.4
void SpanStage::ChooseStretches(Span& span, const Leg& leg, double steady, double most) const {
  if (!machine().ramps_across_passages || !span.may_vary) return;
  if (steady >= leg.limit * (1.0 - kSameLimit)) return;
  span.in_stretches = true;
  span.stretches = {.start = steady, .open = steady, .middle = steady};
  if (!span.plain) return;
  const double cut = span.report.cut_mm;
  const BendSpeeds speeds = leg.corner.PlainSpeeds(cut, most, machine());
  if (std::isinf(machine().tip_jerk_mm_s3)) {
    const auto abrupt = AbruptSpeeds(speeds);
    span.stretches = {.count = abrupt.size(),
                      .start = abrupt.front(),
                      .open = most,
                      .middle = abrupt[abrupt.size() / 2]};
    return;
  }
  span.stretches =
      StretchesOf(speeds, 0.5 * span.curve_length, LimitsOnCurve(leg_stage_, leg.last_move, cut));
}

// The knots of a span from its `first` on.
void SpanStage::PushKnots(const Span& span, std::size_t first) {
  if (first == 0) {
    const bool through = span.report.passage == Passage::kThrough;
    speeds_.Push(span.length, span.limits, through ? span.report.wanted_speed : span.cap);
    ++first;
  }
  if (!span.in_stretches) return;
  PathLimits limits = LimitsInStretches(leg_stage_, span);
  const Stretches stretches = StretchesIn(leg_stage_, span);
  for (std::size_t k = first; k < span.knots(); ++k) {
    const Stretch& stretch = stretches[k - 1];
    limits.speed = stretch.most;
    speeds_.Push(stretch.end - (k == 1 ? 0.0 : stretches[k - 2].end), limits, stretch.end_cap);
  }
}

// A chain of steady bends that use up the lines between them has one speed, which its slowest bend
// sets: nothing is decided before its end. Where the window is full, its bends are passed with
// changing speed, where need be a little slower, so that what comes later need not be known.
void SpanStage::LetBendsVary() {
  SeeDecided();
  std::size_t known = speeds_.final_count() - decided_knots_;  // knots of the span
  speeds_.DropOpen();
  for (Number k = decided_; k < spans_.end(); ++k, known = 0) {
    Span& span = spans_[k];
    if (known == 0 && IsBlend(span.report.passage) && !span.in_stretches) {
      if (!span.may_vary) span.cap *= kLeavesRoom;
      span.in_stretches = true;
      span.stretches = {.start = span.cap, .open = span.cap, .middle = span.cap};
    }
    PushKnots(span, known);
  }
}

// Which moves a part of a leg covers, and the places within the first and the last one.
[[gnu::always_inline]] inline void SpanStage::TakeMoves(Span& span, const Leg& leg,
                                                        const LegPart& part) const {
  span.first_move = leg.first_move;
  double x = part.leg_start;
  while (span.first_move < leg.last_move &&
         x + moves()[span.first_move].path.length() <= part.from) {
    x += moves()[span.first_move].path.length();
    ++span.first_move;
  }
  span.x_from = part.from - x;
  span.last_move = span.first_move;
  while (span.last_move < leg.last_move && x + moves()[span.last_move].path.length() < part.to) {
    x += moves()[span.last_move].path.length();
    ++span.last_move;
  }
  const double last_length = moves()[span.last_move].path.length();
  span.x_to = part.to == part.leg_end ? last_length : std::min(part.to - x, last_length);
}

// The legs from the start of the run to `last_leg`, less what the curves at both ends take, become
// spans.
void SpanStage::CloseRun(Number last_leg, double total, const Span& closing, double speed_cap) {
  const Ring<Leg>& legs = leg_stage_.legs();
  const double begin = run_cut_;
  const double end = std::max(total - closing.report.cut_mm, begin);
  double leg_start = 0.0;
  for (Number k = legs.first(); k <= last_leg; ++k) {
    const Leg& leg = legs[k];
    const double leg_end = k == last_leg ? total : leg_start + leg.length;
    const double from = std::max(leg_start, begin);
    const double to = std::min(leg_end, end);
    const bool closes = k == last_leg || leg_end >= end;
    const double start = leg_start;
    leg_start = leg_end;
    if (!closes && !(to > from)) {  // swallowed by the curve before
      continue;
    }
    Span& span = spans_.PushSlot();
    if (closes) {
      span = closing;
      span.corner_move = legs[last_leg].last_move;
      double swallowed = HUGE_VAL;
      for (Number rest = k; rest < last_leg; ++rest)
        swallowed = std::min(swallowed, legs[rest].cap);
      BendStretches& most = span.stretches;
      speed_cap = std::min(speed_cap, swallowed);
      most.start = std::min(most.start, swallowed);
      most.open = std::min(most.open, swallowed);
      most.middle = std::min(most.middle, swallowed);
    } else {
      span.corner_move = leg.last_move;
      span.settling_s = 0.0;
      span.in_stretches = false;
      span.report = {.passage = Passage::kThrough, .wanted_speed = leg.cap};
    }
    span.length = std::max(to - from, 0.0);
    TakeMoves(span, leg, {.leg_start = start, .leg_end = leg_end, .from = from, .to = to});
    span.limits = moves()[leg.first_move].limits;
    const double cap = closes ? speed_cap : leg.cap;
    // Straight on the shape of the path does not hang on what level 1 reaches.
    span.cap = span.report.passage == Passage::kThrough ? legs[closes ? last_leg : k].limit : cap;
    PushKnots(span, 0);
    if (closes) break;
  }
}

void SpanStage::AcceptHalf() {
  LetBendsVary();
  speeds_.Settle();
  speeds_.Accept(speeds_.size() / 2);
}

std::string SpanStage::Dump() const {
  std::string out;
  std::size_t knot = 0;
  for (Number k = spans_.first(); k < spans_.end(); ++k) {
    const Span& span = spans_[k];
    out += "span " + std::to_string(k) + ": moves " + std::to_string(span.first_move) + " from " +
           FixedText(span.x_from, 3) + " to " + std::to_string(span.last_move) + " at " +
           FixedText(span.x_to, 3) + ", length " + FixedText(span.length, 3) + ", " +
           std::string(NameOf(span.report.passage)) + " at most " + FixedText(span.cap, 3);
    if (IsBlend(span.report.passage)) {
      out += ", cut " + FixedText(span.report.cut_mm, 3) + ", curve " +
             FixedText(span.curve_length, 3);
      if (span.in_stretches) out += " in " + std::to_string(span.curve_knots()) + " stretches";
    }
    out += knot + span.knots() <= speeds_.final_count()
               ? ", passed at " + FixedText(speeds_.speed(knot), 3)
               : std::string(", open");
    knot += span.knots();
    out += '\n';
  }
  return out;
}

}  // namespace rmlcell::motion
