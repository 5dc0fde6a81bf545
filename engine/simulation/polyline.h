#pragma once

#include "engine/simulation/path_extent.h"

namespace rmlcell::simulation {

// Chords in one part of an arc: what the tightest tolerance needs for the longest arc that any
// machine can hold, with room.
inline constexpr int kChordsMax = 100'000;

// How many chords keep within `tolerance_mm` of an arc. motion.md section 9.
int ChordCount(double radius_mm, double sweep_rad, double tolerance_mm);

// The tip's way along `part` as a polyline: calls `take(s, point)` for every vertex after the
// first, the last one being the end of the part. No point of the way is farther than the tolerance
// from the polyline.
template <class Take>
void ForEachVertex(const PathPart& part, double tolerance_mm, Take take);

// Where a curve that is no arc has to be cut: `take` as above.
class CurveCutter {
 public:
  CurveCutter(const PathPart& part, double tolerance_mm)
      : part_(part), tolerance_mm_(tolerance_mm) {}

  // The end of the next chord from `s` on: as long as the tolerance allows, found by halving.
  double NextCut(double s) const;

 private:
  const PathPart& part_;
  double tolerance_mm_;
};

template <class Take>
void ForEachVertex(const PathPart& part, double tolerance_mm, Take take) {
  using Kind = motion::PathPiece::Kind;
  const motion::PathPiece& path = part.path;
  const bool joint_bow = path.kind() == Kind::kJoint && Turns(path);
  if (path.kind() == Kind::kArc) {
    const double sweep = (part.to - part.from) / path.radius_mm();
    const int chords = ChordCount(path.radius_mm(), sweep, tolerance_mm);
    for (int k = 1; k < chords; ++k) {
      const double s = part.from + (part.to - part.from) * k / chords;
      take(s, path.At(s).tip);
    }
  } else if (joint_bow || path.kind() == Kind::kBlend) {
    const CurveCutter cutter(part, tolerance_mm);
    for (double s = cutter.NextCut(part.from); s < part.to; s = cutter.NextCut(s)) {
      take(s, TipAt(path, part.head, s));
    }
  }
  take(part.to, TipAt(path, part.head, part.to));
}

}  // namespace rmlcell::simulation
