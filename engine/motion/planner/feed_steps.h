#pragma once

namespace rmlcell::motion {

// The speeds that a mill's control knows: a range, with fine steps below `coarse_from_mm_s` and
// coarse ones from there on. motion.md section 7; the figures are those of its motion test profile.
struct FeedSteps {
  double minimum_mm_s = 0.5;
  double maximum_mm_s = 15.0;
  double fine_step_mm_s = 0.1;
  double coarse_step_mm_s = 1.0;
  double coarse_from_mm_s = 1.0;

  // The wanted speed clamped to the range, then rounded down to a step. Not a number: the slowest.
  double Nearest(double wanted_mm_s) const;
};

}  // namespace rmlcell::motion
