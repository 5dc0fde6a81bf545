#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/machine_input.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/outcome.h"
#include "engine/machine/run_setup.h"
#include "rmlcell/v1/machine_status.pb.h"
#include "rmlcell/v1/run_event.pb.h"

namespace rmlcell::v1 {
class AssignedSchedule;
}

// What acts on a machine that lives and how it stands, as messages of the contract.
namespace rmlcell::bridge {

v1::MachineState ToProto(machine::MachineState state);
v1::OperatingMode ToProto(machine::Mode mode);
v1::StartSource ToProto(machine::StartSource source);
v1::HoldReason ToProto(machine::HaltReason reason);
std::optional<machine::Mode> ModeOf(v1::OperatingMode mode);
std::optional<machine::StartSource> StartSourceOf(v1::StartSource source);

// As it stands in a journal. Of programs and schedules it says only that they changed.
v1::AppliedInput AppliedOf(const machine::MachineInput& input);
// Back; nothing: what stands there is no input of the machine, or is one of its memory. Error:
// CellInvalidArgument.
Result<std::optional<machine::MachineInput>> InputOf(const v1::AppliedInput& applied);

// What a run began with, and back. Errors: CellInvalidArgument.
v1::RunBase ToProto(const machine::StartBase& base, int program);
Result<machine::StartBase> FromProto(const v1::RunBase& base);

// From outside: IL, IA, door, power, a gate. Errors: CellInvalidArgument.
Result<machine::MachineInput> FromProto(const v1::MachineInput& input);

// In the order of the family, "X Y Z A": of those that slide and of those that turn.
std::vector<v1::AxisValue> AxesOf(std::string_view names, const motion::AxisPose& axes);

// Nothing for what is not stated.
std::optional<machine::KeyAction> ActionOf(v1::KeyAction action);

// "VIEW"; nothing for what is none of those keys.
std::optional<machine::PanelKey> PanelKeyOf(std::string_view name);

// "X+"; nothing for what is no jog key.
std::optional<machine::JogKey> JogKeyOf(std::string_view name);

// Errors: CellInvalidArgument.
Result<machine::SetGates> FromProto(const v1::GatePrograms& gates);

machine::LaserSchedule FromProto(const v1::AssignedSchedule& schedule);

// Error: CellInvalidArgument for what is no number and no logical value.
Result<double> NumberOf(const v1::Variable& variable);

}  // namespace rmlcell::bridge
