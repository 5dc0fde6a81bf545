#pragma once

#include <array>
#include <string_view>

#include "engine/machine/shape.h"
#include "engine/motion/ride/trajectory.h"
#include "engine/simulation/path/motion_peaks.h"
#include "engine/simulation/path/path_extent.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// 0..4: "X" "Y" "Z" "A" "B".
std::string_view AxisName(int axis);
bool IsRotaryAxis(int axis);

// What each axis did over a run: travel, range, reversals, peaks.
class AxisLog {
 public:
  explicit AxisLog(const machine::MachineShape& shape) : shape_(shape) {}

  struct Motion {
    const PointSweep& xyz;  // of the column of a gantry, else of the tip
    const std::array<CoordinateSweep, 2>& ab;
    const MotionPeaks& peaks;
    double tip_path_mm = 0.0;
    bool tip_limited = true;  // PTP of a gantry is not: there only the axes count (motion.md 3.5)
  };
  void Add(const Motion& motion);

  // The highest of what was added; a motion that stays within them need not be looked at for its
  // own. Those of the tip are the ones that `tip_limited` motions have reached, if that is one.
  MotionPeaks Known(bool tip_limited) const;

  // Writes axes, tip_figures and the range of the axes. A rotary axis that a mill never turned is
  // left out.
  void WriteTo(ScopeFigures& figures) const;

 private:
  struct Axis {
    bool seen = false;
    double minimum = 0.0;
    double maximum = 0.0;
    motion::LongSum travel;
    int last_sign = 0;
    std::uint64_t reversals = 0;
  };
  void AddSweep(Axis& axis, const CoordinateSweep& sweep);

  machine::MachineShape shape_;
  std::array<Axis, motion::kAxisCount> axes_{};
  motion::LongSum tip_path_;
  MotionPeaks peaks_;
  // The same of motions in which the tip has limits: a peak above them has no share of one.
  double limited_peak_speed_ = 0.0;
  double limited_peak_acceleration_ = 0.0;
};

}  // namespace rmlcell::simulation
