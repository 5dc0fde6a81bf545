// The last stage of the chain: spans with their final speeds become motions and marks.
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/motion/motion_chain.h"

namespace rmlcell::motion {
namespace {

// Spans timed together: each gives at most two cells.
constexpr std::size_t kSectionMax = RampPlan::kCellsMax / 2;

}  // namespace

const PlannedItem* MotionChain::Next() {
  while (items_.empty()) {
    if (section_left_ == 0) {
      section_left_ = SectionSize();
      if (section_left_ == 0) return nullptr;
      PlanSection();
    }
    items_.Rewind();
    EmitMove();
  }
  const PlannedItem* item = &items_.front();  // nothing is written there before the next call
  items_.PopFront();
  return item;
}

// How many spans are timed together next; 0 when that is not known yet.
std::size_t MotionChain::SectionSize() {
  const std::size_t known = speeds_.final_count();
  while (section_seen_ < known) {
    const std::size_t index = section_seen_++;
    const Number moves = spans_[spans_.first() + index].last_move - spans_.front().first_move;
    if (EndsSection(index) || section_seen_ == kSectionMax || moves >= window_ / 2) {
      return std::exchange(section_seen_, 0);
    }
  }
  return 0;
}

// A knot that is passed as fast as it may be: the speed has no slope there in any good plan.
bool MotionChain::EndsSection(std::size_t index) {
  if (!machine_.ramps_across_passages || std::isinf(machine_.tip_jerk_mm_s3)) return true;
  constexpr double kReaches = 1.0 - 1e-12;
  const Span& span = spans_[spans_.first() + index];
  if (speeds_.speed(index) >= span.cap * kReaches) return true;
  return IsBlend(span.report.passage) && !(span.curve_may_vary && axes_follow_ramps_);
}

// Times the spans of the section that begins with the oldest one.
void MotionChain::PlanSection() {
  // Only a chain that begins moving can be too fast: the passes see to the rest.
  constexpr double kRoom = 1.0 + 1e-9;
  const Span& first = spans_.front();
  if (last_speed_ > speeds_.speed() * kRoom &&
      RampLength(last_speed_, speeds_.speed(), first.limits) > first.length * kRoom) {
    starts_too_fast_ = true;
  }
  section_cell_ = 0;
  place_ = {};
  place_ramp_ = 0;
  alone_ = section_left_ == 1;
  if (alone_) {
    if (first.length > 0.0) {
      lone_ = SpeedProfile::Span(first.length, last_speed_, speeds_.speed(), first.limits);
    }
    return;
  }
  // What lies between the knots at both ends, each with the speed of level 1 at its end. The curve
  // behind the last knot is passed steadily.
  cells_.clear();
  for (std::size_t k = 0; k < section_left_; ++k) {
    const Span& span = spans_[spans_.first() + k];
    const double speed = speeds_.speed(k);
    const bool blend = IsBlend(span.report.passage);
    if (span.length > 0.0) {
      cells_.push_back({span.length, span.limits, speed, blend ? RampCell::kNoCap : span.cap});
    }
    if (k + 1 == section_left_ || !blend) continue;
    cells_.push_back(
        {span.curve_length, LimitsOnCurve(span, spans_[spans_.first() + k + 1].first_move), speed});
  }
  if (!cells_.empty()) ramps_.Plan(cells_, last_speed_);
}

// Those of every move that the curve behind `span` touches, to the one where the next span begins.
PathLimits MotionChain::LimitsOnCurve(const Span& span, Number last_move) {
  PathLimits limits{.speed = span.cap,
                    .acceleration = machine_.curve_tangential * machine_.tip_acceleration_mm_s2,
                    .jerk = span.limits.jerk};
  for (Number k = span.last_move; k <= last_move; ++k) {
    limits.acceleration = std::min(limits.acceleration, moves_[k].limits.acceleration);
    limits.jerk = std::min(limits.jerk, moves_[k].limits.jerk);
  }
  return limits;
}

// The ramp that passes the present cell, a span of `length` or the curve behind it.
MotionChain::Timing MotionChain::PresentTiming(double length) {
  if (alone_) return {&lone_, 0.0, length};
  const RampPlan::Timing& timing = ramps_.timing()[section_cell_];
  if (timing.ramp != place_ramp_) {
    place_ramp_ = timing.ramp;
    place_ = {};
  }
  return {&ramps_.ramps()[timing.ramp], timing.from, timing.to};
}

// The part of the timing to `to` on its cell, or to the end of that, from where the last part
// ended.
void MotionChain::TakePart(SpeedProfile& speed, const Timing& timing, double to, bool to_end) {
  const double end = to_end ? timing.to : std::min(timing.from + to, timing.to);
  if (place_.s == 0.0 && end == timing.profile->end().s) {
    speed = *timing.profile;
    return;
  }
  if (place_.s < timing.from) timing.profile->Advance(place_, timing.from);
  timing.profile->PartTo(place_, end, speed);
}

// Motions are made where they wait to be taken: they are large. The slot holds an old one, so every
// member is set here or by the caller (path, speed).
inline PlannedMotion& MotionChain::NewMotion(const Span& span, const Move& source) {
  PlannedItem& slot = items_.PushSlot();
  auto* motion = std::get_if<PlannedMotion>(&slot);
  if (motion == nullptr) motion = &slot.emplace<PlannedMotion>();
  motion->tag = source.tag;
  motion->head = source.head;
  motion->limits = span.limits;
  motion->settling_s = 0.0;
  motion->upper_bound = false;
  return *motion;
}

inline void MotionChain::FinishMotion(const Span& span, Number move, PlannedMotion& motion,
                                      bool ends_move) {
  motion.ends_move = ends_move;
  if (ends_move) {
    EndMove(span, move, motion);
  } else {
    motion.corner = {};
  }
}

// What is left of the next move between the curves at its ends, and the curve behind it when the
// span ends there.
void MotionChain::EmitMove() {
  Span& span = spans_.front();
  const bool blend = IsBlend(span.report.passage);
  if (span.length > 0.0) {
    if (!emitting_) {
      emitting_ = true;
      emit_move_ = span.first_move;
      emit_done_ = 0.0;
    }
    const Timing timing = PresentTiming(span.length);
    for (bool emitted = false; !emitted && emit_move_ <= span.last_move; ++emit_move_) {
      const Move& move = moves_[emit_move_];
      const PathPiece& path = move.path;
      const bool last = emit_move_ == span.last_move;
      const double from = emit_move_ == span.first_move ? span.x_from : 0.0;
      const double to = last ? span.x_to : path.length();
      if (!(to > from)) continue;
      PlannedMotion& motion = NewMotion(span, move);
      if (from == 0.0 && to == path.length()) {
        motion.path = path;
      } else {
        motion.path.AssignPart(path, from, to);
      }
      emit_done_ += to - from;
      TakePart(motion.speed, timing, emit_done_, last);
      const bool reaches_end = to == path.length() && !(blend && emit_move_ == span.corner_move);
      FinishMotion(span, emit_move_, motion, reaches_end);
      emitted = true;
    }
    if (emit_move_ <= span.last_move) return;
    emitting_ = false;
    ++section_cell_;
  }
  const double speed = speeds_.speed();
  span.report.speed = speed;
  if (blend) EmitCurve(span);
  last_speed_ = speed;
  spans_.PopFront();
  speeds_.Pop();
  --section_left_;
}

void MotionChain::EmitCurve(Span& span) {
  const double half = 0.5 * span.curve_length;
  Timing timing;  // steady
  if (section_left_ > 1) {
    timing = PresentTiming(span.curve_length);
    const double middle = timing.from + half;
    span.report.speed = timing.profile->At(timing.profile->TimeAt(middle)).speed;
  }
  const TipPose& middle = span.curve_middle;
  if (span.plain) {
    const PlainCorner corner = PlainCornerAt(span.corner_move, span.report.cut_mm);
    const TipPose start = corner.Start(), finish = corner.Finish();
    EmitHalves(span, corner, {start, middle, half, 0.0}, {middle, finish, half, half}, timing);
  } else {
    const CornerCurve& curve = curves_.front();
    const TipPose start = curve.At(0.0), finish = curve.At(1.0);
    EmitHalves(span, curve, {start, middle, half, 0.0}, {middle, finish, half, half}, timing);
    curves_.PopFront();
  }
  if (section_left_ > 1) ++section_cell_;
}

// The curve is cut where its middle is, and where points that it swallows are: they lie on its
// halves as they would lie on the straight pieces.
template <class Shape>
void MotionChain::EmitHalves(const Span& span, const Shape& shape, const Half& first,
                             const Half& second, const Timing& timing) {
  const double cut = span.report.cut_mm;
  const double half = first.length;
  // First half: from the end of the span to the corner.
  double x = 0.0;  // way from the start of the curve to the end of the move
  double s = 0.0;
  for (Number k = span.last_move; k <= span.corner_move; ++k) {
    double to = half;
    if (k < span.corner_move) {
      x += moves_[k].path.length() - (k == span.last_move ? span.x_to : 0.0);
      to = std::min(half * std::max(x, 0.0) / cut, half);
    }
    if (!(to > s)) continue;
    EmitCurvePart(span, k, shape, first, {s, to, true}, timing);
    s = to;
  }
  // Second half: to the place where the next span begins.
  x = 0.0;
  s = 0.0;
  for (Number k = span.corner_move + 1;; ++k) {
    x += moves_[k].path.length();
    const bool last = x >= cut || k + 1 == moves_.end();
    const double to = last ? half : std::min(half * x / cut, half);
    if (to > s) EmitCurvePart(span, k, shape, second, {s, to, !last}, timing);
    s = std::max(s, to);
    if (last) break;
  }
}

template <class Shape>
void MotionChain::EmitCurvePart(const Span& span, Number move, const Shape& shape, const Half& half,
                                const HalfPart& part, const Timing& timing) {
  PlannedMotion& motion = NewMotion(span, moves_[move]);
  motion.path.AssignCorner(shape, half.begin, half.length, half.from, half.to);
  if (part.s_from != 0.0 || part.s_to != half.length) {
    motion.path = motion.path.Part(part.s_from, part.s_to);
  }
  if (timing.profile == nullptr) {
    motion.speed = SpeedProfile::Steady(part.s_to - part.s_from, span.report.speed);
    // A STOP on the way brakes as the move does that this part belongs to.
    motion.limits = moves_[move].limits;
    motion.limits.acceleration = std::min(
        motion.limits.acceleration, machine_.curve_tangential * machine_.tip_acceleration_mm_s2);
    motion.limits.speed = span.report.speed;
  } else {
    const double to = half.begin + part.s_to;
    TakePart(motion.speed, timing, to, to >= span.curve_length);
    motion.limits = cells_[section_cell_].limits;  // the ramp runs through both halves
  }
  FinishMotion(span, move, motion, part.ends_move);
}

void MotionChain::EndMove(const Span& span, Number move, PlannedMotion& motion) {
  if (move == span.corner_move) {
    motion.corner = span.report;
    if (!IsBlend(span.report.passage)) motion.corner.speed = motion.speed.end().speed;
    motion.settling_s = span.settling_s;
    motion.upper_bound = moves_[move].would_blend;
  } else {
    motion.corner = {.passage = Passage::kThrough, .speed = motion.speed.end().speed};
  }
  while (!marks_.empty() && marks_.front().after_move <= move) {
    items_.Push(PlannedMark{marks_.front().tag});
    marks_.PopFront();
  }
  while (moves_.first() < move) moves_.PopFront();
  if (move == span.corner_move && moves_.end() == move + 1 && !open_) moves_.PopFront();
}

}  // namespace rmlcell::motion
