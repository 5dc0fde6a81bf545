#include "engine/simulation/path/curve_cutter.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

// Halvings of a part before a chord is taken as it is: 1/65536 of a swing is far below any
// tolerance.
constexpr int kHalvingsMax = 16;
// The first guess: a curve that turns to and fro within less cannot be told from its middle points.
constexpr double kFirstChord_rad = 0.5;

double DistanceToSegment(const MachinePoint& point, const MachineVector& a,
                         const MachineVector& b) {
  const MachineVector along = b - a;
  const double squared = along.dot(along);
  const double share = squared > 0.0 ? std::clamp((point - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (point - (a + along * share)).norm();
}

}  // namespace

const ChordList::Chord* ChordList::Find(double begin, double end) {
  const bool there = next_ < count_ && chords_[next_].begin == begin && chords_[next_].end.p == end;
  return there ? &chords_[next_++] : nullptr;
}

void ChordList::Keep(const Chord& chord) {
  if (next_ == count_ && count_ < kMost) chords_[count_++] = chord;
  next_ = count_;
}

ChordList::Chord CurveCutter::Measured(const CurvePlace& from, double end) const {
  if (const ChordList::Chord* known = chords_.Find(from.p, end)) return *known;
  const MachinePoint to = curve_.Tip(end);
  const auto off = [&](double share) {
    return DistanceToSegment(curve_.Tip(from.p + (end - from.p) * share), from.tip, to);
  };
  // Three points tell a bow from an S; a quarter more for what lies between them.
  const ChordList::Chord chord{
      from.p, {end, to}, 1.25 * std::max({off(0.25), off(0.5), off(0.75)})};
  chords_.Keep(chord);
  return chord;
}

CurvePlace CurveCutter::NextCut(const CurvePlace& from) const {
  const double whole = curve_.end() - curve_.begin();
  double step = whole;
  if (curve_.turning_rad() > kFirstChord_rad) step *= kFirstChord_rad / curve_.turning_rad();
  const double shortest = whole / (1 << kHalvingsMax);
  for (;; step *= 0.5) {
    const double p = from.p + step;
    const double end = p >= curve_.end() - 0.5 * shortest ? curve_.end() : p;
    if (step <= shortest) return {end, curve_.Tip(end)};
    const ChordList::Chord chord = Measured(from, end);
    if (chord.bow_mm <= tolerance_mm_) return chord.end;
  }
}

}  // namespace rmlcell::simulation
