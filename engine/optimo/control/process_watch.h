#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/machine/family.h"
#include "engine/machine/observer.h"
#include "engine/optimo/control/actuators.h"

namespace rmlcell::optimo {

// Way or count of something that should not be, and the first place of it.
struct Misdeed {
  double amount = 0.0;
  machine::Place first{};

  void Add(double more, const machine::Place& place) {
    if (!(amount > 0.0)) first = place;
    amount += more;
  }
};

struct ProcessWatchState {
  Misdeed shutter_closed;
  Misdeed beam_off;
  Misdeed no_power;
  Misdeed gas_refused;
  Misdeed left_on;
};

// Whether the machine does along the contours (PATH LIN, CIR, HOLE) what the processes that are ON
// ask of it. A dry run up to a step asks for nothing: behind it the beam is off until the next WORK
// ON, and nobody expects it (OPT-6.20, OPT-6.21).
class ProcessWatch {
 public:
  ProcessWatch(ProcessWatchState& state, const ActuatorState& actuators)
      : s_(state), actuators_(actuators) {}

  // A motion was told, or a part of one.
  void OnMotion(const machine::MotionDone& done);
  // A program ends at this place with WORK 0 or 1 ON.
  void OnLeftOn(const machine::Place& place) { s_.left_on.Add(1.0, place); }

  std::vector<machine::Figure> figures() const;
  // What they mean, and by which of them a run is judged.
  static std::span<const machine::FigureInfo> FigureTable();
  static std::span<const machine::VerdictRule> VerdictRules();

 private:
  ProcessWatchState& s_;
  const ActuatorState& actuators_;
};

}  // namespace rmlcell::optimo
