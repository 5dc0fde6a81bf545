#include "engine/rml1/work_fit.h"

#include <algorithm>

namespace rmlcell::rml1 {
namespace {

// What the program wants of an axis, from the work origin: what was done, and what was lost.
Extent Wanted(Extent done, const Extent& lost, double origin) {
  if (!lost.known) return done;
  done.Add(lost.low - origin);
  done.Add(lost.high - origin);
  return done;
}

WorkFit::Axis Fit(const Extent& wanted, const Travel& travel, double units_per_mm) {
  if (!wanted.known) return {};
  const double low = travel.low - wanted.low;
  const double high = travel.high - wanted.high;
  const double length = (wanted.high - wanted.low) / units_per_mm;
  if (low > high) return {.known = true, .over = (low - high) / units_per_mm, .length = length};
  return {.known = true,
          .low = std::min(std::max(low, travel.low), high) / units_per_mm,
          .high = std::max(std::min(high, travel.high), low) / units_per_mm,
          .length = length};
}

}  // namespace

WorkFit FitOf(const WorkExtent& work, const LostCut& lost, const Point& origin,
              const CuttingRange& travel, double units_per_mm) {
  Extent depth = Wanted(work.z, lost.z, origin.z);
  depth.high = std::max(depth.low, 0.0);  // what lies above Z 0 is lift: cut off, nothing is lost
  return {.x = Fit(Wanted(work.x, lost.x, origin.x), travel.x, units_per_mm),
          .y = Fit(Wanted(work.y, lost.y, origin.y), travel.y, units_per_mm),
          .z = Fit(depth, travel.z, units_per_mm)};
}

}  // namespace rmlcell::rml1
