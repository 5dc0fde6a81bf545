#include "engine/simulation/run/trial_run.h"

#include <utility>

namespace rmlcell::simulation {

Result<TrialRun> RunForComparison(const machine::MachineFamily& family, machine::RunSetup setup,
                                  SimulationOptions options) {
  TrialRun run;
  run.path = std::make_unique<PictureRecorder>(family.Shape(setup.parameters));
  SimulationRequest request;
  request.products.also = run.path.get();
  request.options = std::move(options);
  const Result<SimulationResult> result = Simulate(family, std::move(setup), std::move(request));
  if (!result) return result.error();
  const RunReport& report = result->report;
  run.outcome = report.outcome;
  run.reasons = report.judgement.reasons;
  if (report.outcome.kind == machine::OutcomeKind::kCompleted) {
    run.figures = {{"cycle_time", "s", ToSeconds(report.cycle_time)},
                   {"cut_length", "mm", report.total.cut_mm},
                   {"travel_length", "mm", report.total.travel_mm},
                   {"beam_on_time", "s", ToSeconds(report.total.beam_on)},
                   {"pierces", "", static_cast<double>(report.total.pierces)},
                   {"beam_energy", "J", report.total.energy_j()}};
  }
  return run;
}

}  // namespace rmlcell::simulation
