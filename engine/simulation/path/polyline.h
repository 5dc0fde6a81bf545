#pragma once

#include "engine/simulation/path/part_shape.h"

namespace rmlcell::simulation {

// Chords in one part of an arc: what the tightest tolerance needs for the longest arc that any
// machine can hold, with room.
inline constexpr int kChordsMax = 100'000;

// How many chords keep within `tolerance_mm` of an arc. motion.md section 9.
int ChordCount(double radius_mm, double sweep_rad, double tolerance_mm);

// The tip's way along the part as a polyline: calls `take(s, tip)` for every vertex after the
// first, the last one being the end of the part. No point of the way is farther than the tolerance
// from the polyline. Within the curve of a blend `s` is near enough to tell the time, not exact.
template <class Take>
void ForEachVertex(PartShape& shape, double tolerance_mm, Take take) {
  using Kind = motion::PathPiece::Kind;
  const PathPart& part = shape.part();
  const motion::PathPiece& path = part.path;
  const bool bows = path.in_axes() && shape.turns();
  if (path.kind() == Kind::kArc) {
    const double sweep = (part.to - part.from) / path.radius_mm();
    const int chords = ChordCount(path.radius_mm(), sweep, tolerance_mm);
    for (int k = 1; k < chords; ++k) {
      const double s = part.from + (part.to - part.from) * k / chords;
      take(s, path.At(s).point);
    }
  } else if (bows || path.kind() == Kind::kBlend) {
    const PartCurve& curve = shape.curve();
    const CurveCutter cutter(curve, shape.chords(), tolerance_mm);
    const double s_per_p = (part.to - part.from) / (curve.end() - curve.begin());
    CurvePlace place = cutter.NextCut({curve.begin(), curve.Tip(curve.begin())});
    for (; place.p < curve.end(); place = cutter.NextCut(place)) {
      take(part.from + (place.p - curve.begin()) * s_per_p, place.tip);
    }
  }
  take(part.to, shape.tip_to());
}

}  // namespace rmlcell::simulation
