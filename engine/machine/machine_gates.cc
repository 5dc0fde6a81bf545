// Inputs that start a program each. LIVE-2.11
#include "engine/core/number_text.h"
#include "engine/machine/machine.h"

namespace rmlcell::machine {
namespace {

Error NoGates() { return {ErrorCode::kCellNotLive, "the machine has no gates", {}}; }

}  // namespace

Status Machine::Act(const SetGates& input) {
  if (!has_gates()) return NoGates();
  for (const int program : input.programs) {
    if (program < 0 || program > kSlotMax)
      return Error{ErrorCode::kCellInvalidArgument,
                   "gate program " + Told("program", program) + ": a slot is 1 to 99, 0 is none",
                   {}};
  }
  gates_ = input.programs;
  return {};
}

Status Machine::Act(const PressGate& input) {
  if (!has_gates()) return NoGates();
  if (input.gate < 1 || input.gate > kGates)
    return Error{ErrorCode::kCellInvalidArgument,
                 "gate " + Told("gate", input.gate) + ": there are gate 1 and gate 2",
                 {}};
  const int program = gates_[static_cast<std::size_t>(input.gate - 1)];
  if (program == 0)
    return Error{ErrorCode::kCellMode,
                 "gate " + Told("gate", input.gate) + " starts no program; set one first",
                 {}};
  return Act(StartRun{.program = program,
                      .source = input.gate == 1 ? StartSource::kGate1 : StartSource::kGate2});
}

}  // namespace rmlcell::machine
