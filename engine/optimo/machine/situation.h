#pragma once

#include <optional>

#include "engine/machine/run.h"
#include "engine/optimo/machine/machine_state.h"

namespace rmlcell::optimo {

// Where a run is, as the parts of the control see it: what each must know of those above it, which
// it cannot ask. Whatever a part decides for those above it alone lies with that part. A value.
struct Situation {
  SimTime now{0};                                         // Control lets it pass
  machine::RunPhase phase = machine::RunPhase::kRunning;  // Halts; at the end Control
  machine::Mode mode = machine::Mode::kCycle;             // the run, GO (Control)
  // Of the instruction in execution; what is told is told there. Control; whoever carries out what
  // an earlier instruction asked for puts the place of that one here meanwhile.
  machine::Place place{};
  ToolState tool{};  // TCP (Moves): what the tip is, planned (Ride) and looked at (Travel)
  // Dry run up to a step, OPT-6.12 to 6.30: the run, its end Control
  std::optional<machine::ProgramStep> simulated_until{};

  bool running() const { return phase == machine::RunPhase::kRunning; }
  bool simulating() const { return simulated_until.has_value(); }
};

// What carries the tool, with the TCP in force. motion.md 2.2
inline motion::Head HeadOf(const ToolState& tool, const OptimoParameters& parameters) {
  return motion::GantryHead{.length_mm = parameters.head_length_mm, .tool = tool.offset};
}

}  // namespace rmlcell::optimo
