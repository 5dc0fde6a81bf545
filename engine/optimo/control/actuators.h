#pragma once

#include "engine/machine/run.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "engine/optimo/machine/situation.h"
#include "engine/optimo/machine/telling.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

inline constexpr int kGas2 = 8;  // OL numbers, OPT-5.39
inline constexpr int kGas3 = 9;

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

// What the control switches: beam and shutter, assist gas and outputs, laser schedule, rotary
// table. It acts now; what it is asked for when it stands so already changes nothing.
//
//             shutter   beam
//   BeamOn    opens     on        its power is another one when it is on already
//   BeamOff   -         off       with the EFA-51 the shutter closes, too (OPT-3.15)
//   Suspend   as BeamOff         until Restore: held, stopped, door open (OPT-B.34)
class Actuators {
 public:
  Actuators(Situation& situation, const OptimoParameters& parameters,
            const machine::RunSetup& setup, const Telling& telling, Ride& ride)
      : situation_(situation),
        parameters_(parameters),
        setup_(setup),
        telling_(telling),
        ride_(ride) {}

  // Told at the step that asked for it: the program may have run ahead of the passage.
  void Carry(const PassageEffect& effect);

  void BeamOn(const machine::PowerBySpeed& power);
  // No process asks for it any more.
  void BeamOff();
  void CloseShutter();
  // The beam, while motion is held: START brings it back.
  void Suspend();
  // The door: what is open closes behind it, until Restore. OPT-3.17, OPT-3.62
  void CloseForDoor();
  // Whether START would open the shutter or bring the beam back: not while the door is open.
  bool wants_restore() const { return situation_.beam.returns || situation_.beam.shutter_was_open; }
  void Restore();
  // The run is over, whatever the reason. OPT-3.16, 3.18, B.54
  void AllOff();

  // Of the laser schedule in force, in percent.
  double SchedulePower() const;
  // Whether the machine has this laser schedule.
  bool HasSchedule(int number) const;

 private:
  void Take(const PassageEffect& effect);
  void SetOutput(int index, double value);
  void OpenShutter();
  void Darken();
  void TellZeroed(int group);

  Situation& situation_;
  const OptimoParameters& parameters_;
  const machine::RunSetup& setup_;
  const Telling& telling_;
  Ride& ride_;
};

}  // namespace rmlcell::optimo
