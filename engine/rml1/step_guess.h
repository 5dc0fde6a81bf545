#pragma once

#include <cstdint>

#include "engine/rml1/extent.h"
#include "engine/rml1/work_fit.h"

namespace rmlcell::rml1 {

// Whether a stream seems to be written for a machine with the other usual step: 40 or 100 units in
// a millimetre (RML1-1.08). A guess, and only where there is a reason for it.
struct StepGuess {
  double fits_at = 0.0;  // units per mm at which work fits that is too large as it is; 0: no reason
  WorkFit work{};        // with `fits_at`: how large it would be there
  // Where the tool never rises so high above the surface as anybody lifts it on this machine, but
  // as on the other one: how high that is here and would be there, mm. 0: no reason.
  double lift_mm = 0.0;
  double lift_there_mm = 0.0;
};

// The heights that a program asks for, units from the surface: their extent, and what every one of
// them is a multiple of.
struct ProgrammedHeights {
  Extent extent{};
  std::uint32_t grain = 0;
};

// `fit` of the work as it is.
StepGuess GuessStep(const WorkFit& fit, const CuttingRange& travel,
                    const ProgrammedHeights& heights, double units_per_mm);

}  // namespace rmlcell::rml1
