#include "engine/motion/planner/item_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"

namespace rmlcell::motion {
namespace {

// Spans timed together: each gives at most three cells, itself and two stretches of a bend.
constexpr std::size_t kSectionMax = RampPlan::kCellsMax / 3;

// A bend that takes half of what follows ends at a point in the middle of that: the way to it and
// the bend's are sums of the same lengths in another order.
constexpr double kSamePlace_mm = 1e-10;

// To make cells of a span, and to give it out.
constexpr int kMaking = 2;
constexpr int kEmitting = 3;

}  // namespace

ItemStage::Ramps& ItemStage::Ramps::operator=(const Ramps& other) {
  if (this == &other) return *this;
  cells = other.cells;
  most.reserve(other.most.capacity());
  most = other.most;
  for (RampCell& cell : cells) {
    if (cell.most.empty()) continue;
    const std::ptrdiff_t begin = cell.most.data() - other.most.data();
    cell.most = std::span(most).subspan(static_cast<std::size_t>(begin), cell.most.size());
  }
  plan = other.plan;
  plan.FindCellsAt(cells);
  return *this;
}

const PlannedItem* ItemStage::Next() {
  while (items_.empty()) {
    if (!MayGoOn()) return nullptr;
    if (section_left_ == 0) {
      if (speeds().final_count() <= section_knots_) return nullptr;  // nothing new
      section_left_ = SectionSize();
      if (section_left_ == 0) return nullptr;
      BeginSection();
    }
    if (!section_planned()) {
      allowance_ -= PlanSection();
      continue;
    }
    items_.Rewind();
    allowance_ -= kEmitting;
    EmitMove();
  }
  const PlannedItem* item = &items_.front();  // nothing is written there before the next call
  items_.PopFront();
  return item;
}

// How many spans are timed together next; 0 when that is not known yet.
std::size_t ItemStage::SectionSize() {
  const std::size_t known = speeds().final_count();
  while (spans().first() + section_seen_ < spans().end()) {
    const Span& span = spans()[spans().first() + section_seen_];
    if (section_knots_ + span.knots() > known) break;
    ++section_seen_;
    section_knots_ += span.knots();
    const Number moves = span.last_move - spans().front().first_move;
    if (EndsSection(span, section_knots_ - 1) || section_seen_ == kSectionMax ||
        moves >= legs().window() / 2) {
      section_knots_ = 0;
      return std::exchange(section_seen_, 0);
    }
  }
  return 0;
}

// A knot that is passed as fast as it may be: the speed has no slope there in any good plan.
bool ItemStage::EndsSection(const Span& span, std::size_t last_knot) const {
  if (!machine().ramps_across_passages || std::isinf(machine().tip_jerk_mm_s3)) return true;
  constexpr double kReaches = 1.0 - 1e-12;
  if (speeds().speed(last_knot) >= span.cap * kReaches) return true;
  const bool varies = span.in_stretches || span.may_vary;
  return IsBlend(span.report.passage) && !varies;
}

// The section that begins with the oldest span: one profile times it, or ramps that PlanSection
// finds.
void ItemStage::BeginSection() {
  // Only a chain that begins moving can be too fast: the passes see to the rest.
  constexpr double kRoom = 1.0 + 1e-9;
  const Span& first = spans().front();
  if (last_speed_ > speeds().speed() * kRoom &&
      RampLength(last_speed_, speeds().speed(), first.limits) > first.length * kRoom) {
    starts_too_fast_ = true;
  }
  section_cell_ = 0;
  place_ = {};
  place_ramp_ = 0;
  alone_ = section_left_ == 1 && !first.in_stretches;
  if (alone_) {
    lone_ = SpeedProfile::Span(first.length, last_speed_, speeds().speed(), first.limits);
    return;
  }
  section_.cells.clear();
  section_.most.clear();
  section_.most.reserve(section_left_ * (2 * BendSpeeds::kSteps + 1));  // cells look into it
  section_size_ = section_left_;
  built_ = built_knots_ = 0;
}

// Times them, a little at a time: returns its work.
int ItemStage::PlanSection() {
  if (built_ == section_size_) return section_.plan.GoOn();
  AddSpan(spans()[spans().first() + built_], built_ + 1 == section_size_);
  ++built_;
  if (built_ == section_size_ && !section_.cells.empty())
    section_.plan.Begin(section_.cells, last_speed_);
  return kMaking;
}

// What lies between the knots at both ends, each with the speed of level 1 at its end. The curve
// behind the last knot is passed steadily, unless it has knots itself.
void ItemStage::AddSpan(const Span& span, bool last) {
  const double speed = speeds().speed(built_knots_);
  const bool blend = IsBlend(span.report.passage);
  const bool free = blend && !span.in_stretches;
  if (span.length > 0.0) {
    section_.cells.push_back(
        {span.length, span.limits, speed, free ? RampCell::kNoCap : span.cap, {}});
  } else if (!section_.cells.empty() && !free) {  // a bend begins where the last one ends
    section_.cells.back().end_cap = std::min(section_.cells.back().end_cap, span.cap);
  }
  if (span.in_stretches) {
    AddCurve(span, built_knots_);
  } else if (blend && !last) {
    PathLimits limits = LimitsOnCurve(legs(), span.corner_move, span.report.cut_mm);
    limits.speed = span.cap;
    section_.cells.push_back({span.curve_length, limits, speed, RampCell::kNoCap, {}});
  }
  built_knots_ += span.knots();
}

// The stretches of the curve behind a span whose own knot is `knot`.
void ItemStage::AddCurve(const Span& span, std::size_t knot) {
  PathLimits limits = LimitsInStretches(legs(), span);
  const Stretches stretches = StretchesIn(legs(), span);
  const std::size_t count = span.curve_knots();
  std::span<const double> most;
  if (count <= 2 && span.stretches.open > span.stretches.start) {
    const BendSpeeds half = SpeedsAlong(legs(), span);
    const std::size_t begin = section_.most.size();
    section_.most.insert(section_.most.end(), half.most.begin(), half.most.end());
    section_.most.insert(section_.most.end(), half.most.rbegin() + 1, half.most.rend());
    most = std::span(section_.most).subspan(begin);
  }
  double begin = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const Stretch& stretch = stretches[k];
    limits.speed = stretch.most;
    RampCell cell{stretch.end - begin, limits, speeds().speed(knot + 1 + k), stretch.end_cap, {}};
    if (!most.empty()) {
      const std::size_t steps = 2 * BendSpeeds::kSteps / count;
      cell.most = most.subspan(k * steps, steps + 1);
    }
    section_.cells.push_back(cell);
    begin = stretch.end;
  }
}

