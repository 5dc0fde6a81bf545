#pragma once

#include "engine/rml1/carriage.h"

namespace rmlcell::rml1 {

// Where the work origin may lie on the machine so that nothing of the work is lost. RML1-5A.01
struct WorkFit {
  // Of one axis, in mm. The origin may be from `low` to `high`, both in the travel, where the panel
  // can set it. Where the work is larger than the travel there is no such place, and `over` says by
  // how much; where it would have to lie outside, `move` says how far the program must move itself.
  struct Axis {
    bool known = false;  // false: nothing was in the work
    double low = 0.0;
    double high = 0.0;
    double over = 0.0;
    double move = 0.0;  // to less below 0
    bool fits() const { return known && over == 0.0 && move == 0.0; }
    double length = 0.0;  // of the work
  };
  Axis x;
  Axis y;
  Axis z;  // of Z0; up to where the lifts of the program still rise above the surface
};

// How far the work goes, device units from the work origin: what the tool did in it.
struct WorkExtent {
  Extent x;
  Extent y;
  Extent z;
};

// `origin` is where the work origin was then, and `lost` what lay beyond the travel from there;
// `lift` is the least height above the surface that the program rises to, 0 without one. Device
// units.
WorkFit FitOf(const WorkExtent& work, const LostCut& lost, const Point& origin,
              const CuttingRange& travel, double lift, double units_per_mm);

}  // namespace rmlcell::rml1
