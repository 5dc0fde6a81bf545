#pragma once

#include <cstdint>
#include <optional>

#include "engine/machine/run.h"
#include "engine/optimo/control/actuators.h"
#include "engine/optimo/control/alarms.h"
#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/entry.h"
#include "engine/optimo/control/halts.h"
#include "engine/optimo/control/move_watch.h"
#include "engine/optimo/control/moves.h"
#include "engine/optimo/control/passage_effects.h"
#include "engine/optimo/control/process_watch.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/control/waits.h"
#include "engine/optimo/control/works.h"
#include "engine/optimo/language/instruction_set.h"
#include "engine/optimo/machine/situation.h"
#include "engine/optimo/ride/ride.h"
#include "engine/optimo/ride/travel.h"

namespace rmlcell::optimo {

// Everything that the control is at while it runs a program: a snapshot of a run is a copy of it.
// Each part owns its own; all see the situation, and Flow keeps nothing. What a program has of its
// own and takes with it (program_context.h) lies with the program counter: there instructions of
// other parts set the modal values, the parameters and the processes.
struct ControlState {
  // What the machine kept is handed to the parts; SIMUL that was armed begins.
  ControlState(const OptimoParameters& parameters, const MachineState& kept);

  // What the machine keeps of it; the axes as they stood when the motion under way began.
  MachineState Kept() const;

  Situation situation{};
  TravelState travel{};
  RideState ride;
  ActuatorState actuators;
  PassageEffectState effects{};
  ProgramCounterState counter{};
  DataState data{};
  WaitState waits{};
  WatchState watch{};
  ProcessWatchState process_watch{};
  WorkState works{};
  HaltState halts{};
  MoveState moves{};
  AlarmState alarms{};
  EntryState entry{};

  std::optional<machine::ProgramStep> simul{};  // SIMUL: arms the next start, OPT-6.16
  Op op = Op::kInvalid;                         // in execution, as it is shown
  std::size_t next_input = 0;                   // of the script
  std::uint64_t steps = 0;
  std::uint64_t steps_at_repeat = 0;  // REPEAT: executed before this repetition
  std::int64_t executions = 0;        // of the main program, to its end
  SimTime instant{-1};                // of the instruction that was carried out last
  std::uint64_t steps_before = 0;     // executed before that instant
  machine::Outcome outcome{};
};

}  // namespace rmlcell::optimo
