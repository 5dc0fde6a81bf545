#pragma once

#include <array>
#include <cstddef>

#include "engine/machine/observer.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// How near a contour keeps to the speed and to the energy by length that are asked of it. It is
// shown the contour in stretches, in order.
class CutPace {
 public:
  // The motion that the next stretches belong to. `programmed_mm_s` 0: no speed is asked for.
  void Begin(double programmed_mm_s, const machine::PowerBySpeed& power,
             const machine::Place& place);

  // Tip speeds at which a stretch must end: on one side it is slow, hot or weak. 0: no such speed.
  static constexpr std::size_t kBounds = 3;
  const std::array<double, kBounds>& bounds() const { return bounds_; }

  // `tip_speed` and `power_percent` are means.
  void Add(double duration_s, double tip_speed, double power_percent);

  // Of the contour.
  double slow_mm() const { return slow_mm_; }
  double programmed_max_mm_s() const { return programmed_max_; }
  // The contour is over: its stretches, and its way without a speed, go to `figures`.
  void Close(CutFigures& figures);

 private:
  // A stretch that goes on over motions, and the longest so far.
  struct Stretch {
    double mm = 0.0;
    machine::Place place{};
    Extreme longest{};

    void Go(bool on, double way_mm, const machine::Place& where);
    void End();
  };

  double programmed_ = 0.0;
  double asked_ = 0.0;  // percent of power by mm/s: with the rated power the energy by length
  bool ramped_ = false;
  machine::Place place_;
  std::array<double, kBounds> bounds_{};

  double slow_mm_ = 0.0;
  double programmed_max_ = 0.0;
  double uncontrolled_mm_ = 0.0;
  machine::Place uncontrolled_place_;
  Stretch hot_;
  Stretch weak_;
};

}  // namespace rmlcell::simulation
