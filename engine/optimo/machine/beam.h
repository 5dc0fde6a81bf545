#pragma once

#include <cstdint>

#include "engine/machine/observer.h"
#include "engine/optimo/machine/optimo_parameters.h"

namespace rmlcell::optimo {

// What becomes of the beam where the tip is.
enum class BeamStage : std::uint8_t {
  kOff,  // no process asks for it
  kOn,
  kTaken,  // WORK 0 or 1 is ON, but the /OFF of another process took the beam away. OPT-3.24
  kHeld,   // WORK 0 or 1 is ON, but motion is held or the door open: START brings it. OPT-B.34
};

enum class Shutter : std::uint8_t {
  kClosed,
  kOpen,
  kClosedByDoor,  // START opens it again. OPT-3.62
};

// Beam, shutter and the operator door of a laser: a value. Each of the functions below says what
// the three are once that has happened; who carries it out tells of the difference (actuators.h).
//
//   stage           On        Off    Taken    Held    DoorOpened      Returned   ShutDown
//   kOff            kOn *     -      kTaken   -       -               -          -
//   kOn             -         kOff   kTaken   kHeld   kHeld           -          kOff
//   kTaken          kOn *     kOff   -        -       -               -          kOff
//   kHeld           kOn *     kOff   kTaken   -       -               kOn **     kOff
//
//   shutter         On        the beam goes off       DoorOpened      Returned   ShutDown
//   kClosed         kOpen *   -                       -               - ***      -
//   kOpen           -         -; of an EFA-51         kClosedByDoor   -          kClosed
//                             kClosed (OPT-3.15)
//   kClosedByDoor   kOpen *   -                       -               kOpen **   kClosed
//
// "-": stays. * While the door is open the shutter stays, and the stage is kHeld. ** Stays while
// the door is open. *** kOpen where the beam comes back.
//
// So the beam is on behind an open shutter only, the shutter is open behind a closed door only, and
// of an EFA-51 only while the beam is on.
class Beam {
 public:
  explicit Beam(Laser laser) : laser_(laser) {}

  BeamStage stage() const { return stage_; }
  Shutter shutter() const { return shutter_; }
  bool on() const { return stage_ == BeamStage::kOn; }
  // WORK 0 or 1 is ON where the tip is, whatever took the beam away.
  bool asked() const { return stage_ != BeamStage::kOff; }
  bool shutter_open() const { return shutter_ == Shutter::kOpen; }
  bool door_open() const { return door_open_; }
  // START would bring the beam back or open the shutter.
  bool waits_for_start() const {
    return stage_ == BeamStage::kHeld || shutter_ == Shutter::kClosedByDoor;
  }
  // While it is on, and when it comes back.
  const machine::PowerBySpeed& power() const { return power_; }

  // WORK 0 or 1 ON. One that the door should have refused (OPT-3.19) is passed on the way to rest.
  Beam On(const machine::PowerBySpeed& power) const;
  Beam Off() const;         // the last of them OFF; an error
  Beam Taken() const;       // a process OFF, and another of them is ON
  Beam Held() const;        // the motion is held
  Beam DoorOpened() const;  // OPT-3.17
  Beam DoorClosed() const;
  Beam Returned() const;  // START. OPT-3.62
  Beam ShutDown() const;  // the end of a program or of the run. OPT-3.16, OPT-3.18
  // The end of a pierce.
  Beam WithPower(const machine::PowerBySpeed& power) const;

  friend bool operator==(const Beam&, const Beam&) = default;

 private:
  Beam At(BeamStage stage) const;

  Laser laser_;
  BeamStage stage_ = BeamStage::kOff;
  Shutter shutter_ = Shutter::kClosed;
  bool door_open_ = false;
  machine::PowerBySpeed power_{};
};

}  // namespace rmlcell::optimo
