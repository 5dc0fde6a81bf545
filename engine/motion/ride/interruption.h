#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/motion/planner/planner.h"

namespace rmlcell::motion {

// Whether SpeedProfile::From gets from `state` to `v1` at `end_s` without breaking `limits`. False
// above all while braking for `end_s`: what is left is then too short for anything but to go on.
bool FromFits(const PathState& state, double end_s, double v1, const PathLimits& limits);

// Whether the axes can do what the motions on bends among these ask of them. All others keep the
// limits of motion.md 5.1, which leave room for ramps anywhere.
bool AxesCan(std::span<const PlannedMotion> motions, const AxisLimits& axes);

// What becomes of planned motions when the machine is stopped on its way. motion.md section 6.
struct StopOnPath {
  std::vector<PlannedMotion> motions;  // from the instant of the STOP to rest; no settling
  std::size_t index = 0;               // the machine rests on this one of `ahead`
  double s = 0.0;                      // at this place of its path
  bool complete = true;                // false: `ahead` ends before the machine stands
};

// The ramp to rest along the planned path that begins at `t_s` of ahead[0]: at once, with the
// limits of the motions that it touches. Only in a bend where the axes have nothing left to brake
// with, because the head turns, does it brake more gently or behind the bend.
// Precondition: ahead is not empty.
StopOnPath StopAlong(std::span<const PlannedMotion> ahead, double t_s, const AxisLimits& axes);

// The motions that lead from rest at the place `s` of ahead[0] over the same path. Speeds at knots
// are those planned, as soon as they can be reached again; in a bend where the axes would be asked
// for too much that way, lower ones. Precondition: ahead is not empty.
std::vector<PlannedMotion> RestartAlong(std::span<const PlannedMotion> ahead, double s,
                                        const AxisLimits& axes);

}  // namespace rmlcell::motion
