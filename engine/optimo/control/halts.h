#pragma once

#include <optional>
#include <string_view>

#include "engine/optimo/control/actuators.h"
#include "engine/optimo/control/waits.h"
#include "engine/optimo/control/works.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

// What is to halt the run before its next instruction. All may be wanted at once: a halt ends HOLD
// and STOP, and that after a step comes first.
struct HaltRequests {
  bool hold = false;  // HOLD; a MOVE that is carried out meanwhile is exact. OPT-4.17
  bool stop = false;  // STOP on a motion that could not be left when the key was pressed
  std::string_view after_step{};  // SINGLE or BREAK, when the step is over; empty: none
  std::optional<machine::ProgramStep> breakpoint{};  // of BREAK, which stays when met. OPT-6.08

  // BREAK is set at this step.
  bool breaks_at(const machine::Place& place) const {
    return breakpoint && breakpoint->program == place.program && breakpoint->step == place.step;
  }
};

struct HaltState {
  HaltRequests requests{};
  SimTime halted_at{0};
  // Where the program had run ahead to when HOLD or STOP halted the motion; while halted.
  std::optional<machine::Place> place_ahead{};
};

// Halts of the run, where time stands for the program and the beam is off, until START.
//
//   RunPhase::kRunning   Halt, HaltOnPath   kHalted
//   RunPhase::kHalted    Resume             kRunning
class Halts {
 public:
  Halts(HaltState& state, Situation& situation, const Telling& telling, Ride& ride,
        Actuators& actuators, Waits& waits, Works& works)
      : s_(state),
        situation_(situation),
        telling_(telling),
        ride_(ride),
        actuators_(actuators),
        waits_(waits),
        works_(works) {}

  HaltRequests& requests() { return s_.requests; }
  const HaltRequests& requests() const { return s_.requests; }
  // The run is to halt before the next instruction; one whose condition is met is finished before a
  // HOLD (OPT-4.17), and a motion that may be held back before a STOP.
  bool due() const;

  // HOLD: the ride ends at a target, or the run halts before the next instruction.
  void Hold();
  // STOP: at once, or as soon as the machine can come to rest. A HOLD that is still on its way to
  // the target is overtaken, a STOP is not.
  void Stop();
  // The step that was begun here is over: SINGLE or BREAK may halt behind it.
  void EndStep(const machine::Place& place);

  void Halt(std::string_view why);
  // The motions are at rest, and go on at START: the halt belongs to the move that was under way.
  void HaltOnPath();
  // The halt up to now: the operator is waited for.
  void Tell() const;
  // START. The door was looked at.
  void Resume();

 private:
  HaltState& s_;
  Situation& situation_;
  const Telling& telling_;
  Ride& ride_;
  Actuators& actuators_;
  Waits& waits_;
  Works& works_;
};

}  // namespace rmlcell::optimo
