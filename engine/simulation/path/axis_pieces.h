#pragma once

#include <array>
#include <span>

#include "engine/simulation/path/part_curve.h"

namespace rmlcell::simulation {

// What the axes of a gantry do along a part of a path on which the head turns: how far each of
// their derivatives by the parameter of the curve goes at most, over a few pieces of the part. In
// the middle of each piece the derivatives are worked out, up to the third; how far they can change
// from there to its ends follows from bounds of the next one. Rigorous but for rounding.
class AxisPieces {
 public:
  static constexpr std::size_t kFew = 4;    // bounds some per cent too high
  static constexpr std::size_t kMany = 16;  // below one per cent

  struct Piece {
    motion::AxisValues middle;  // first derivatives there
    motion::AxisValues first;   // bounds over the piece
    motion::AxisValues second;
    motion::AxisValues third;
    // Of the tip: |p'| from below, p'' and p''' from above, and how |p'| changes.
    double slowest;
    double fastest;
    double tip_second;
    double tip_third;
    double curvature;
    double change;         // |p'|'
    double second_change;  // |p'|''
  };

  // Lines, turns about a standing tip, and blends that are not in_axes().
  static bool AreFor(const motion::PathPiece& path);

  // In kFew or kMany pieces.
  AxisPieces(const PartCurve& curve, std::size_t count);

  // False: the tip all but stands somewhere, and nothing is known.
  bool known() const { return known_; }
  std::span<const Piece> pieces() const { return {pieces_.data(), count_}; }
  double width() const { return 2.0 * half_; }  // of each, in the parameter

  // Whether an axis, 0 to 4, certainly goes one way all along.
  bool GoesOneWay(int axis) const;

 private:
  std::array<Piece, kMany> pieces_;  // the first count_
  std::size_t count_;
  double half_ = 0.0;  // of a piece, in the parameter
  bool known_ = true;
};

}  // namespace rmlcell::simulation
