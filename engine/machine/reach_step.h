#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/family.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/machine/run_setup.h"
#include "engine/machine/step_entry.h"

namespace rmlcell::machine {

// How far a step is looked for. LIVE-6.01
struct ReachLimits {
  std::uint64_t steps_max = 100'000'000;
  // Asked again and again, so that the caller bounds the processor time. False: it is given up.
  std::function<bool()> go_on{};
};

// How often control came to each step. Of a long stream, which comes to each command once, the
// first of them alone are counted.
class StepCounts {
 public:
  std::uint64_t Count(const ProgramStep& at);  // once more: how manieth time this is

 private:
  static constexpr std::size_t kCountedMax = 1 << 16;
  std::array<std::vector<std::uint32_t>, kSlotMax + 1> counts_{};  // by slot and step
};

// A run with nobody looking that has halted before a step.
struct StepReach {
  std::unique_ptr<RunObserver> nobody{};
  std::unique_ptr<Run> run{};          // never null
  std::optional<Error> unreachable{};  // CellStepUnreachable, with the last step that was reached
  StepTarget target{};                 // with its step, where a byte was asked for
  StepFacts facts{};                   // of the step, where it is reached
  std::optional<StepTarget> clean_before{};  // the last clean step that it came to
  StepCounts counts{};                       // of the steps begun
};

// In virtual time, with the inputs of the setup and START at every halt that none of them ends.
// Errors: those of MachineFamily::NewRun; CellNotLive where the family has no start at a step.
Result<StepReach> ReachStep(const MachineFamily& family, const RunSetup& setup,
                            const StepTarget& target, const ReachLimits& limits);

// From there on, or from the beginning where the step is unreachable for what it is, or where the
// halt changed what comes behind; as far as it is looked for.
struct StepsBehind {
  bool passes = false;                       // the whole run passes at the step
  std::optional<StepTarget> clean_before{};  // as StepReach has it, or as a whole run has
  std::optional<StepTarget> clean_after{};
  double beam_way_mm = 0.0;  // until the beam goes off for the first time; 0 where it is not on
};
StepsBehind LookBehind(const MachineFamily& family, const RunSetup& setup, const StepReach& reach,
                       const ReachLimits& limits);

// The how manieth pass through the step a run was in at this time of its own; 0: it had not come
// there. Errors: as ReachStep; CellStepUnreachable, it takes longer than is looked for.
Result<std::uint64_t> OccurrenceAt(const MachineFamily& family, const RunSetup& setup,
                                   const ProgramStep& at, SimTime time, const ReachLimits& limits);

// Goes on until this time of its own, with START at every halt that nothing ends; less far where it
// ends or waits for ever. Error: CellStepUnreachable, it takes longer than is looked for.
Status GoUntilTime(Run& run, SimTime time, const ReachLimits& limits);

// Goes on until `done`, which is asked between two calls of Advance, with START at every halt.
enum class WayEnd { kDone, kFinished, kWaitsForEver, kGivenUp };
WayEnd GoUntil(Run& run, const std::function<bool()>& done, const ReachLimits& limits);

}  // namespace rmlcell::machine
