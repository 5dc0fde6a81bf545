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
    if (options.at_halt == AtHalt::kStart) {
      simulation.StartOrEnd();
    } else {
      simulation.End(machine::OutcomeKind::kStopped, ErrorCode::kCellWaitsForever);
    }
  }
  return simulation.Finish();
}

Result<BegunRun> Begin(const machine::MachineFamily& family, machine::RunSetup setup,
                       Products products) {
  BegunRun begun;
  begun.recorder = std::make_unique<Recorder>(family.Shape(setup.parameters),
                                              DescribeInputs(family, setup), std::move(products));
  const std::vector<machine::Breakpoint> breakpoints = std::move(setup.breakpoints);
  Result<std::unique_ptr<machine::Run>> run = family.NewRun(std::move(setup), *begun.recorder);
  if (!run) return run.error();
  if (!breakpoints.empty()) (*run)->SetBreakpoints(breakpoints);
  begun.run = *std::move(run);
  begun.simulation = std::make_unique<Simulation>(*begun.run, *begun.recorder);
  return begun;
}

Result<SimulationResult> Simulate(const machine::MachineFamily& family, machine::RunSetup setup,
                                  SimulationRequest request) {
  std::optional<machine::RunSetup> comes;
  if (!IsWhole(setup)) comes = setup;
  Result<BegunRun> begun = Begin(family, std::move(setup), std::move(request.products));
  if (!begun) return begun.error();
  const Recorder& recorder = *begun->recorder;
  const machine::Run& run = *begun->run;
  SimulationResult result;
  result.report = RunToEnd(*begun->simulation, request.options);
  if (comes) {
    for (auto& [slot, program] : comes->programs) program.object.ReadAll();
    result.report.inputs_hash = FingerprintOf(family, *comes);
  }
  if (recorder.milling() != nullptr) {
    result.material = recorder.milling()->material();
    result.target = recorder.milling()->target();
  }
  result.machine_state = run.SaveMachine();
  result.executables = run.made_executables();
  result.variables = machine::ReadVariables(run, request.variables);
  // What was run is over: a drawing takes its room.
  begun->simulation.reset();
  begun->run.reset();
  result.svg = recorder.Svg(result.report, request.picture);
  result.plot = recorder.PlotSvg(result.report, request.plot);
  return result;
}

}  // namespace rmlcell::simulation
