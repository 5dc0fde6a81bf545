#pragma once

#include <array>

#include "engine/core/units.h"
#include "engine/machine/observer.h"
#include "engine/motion/ride/trajectory.h"
#include "engine/simulation/report/cut_pace.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// How long a beam is on at which speed and power.
struct BeamTimes {
  std::array<motion::LongSum, kSpeedBins> by_speed{};
  std::array<motion::LongSum, kPowerBins> by_power{};

  // The times by class, in whole nanoseconds that add up to `beam_on`.
  BeamHistogram Histogram(SimTime beam_on) const;
};

// What a beam does over time: energy, and how long it was on at which speed and power.
// motion.md 8.1, 8.2.
class BeamWork {
 public:
  // `tip_speed_max_mm_s` is the 100 % of the speed classes; 0: not known, everything counts as 0.
  BeamWork(double laser_watts, double tip_speed_max_mm_s)
      : watts_(laser_watts), speed_max_(tip_speed_max_mm_s) {}

  // A motion with the beam on, between two times of its speed profile. `tip_per_s` is what the tip
  // moves per unit of that s: 1, or 0 where it stands (A and B turn), or the tip's length of a
  // sigma piece. Exact also where the power saturates on the way. Returns the energy in J. `pace`
  // is shown the stretches of the motion in order; null: nobody looks.
  double Moving(const motion::SpeedProfile& profile, double from_s, double to_s, double tip_per_s,
                const machine::PowerBySpeed& power, CutPace* pace = nullptr);

  // The beam on a standing tip. Returns the energy in J.
  double Standing(double duration_s, double power_percent);

  // Whose times what follows is counted in, besides the whole; null: nobody's.
  void AlsoInto(BeamTimes* times) { also_ = times; }

  BeamHistogram Histogram(SimTime beam_on) const { return all_.Histogram(beam_on); }

 private:
  void Count(double duration_s, double tip_speed, double power_percent);

  double watts_;
  double speed_max_;
  BeamTimes all_;
  BeamTimes* also_ = nullptr;
};

}  // namespace rmlcell::simulation
