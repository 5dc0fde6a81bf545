#pragma once

#include <cstdint>
#include <optional>

#include "engine/core/result.h"
#include "engine/optimo/control/actuators.h"
#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/move_watch.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/control/waits.h"
#include "engine/optimo/control/works.h"
#include "engine/optimo/machine/telling.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

struct AlarmState {
  struct Raised {
    Error error;
    machine::Place place;
  };
  std::optional<Raised> deferred{};  // ahead of motion: handled when it is over
};

// Errors of instructions: the failing one has no effect, whatever moves comes to rest, the beam
// goes off, and the program goes on at its ERR label or is over. OPT-3.55 to 3.59
//
//   none       Raise           handled, where the machine stands; else deferred, and the control
//                              waits for standstill: at once, but for motions that the program
//                              has run ahead of
//   deferred   Raise           stays: the first error counts
//   deferred   HandleDeferred  handled
class Alarms {
 public:
  Alarms(AlarmState& state, Situation& situation, const Telling& telling, ProgramCounter& counter,
         Ride& ride, Actuators& actuators, DataAccess& data, Waits& waits, MoveWatch& watch,
         Works& works)
      : s_(state),
        situation_(situation),
        telling_(telling),
        counter_(counter),
        ride_(ride),
        actuators_(actuators),
        data_(data),
        waits_(waits),
        watch_(watch),
        works_(works) {}

  bool deferred() const { return s_.deferred.has_value(); }

  // Of the instruction in execution, which may have run ahead of /FLY motions, or of what goes on
  // while the machine moves.
  enum class Where : std::uint8_t { kInstruction, kBesideTheMotion };

  // At the place of the situation. Error: the one that ends the run; good when it goes on.
  Status Raise(const Error& error, Where where);
  Status HandleDeferred();

 private:
  Status Handle(const Error& error);
  void TellNoHandler(const Error& error);

  AlarmState& s_;
  Situation& situation_;
  const Telling& telling_;
  ProgramCounter& counter_;
  Ride& ride_;
  Actuators& actuators_;
  DataAccess& data_;
  Waits& waits_;
  MoveWatch& watch_;
  Works& works_;
};

}  // namespace rmlcell::optimo
