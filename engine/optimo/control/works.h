#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/optimo/control/actuators.h"
#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/passage_effects.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/control/waits.h"

namespace rmlcell::optimo {

// A WORK that is not over when the program goes on. OPT-3.38
enum class WorkStage : std::uint8_t {
  kStart,  // /START with /NEXT is not true yet: `start` has it
  kDwell,  // a pierce with /NEXT: peak power, and from `until` on that of `after`
  kEnd,    // ON until /END is true: `end` has it
};

struct WorkTask {
  WorkStage stage = WorkStage::kStart;
  std::size_t call_level = 0;  // of its program: it stands still while a CALLed one runs
  machine::Place place{};
  int kind = 0;
  int process = 0;
  bool on = true;                 // kStart: /ON; the others are ON
  bool stale = true;              // something happened since its condition was tested last
  SimTime since{0};               // of the instruction; conditions are tested each CYCLE from here
  SimTime until{0};               // kDwell
  machine::PowerBySpeed after{};  // kDwell
  std::optional<Condition> start{};
  std::optional<Condition> end{};  // kStart, too, where the WORK has one
};

struct WorkState {
  std::vector<WorkTask> tasks{};  // those of the innermost program last
  bool input_changed = false;  // a /START in the background is tested again, before its next tick
  int simulated_schedule = 0;  // that a dry run selected last; 0: none
};

// WORKDEF and WORK. A WORK may go on in the background: it waits for /START or dwells while the
// program goes on (/NEXT), or is switched off by /END. Then it is a task of its program:
//
//   -        WORK whose /START is not true, /NEXT    kStart
//            pierce of WORK 1 with /NEXT             kDwell
//            WORK /ON with /END                      kEnd, beside its kDwell
//   kStart   its condition is true                   carried out: kDwell, kEnd, both or none
//   kDwell   its time is over                        over: the ramp begins
//            WORK 0 or 1 of whatever process         over: it decides the power
//            WORK 2,p /OFF                           over: it takes the beam
//   kEnd     its condition is true                   over: OFF; its kDwell runs on in the dark
//   any      WORK of the same n, p                   over: that takes its place
//            the end of its program, an error        over
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

  bool idle() const { return s_.tasks.empty(); }  // nothing is in the background
  // Those in the background: when they are to be looked at next. A condition that nothing can have
  // changed since it was tested last is not tested again.
  // `stops`: STOP was pressed, and nothing begins before START. OPT-4.18
  SimTime NextEvent(bool stops) const;
  // The first error, and where: errors and signals are told at the step of the WORK, not of the
  // instruction in execution.
  struct Failure {
    Error error;
    machine::Place place;
  };
  std::optional<Failure> Run(bool stops);
  // Something happened that conditions may depend on.
  void MarkStale();
  void InputChanged() { s_.input_changed = true; }
  void InputSeen() { s_.input_changed = false; }
  // The machine stood halted so long.
  void Shift(SimTime stood);

  // The program in execution is over, or an error ends what it has going on.
  void EndProgram();
  // All programs are.
  void Clear() { s_.tasks.clear(); }
  // The laser schedule that a dry run leaves selected, once; 0: none.
  int TakeSimulatedSchedule() { return std::exchange(s_.simulated_schedule, 0); }

 private:
  using When = PassageEffects::When;

  bool IsOfProgram(const WorkTask& task) const { return task.call_level == counter_.call_level(); }
  Status Switch(WorkTask task, bool dwell_in_background, When when);
  Status SwitchOn(const WorkTask& task, bool dwell_in_background, When when);
  void SwitchOff(int kind, int process, When when);
  Status MaySwitchOn(const WorkTask& task, const std::optional<WorkDefinition>& definition) const;
  Status SelectSchedule(int number, When when);
  void Pierce(const WorkTask& task, const WorkDefinition& definition, bool in_background);
  void Drop(int kind, int process);
  WorkTask Take(std::size_t n);
  bool EndDwell(std::size_t n);
  Result<bool> TestTask(std::size_t n, bool stops);

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
