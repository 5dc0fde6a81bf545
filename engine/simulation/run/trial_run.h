#pragma once

#include <memory>
#include <vector>

#include "engine/simulation/picture/picture.h"
#include "engine/simulation/run/simulate.h"

namespace rmlcell::simulation {

// A run whose figures and path are compared with those of another one.
struct TrialRun {
  machine::Outcome outcome;
  std::vector<machine::Reason> reasons;  // of its verdict
  // "cycle_time" s, "cut_length" mm, "travel_length" mm, "beam_on_time" s, "pierces",
  // "beam_energy" J; none when the program did not run to its end by itself.
  std::vector<machine::Figure> figures;
  std::unique_ptr<PictureRecorder> path;  // as far as it ran
};

// Errors: those of MachineFamily::NewRun.
Result<TrialRun> RunForComparison(const machine::MachineFamily& family, machine::RunSetup setup,
                                  SimulationOptions options);

}  // namespace rmlcell::simulation
