#include "engine/simulation/run/milled_target.h"

#include <utility>

#include "engine/simulation/run/simulate.h"

namespace rmlcell::simulation {

Result<std::vector<float>> MilledTarget(const ProgramMemory& memory, const RunOptions& options,
                                        const Milling& milling, const StillWanted& wanted) {
  Result<PreparedRun> prepared = PrepareRun(memory, options);
  if (!prepared) return prepared.error();
  if (!prepared->setup)
    return Error{ErrorCode::kCellBadText, "the program has errors: rmlcell check lists them", {}};
  Products products;
  products.milling = milling;
  products.milling->target.reset();
  const Result<BegunRun> begun =
      Begin(*memory.family, std::move(*prepared->setup), std::move(products));
  if (!begun) return begun.error();
  SimulationOptions driving;
  driving.progress = [&](const Progress&) { return !wanted || wanted(); };
  const machine::Outcome outcome = RunToEnd(*begun->simulation, driving).outcome;
  if (outcome.kind != machine::OutcomeKind::kCompleted) {
    return Error{outcome.code.value_or(ErrorCode::kCellWaitsForever),
                 "the program does not run to its end; " + outcome.detail,
                 {}};
  }
  return begun->recorder->milling()->material().heights();
}

}  // namespace rmlcell::simulation
