#pragma once

#include "engine/rml1/carriage.h"

namespace rmlcell::rml1 {

// Where the work origin may lie on the machine so that nothing of the work is lost. RML1-5A.01
struct WorkFit {
  // Of one axis, in mm. The origin may be from `low` to `high`, both in the travel, as the panel
  // sets it; where the work is larger than that there is no such place, and `over` says by how
  // much.
  struct Axis {
    bool known = false;  // false: nothing was in the work
    double low = 0.0;
    double high = 0.0;
    double over = 0.0;
    double length = 0.0;  // of the work
  };
  Axis x;
  Axis y;
  Axis z;  // of Z0; its upper end is the top of the travel
};

// How far the work goes, device units from the work origin: what the tool did in it.
struct WorkExtent {
  Extent x;
  Extent y;
  Extent z;
};

// `origin` is where the work origin was then, and `lost` what lay beyond the travel from there;
// device units.
WorkFit FitOf(const WorkExtent& work, const LostCut& lost, const Point& origin,
              const CuttingRange& travel, double units_per_mm);

}  // namespace rmlcell::rml1
