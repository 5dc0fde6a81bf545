#include "engine/motion/motion_chain.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::motion {
namespace {

constexpr std::size_t kBatchMin = 32;    // knots before a backward pass is worth its while
constexpr std::size_t kMillLegMax = 16;  // moves: most of what one leg of all would save
constexpr double kCutMin_mm = 1e-4;      // a smaller curve is a stop, motion.md 4.4
constexpr double kEqualLimits = 1e-9;    // relative
constexpr double kContiguous_mm = 1e-6;

// A bend that takes all that the axes have takes nine tenths of it at this share of its speed.
constexpr double kLeavesRoom = 0.95;

bool Equal(double a, double b) { return a == b || std::abs(a - b) <= kEqualLimits * std::abs(b); }
bool Equal(const PathLimits& a, const PathLimits& b) {
  return Equal(a.speed, b.speed) && Equal(a.acceleration, b.acceleration) && Equal(a.jerk, b.jerk);
}

bool Contiguous(const TipPose& a, const TipPose& b) {
  return a.a_rad == b.a_rad && a.b_rad == b.b_rad &&
         (a.tip == b.tip || Distance(a.tip, b.tip) <= kContiguous_mm);
}

bool AxesKeepUp(const MachineLimits& machine) {
  bool enough = true;
  for (std::size_t i = 0; i < 3; ++i) {
    enough = enough && machine.axes.speed[i] >= machine.tip_speed_mm_s &&
             machine.axes.acceleration[i] >= machine.normal_acceleration();
  }
  return enough;
}

// The tip's acceleration is at most that of the machine, whatever its speed does on a curve.
bool AxesFollowRamps(const MachineLimits& machine) {
  bool enough = AxesKeepUp(machine);
  for (std::size_t i = 0; i < 3; ++i) {
    enough = enough && machine.axes.acceleration[i] >= machine.tip_acceleration_mm_s2 &&
             machine.axes.jerk[i] >= machine.tip_jerk_mm_s3;
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

void MotionChain::Append(const MoveCommand& move, const PathLimits& limits) {
  const bool merged = open_ && !Join(move, limits);
  const Number number = moves_.end();
  Move& slot = moves_.PushSlot();
  slot.path = move.path;
  slot.head = move.head;
  slot.limits = limits;
  // What is no number makes no passage.
  slot.overshoot = move.overshoot_fraction > 0.0 ? std::min(move.overshoot_fraction, 1.0) : 0.0;
  slot.passage_speed = move.passage_speed_mm_s;
  slot.settling_s = move.settles ? machine_.settling_s : 0.0;
  slot.tag = move.tag;
  slot.fly = move.fly;
  slot.would_blend = false;
  end_ = move.path.to();
  end_known_ = true;
  open_ = true;
  if (merged) {
    legs_.back().last_move = number;
    legs_.back().length += move.path.length();
  } else {
    Leg& leg = legs_.PushSlot();  // CloseLeg sets the rest
    leg.first_move = leg.last_move = number;
    leg.length = move.path.length();
  }
  if (!move.fly) {
    CloseLeg(Passage::kStop, false, 0.0);
    open_ = false;
  }
  if (!merged || !open_ || number % kBatchMin == 0) Work();
}

// Decides how the last move passes into this one. False when both are one leg.
bool MotionChain::Join(const MoveCommand& move, const PathLimits& limits) {
  const Move& before = moves_.back();
  Leg& leg = legs_.back();
  Passage passage = Passage::kStop;
  double cap = 0.0;
  const bool mill = machine_.junction_jump_mm_s > 0.0;
  // A curve must not reach over it, although without a limit on jerk it is passed.
  bool bends = false;
  if (before.overshoot <= 0.0 || stands_) {
    passage = Passage::kStopNoSpeed;
  } else if (before.path.by_sigma() || move.path.by_sigma()) {
    passage = Passage::kStopNeighbour;
    // The machine would blend these in axis space (motion.md 4.5), which is not planned.
    using Kind = PathPiece::Kind;
    moves_.back().would_blend =
        before.path.kind() == Kind::kJoint && move.path.kind() == Kind::kJoint;
  } else if (before.head == move.head && Contiguous(before.path.to(), move.path.from())) {
    cap = before.overshoot * std::min(before.limits.speed, limits.speed);
    if (mill) {
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
  const bool alike = Equal(before.limits, limits) && Equal(cap, limits.speed);
  if (passage == Passage::kThrough && !bends && alike) {
    // A line without end must not fill the window as one leg. Of a mill it need not even wait:
    // without a limit on jerk a leg may be cut anywhere.
    if (leg.last_move - leg.first_move < (mill ? kMillLegMax : window_ / 2)) return false;
    if (!mill) ++starved_;
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

void MotionChain::BeginMoving(double speed) {
  running_.BeginAt(speed);
  speeds_.BeginAt(speed);
  last_speed_ = speed;
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
  if (2 * speeds_.Settle() < speeds_.size()) speeds_.Accept(speeds_.size() / 2);
}

void MotionChain::SeeDecided() {
  while (decided_ < spans_.end() &&
         decided_knots_ + spans_[decided_].knots() <= speeds_.final_count()) {
    decided_knots_ += spans_[decided_++].knots();
  }
}

// A chain of steady bends that use up the lines between them has one speed, which its slowest bend
// sets: nothing is decided before its end. Where the window is full, its bends are passed with
// changing speed, where need be a little slower, so that what comes later need not be known.
void MotionChain::LetBendsVary() {
  SeeDecided();
  std::size_t known = speeds_.final_count() - decided_knots_;  // knots of the span
  speeds_.DropOpen();
  for (Number k = decided_; k < spans_.end(); ++k, known = 0) {
    Span& span = spans_[k];
    if (known == 0 && IsBlend(span.report.passage) && !span.in_stretches) {
      if (!span.head_steady || !axes_follow_ramps_) span.cap *= kLeavesRoom;
      span.in_stretches = true;
      span.stretches = {.start = span.cap, .open = span.cap, .middle = span.cap};
    }
    PushKnots(span, known);
  }
}

// The length of the run that begins behind `leg`, or at least `enough` of it; nothing when that is
// not known yet.
std::optional<double> MotionChain::LengthAfter(Number leg, double enough,
                                               bool accept_what_is_there) {
  double length = 0.0;
  for (Number k = leg + 1; k < legs_.end(); ++k) {
    length += legs_[k].length;
    if (length >= enough) return length;
    const bool closed = k + 1 < legs_.end() || !open_;
    if (closed && legs_[k].ends_run) return length;
  }
  if (accept_what_is_there) return length;
  return std::nullopt;
}

// Points passed straight on that the curve of `cut` at the end of `leg` swallows keep their speed:
// the least of them; nothing when they are not known yet.
std::optional<double> MotionChain::SpeedWithin(Number leg, double cut, bool accept_what_is_there) {
  double least = HUGE_VAL;
  double beyond = 0.0;
  for (Number k = leg + 1; k < legs_.end() && beyond + legs_[k].length < cut; ++k) {
    beyond += legs_[k].length;
    const auto index = static_cast<std::size_t>(k - leg);
    const bool known = index < running_.final_count();
    if (!known && !accept_what_is_there) return std::nullopt;
    least = std::min(least, known ? running_.speed(index) : legs_[k].cap);
  }
  return least;
}

bool MotionChain::Resolve(bool accept_what_is_there) {
  if (running_.final_count() == 0) return false;
  const Number number = resolving_;
  Leg& leg = legs_[number];
  const double wanted = running_.speed();
  const double total = run_length_ + leg.length;
  // Nor may a run fill the window; but it holds what the curve before it takes. The run of a mill has
  // no curve at its end to wait for.
  const bool mill = machine_.junction_jump_mm_s > 0.0;
  const std::size_t longest = mill ? kBatchMin : window_ / 2;
  if (!leg.ends_run && number - legs_.first() >= longest && total >= run_cut_) {
    leg.ends_run = true;
    if (!mill) ++starved_;
  }
  if (!leg.ends_run) {
    leg.cap = std::min(leg.cap, wanted);
    run_length_ = total;
    ++resolving_;
    running_.Pop();
    return true;
  }

  Span closing;
  closing.report.passage = leg.passage;
  closing.report.wanted_speed = wanted;
  double cut = 0.0;
  double speed_cap = 0.0;
  if (leg.passage == Passage::kThrough) {
    speed_cap = wanted;
  } else if (!IsStop(leg.passage)) {
    const double uncapped = leg.corner.CutFor(wanted, machine_);
    const double want = std::min(uncapped, leg.corner.cut_max_mm());
    const std::optional<double> after = LengthAfter(number, 2.0 * want, accept_what_is_there);
    if (!after) return false;
    cut = std::min({want, 0.5 * total, 0.5 * *after});
    const bool capped = cut < uncapped;
    double swallowed = HUGE_VAL;  // the speed of what the curve takes whole
    if (cut < kCutMin_mm) {
      cut = 0.0;
      closing.report.passage = Passage::kStopShort;
    } else {
      if (legs_[number + 1].length < cut) {
        const auto within = SpeedWithin(number, cut, accept_what_is_there);
        if (!within) return false;
        swallowed = *within;
      }
      closing.report.passage = capped ? Passage::kBlendCapped : Passage::kBlend;
      closing.report.cut_mm = cut;
      speed_cap = wanted;
      MakeCurve(closing, leg, cut);
    }
    if (cut > 0.0 && !leg.corner.lines() && curves_.back().HasCusp(cut)) {
      curves_.PopBack();
      cut = speed_cap = 0.0;
      closing.curve_length = closing.report.deviation_mm = 0.0;
      closing.report.passage = Passage::kStopReversal;
    }
    if (cut > 0.0) {
      const Head& head = moves_[leg.last_move].head;
      if (leg.corner.lines() && capped) {
        speed_cap = std::min(speed_cap, leg.corner.PlainSpeed(cut, machine_));
      }
      const bool axes_follow =
          leg.corner.plain()
              ? axes_keep_up_
              : leg.corner.lines() && AxesFollow(curves_.back(), head, machine_, speed_cap,
                                                 leg.corner.PlainCurvature(cut));
      if (!axes_follow) {
        const CornerCurve curve =
            closing.plain ? CornerCurve(PlainCornerAt(leg.last_move, cut)) : curves_.back();
        speed_cap = std::min(speed_cap, SpeedOnCurve(curve, head, machine_, speed_cap));
      }
      if (speed_cap < wanted) closing.report.passage = Passage::kBlendCapped;
      speed_cap = std::min(speed_cap, swallowed);
      ChooseStretches(closing, leg, speed_cap, std::min(leg.limit, swallowed));
      if (closing.in_stretches) speed_cap = closing.stretches.start;
    }
  }
  closing.report.cut_mm = cut;
  if (closing.report.passage == Passage::kStop)
    closing.settling_s = moves_[leg.last_move].settling_s;
  running_.Pop();
  CloseRun(number, total, closing, speed_cap);
  run_length_ = 0.0;
  run_cut_ = cut;
  ++resolving_;
  while (legs_.first() < resolving_) legs_.PopFront();
  return true;
}

PlainCorner MotionChain::PlainCornerAt(Number corner_move, double cut) {
  const PathPiece& in = moves_[corner_move].path;
  return {in.to(), in.Tangent(0.0), moves_[corner_move + 1].path.Tangent(0.0), cut};
}

void MotionChain::MakeCurve(Span& span, const Leg& leg, double cut) {
  span.plain = leg.corner.plain();
  if (span.plain) {
    const PathPiece& in = moves_[leg.last_move].path;
    const PathPiece& out = moves_[leg.last_move + 1].path;
    span.curve_length = leg.corner.PlainLength(cut);
    span.curve_middle = in.to();
    span.curve_middle.tip =
        in.to().tip + (out.Tangent(0.0) - in.Tangent(0.0)) * leg.corner.PlainBow(cut);
    span.report.deviation_mm = leg.corner.PlainDeviation(cut);
    return;
  }
  // The place at the distance `cut` before the corner, and behind it; both may lie some moves away.
  Number before = leg.last_move;
  double left = cut;
  while (left > moves_[before].path.length() && before > moves_.first()) {
    left -= moves_[before].path.length();
    --before;
  }
  const PathPiece& in = moves_[before].path;
  Number after = leg.last_move + 1;
  double right = cut;
  while (right > moves_[after].path.length() && after + 1 < moves_.end()) {
    right -= moves_[after].path.length();
    ++after;
  }
  const PathPiece& out = moves_[after].path;
  span.head_steady =
      in.a_rate() == 0.0 && in.b_rate() == 0.0 && out.a_rate() == 0.0 && out.b_rate() == 0.0;
  const CornerCurve curve(EndAt(in, std::max(in.length() - left, 0.0)),
                          EndAt(out, std::min(right, out.length())), cut);
  curves_.Push(curve);
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
  span.report.deviation_mm = curve.DistanceFrom(moves_[leg.last_move].path.to().tip);
}

// A bend that cannot be passed at OVERSH x Vb but at `steady` may be faster where it is less tight,
// up to `most`. motion.md 5.4
void MotionChain::ChooseStretches(Span& span, const Leg& leg, double steady, double most) {
  if (!machine_.ramps_across_passages || std::isinf(machine_.tip_jerk_mm_s3)) return;
  if (!axes_follow_ramps_ || !span.head_steady) return;
  if (steady >= leg.limit * (1.0 - kEqualLimits)) return;
  span.in_stretches = true;
  span.stretches = {.start = steady, .open = steady, .middle = steady};
  if (!span.plain) return;
  const double cut = span.report.cut_mm;
  span.stretches = StretchesOf(leg.corner.PlainSpeeds(cut, most, machine_), 0.5 * span.curve_length,
                               LimitsOnCurve(leg.last_move, cut));
}

// Those of every move that a curve touches.
PathLimits MotionChain::LimitsOnCurve(Number corner_move, double cut) {
  PathLimits limits = moves_[corner_move].limits;
  const auto lower = [&](const Move& move) {
    limits.acceleration = std::min(limits.acceleration, move.limits.acceleration);
    limits.jerk = std::min(limits.jerk, move.limits.jerk);
    return move.path.length();
  };
  limits.acceleration =
      std::min(limits.acceleration, machine_.curve_tangential * machine_.tip_acceleration_mm_s2);
  double left = cut;
  for (Number k = corner_move; left > 0.0; --k) {
    left -= lower(moves_[k]);
    if (k == moves_.first()) break;
  }
  left = cut;
  for (Number k = corner_move + 1; left > 0.0 && k < moves_.end(); ++k) left -= lower(moves_[k]);
  return limits;
}

PathLimits MotionChain::LimitsInStretches(const Span& span) {
  PathLimits limits = LimitsOnCurve(span.corner_move, span.report.cut_mm);
  limits.speed = span.stretches.open;
  if (span.head_steady && axes_follow_ramps_) return limits;
  // No axis moves by more than its speed over that of the tip for a mm of the way.
  const double whole = limits.speed / kLeavesRoom;
  for (std::size_t i = 0; i < kAxisCount; ++i) {
    const double per_axis = whole / machine_.axes.speed[i];
    limits.acceleration =
        std::min(limits.acceleration,
                 (1.0 - kLeavesRoom * kLeavesRoom) * machine_.axes.acceleration[i] * per_axis);
    if (std::isfinite(limits.jerk)) {
      limits.jerk = std::min(limits.jerk, machine_.axes.jerk[i] * per_axis);
    }
  }
  return limits;
}

MotionChain::Stretch MotionChain::StretchOf(const Span& span, std::size_t index) {
  const BendStretches& most = span.stretches;
  if (index + 1 == most.count) return {span.curve_length, most.start};
  return {0.5 * span.curve_length, most.middle};
}

// The knots of a span from its `first` on.
void MotionChain::PushKnots(const Span& span, std::size_t first) {
  if (first == 0) {
    const bool through = span.report.passage == Passage::kThrough;
    speeds_.Push(span.length, span.limits, through ? span.report.wanted_speed : span.cap);
    ++first;
  }
  if (!span.in_stretches) return;
  const PathLimits limits = LimitsInStretches(span);
  for (std::size_t k = first; k < span.knots(); ++k) {
    const Stretch stretch = StretchOf(span, k - 1);
    const double begin = k == 1 ? 0.0 : StretchOf(span, k - 2).end;
    speeds_.Push(stretch.end - begin, limits, stretch.end_cap);
  }
}

// The legs from the start of the run to `last_leg`, less what the curves at both ends take, become
// spans.
void MotionChain::CloseRun(Number last_leg, double total, const Span& closing, double speed_cap) {
  const double begin = run_cut_;
  const double end = std::max(total - closing.report.cut_mm, begin);
  double leg_start = 0.0;
  for (Number k = legs_.first(); k <= last_leg; ++k) {
    Leg& leg = legs_[k];
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
      span.corner_move = legs_[last_leg].last_move;
      double swallowed = HUGE_VAL;
      for (Number rest = k; rest < last_leg; ++rest)
        swallowed = std::min(swallowed, legs_[rest].cap);
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
    // Which moves the interval covers; places within the first and the last one.
    span.first_move = leg.first_move;
    double x = start;
    while (span.first_move < leg.last_move && x + moves_[span.first_move].path.length() <= from) {
      x += moves_[span.first_move].path.length();
      ++span.first_move;
    }
    span.x_from = from - x;
    span.last_move = span.first_move;
    while (span.last_move < leg.last_move && x + moves_[span.last_move].path.length() < to) {
      x += moves_[span.last_move].path.length();
      ++span.last_move;
    }
    const double last_length = moves_[span.last_move].path.length();
    span.x_to = to == leg_end ? last_length : std::min(to - x, last_length);
    span.limits = moves_[leg.first_move].limits;
    const double cap = closes ? speed_cap : leg.cap;
    // Straight on the shape of the path does not hang on what level 1 reaches.
    span.cap = span.report.passage == Passage::kThrough ? legs_[closes ? last_leg : k].limit : cap;
    PushKnots(span, 0);
    if (closes) break;
  }
}

}  // namespace rmlcell::motion
