#pragma once

#include <bitset>
#include <cstddef>

#include "engine/simulation/path/motion_peaks.h"

// How high the peaks of a motion can be at most, from what its path and its speed profile are made
// of: far cheaper than to look for them.
namespace rmlcell::simulation {

// Stretches of a ride in which something may be above what is known: each phase of the speed
// profile that is ridden, in order, in slices of even time.
class OpenSlices {
 public:
  static constexpr std::size_t kOfPhase = 8;

  static OpenSlices None() { return OpenSlices(false); }
  static OpenSlices All() { return OpenSlices(true); }

  bool any() const { return rest_ || open_.any(); }
  void Open(std::size_t phase, std::size_t slice) {
    if (phase < kPhases) open_.set(phase * kOfPhase + slice);
    if (phase >= kPhases) rest_ = true;
  }
  bool IsOpen(std::size_t phase, std::size_t slice) const {
    return phase < kPhases ? open_.test(phase * kOfPhase + slice) : rest_;
  }

 private:
  static constexpr std::size_t kPhases = 16;  // of those behind, all are open or none
  explicit OpenSlices(bool all) : rest_(all) {
    if (all) open_.set();
  }
  std::bitset<kPhases * kOfPhase> open_;
  bool rest_;
};

// Where PeaksOf of that motion between the times, during which it rides the part of `shape`, may be
// above `known`; it is certainly not elsewhere. A bend of a steady head and an arc are judged by
// their curvature, as a whole; a head that turns by the derivatives of the axes in the middle of
// pieces, and by how much they can change within them.
OpenSlices MayExceed(const MotionPeaks& known, const motion::PlannedMotion& motion,
                     PartShape& shape, bool five_axis, double from_s, double to_s);

}  // namespace rmlcell::simulation
