#pragma once

#include <optional>
#include <string>

#include "engine/optimo/control/actuators.h"
#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/passage_effects.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/control/waits.h"

namespace rmlcell::optimo {

struct WorkState {
  bool input_changed = false;  // a /START in the background is tested again, before its next tick
};

// WORKDEF and WORK. A WORK may go on in the background: it waits for /START or dwells while the
// program goes on (/NEXT), or is switched off by /END (OPT-3.38). Then it is a WorkTask of its
// program:
//
//   kStart   /START with /NEXT is not true yet    true: WORK is carried out; kDwell, kEnd or over
//   kDwell   peak power for the delay             over: the ramp; over
//   kEnd     ON until /END is true                true: OFF; over
class Works {
 public:
  Works(WorkState& state, Situation& situation, const OptimoParameters& parameters,
        SystemCycle cycle, const Telling& telling, ProgramCounter& counter, Ride& ride,
        Actuators& actuators, PassageEffects& effects, DataAccess& data, Waits& waits)
      : s_(state),
        situation_(situation),
        parameters_(parameters),
        cycle_(cycle),
        telling_(telling),
        counter_(counter),
        ride_(ride),
        actuators_(actuators),
        effects_(effects),
        data_(data),
        waits_(waits) {}

  // WORKDEF. Errors: of expressions, ValueRange, ScheduleRange.
  Status Define(const Instruction& i);
  // WORK, which may begin a wait. Errors: of expressions, SchedulesUnavailable, WorkdefMissing,
  // RampBlocked, ShutterInterlock, ScheduleMissing.
  Status Work(const Instruction& i);
  // Whether a motion must be over before this WORK. OPT-2.48
  bool NeedsStandstill(const Instruction& i) const;

  // Those in the background: when they are to be looked at next. A condition that nothing can have
  // changed since it was tested last is not tested again.
  SimTime NextEvent() const;
  // The first error, and where: errors and signals are told at the step of the WORK, not of the
  // instruction in execution.
  struct Failure {
    Error error;
    machine::Place place;
  };
  std::optional<Failure> Run();
  // Something happened that conditions may depend on.
  void MarkStale();
  void InputChanged() { s_.input_changed = true; }
  void InputSeen() { s_.input_changed = false; }
  // The machine stood halted so long.
  void Shift(SimTime stood);

 private:
  using When = PassageEffects::When;

  Status Switch(WorkTask task, bool dwell_in_background, When when);
  Status SwitchOn(const WorkTask& task, bool dwell_in_background, When when);
  void SwitchOff(int kind, int process, When when);
  Status MaySwitchOn(const WorkTask& task, const std::optional<WorkDefinition>& definition) const;
  Status SelectSchedule(int number, When when);
  void Pierce(const WorkTask& task, const WorkDefinition& definition, bool in_background);
  void Drop(int kind, int process);
  WorkTask Take(std::size_t n);
  bool EndDwell(std::size_t n);
  Result<bool> TestTask(std::size_t n);

  WorkState& s_;
  Situation& situation_;
  const OptimoParameters& parameters_;
  const SystemCycle cycle_;
  const Telling& telling_;
  ProgramCounter& counter_;
  Ride& ride_;
  Actuators& actuators_;
  PassageEffects& effects_;
  DataAccess& data_;
  Waits& waits_;
};

}  // namespace rmlcell::optimo
