#include "engine/simulation/run/simulate.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace rmlcell::simulation {
Simulation::Simulation(machine::Run& run, Recorder& recorder)
    : recorder_(recorder), drive_(run, recorder.inputs().input_times) {
  recorder_.Begin(run);
}

RunReport Simulation::Finish() {
  recorder_.Finish(drive_.run());
  return Report();
}

RunReport RunToEnd(Simulation& simulation, const SimulationOptions& options) {
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
    if (options.at_halt == AtHalt::kStart && simulation.Start()) continue;
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
  if (recorder.milling() != nullptr) {
    result.material = recorder.milling()->material();
    result.target = recorder.milling()->target();
  }
  result.machine_state = (*run)->SaveMachine();
  result.executables = (*run)->made_executables();
  for (const std::string& name : request.variables) {
    if (auto value = (*run)->ReadVariable(name)) result.variables[name] = *std::move(value);
  }
  return result;
}

}  // namespace rmlcell::simulation
