#include "engine/simulation/corner_log.h"

#include <algorithm>

namespace rmlcell::simulation {
namespace {

using motion::Passage;

// A motion reached its feed rate when it came this near: rounding is no shortfall.
constexpr double kReached = 1.0 - 1e-6;

std::uint64_t& CounterOf(CornerFigures& corners, Passage passage) {
  switch (passage) {
    case Passage::kStop:
      return corners.stops;
    case Passage::kStopNoSpeed:
    case Passage::kStopNeighbour:
    case Passage::kStopShort:
      return corners.stops_with_fly;
    case Passage::kStopReversal:
      return corners.reversals;
    case Passage::kThrough:
      return corners.through;
    case Passage::kBlend:
      return corners.blended;
    case Passage::kBlendCapped:
      return corners.capped;
  }
  return corners.stops;
}

}  // namespace

void CornerLog::Add(const machine::MotionDone& done) {
  const motion::PlannedMotion& motion = *done.motion;
  if (!motion.path.by_sigma()) {
    move_peak_mm_s_ = std::max(move_peak_mm_s_, motion.speed.peak_speed());
  }
  const double length = motion.path.length();
  if (!motion.ends_move || done.travelled < length) return;
  if (length > 0.0 && done.from >= length) return;  // it was over before: settling, told in parts
  AddCorner(done);
  AddShortfall(done);
  move_peak_mm_s_ = 0.0;
}

void CornerLog::AddCorner(const machine::MotionDone& done) {
  const motion::CornerReport& corner = done.motion->corner;
  ++CounterOf(corners_, corner.passage);
  if (corner.deviation_mm <= corners_.deviation_mm_max) return;
  corners_.deviation_mm_max = corner.deviation_mm;
  corners_.deviation_place = done.place;
  corners_.deviation_point = done.motion->path.to().tip;
}

void CornerLog::AddShortfall(const machine::MotionDone& done) {
  const double reached = move_peak_mm_s_;
  if (reached <= 0.0 || reached >= done.programmed_mm_s * kReached) return;
  if (shortfall_.moves == 0 ||
      reached * shortfall_.wanted_mm_s < shortfall_.reached_mm_s * done.programmed_mm_s) {
    shortfall_.worst = done.place;
    shortfall_.wanted_mm_s = done.programmed_mm_s;
    shortfall_.reached_mm_s = reached;
  }
  ++shortfall_.moves;
}

}  // namespace rmlcell::simulation
