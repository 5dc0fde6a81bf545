#pragma once

#include <optional>

#include "engine/motion/geometry/corner_table.h"
#include "engine/motion/geometry/path.h"

namespace rmlcell::motion {

// A blend, ready to be looked at by arc length many times. Owns what it needs.
class BlendCurve {
 public:
  // `piece` is a blend.
  explicit BlendCurve(const PathPiece& piece) : curve_(piece.curve()), start_(piece.curve_start()) {
    if (const PathPiece::PlainPart* plain = piece.plain_corner()) {
      measure_.emplace(plain->corner);
      per_mm_ = 1.0 / plain->total;
      if (measure_->known()) return;
    }
    length_.emplace(curve_);
  }

  const CornerCurve& curve() const { return curve_; }

  // The parameter of the curve at `s` of the piece.
  double ParameterAt(double s) const {
    if (length_) return length_->ParameterAt(curve_, start_ + s);
    return measure_->ParameterAt((start_ + s) * per_mm_);
  }

 private:
  CornerCurve curve_;
  double start_ = 0.0;  // arc length before the piece
  double per_mm_ = 0.0;
  std::optional<PlainMeasure> measure_;
  std::optional<CornerLength> length_;  // when that is not known
};

}  // namespace rmlcell::motion