// The part of a ramp to `to`, from where the last part ended.
void ItemStage::TakeRamp(SpeedProfile& speed, const SpeedProfile& ramp, double to) {
  if (place_.s == 0.0 && to == ramp.end().s) {
    speed = ramp;
    return;
  }
  ramp.PartTo(place_, to, speed);
}

// The ramp of the present cell; another one begins at its beginning.
const SpeedProfile& ItemStage::PresentRamp() {
  const std::size_t ramp = section_.plan.timing()[section_cell_].ramp;
  if (ramp != place_ramp_) {
    place_ramp_ = ramp;
    place_ = {};
  }
  return section_.plan.ramps()[ramp];
}

// The part of the span to `to` of its length, or to its end.
void ItemStage::TakePart(SpeedProfile& speed, double to, bool to_end) {
  if (alone_) return TakeRamp(speed, lone_, to_end ? spans().front().length : to);
  const SpeedProfile& ramp = PresentRamp();
  const RampPlan::Timing& timing = section_.plan.timing()[section_cell_];
  TakeRamp(speed, ramp, to_end ? timing.to : std::min(timing.from + to, timing.to));
}

// The part of a curve to `to` of its length, or to where another ramp begins: that is `to` then.
void ItemStage::TakeStretches(SpeedProfile& speed, CurveCells& cells, double& to) {
  const SpeedProfile& ramp = PresentRamp();
  double on_ramp_to = 0.0;
  for (bool more = true; more;) {
    const RampPlan::Timing& timing = section_.plan.timing()[section_cell_];
    const double start = cells.at == 0 ? 0.0 : cells.end[cells.at - 1];
    const double end = cells.end[cells.at];
    const bool whole = to >= end;
    on_ramp_to = whole ? timing.to : std::min(timing.from + (to - start), timing.to);
    if (whole) {
      ++section_cell_;
      ++cells.at;
    }
    more = whole && cells.at < cells.count && to > end &&
           section_.plan.timing()[section_cell_].ramp == place_ramp_;
    if (!more) to = std::min(to, end);
  }
  TakeRamp(speed, ramp, on_ramp_to);
}

