#pragma once

#include <string>

#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing {

// What the machine did, seen from outside: the highest accelerations that follow from where it was
// at times close to each other, whatever the run told of its speeds.
struct Measured {
  double tip_mm_s2 = 0.0;
  double tip_at_s = 0.0;
  double axes = 0.0;  // share of the limit of the axis that is nearest to its own
  double axes_at_s = 0.0;
};
Measured MeasuredFrom(const Ran& ran, double step_s = 1e-3);

// Adds a failure for each limit that is broken by more than 1 %. `tip`: the program has nothing but
// LIN and CIR, so that the limits of the tip hold.
void ExpectWithinLimits(const Ran& ran, bool tip, const std::string& what);

}  // namespace rmlcell::optimo::testing
