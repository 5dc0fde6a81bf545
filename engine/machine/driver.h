#pragma once

#include "engine/core/result.h"
#include "engine/machine/machine.h"

namespace rmlcell::machine {

// Where the positions of a machine come from. LIVE-3.16, DEV-1.70
enum class PositionSource {
  kPlanned,    // a virtual machine: where it is
  kReported,   // it says so itself
  kEstimated,  // followed from what was sent, within its bounds
  kBounded,    // as kEstimated, and no bound is known to be narrower
};

// What whoever drives a machine may ask of it; what it does not take is refused with CellNotLive.
struct DriverCapabilities {
  PositionSource positions = PositionSource::kPlanned;
  bool override_on_the_way = true;
  bool emergency_stop = true;
  bool inputs = true;  // IL, IA, the door
  bool variables = true;
  bool breakpoints = true;
  bool any_factor = true;  // its time may go slower and faster than the clock

  bool operator==(const DriverCapabilities&) const = default;
};

// What the host of a machine moves: a virtual machine, or a link to a real one. It has no clock and
// starts no thread: times are those of the host's steady clock, from any zero, never falling. One
// thread at a time.
class MachineDriver {
 public:
  virtual ~MachineDriver() = default;

  virtual DriverCapabilities capabilities() const = 0;

  // Begins a run, at this time. Errors: as Machine::Apply.
  virtual Status Start(SimTime clock, const StartRun& run) = 0;
  // Any other input, at this time. Errors: as Machine::Apply.
  virtual Status Order(SimTime clock, const MachineInput& input) = 0;
  // Goes on to this time. kMoreWork: it is behind it, and is to be called again when inputs were
  // looked at.
  virtual Progress Pump(SimTime clock) = 0;

  virtual MachineStatus status() const = 0;
};

}  // namespace rmlcell::machine
