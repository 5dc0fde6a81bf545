#pragma once

#include <memory>

#include "engine/machine/run.h"
#include "engine/machine/step_entry.h"
#include "engine/optimo/control/control.h"

namespace rmlcell::optimo {

// A run of the control behind the interface of all machines.
class OptimoRun final : public machine::Run, public machine::EnterableRun {
 public:
  OptimoRun(OptimoParameters parameters, machine::RunSetup setup, machine::RunObserver& observer)
      : control_(std::move(parameters), std::move(setup), observer) {}

  machine::RunPhase Advance(SimTime until) override { return control_.Advance(until); }
  void Apply(const machine::InputChange& input) override { control_.Apply(input); }
  void Stand(SimTime until) override { control_.Stand(until); }
  bool may_be_moved() const override { return control_.may_be_moved(); }
  Status MayGoOn() const override { return control_.MayGoOn(); }
  void MoveTo(const motion::AxisPose& axes) override { control_.MoveTo(axes); }
  void SetZeroed() override { control_.SetZeroed(); }
  void SetMode(machine::Mode mode) override { control_.SetMode(mode); }
  void End(machine::OutcomeKind kind, ErrorCode code) override { control_.End(kind, code); }
  machine::RunState state() const override { return control_.Snapshot(); }
  const machine::Outcome& outcome() const override { return control_.state().outcome; }
  std::uint64_t steps_executed() const override { return control_.state().steps; }
  std::optional<machine::VariableValue> ReadVariable(std::string_view name) const override {
    return ReadByName(control_.state().data.area, name);
  }
  machine::MachineOutputs outputs() const override { return control_.outputs(); }
  std::optional<machine::ProgramStep> simulation_until() const override {
    return control_.state().situation.simulated_until;
  }
  void WriteVariable(std::string_view name, double value) override {
    control_.WriteVariable(name, value);
  }
  void SetBreakpoints(const std::vector<machine::Breakpoint>& breakpoints) override {
    control_.SetBreakpoints(breakpoints);
  }
  std::vector<machine::Place> stack() const override { return control_.Stack(); }
  std::vector<machine::ModalValue> modal_values() const override { return control_.ModalValues(); }
  bool waits_for_ever() const override { return control_.WaitsForEver(); }
  std::vector<machine::Figure> figures() const override { return control_.figures(); }
  std::string SaveMachine() const override { return EncodeMachineState(control_.Kept()); }
  std::map<int, std::string> made_executables() const override {
    return control_.state().counter.made_executables;
  }
  std::unique_ptr<machine::RunSnapshot> Save() const override;
  void Restore(const machine::RunSnapshot& snapshot) override;

  machine::EnterableRun* enterable() override { return this; }
  Status HaltBefore(const machine::StepTarget& target) override {
    return control_.HaltBefore(target);
  }
  void ForgetTarget() override { control_.ForgetTarget(); }
  const std::optional<machine::StepFacts>& reached() const override {
    return control_.state().entry.halted;
  }
  void WatchSteps(machine::StepWatcher* watcher) override { control_.WatchSteps(watcher); }
  std::vector<machine::StateItem> items() const override { return control_.Items(); }
  std::vector<machine::ApproachMotion> PlanApproach(std::string_view machine_state,
                                                    machine::ApproachWay way) const override;
  bool may_enter_directly() const override { return true; }
  void Enter(const machine::EntryOrder& order) override;

 private:
  Control control_;
};

}  // namespace rmlcell::optimo
