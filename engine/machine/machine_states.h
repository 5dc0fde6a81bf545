#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/machine_status.h"
#include "engine/machine/run_setup.h"

// How a machine that lives goes from state to state (LIVE-2.10), as a table without memory:
// machine, host, server and tests ask this one.
namespace rmlcell::machine {

// What happens to a machine: what people and programs ask of it, what it does itself, and what
// becomes of its host.
enum class MachineEvent {
  kPowerOn,  // or enabled
  kPowerOff,
  kStart,  // begins a run
  kResume,
  kStartKey,  // at the panel: begins a run, or goes on
  kHold,
  kStop,
  kAtRest,  // told by the machine
  kProgramEnded,
  kProgramHalts,  // PAUSE, a breakpoint, SINGLE
  kProgramFails,  // an error that ends the run, and is no alarm
  kAlarmComes,
  kAcknowledge,  // an alarm whose cause is gone
  kAbort,
  kMoveByHand,  // a jog key down, HOME, ZERO
  kRelease,     // of the key, or the client is not heard any more
  kDoorOpens,   // or the cover
  kEmergencyStop,
  kModeChange,
  kStartAtStep,
  kConfirm,  // or abandon: a person has looked
  kControlLost,
  kMachineLeaseLost,
  kHostSilent,
  kHostBack,   // with the same fence
  kHostReady,  // a new one, with the state of the last mark
};
inline constexpr int kMachineEvents = static_cast<int>(MachineEvent::kHostReady) + 1;
std::string_view Name(MachineEvent event);  // "START key"

// What the table does not say by itself.
struct StateGuards {
  bool zeroed = true;
  bool run_open = false;        // as of STOPPING, JOGGING, and of a host that is lost
  bool aborts = false;          // STOPPING: the run is over once it stands
  bool lease_gone = false;      // STOPPING: that of the machine
  bool unzeroed_start = false;  // SIMUL is armed, or the program says that it zeroes the axes
  bool alarm_left = false;      // of several alarms another one stays
  bool inspect_due = false;     // a run was cut off, and nobody has decided yet
  bool holds_on_loss = true;    // what becomes of a run when control is lost
  ErrorCode alarm = ErrorCode::kCellMachineState;       // the first one
  ErrorCode not_zeroed = ErrorCode::kCellMachineState;  // as the family says it
  bool manual = false;                                  // the mode
  bool single = false;                                  // likewise
  bool from_panel = false;                              // by a key and not by a client
  MachineState own = MachineState::kIdle;               // of a host that is back: what it says
};

// What goes with a transition.
enum class StateAct : std::uint8_t {
  kEndInterrupted,  // the run is over: control over the machine was lost
  kEndFailed,
  kEndCancelled,
  kSafe,       // beam off, shutter closed, spindle off
  kShutter,    // closed
  kTakeBack,   // a HOLD or STOP that has not halted yet
  kOvertake,   // a STOP takes the place of a HOLD, not of a STOP
  kHoldFirst,  // at the end of the present instruction
  kCall,       // to rest, as by STOP
};

struct Transition {
  enum class Kind {
    kCannot,   // this does not happen in that state
    kStays,    // OK, and nothing changes but what the acts say
    kGoes,     // to `to`
    kRefused,  // with `code`; nothing changes
    kKeyOnly,  // a key that does nothing but a message of the control
    kKept,     // by the server, for a host that speaks again; refused with `code`
  };
  Kind kind = Kind::kCannot;
  MachineState to = MachineState::kOff;
  std::optional<ErrorCode> code{};
  std::uint16_t acts = 0;  // bits of StateAct

  bool Does(StateAct act) const { return (acts >> static_cast<unsigned>(act) & 1U) != 0; }
  bool operator==(const Transition&) const = default;
};

// Precondition: the state is none of STARTING and RECOVERING but for kHostReady; they answer as
// LOST.
Transition Next(MachineState state, MachineEvent event, const StateGuards& guards);

// Only these move axes. LIVE-2.04
constexpr bool MovesAxes(MachineState state) {
  return state == MachineState::kJogging || state == MachineState::kRunning ||
         state == MachineState::kStopping;
}

}  // namespace rmlcell::machine
