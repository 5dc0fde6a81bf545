#pragma once

#include <array>
#include <bitset>

#include "engine/machine/run.h"
#include "engine/optimo/language/instruction_set.h"
#include "engine/optimo/machine/laser_unit.h"
#include "engine/optimo/machine/machine_state.h"

namespace rmlcell::optimo {

// Dry run up to a step, OPT-6.12 to 6.30.
struct Simulated {
  bool active = false;
  machine::ProgramStep until{};
  int schedule = 0;  // selected last; 0: none
};

// Whether what the run does hangs on something that nothing of it has set.
struct Reliance {
  std::array<std::bitset<kVariableIndexMax + 1>, kVariableGroups>
      written{};  // by the run; by group
  bool on_what_was = false;
};

// Where a run is, as all parts of the control see it: the instant, the instruction, the machine.
// A value.
struct Situation {
  SimTime now{0};
  machine::RunPhase phase = machine::RunPhase::kRunning;
  machine::Mode mode = machine::Mode::kCycle;
  machine::Place place{};  // of the instruction in execution; what is told is told there
  Op op = Op::kInvalid;
  double override_percent = 100.0;
  Simulated simulated{};
  MachineState machine{};
  Beam beam{};
  int gas_refused = 0;  // OL of the assist gas that was switched on last and is refused, OPT-5.40
  Reliance reliance{};

  bool running() const { return phase == machine::RunPhase::kRunning; }
  bool simulating() const { return simulated.active; }
};

// VI[99], the number of the last error.
inline void SetLastError(MachineState& machine, ErrorCode code) {
  machine.data.vi[99] = static_cast<float>(Lookup(code).number);
}

// What carries the tool, with the TCP in force. motion.md 2.2
inline motion::Head HeadOf(const MachineState& machine, const OptimoParameters& parameters) {
  return motion::GantryHead{.length_mm = parameters.head_length_mm, .tool = machine.tool.offset};
}

}  // namespace rmlcell::optimo
