#include "engine/optimo/machine/beam.h"

namespace rmlcell::optimo {

// The shutter opens for the beam, and that of an EFA-51 closes behind it.
Beam Beam::At(BeamStage stage) const {
  Beam next = *this;
  next.stage_ = stage;
  if (next.on()) {
    next.shutter_ = Shutter::kOpen;
  } else if (on() && laser_ == Laser::kEfa51) {
    next.shutter_ = Shutter::kClosed;
  }
  return next;
}

Beam Beam::WithPower(const machine::PowerBySpeed& power) const {
  Beam next = *this;
  next.power_ = power;
  return next;
}

Beam Beam::On(const machine::PowerBySpeed& power) const {
  return WithPower(power).At(door_open_ ? BeamStage::kHeld : BeamStage::kOn);
}

Beam Beam::Off() const { return At(BeamStage::kOff); }
Beam Beam::Taken() const { return At(BeamStage::kTaken); }
Beam Beam::Held() const { return on() ? At(BeamStage::kHeld) : *this; }

Beam Beam::DoorOpened() const {
  Beam next = Held();
  next.door_open_ = true;
  if (next.shutter_open()) next.shutter_ = Shutter::kClosedByDoor;
  return next;
}

Beam Beam::DoorClosed() const {
  Beam next = *this;
  next.door_open_ = false;
  return next;
}

Beam Beam::Returned() const {
  if (door_open_) return *this;
  Beam next = *this;
  if (shutter_ == Shutter::kClosedByDoor) next.shutter_ = Shutter::kOpen;
  return stage_ == BeamStage::kHeld ? next.At(BeamStage::kOn) : next;
}

Beam Beam::ShutDown() const {
  Beam next = At(BeamStage::kOff);
  next.shutter_ = Shutter::kClosed;
  return next;
}

}  // namespace rmlcell::optimo