// Motions are made where they wait to be taken: they are large. The slot holds an old one, so every
// member is set here or by the caller (path, speed).
[[gnu::always_inline]] inline PlannedMotion& ItemStage::NewMotion(const Span& span,
                                                                  const Move& source) {
  PlannedItem& slot = items_.PushSlot();
  auto* motion = std::get_if<PlannedMotion>(&slot);
  if (motion == nullptr) motion = &slot.emplace<PlannedMotion>();
  motion->tag = source.tag;
  motion->head = source.head;
  motion->limits = span.limits;
  motion->settling_s = 0.0;
  motion->restart_speed = kLargest;
  return *motion;
}

inline void ItemStage::FinishMotion(const Span& span, Number move, PlannedMotion& motion,
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
void ItemStage::EmitMove() {
  const Span& span = spans().front();
  const bool blend = IsBlend(span.report.passage);
  if (span.length > 0.0) {
    if (!emitting_) {
      emitting_ = true;
      emit_move_ = span.first_move;
      emit_done_ = 0.0;
    }
    for (bool emitted = false; !emitted && emit_move_ <= span.last_move; ++emit_move_) {
      const Move& move = moves()[emit_move_];
      const PathPiece& path = move.path;
      const bool last = emit_move_ == span.last_move;
      const double from = emit_move_ == span.first_move ? span.x_from : 0.0;
      const double to = last ? span.x_to : path.length();
      if (!(to > from) || emit_move_ < ended_before_) continue;
      PlannedMotion& motion = NewMotion(span, move);
      if (from == 0.0 && to == path.length()) {
        motion.path = path;
      } else {
        motion.path.AssignPart(path, from, to);
      }
      emit_done_ += to - from;
      TakePart(motion.speed, emit_done_, last);
      const bool reaches_end = to == path.length() && !(blend && emit_move_ == span.corner_move);
      FinishMotion(span, emit_move_, motion, reaches_end);
      emitted = true;
    }
    if (emit_move_ <= span.last_move) return;
    emitting_ = false;
    ++section_cell_;
  }
  curve_speed_ = speeds().speed();
  const double end_speed = speeds().speed(span.knots() - 1);
  if (blend) EmitCurve(span);
  last_speed_ = end_speed;
  span_stage_.DropOldest();
  --section_left_;
}

void ItemStage::EmitCurve(const Span& span) {
  const double half = 0.5 * span.curve_length;
  CurveCells cells;  // none: steady
  if (span.in_stretches || section_left_ > 1) {
    cells.count = span.in_stretches ? span.curve_knots() : 1;
    for (std::size_t k = 0; k < cells.count; ++k) {
      cells.end[k] = span.in_stretches ? span.curve_end(k) : span.curve_length;
    }
    // The speed in the middle, which is an end of a stretch when there are some.
    const std::size_t cell = section_cell_ + (cells.count > 1 ? cells.count / 2 - 1 : 0);
    const RampPlan::Timing& timing = section_.plan.timing()[cell];
    const SpeedProfile& ramp = section_.plan.ramps()[timing.ramp];
    const double middle = cells.count > 1 ? timing.to : 0.5 * (timing.from + timing.to);
    curve_speed_ = ramp.At(ramp.TimeAt(middle)).speed;
  }
  const PathPose& middle = span.curve_middle;
  if (span.plain) {
    const PlainCorner corner = PlainCornerAt(legs(), span.corner_move, span.report.cut_mm);
    const PathPose start = corner.Start(), finish = corner.Finish();
    EmitHalves(span, corner, {start, middle, half, 0.0}, {middle, finish, half, half}, cells);
  } else {
    const CornerCurve& curve = span_stage_.oldest_curve();
    const PathPose start = curve.At(0.0), finish = curve.At(1.0);
    EmitHalves(span, curve, {start, middle, half, 0.0}, {middle, finish, half, half}, cells);
  }
}

// The curve is cut where its middle is, and where points that it swallows are: they lie on its
// halves as they would lie on the straight pieces.
template <class Shape>
void ItemStage::EmitHalves(const Span& span, const Shape& shape, const Half& first,
                           const Half& second, CurveCells& cells) {
  const double cut = span.report.cut_mm;
  const double half = first.length;
  // First half: from the end of the span to the corner.
  double x = 0.0;  // way from the start of the curve to the end of the move
  double s = 0.0;
  for (Number k = span.last_move; k <= span.corner_move; ++k) {
    double to = half;
    if (k < span.corner_move) {
      x += moves()[k].path.length() - (k == span.last_move ? span.x_to : 0.0);
      to = std::min(half * std::max(x, 0.0) / cut, half);
    }
    if (!(to > s) || k < ended_before_) continue;
    EmitCurvePart(span, k, shape, first, {s, to, true}, cells);
    s = to;
  }
  // Second half: to the place where the next span begins. A move that ends there ends on the curve:
  // nothing is left of it.
  x = 0.0;
  s = 0.0;
  for (Number k = span.corner_move + 1;; ++k) {
    x += moves()[k].path.length();
    const bool last = x + kSamePlace_mm >= cut || k + 1 == moves().end();
    const bool ends = x <= cut + kSamePlace_mm;
    double to = last ? half : std::min(half * x / cut, half);
    if (half + to >= half + half)
      to = half;  // what is left is less than the last digit of the curve
    if (to > s) EmitCurvePart(span, k, shape, second, {s, to, ends}, cells);
    if (ends) ended_before_ = k + 1;
    s = std::max(s, to);
    if (last) break;
  }
}

template <class Shape>
void ItemStage::EmitCurvePart(const Span& span, Number move, const Shape& shape, const Half& half,
                              const HalfPart& part, CurveCells& cells) {
  // A half is one motion, but for its moves and where the ramp changes.
  for (double s = part.s_from; s < part.s_to;) {
    PlannedMotion& motion = NewMotion(span, moves()[move]);
    motion.limits = moves()[move].limits;
    double s_to = part.s_to;
    if (cells.count == 0) {
      // A STOP on the way brakes as the move does that this part belongs to.
      motion.speed = SpeedProfile::Steady(s_to - s, curve_speed_);
      motion.limits.acceleration =
          std::min(motion.limits.acceleration,
                   machine().curve_tangential * machine().tip_acceleration_mm_s2);
      motion.limits.speed = curve_speed_;
    } else {
      motion.limits = section_.cells[section_cell_].limits;  // the ramp runs through both halves
      if (span.in_stretches) {
        motion.restart_speed =
            std::min({span.stretches.start, span.stretches.open, span.stretches.middle});
      }
      double to = half.begin + s_to;
      TakeStretches(motion.speed, cells, to);
      s_to = to < half.begin + s_to ? to - half.begin : s_to;
    }
    motion.path.AssignCorner(shape, half.begin, half.length, half.from, half.to);
    if (s != 0.0 || s_to != half.length) motion.path = motion.path.Part(s, s_to);
    FinishMotion(span, move, motion, part.ends_move && s_to == part.s_to);
    s = s_to;
  }
}

void ItemStage::EndMove(const Span& span, Number move, PlannedMotion& motion) {
  if (move == span.corner_move) {
    motion.corner = span.report;
    motion.corner.speed = IsBlend(span.report.passage) ? curve_speed_ : motion.speed.end().speed;
    motion.settling_s = span.settling_s;
  } else {
    motion.corner = {.passage = Passage::kThrough, .speed = motion.speed.end().speed};
  }
  while (!marks_.empty() && marks_.front().after_move <= move) {
    items_.Push(PlannedMark{marks_.front().tag});
    marks_.PopFront();
  }
  LegStage& from = span_stage_.leg_stage();
  while (from.moves().first() < move) from.DropOldestMove();
  if (move == span.corner_move && from.moves().end() == move + 1 && !from.open()) {
    from.DropOldestMove();
  }
}

void ItemStage::AddMark(std::uint64_t tag) {
  if (!legs().open() && moves().empty()) {
    items_.Push(PlannedMark{tag});
  } else {
    marks_.Push({tag, moves().end() - 1});
  }
}

std::string ItemStage::Dump() const {
  std::string out;
  if (section_left_ > 0) {
    out += "section: " + std::to_string(section_left_) + " spans, from " +
           FixedText(last_speed_, 3) + (alone_ ? ", one profile\n" : ", ramps across\n");
  }
  for (std::uint64_t k = items_.first(); k < items_.end(); ++k) {
    if (const auto* motion = std::get_if<PlannedMotion>(&items_[k])) {
      out += "motion " + std::to_string(motion->tag) + ": length " +
             FixedText(motion->path.length(), 3) + " in " + FixedText(motion->duration_s(), 6) +
             " s" + (motion->ends_move ? ", " + std::string(NameOf(motion->corner.passage)) : "") +
             '\n';
    } else {
      out += "mark " + std::to_string(std::get<PlannedMark>(items_[k]).tag) + '\n';
    }
  }
  for (std::uint64_t k = marks_.first(); k < marks_.end(); ++k) {
    out += "mark " + std::to_string(marks_[k].tag) + ": waits for move " +
           std::to_string(marks_[k].after_move) + '\n';
  }
  return out;
}

}  // namespace rmlcell::motion
