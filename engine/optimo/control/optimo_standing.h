#pragma once

#include "engine/machine/standing.h"
#include "engine/optimo/machine/machine_state.h"

namespace rmlcell::optimo {

// An Optimo between two runs.
class OptimoStanding final : public machine::Standing {
 public:
  OptimoStanding(OptimoParameters parameters, MachineState state)
      : parameters_(std::move(parameters)), s_(std::move(state)) {}

  machine::RunState state() const override;
  std::optional<machine::VariableValue> ReadVariable(std::string_view name) const override {
    return ReadByName(s_.data, name);
  }
  // Outputs follow their images: UPDATE ON is in force when no program runs. A second assist gas
  // stays off beside the first (OPT-5.40).
  void WriteVariable(std::string_view name, double value) override;
  machine::MachineOutputs outputs() const override { return OutputsOf(s_.outputs); }
  std::vector<machine::ModalValue> modal_values() const override;
  std::optional<machine::ProgramStep> simulation_until() const override { return s_.simul; }
  void SelectProgram() override;  // VI[98] is 0. OPT-B.63
  // TCP, with six values; SYSDEF, with six or none.
  void SetModal(std::string_view name, std::span<const double> values) override;
  void Apply(const machine::InputChange& input) override;
  // At the step of the jog table that the override stands for. OPT-4.35
  std::optional<machine::HandMotion> ByHand(double override_percent, bool fast) const override;
  void MoveTo(const motion::AxisPose& axes) override { s_.axes = axes; }
  // No reference, no TCP, no BREAK and no SIMUL; outputs and images are 0, and what a program has
  // counted stays. OPT-4.68, OPT-6.08, OPT-6.30, OPT-7.63
  void CyclePower() override;
  std::vector<machine::StateItem> items() const override;
  std::string Save() const override { return EncodeMachineState(s_); }

 private:
  const OptimoParameters parameters_;
  MachineState s_;
};

}  // namespace rmlcell::optimo
