#pragma once

#include <optional>

#include "engine/core/units.h"
#include "engine/machine/machine_status.h"
#include "engine/motion/geometry/pose.h"

namespace rmlcell::machine {

// A way that a key sends the machine, to its end or until it has to brake. How the caller divides
// time changes nothing.
class HandWay {
 public:
  virtual ~HandWay() = default;

  virtual void Advance(SimTime until) = 0;
  virtual void Brake() = 0;  // on the way, where it was advanced to; nothing follows

  virtual bool rests() const = 0;
  virtual bool brakes() const = 0;
  virtual motion::AxisPose axes() const = 0;
  virtual double tip_speed_mm_s() const = 0;

  // Of HOME and ZERO: which of them, at another override, and whether the axes have their
  // reference.
  virtual std::optional<HandRun> what() const { return {}; }
  virtual void ChangeOverride(double /*percent*/) {}
  virtual bool zeroed() const { return false; }
};

}  // namespace rmlcell::machine
