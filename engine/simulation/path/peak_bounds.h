#pragma once

#include "engine/simulation/path/motion_peaks.h"

// How high the peaks of a motion can be at most, from what its path and its speed profile are made
// of: far cheaper than to look for them.
namespace rmlcell::simulation {

// Whether PeaksOf of that motion between the times, during which it rides the part of `shape`, is
// certainly nowhere above `known`. False says nothing. A bend of a steady head and an arc are
// judged by their curvature; a head that turns by the derivatives of the axes in the middle of
// pieces, and by how much they can change within them.
bool StaysWithin(const MotionPeaks& known, const motion::PlannedMotion& motion, PartShape& shape,
                 bool five_axis, double from_s, double to_s);

}  // namespace rmlcell::simulation
