#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/machine/run.h"
#include "engine/motion/geometry/path.h"
#include "engine/motion/kinematics/kinematics.h"
#include "engine/motion/planner/planner.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "engine/optimo/machine/situation.h"
#include "engine/optimo/machine/telling.h"

// Motions that ask more of an axis than it can do: way or speed.
namespace rmlcell::optimo {

// An axis that a motion takes out of its travel.
struct BeyondTravel {
  int axis = 0;
  double excess = 0.0;  // the worst of the motion, mm or rad
  bool at_target = false;
  bool by_work_offset = false;  // of a MOVE in COORD ABSOL: SYSDEF shifts it
  motion::AxisPose axes{};      // where it is worst
};

struct TravelState {
  // A forecast: the first motion that leaves the travel, and how many do.
  std::optional<Diagnostic> first_violation{};
  std::uint64_t violations = 0;
  std::set<std::pair<int, int>> held_by_axis{};  // program and step, told already
};

// The travel of the axes. In a forecast (RunSetup::forecast) a motion that leaves it is told when
// it begins, and the run goes on; else it is an alarm before it begins. motion.md 2.6, OPT-B.08
class Travel {
 public:
  Travel(TravelState& state, const Situation& situation, const OptimoParameters& parameters,
         const Telling& telling, bool forecast)
      : s_(state),
        situation_(situation),
        parameters_(parameters),
        telling_(telling),
        forecast_(forecast) {}

  // Of a motion that begins at this place of a program: what is to be told when it does, in a
  // forecast. Errors: TargetOutOfTravel, told with its axes.
  Result<std::vector<BeyondTravel>> Look(const motion::PathPiece& path,
                                         const machine::Place& place);

  // By what the motion leaves the travel. Nobody is told.
  std::vector<BeyondTravel> BeyondTravelOf(const motion::PathPiece& path) const;

  // Now: where the motion begins, or where it is refused.
  void TellViolations(const machine::Place& place, const std::vector<BeyondTravel>& beyond);

  // OPT-2.16: the contour that begins slows down for an axis. Once for each step.
  void TellSpeedHeld(const motion::PlannedMotion& motion, const machine::Place& place,
                     double feed_mm_s);

  // A forecast that found violations has not shown a program that the machine could run.
  void Judge(machine::Outcome& outcome) const;

 private:
  TravelState& s_;
  const Situation& situation_;
  const OptimoParameters& parameters_;
  const Telling& telling_;
  const bool forecast_;
};

}  // namespace rmlcell::optimo
