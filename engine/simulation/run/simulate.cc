#include "engine/simulation/run/simulate.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace rmlcell::simulation {
namespace {

SimTime Later(SimTime time, SimTime by) { return time > kForever - by ? kForever : time + by; }

}  // namespace

Simulation::Simulation(machine::Run& run, Recorder& recorder) : run_(run), recorder_(recorder) {
  recorder_.Begin(run_);
}

machine::RunPhase Simulation::Step(SimTime slice) {
  if (finished()) return phase_;
  // Also for a slice of zero: a caller that does not advance must not loop for ever.
  const SimTime now = run_.state().time;
  phase_ = run_.Advance(Later(now, std::max(slice, SimTime(1))));
  while (phase_ == machine::RunPhase::kHalted) {
    // Scripted inputs end a halt when their time comes, however long that is.
    const std::vector<SimTime>& inputs = recorder_.inputs().input_times;
    const auto next = std::upper_bound(inputs.begin(), inputs.end(), run_.state().time);
    if (next == inputs.end()) break;
    const SimTime before = run_.state().time;
    phase_ = run_.Advance(*next);
    if (phase_ == machine::RunPhase::kHalted && run_.state().time == before) break;
  }
  return phase_;
}

void Simulation::End(machine::OutcomeKind kind, ErrorCode code) {
  if (finished()) return;
  run_.End(kind, code);
  phase_ = machine::RunPhase::kFinished;
}

RunReport Simulation::Finish() {
  recorder_.Finish(run_);
  return recorder_.Report(run_);
}

RunReport RunToEnd(Simulation& simulation, const SimulationOptions& options) {
  std::optional<Progress> started;  // where START was last given
  while (simulation.Step(options.slice) != machine::RunPhase::kFinished) {
    if (options.progress) {
      const Progress here{simulation.state(), simulation.steps_executed(), simulation.cut_off()};
      if (!options.progress(here)) {
        simulation.Cancel();
        break;
      }
    }
    if (options.end_when_cut_off && simulation.cut_off()) {
      simulation.End(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kCellOutputBudget);
      break;
    }
    if (simulation.phase() != machine::RunPhase::kHalted) continue;
    // START that changes nothing will never do.
    const Progress here{simulation.state(), simulation.steps_executed(), simulation.cut_off()};
    const bool stuck =
        started && started->state.time == here.state.time && started->steps == here.steps;
    if (options.at_halt == AtHalt::kStart && !stuck) {
      started = here;
      simulation.Apply({here.state.time, machine::InputKind::kStart, 0, 1.0});
      continue;
    }
    simulation.End(machine::OutcomeKind::kStopped, ErrorCode::kCellWaitsForever);
    break;
  }
  return simulation.Finish();
}

Result<SimulationResult> Simulate(const machine::MachineFamily& family, machine::RunSetup setup,
                                  SimulationRequest request) {
  Recorder recorder(family.Shape(setup.parameters), DescribeInputs(family, setup),
                    std::move(request.products));
  Result<std::unique_ptr<machine::Run>> run = family.NewRun(std::move(setup), recorder);
  if (!run) return run.error();
  Simulation simulation(**run, recorder);
  SimulationResult result;
  result.report = RunToEnd(simulation, request.options);
  result.svg = recorder.Svg(result.report, request.picture);
  result.plot = recorder.PlotSvg(result.report, request.plot);
  if (recorder.material() != nullptr) result.material = *recorder.material();
  result.machine_state = (*run)->SaveMachine();
  result.executables = (*run)->made_executables();
  for (const std::string& name : request.variables) {
    if (auto value = (*run)->ReadVariable(name)) result.variables[name] = *std::move(value);
  }
  return result;
}

}  // namespace rmlcell::simulation
