#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "engine/motion/geometry/corner_table.h"
#include "engine/motion/kinematics/machine_limits.h"
#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion {

// How fast the curve between two lines may be passed from place to place, at equal steps of its arc
// length from the start to the middle; the second half is its mirror image. motion.md 4.3, 5.4.
struct BendSpeeds {
  static constexpr std::size_t kSteps = HalfCorner::kSteps;
  std::array<double, kSteps + 1> most;
};

// The stretches in which a bend is passed that cannot be passed at OVERSH x Vb: the whole of it, or
// its halves where it is tightest in the middle. A stretch may be passed by any ramp between speeds
// allowed at its start and its end, with acceleration zero at both and `open` on the way: that
// keeps the speeds of the bend all along. Without a limit on jerk there are kAbrupt of equal
// length, each with a speed of its own that any ramp within it may reach.
struct BendStretches {
  static constexpr std::size_t kAbrupt = 6;
  std::size_t count = 1;
  double start = 0.0;   // highest speed at the start of the bend, and at its end
  double open = 0.0;    // on the way
  double middle = 0.0;  // of more than one: where the halves meet
};

// The highest speed on each of kAbrupt stretches.
std::array<double, BendStretches::kAbrupt> AbruptSpeeds(const BendSpeeds& speeds);

// `limits` are those of the ramps (their speed does not count).
BendStretches StretchesOf(const BendSpeeds& speeds, double half_length_mm,
                          const PathLimits& limits);

// Whether all ramps to `to` that begin at `fastest` or slower keep below the speeds `most` at equal
// steps of `step_mm`, by bounds: no is only a maybe. Precondition: fastest <= most.front().
bool RampsFitByBounds(std::span<const double> most, double step_mm, double jerk, double fastest,
                      double to);

}  // namespace rmlcell::motion
