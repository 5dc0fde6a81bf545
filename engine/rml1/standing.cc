#include "engine/rml1/standing.h"

#include <utility>

#include "engine/rml1/machine_state.h"
#include "engine/rml1/state_items.h"
#include "engine/rml1/timing.h"
#include "engine/rml1/variables.h"

namespace rmlcell::rml1 {

Result<std::unique_ptr<machine::Standing>> MillStanding::Make(Profile profile,
                                                              std::string_view machine_state) {
  std::unique_ptr<MillStanding> made(new MillStanding(std::move(profile)));
  if (!machine_state.empty()) {
    const Result<MachineState> kept = ReadMachineState(machine_state, *made->profile_);
    if (!kept) return kept.error();
    made->device_.Restore(kept->registers, kept->at);
  }
  return std::unique_ptr<machine::Standing>(std::move(made));
}

MillStanding::MillStanding(Profile profile)
    : profile_(std::make_unique<const Profile>(std::move(profile))), device_(*profile_) {}

ToolNow MillStanding::tool() const {
  return {.at = device_.carriage().physical(), .spindle_turns = device_.spindle_turns()};
}

machine::RunState MillStanding::state() const {
  machine::RunState state;
  state.phase = machine::RunPhase::kFinished;
  state.tip = PoseOf(*profile_, tool().at);
  state.axes = {.column = state.tip.tip, .a_rad = state.tip.a_rad, .b_rad = 0.0};
  state.spindle_on = tool().spindle_turns;
  state.work_origin =
      motion::MachinePoint(profile_->origin_x, profile_->origin_y, device_.registers().z0) /
      profile_->units_per_mm;
  return state;
}

std::optional<machine::VariableValue> MillStanding::ReadVariable(std::string_view name) const {
  return ReadRegister(device_, *profile_, tool(), name);
}

std::vector<machine::ModalValue> MillStanding::modal_values() const {
  return ModalRegisters(device_, *profile_, tool());
}

void MillStanding::Rest() {
  Registers registers = device_.registers();
  registers.spindle_on = false;
  device_.Restore(registers, device_.carriage().physical());
}

void MillStanding::CyclePower() { device_ = Device(*profile_); }

std::vector<machine::StateItem> MillStanding::items() const {
  return ItemsOf(device_, *profile_, tool(), "not known");
}

std::string MillStanding::Save() const {
  return WriteMachineState({.registers = device_.registers(), .at = device_.carriage().physical()});
}

}  // namespace rmlcell::rml1
