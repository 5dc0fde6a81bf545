#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "engine/motion/geometry/frames.h"
#include "engine/rml1/action.h"
#include "engine/rml1/profile.h"

namespace rmlcell::rml1 {

// The box that the physical tool never leaves (rml1.md section 5A), faces included.
struct CuttingRange {
  Travel x;
  Travel y;
  Travel z;

  // Sums of relative motions carry rounding errors: this far beyond a face still counts as on it.
  static constexpr double kFaceTolerance = 1e-6;  // device units

  bool HasXY(const Point& p) const {
    return p.x >= x.low - kFaceTolerance && p.x <= x.high + kFaceTolerance &&
           p.y >= y.low - kFaceTolerance && p.y <= y.high + kFaceTolerance;
  }
  // Not beyond a face, nor on it.
  bool HasXYWithin(double px, double py) const {
    return px > x.low && px < x.high && py > y.low && py < y.high;
  }
  bool HasWithin(const Point& p) const {
    return HasXYWithin(p.x, p.y) && p.z > z.low && p.z < z.high;
  }
  // The same without what is so close to a face that it counts as on it.
  CuttingRange WithoutFaces() const;
  double top() const { return z.high; }
  double bottom() const { return z.low; }
  // The nearest point of the range.
  Point Nearest(const Point& p) const;
};

// Where a piece of a straight line lies (section 5A).
enum class Region : std::uint8_t { kInside, kBelow, kAbove, kOutside };

struct Piece {
  Region region = Region::kInside;
  Point from;
  Point to;
};

// A line cut into pieces of one region each, in order, at most five. Pieces shorter than `zero` are
// left out; a line that lies in one piece comes back as it is.
class Pieces {
 public:
  // Cut at all six faces: three-axis motion.
  static Pieces Cut(const CuttingRange& range, const Point& from, const Point& to, double zero);

  std::span<const Piece> all() const { return {pieces_.data(), count_}; }

 private:
  void Add(Region region, const Point& from, const Point& to, double zero);

  static constexpr std::size_t kPiecesMax = 5;  // out, above or below, inside, below or above, out
  std::array<Piece, kPiecesMax> pieces_;
  std::size_t count_ = 0;
};

// The part of a line whose X and Y lie in the range, as shares of the line; empty when low > high.
struct Share {
  double low = 0.0;
  double high = 1.0;
  bool empty() const { return low > high; }
};
Share ShareInXY(const CuttingRange& range, const Point& from, const Point& to);

// from + (to - from) * share, the ends exactly.
Point Between(const Point& from, const Point& to, double share);

inline double DistanceXYZ(const Point& a, const Point& b) {
  return motion::ProgramVector(a.x - b.x, a.y - b.y, a.z - b.z).norm();
}

// Not further apart than `zero` device units, and the same angle.
inline constexpr double kSameAngle_deg = 1e-9;  // rounding errors of angles computed on a line
inline bool SamePoint(const Point& a, const Point& b, double zero) {
  return DistanceXYZ(a, b) <= zero && std::abs(a.a - b.a) <= kSameAngle_deg;
}

}  // namespace rmlcell::rml1
