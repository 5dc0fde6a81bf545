#pragma once

#include "engine/machine/run.h"
#include "engine/optimo/machine/beam.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "engine/optimo/machine/situation.h"
#include "engine/optimo/machine/telling.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

// Something visible that an actuator does. Of a program that has run ahead it happens between two
// motions (passage_effects.h).
struct PassageEffect {
  // kZeroed: a group of axes stands at its mechanical zero; `index` says which.
  enum class Kind { kOutput, kAnalogue, kBeamOn, kBeamOff, kSchedule, kTable, kZeroed };
  Kind kind = Kind::kOutput;
  machine::Place place{};
  int index = 0;
  double value = 0.0;  // kBeamOff: 1 where WORK 0 or 1 is ON all the same
  machine::PowerBySpeed power{};
};

struct ActuatorState {
  explicit ActuatorState(Laser laser) : beam(laser) {}

  Beam beam;
  Outputs outputs{};
  int gas_refused = 0;  // OL of the assist gas that was switched on last and is refused, OPT-5.40
  bool zeroed = true;   // every group of axes has stood at its mechanical zero, OPT-4.48
};

// What the control switches: beam and shutter (beam.h has what leads from one to the next), assist
// gas and outputs, laser schedule, rotary table. It acts now, and tells what has changed; what it
// is asked for when it stands so already changes nothing.
class Actuators {
 public:
  Actuators(ActuatorState& state, Situation& situation, const OptimoParameters& parameters,
            const machine::RunSetup& setup, const Telling& telling, Ride& ride)
      : s_(state),
        situation_(situation),
        parameters_(parameters),
        setup_(setup),
        telling_(telling),
        ride_(ride) {}

  // Told at the step that asked for it: the program may have run ahead of the passage.
  void Carry(const PassageEffect& effect);

  void BeamOn(const machine::PowerBySpeed& power);
  // No process asks for it any more.
  void BeamOff();
  // Precondition: what of a wait or a motion had the old power is told.
  void ChangePower(const machine::PowerBySpeed& power);
  // Motion is held: the beam is off until Return.
  void Hold();
  // Of the operator. What an open door switches off is told where the machine is.
  void MoveDoor(bool open);
  bool beam_on() const { return s_.beam.on(); }
  bool door_open() const { return s_.beam.door_open(); }
  // START is an alarm: the door is open, and the beam or the shutter waits for it. OPT-B.56
  bool door_blocks_start() const { return door_open() && s_.beam.waits_for_start(); }
  void Return();
  // A main program, or the run, is over, whatever the reason. OPT-3.16, 3.18, B.54
  void ShutDown();

  // Of the laser schedule in force, in percent.
  double SchedulePower() const;
  // Whether the machine has this laser schedule.
  bool HasSchedule(int number) const;

 private:
  void Take(const PassageEffect& effect);
  void Become(const Beam& next);
  void SetOutput(int index, double value);
  void TellZeroed(int group);

  ActuatorState& s_;
  Situation& situation_;
  const OptimoParameters& parameters_;
  const machine::RunSetup& setup_;
  const Telling& telling_;
  Ride& ride_;
};

}  // namespace rmlcell::optimo
