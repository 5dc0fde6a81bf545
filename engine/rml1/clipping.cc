#include "engine/rml1/clipping.h"

#include <algorithm>
#include <cmath>

#include "engine/motion/geometry/frames.h"

namespace rmlcell::rml1 {
namespace {

// The shares of the way from `from` to `to` between which low <= value <= high, cut into `share`.
void Narrow(Share& share, double from, double to, const Travel& travel) {
  const double low = travel.low - CuttingRange::kFaceTolerance;
  const double high = travel.high + CuttingRange::kFaceTolerance;
  const bool from_inside = from >= low && from <= high;
  const bool to_inside = to >= low && to <= high;
  if (from_inside && to_inside) return;
  const double way = to - from;
  if (way == 0.0) {  // outside all along
    share = {1.0, 0.0};
    return;
  }
  // Crossings of the faces themselves: the tolerance decides only whether there is one.
  const double at_low = (travel.low - from) / way;
  const double at_high = (travel.high - from) / way;
  if (!from_inside) share.low = std::max(share.low, std::min(at_low, at_high));
  if (!to_inside) share.high = std::min(share.high, std::max(at_low, at_high));
}

// A point computed on a face lies on it exactly.
void Snap(double& value, const Travel& travel) {
  if (std::abs(value - travel.low) <= CuttingRange::kFaceTolerance) value = travel.low;
  if (std::abs(value - travel.high) <= CuttingRange::kFaceTolerance) value = travel.high;
}

Point OnLine(const CuttingRange& range, const Point& from, const Point& to, double share) {
  Point p = Between(from, to, share);
  Snap(p.x, range.x);
  Snap(p.y, range.y);
  Snap(p.z, range.z);
  return p;
}

}  // namespace

CuttingRange CuttingRange::WithoutFaces() const {
  const auto narrowed = [](const Travel& travel) -> Travel {
    return {travel.low + 2.0 * kFaceTolerance, travel.high - 2.0 * kFaceTolerance};
  };
  return {narrowed(x), narrowed(y), narrowed(z)};
}

Point CuttingRange::Nearest(const Point& p) const {
  return {std::clamp(p.x, x.low, x.high), std::clamp(p.y, y.low, y.high),
          std::clamp(p.z, z.low, z.high), p.a};
}

Point Between(const Point& from, const Point& to, double share) {
  if (share >= 1.0) return to;
  const auto at = [share](double a, double b) { return a + (b - a) * share; };
  return {at(from.x, to.x), at(from.y, to.y), at(from.z, to.z), at(from.a, to.a)};
}

Share ShareInXY(const CuttingRange& range, const Point& from, const Point& to) {
  Share share;
  Narrow(share, from.x, to.x, range.x);
  Narrow(share, from.y, to.y, range.y);
  return share;
}

Pieces Pieces::Cut(const CuttingRange& range, const Point& from, const Point& to, double zero) {
  Pieces pieces;
  const Share inside = ShareInXY(range, from, to);
  if (inside.empty()) {
    pieces.Add(Region::kOutside, from, to, zero);
    return pieces;
  }
  const Point enter = OnLine(range, from, to, inside.low);
  const Point leave = OnLine(range, from, to, inside.high);
  if (inside.low > 0.0) pieces.Add(Region::kOutside, from, enter, zero);

  // Within X and Y, Z falls or rises steadily through at most three regions.
  Share level = inside;
  Narrow(level, from.z, to.z, range.z);
  const bool rises = to.z > from.z;
  const auto region_at = [&](double share) {
    const double z = from.z + (to.z - from.z) * share;
    if (z > range.top() + CuttingRange::kFaceTolerance) return Region::kAbove;
    if (z < range.bottom() - CuttingRange::kFaceTolerance) return Region::kBelow;
    return Region::kInside;
  };
  if (level.empty()) {
    pieces.Add(region_at(0.5 * (inside.low + inside.high)), enter, leave, zero);
  } else {
    const Point from_level = OnLine(range, from, to, level.low);
    const Point to_level = OnLine(range, from, to, level.high);
    const Region before = rises ? Region::kBelow : Region::kAbove;
    const Region after = rises ? Region::kAbove : Region::kBelow;
    pieces.Add(before, enter, from_level, zero);
    pieces.Add(Region::kInside, from_level, to_level, zero);
    pieces.Add(after, to_level, leave, zero);
  }
  if (inside.high < 1.0) pieces.Add(Region::kOutside, leave, to, zero);
  return pieces;
}

void Pieces::Add(Region region, const Point& from, const Point& to, double zero) {
  if (SamePoint(from, to, zero)) return;
  pieces_[count_++] = {region, from, to};
}

}  // namespace rmlcell::rml1
