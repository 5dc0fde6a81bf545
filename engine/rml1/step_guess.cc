#include "engine/rml1/step_guess.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kCoarse = 40.0;       // MODELA MDX-15 and MDX-20, and machines before them
constexpr double kFine = 100.0;        // every later one
constexpr double kTooLarge_mm = 0.01;  // less is rounding

// Real programs for 100 units a millimetre lift by 1 mm and more, those for 40 by 1 or 2 mm: 40 or
// 80 units. Who lifts by 0.2 to 0.4 mm here may well mean 0.5 to 1 mm there. 0.5 mm is an ordinary
// lift here, and 1.25 mm, which it would be there, is none. Who lifts by less than 1 mm here may,
// where the heights are round there and not here.
constexpr double kLeastLift = 20.0;  // units
constexpr double kMostLift = 40.0;
constexpr double kMostRoundLift = 99.0;
// People think of heights in twentieths of a millimetre: 2 units of 40, 5 of 100.
constexpr std::uint32_t kTwentiethOfCoarse = 2;
constexpr std::uint32_t kTwentiethOfFine = 5;

// Makes the length that of a fine step. True: it is no larger than the travel of a coarse one.
bool Shrinks(WorkFit::Axis& axis, const Travel& travel) {
  axis.length = axis.length * kCoarse / kFine;
  return axis.length <= (travel.high - travel.low) / kCoarse;
}

}  // namespace

StepGuess GuessStep(const WorkFit& fit, const CuttingRange& travel,
                    const ProgrammedHeights& heights, double units_per_mm) {
  StepGuess guess;
  const bool too_large =
      fit.x.over > kTooLarge_mm || fit.y.over > kTooLarge_mm || fit.z.over > kTooLarge_mm;
  if (units_per_mm == kCoarse && too_large) {
    guess.work = fit;
    const bool fits = Shrinks(guess.work.x, travel.x) && Shrinks(guess.work.y, travel.y) &&
                      Shrinks(guess.work.z, travel.z);
    if (fits) guess.fits_at = kFine;
  }
  const bool round_there =
      heights.grain % kTwentiethOfCoarse == 0 && heights.grain % kTwentiethOfFine != 0;
  const double lift = heights.extent.high;
  const bool low = lift >= kLeastLift && lift <= (round_there ? kMostRoundLift : kMostLift);
  if (units_per_mm == kFine && fit.x.known && low) {
    guess.lift_mm = lift / kFine;
    guess.lift_there_mm = lift / kCoarse;
  }
  return guess;
}

}  // namespace rmlcell::rml1
