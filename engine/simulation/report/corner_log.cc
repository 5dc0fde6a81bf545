#include "engine/simulation/report/corner_log.h"

#include "engine/simulation/path/part_curve.h"
#include "engine/simulation/report/move_speeds.h"

namespace rmlcell::simulation {
namespace {

using motion::Passage;

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
  if (!EndsMove(done)) return;
  const motion::CornerReport& corner = done.motion->corner;
  ++CounterOf(corners_, corner.passage);
  if (corner.deviation_mm <= corners_.deviation_mm_max) return;
  corners_.deviation_mm_max = corner.deviation_mm;
  corners_.deviation_place = done.place;
  const motion::PathPiece& path = done.motion->path;
  corners_.deviation_point = TipAt(path, done.motion->head, path.length());
}

}  // namespace rmlcell::simulation
