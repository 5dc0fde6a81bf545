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
  if (high < travel.low)
    return {.known = true, .move = (high - travel.low) / units_per_mm, .length = length};
  if (low > travel.high)
    return {.known = true, .move = (low - travel.high) / units_per_mm, .length = length};
  return {.known = true,
          .low = std::max(low, travel.low) / units_per_mm,
          .high = std::min(high, travel.high) / units_per_mm,
          .length = length};
}

}  // namespace

WorkFit FitOf(const WorkExtent& work, const LostCut& lost, const Point& origin,
              const CuttingRange& travel, double lift, double units_per_mm) {
  Extent depth = Wanted(work.z, lost.z, origin.z);
  // Higher lifts may be cut off, and nothing is lost; with none at all the tool would cross the
  // work. Where there is no room for both, the work goes first.
  const double room = travel.z.high - travel.z.low + std::min(depth.low, 0.0);
  depth.high = std::max(depth.low, std::min(lift, std::max(room, 0.0)));
  WorkFit::Axis z = Fit(depth, travel.z, units_per_mm);
  z.length = std::max(-depth.low, 0.0) / units_per_mm;  // without the lift
  return {.x = Fit(Wanted(work.x, lost.x, origin.x), travel.x, units_per_mm),
          .y = Fit(Wanted(work.y, lost.y, origin.y), travel.y, units_per_mm),
          .z = z};
}

}  // namespace rmlcell::rml1
