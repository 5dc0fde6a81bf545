// The last stage of the chain: spans with their final speeds become motions and marks.
#include <algorithm>

#include "engine/motion/motion_chain.h"

namespace rmlcell::motion {

std::optional<PlannedItem> MotionChain::Next() {
  while (items_.empty()) {
    if (speeds_.final_count() == 0) return std::nullopt;
    EmitSpan();
  }
  PlannedItem item = std::move(items_.front());
  items_.PopFront();
  return item;
}

void MotionChain::EmitSpan() {
  Span& span = spans_.front();
  const double speed = speeds_.speed();
  span.report.speed = speed;
  const bool blend = IsBlend(span.report.passage);
  if (span.length > 0.0) {
    const SpeedProfile profile = SpeedProfile::Span(span.length, last_speed_, speed, span.limits);
    double done = 0.0;
    for (Number k = span.first_move; k <= span.last_move; ++k) {
      const PathPiece& path = moves_[k].path;
      const double from = k == span.first_move ? span.x_from : 0.0;
      const double to = k == span.last_move ? span.x_to : path.length();
      if (!(to > from)) continue;
      PlannedMotion& motion = NewMotion(span, k);
      if (from == 0.0 && to == path.length()) {
        motion.path = path;
      } else {
        motion.path = path.Part(from, to);
      }
      if (span.first_move == span.last_move) {
        motion.speed = profile;
      } else {
        motion.speed = profile.Part(done, k == span.last_move ? span.length : done + (to - from));
      }
      done += to - from;
      const bool reaches_end = to == path.length() && !(blend && k == span.corner_move);
      FinishMotion(span, k, motion, reaches_end);
    }
  }
  if (blend) EmitCurve(span);
  last_speed_ = speed;
  spans_.PopFront();
  speeds_.Pop();
}

// The curve is cut where its middle is, and where points that it swallows are: they lie on its
// halves as they would lie on the straight pieces.
void MotionChain::EmitCurve(const Span& span) {
  const double half = 0.5 * span.curve_length;
  const double cut = span.report.cut_mm;
  const PathPiece::Halves halves =
      PathPiece::CornerHalves(span.curve, span.curve_length, span.curve_middle);
  // First half: from the end of the span to the corner.
  double x = moves_[span.last_move].path.length() - span.x_to;  // way to the end of the move
  if (x <= 0.0 && span.last_move < span.corner_move) x = 0.0;
  double s = 0.0;
  for (Number k = span.last_move; k <= span.corner_move; ++k) {
    if (k > span.last_move) x += moves_[k].path.length();
    const double to = k == span.corner_move ? half : std::min(half * x / cut, half);
    if (to > s) EmitCurvePart(span, halves.first, k, s, to, true);
    s = std::max(s, to);
  }
  // Second half: to the place where the next span begins.
  x = 0.0;
  s = 0.0;
  for (Number k = span.corner_move + 1;; ++k) {
    x += moves_[k].path.length();
    const bool last = x >= cut || k + 1 == moves_.end();
    const double to = last ? half : std::min(half * x / cut, half);
    if (to > s) EmitCurvePart(span, halves.second, k, s, to, !last);
    s = std::max(s, to);
    if (last) break;
  }
}

void MotionChain::EmitCurvePart(const Span& span, const PathPiece& piece, Number move,
                                double s_from, double s_to, bool ends_move) {
  PlannedMotion& motion = NewMotion(span, move);
  if (s_from == 0.0 && s_to == piece.length()) {
    motion.path = piece;
  } else {
    motion.path = piece.Part(s_from, s_to);
  }
  motion.speed = SpeedProfile::Steady(s_to - s_from, span.report.speed);
  motion.limits.speed = span.report.speed;
  motion.limits.acceleration = std::min(
      motion.limits.acceleration, machine_.curve_tangential * machine_.tip_acceleration_mm_s2);
  FinishMotion(span, move, motion, ends_move);
}

// Motions are made where they wait to be taken: they are large. The slot holds an old one, so every
// member is set here or by the caller (path, speed).
PlannedMotion& MotionChain::NewMotion(const Span& span, Number move) {
  PlannedItem& slot = items_.PushSlot();
  auto* motion = std::get_if<PlannedMotion>(&slot);
  if (motion == nullptr) motion = &slot.emplace<PlannedMotion>();
  const Move& source = moves_[move];
  motion->tag = source.tag;
  motion->head = source.head;
  motion->limits = span.limits;
  motion->settling_s = 0.0;
  motion->upper_bound = false;
  motion->corner = {};
  return *motion;
}

void MotionChain::FinishMotion(const Span& span, Number move, PlannedMotion& motion,
                               bool ends_move) {
  motion.ends_move = ends_move;
  if (!ends_move) return;
  if (move == span.corner_move) {
    motion.corner = span.report;
    motion.settling_s = span.settling_s;
  } else {
    motion.corner.passage = Passage::kThrough;
    motion.corner.speed = motion.speed.end().speed;
  }
  while (!marks_.empty() && marks_.front().after_move <= move) {
    items_.Push(PlannedMark{marks_.front().tag});
    marks_.PopFront();
  }
  while (moves_.first() < move) moves_.PopFront();
  if (move == span.corner_move && moves_.end() == move + 1 && !open_) moves_.PopFront();
}

}  // namespace rmlcell::motion
