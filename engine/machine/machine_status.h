#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/units.h"
#include "engine/machine/machine_input.h"
#include "engine/machine/machine_note.h"
#include "engine/machine/run.h"
#include "engine/machine/step_entry.h"

namespace rmlcell::machine {

// LIVE-2.03
enum class MachineState {
  kOff,         // no power, or not enabled
  kStarting,    // its host takes its lease and reads its state
  kRecovering,  // the same after an unclean end
  kNotZeroed,   // on and standing, its axes without reference
  kIdle,        // on and standing, no run is open
  kJogging,     // moves by hand: jog, HOME, ZERO
  kRunning,     // a run is open and goes on
  kStopping,    // comes to rest
  kHeld,        // a run is open and stands
  kAlarm,       // an alarm is not acknowledged
  kInspect,     // a run was cut off: a person decides
  kLost,        // as the server sees it: nothing is heard of its host
};
inline constexpr int kMachineStates = static_cast<int>(MachineState::kLost) + 1;
std::string_view Name(MachineState state);  // "HELD"

// Of a run that begins at a step.
struct RunEntry {
  StepTarget at{};
  SimTime run_time{0};  // of the run where it begins: what lies before was not done by it

  bool operator==(const RunEntry&) const = default;
};

// What moves by hand and is a run nevertheless.
enum class HandRun : std::uint8_t {
  kZero,      // the axes find their reference
  kHome,      // to the home position, while the key is down
  kFunction,  // a part of a program, carried out from the handbox: STOP holds it, START goes on
};

// A run that is open, or the last one that was.
struct RunNote {
  std::int64_t number = 0;  // counts from 1
  int program = 0;
  StartSource source = StartSource::kConsole;
  SimTime begun{0};                   // of the machine: time of the run counts from here
  bool by_hand = false;               // no program of anybody
  HandRun hand = HandRun::kZero;      // by_hand: which one
  std::optional<RunEntry> entered{};  // then `begun` lies before it was begun, by that time
};

// How it is now.
struct MachineStatus {
  SimTime time{0};  // of the machine
  MachineState state = MachineState::kIdle;
  Mode mode = Mode::kRemote;
  double override_percent = 100.0;
  RunState run{};  // the machine's own where no run is open: phase kFinished
  std::optional<RunNote> open{};
  std::optional<HandRun> by_hand{};  // is under way: the open run, or beside one that is held
  std::int64_t last_run = 0;         // number of the newest that was begun
  std::vector<Alarm> alarms{};
  ShownStep shown{};
  // The machine's own code of the last error, alarm or end of a run that nobody has cleared from
  // the panel (ClearMessage); its cause may be over long since, or not. OPT-4.06
  std::optional<ErrorCode> message{};
};

}  // namespace rmlcell::machine
