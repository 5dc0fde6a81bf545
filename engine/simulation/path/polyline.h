#pragma once

#include "engine/simulation/path/part_curve.h"

namespace rmlcell::simulation {

// Chords in one part of an arc: what the tightest tolerance needs for the longest arc that any
// machine can hold, with room.
inline constexpr int kChordsMax = 100'000;

// How many chords keep within `tolerance_mm` of an arc. motion.md section 9.
int ChordCount(double radius_mm, double sweep_rad, double tolerance_mm);

// Where a curve that is no arc has to be cut.
class CurveCutter {
 public:
  CurveCutter(const PartCurve& curve, double tolerance_mm)
      : curve_(curve), tolerance_mm_(tolerance_mm) {}

  // The end of the next chord from `p` on: as long as the tolerance allows, found by halving.
  double NextCut(double p) const;

 private:
  const PartCurve& curve_;
  double tolerance_mm_;
};

// The tip's way along `part` as a polyline: calls `take(s, tip)` for every vertex after the first,
// the last one being the end of the part. No point of the way is farther than the tolerance from
// the polyline. Within the curve of a blend `s` is near enough to tell the time, not exact.
template <class Take>
void ForEachVertex(const PathPart& part, double tolerance_mm, Take take) {
  using Kind = motion::PathPiece::Kind;
  const motion::PathPiece& path = part.path;
  const bool bows = path.in_axes() && Turns(path);
  if (path.kind() == Kind::kArc) {
    const double sweep = (part.to - part.from) / path.radius_mm();
    const int chords = ChordCount(path.radius_mm(), sweep, tolerance_mm);
    for (int k = 1; k < chords; ++k) {
      const double s = part.from + (part.to - part.from) * k / chords;
      take(s, path.At(s).point);
    }
  } else if (bows || path.kind() == Kind::kBlend) {
    const PartCurve curve(part);
    const CurveCutter cutter(curve, tolerance_mm);
    const double s_per_p = (part.to - part.from) / (curve.end() - curve.begin());
    for (double p = cutter.NextCut(curve.begin()); p < curve.end(); p = cutter.NextCut(p)) {
      take(part.from + (p - curve.begin()) * s_per_p, curve.Tip(p));
    }
  }
  take(part.to, TipAt(path, part.head, part.to));
}

}  // namespace rmlcell::simulation
