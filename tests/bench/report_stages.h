#pragma once

#include <cstdint>
#include <cstdio>
#include <string_view>
#include <utility>

#include "engine/simulation/run/simulate.h"

namespace rmlcell::bench {

// Carries a program out and makes what the stage says beside its report: toolpath, picture, or all.
// The exit code of who counts that.
inline int SimulateStage(std::string_view stage, const machine::MachineFamily& family,
                         machine::RunSetup setup) {
  std::uint64_t bytes = 0;
  simulation::SimulationRequest request;
  if (stage == "toolpath" || stage == "all") {
    request.products.toolpath = [&bytes](std::string_view block) {
      bytes += block.size();
      return true;
    };
  }
  request.products.picture = stage == "picture" || stage == "all";
  const auto result = simulation::Simulate(family, std::move(setup), std::move(request));
  if (!result) return 1;
  std::printf("%llu bytes of toolpath, %zu of picture\n", static_cast<unsigned long long>(bytes),
              result->svg.size());
  return result->report.outcome.kind == machine::OutcomeKind::kCompleted ? 0 : 1;
}

}  // namespace rmlcell::bench
