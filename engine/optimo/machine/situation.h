#pragma once

#include <optional>

#include "engine/machine/run.h"
#include "engine/optimo/language/instruction_set.h"
#include "engine/optimo/machine/machine_state.h"

namespace rmlcell::optimo {

// Where a run is, as all parts of the control see it. A value.
struct Situation {
  SimTime now{0};
  machine::RunPhase phase = machine::RunPhase::kRunning;
  machine::Mode mode = machine::Mode::kCycle;
  machine::Place place{};  // of the instruction in execution; what is told is told there
  Op op = Op::kInvalid;
  double override_percent = 100.0;
  ToolState tool{};  // in force: what the tip is, planned and told
  std::optional<machine::ProgramStep> simulated_until{};  // dry run up to a step, OPT-6.12 to 6.30

  bool running() const { return phase == machine::RunPhase::kRunning; }
  bool simulating() const { return simulated_until.has_value(); }
};

// What carries the tool, with the TCP in force. motion.md 2.2
inline motion::Head HeadOf(const ToolState& tool, const OptimoParameters& parameters) {
  return motion::GantryHead{.length_mm = parameters.head_length_mm, .tool = tool.offset};
}

}  // namespace rmlcell::optimo
