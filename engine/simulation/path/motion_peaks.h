#pragma once

#include "engine/motion/planner/planner.h"
#include "engine/simulation/path/part_shape.h"

namespace rmlcell::simulation {

// The highest speeds and accelerations during a motion: mm and s, rad and s.
struct MotionPeaks {
  double tip_speed = 0.0;
  double tip_acceleration = 0.0;
  motion::AxisValues axis_speed{};
  motion::AxisValues axis_acceleration{};
  double tip_jerk = 0.0;  // within the phases: steps of the acceleration between them do not count
  motion::AxisValues axis_jerk{};

  void Raise(const MotionPeaks& other);  // each to the higher one
};

// Between two times of the motion's speed profile. Exact where the tip goes straight and no axis
// turns; on curves from samples at most kPeakSampleAngle_rad apart, so at most 0.2 % too low; jerks
// there are means between two samples. `five_axis` as in machine::MachineShape: otherwise the tip
// is what the axes move.
inline constexpr double kPeakSampleAngle_rad = 0.05;
// `shape` is the part that is ridden between the times.
MotionPeaks PeaksOf(const motion::PlannedMotion& motion, PartShape& shape, bool five_axis,
                    double from_s, double to_s);

// The same for who wants to know what is above `known` alone: where nothing can be, by bounds that
// cost little (peak_bounds.h), all of it is 0. `shape` is the part that is ridden between the
// times.
MotionPeaks PeaksBeyond(const MotionPeaks& known, const motion::PlannedMotion& motion,
                        PartShape& shape, bool five_axis, double from_s, double to_s);

}  // namespace rmlcell::simulation
