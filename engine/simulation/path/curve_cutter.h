#pragma once

#include <array>
#include <cstddef>

#include "engine/simulation/path/part_curve.h"

namespace rmlcell::simulation {

// A place on a curve.
struct CurvePlace {
  double p = 0.0;
  motion::MachinePoint tip;
};

// Chords of one curve that were looked at, in that order: who cuts it once more to a like tolerance
// asks for the same ones.
class ChordList {
 public:
  struct Chord {
    double begin = 0.0;
    CurvePlace end;
    double bow_mm = 0.0;  // how far the curve leaves it
  };

  void Rewind() { next_ = 0; }
  // The chord between two places, or null; else it goes to the end with Keep.
  const Chord* Find(double begin, double end);
  void Keep(const Chord& chord);

 private:
  static constexpr std::size_t kMost = 16;  // of a half of a corner: 7, when nothing is halved
  std::array<Chord, kMost> chords_;         // the first count_
  std::size_t count_ = 0;
  std::size_t next_ = 0;
};

// Where a curve that is no arc has to be cut.
class CurveCutter {
 public:
  CurveCutter(const PartCurve& curve, ChordList& chords, double tolerance_mm)
      : curve_(curve), chords_(chords), tolerance_mm_(tolerance_mm) {
    chords_.Rewind();
  }

  // The end of the next chord from a place on: as long as the tolerance allows, found by halving.
  CurvePlace NextCut(const CurvePlace& from) const;

 private:
  ChordList::Chord Measured(const CurvePlace& from, double end) const;

  const PartCurve& curve_;
  ChordList& chords_;
  double tolerance_mm_;
};

}  // namespace rmlcell::simulation
