#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/optimo/control/actuators.h"
#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/move_watch.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/control/waits.h"
#include "engine/optimo/control/works.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

// What halts the run behind the step that was carried out last.
enum class AfterStep : std::uint8_t {
  kNone,
  kSingle,   // the mode. OPT-6.31
  kBreak,    // the breakpoint stands at it. OPT-6.08
  kWatched,  // somebody who watches wants it
};

// A breakpoint of somebody who watches the run.
struct WatchedStep {
  machine::Breakpoint breakpoint{};
  std::optional<Condition> condition{};  // as it is read; none: always
  std::uint64_t passes = 0;              // how often the step was begun with the condition met

  bool due() const { return passes >= breakpoint.from_pass; }
};

struct HaltState {
  // Any of the three may be wanted together: the halt after a step comes first.
  bool hold = false;  // HOLD; a MOVE that is carried out meanwhile is exact. OPT-4.17
  bool stop = false;  // STOP on a motion that could not be left when the key was pressed
  AfterStep after_step = AfterStep::kNone;
  std::optional<machine::ProgramStep> breakpoint{};  // of BREAK
  std::vector<WatchedStep> watched{};
  bool watched_halts = false;       // behind the step in execution
  machine::HaltReason halted_by{};  // while halted
  SimTime halted_at{0};
  // Where the program had run ahead to when HOLD or STOP halted the motion; while halted.
  std::optional<machine::Place> place_ahead{};
};

// Halts of the run, where time stands for the program and the beam is off, until START.
//
//   phase      by                                                        next
//   kRunning   Halt, HaltOnPath; HaltHere, StopNow where they say so     kHalted
//   kHalted    Resume                                                    kRunning
//   any        Finish (Control)                                          kFinished, for good
//
//   request      set by                               cleared by
//   hold         Hold; halted: for the next START     any halt
//   stop         Stop, where the motion under way     Stop, StopNow: it can, and comes to rest;
//                cannot be left yet                   any halt
//   after_step   EndStep: kBreak at the breakpoint,   HaltHere, with a halt; without one where the
//                kWatched, else kSingle in SINGLE;    main program is over. Other halts leave it;
//                SetMode and Watch, of what is        SetMode and Watch, of what they set
//                under way
//   breakpoint   SetBreakpoint; what the machine kept never: the next BREAK replaces it. OPT-6.08
//   watched      Watch                                never: the next Watch replaces them
//
// In kFinished nothing is set or cleared.
class Halts {
 public:
  Halts(HaltState& state, Situation& situation, const Telling& telling, Ride& ride,
        Actuators& actuators, ProgramCounter& counter, const DataAccess& data, Waits& waits,
        MoveWatch& watch, Works& works)
      : s_(state),
        situation_(situation),
        telling_(telling),
        ride_(ride),
        actuators_(actuators),
        counter_(counter),
        data_(data),
        waits_(waits),
        watch_(watch),
        works_(works) {}

  // The run is to halt before the next instruction; one whose condition is met is finished before a
  // HOLD (OPT-4.17), and a motion that may be held back before a STOP.
  bool due() const;
  // No step has to do with halts: none is due, and none comes behind whatever step.
  bool idle() const;
  // A STOP waits until more of the motions is planned, or until the one under way is over.
  bool stop_waits() const { return s_.stop; }
  // STOP was pressed, and not START since.
  bool stops() const { return s_.stop || ride_.protocol().intent() == motion::RideIntent::kStop; }
  // The run halts behind the step at this place: nothing may pass its target without a stop.
  bool will_halt_behind(const machine::Place& place) const;

  // HOLD: the ride ends at a target, or the run halts before the next instruction.
  void Hold();
  // STOP: at once, or as soon as the machine can come to rest. A HOLD that is still on its way to
  // the target is overtaken, a STOP is not.
  void Stop();
  // A step begins here: whether somebody who watches wants the run to halt behind it.
  void BeginStep(const machine::Place& place);
  // The step that was begun here is over: SINGLE or a breakpoint may halt behind it.
  void EndStep(const machine::Place& place);
  // BREAK
  void SetBreakpoint(const machine::ProgramStep& step) { s_.breakpoint = step; }
  // One that was there already goes on counting; a new one on a place that was read ahead halts
  // behind what is under way.
  void Watch(std::vector<WatchedStep> steps);
  // SINGLE halts behind the instruction that is under way, and behind each that comes; another mode
  // takes that back.
  void SetMode(machine::Mode mode);

  // Time passed. A STOP that waited brings the machine to rest from here, where it can. True: it
  // stands already, and the run is halted.
  bool StopNow();
  // The machine stands behind the last step. False: the step was the last of the main program, and
  // no halt comes behind it. Precondition: due().
  bool HaltHere(bool program_over);
  void Halt(machine::HaltReason reason, std::string_view why);
  // The motions are at rest, and go on at START: the halt belongs to the move that was under way.
  void HaltOnPath();
  // The halt up to now: the operator is waited for.
  void Tell() const;
  // START. The door was looked at. Errors: of Ride::Resume; the place is that of its move.
  Status Resume();

 private:
  void HaltByKey(bool stop);
  bool breaks_at(const machine::Place& place) const;
  bool Counts(const WatchedStep& step) const;
  bool IsUnderWay() const;
  bool IsBegun() const;
  bool IsReadAhead(const machine::ProgramStep& step) const;

  HaltState& s_;
  Situation& situation_;
  const Telling& telling_;
  Ride& ride_;
  Actuators& actuators_;
  ProgramCounter& counter_;
  const DataAccess& data_;
  Waits& waits_;
  MoveWatch& watch_;
  Works& works_;
};

}  // namespace rmlcell::optimo
