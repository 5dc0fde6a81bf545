#pragma once

#include "engine/machine/observer.h"
#include "engine/simulation/report/axis_log.h"
#include "engine/simulation/report/beam_work.h"
#include "engine/simulation/report/corner_log.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// Adds up the figures of one scope, the whole run or one program. Whoever feeds it works out once
// what a motion does, for all the scopes that it belongs to.
class FigureLog {
 public:
  explicit FigureLog(const machine::MachineShape& shape) : axes_(shape) {}

  struct Motion {
    const machine::MotionDone& done;
    const AxisLog::Motion& axes;
    const machine::Box& tip;
    const machine::Box& column;
    bool cuts = false;
    const std::optional<SlowMove>& slow;
  };
  void Add(const Motion& motion);
  MotionPeaks Known(bool tip_limited) const { return axes_.Known(tip_limited); }
  void AddProgrammed(const motion::ProgramPoint& point) { programmed_.Add(point); }

  // All but the times of the beam.
  void TakeFigures(const FigureLog& other);

  BeamTimes& beam() { return beam_; }
  const BeamTimes& beam() const { return beam_; }

  // Everything but the work, which is its own table. `beam_on` is the sum of the beam's histograms.
  void WriteTo(ScopeFigures& figures, SimTime beam_on) const;

 private:
  AxisLog axes_;
  BeamTimes beam_;
  CornerLog corners_;
  SpeedShortfall shortfall_;
  machine::ProgramBox programmed_;
  machine::Box tip_;
  machine::Box cut_;
  machine::Box column_;
};

}  // namespace rmlcell::simulation
