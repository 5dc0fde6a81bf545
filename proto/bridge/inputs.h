#pragma once

#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/inputs.h"
#include "engine/machine/variable.h"

namespace rmlcell::v1 {
class AppliedInput;
class ScriptedInput;
class SimulationOptions;
class Variable;
}  // namespace rmlcell::v1

namespace rmlcell::bridge {

// What acts on a simulation from outside, at a virtual time. CellInvalidArgument: before 0,
// nothing, something that acts on live machines only, no input IL[0..99] or IA[0..99], a value that
// it cannot have: logical ones are true or false, analogue ones finite numbers, and the override is
// above 0 to `override_max`, percent.
Result<machine::InputChange> FromProto(const v1::ScriptedInput& scripted, double override_max);

v1::AppliedInput ToProto(const machine::InputChange& change);
// Errors: as of FromProto, but for its time.
Result<machine::InputChange> ChangeOf(const v1::AppliedInput& input, double override_max);

// Those of the options in order of time. Errors: of FromProto, but for an override that is high.
Result<machine::InputScript> InputsOf(const v1::SimulationOptions& options);

// Input file: one change a line, "SECONDS WHAT [= VALUE]", # begins a comment:
//   0.5 IL[20] = 1      2.0 START      3.25 OVERRIDE = 55      4 DOOR = OPEN
// Appends to options.inputs. `override_max` as of FromProto. Errors: CellBadText with line and
// column.
Status ParseInputFile(std::string_view text, const std::string& name, double override_max,
                      v1::SimulationOptions& options);

// Error: CellInvalidArgument, naming what is allowed: above 0 to `override_max`, percent.
Status CheckOverride(double percent, double override_max);

v1::Variable ToProto(const machine::NamedVariable& variable);

}  // namespace rmlcell::bridge
