#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/units.h"
#include "engine/machine/family.h"
#include "engine/machine/part_on_table.h"
#include "engine/machine/reach_step.h"
#include "engine/machine/run_setup.h"
#include "engine/machine/step_entry.h"

namespace rmlcell::machine {

// What is different there. LIVE-6.03
struct StartDifference {
  std::string item{};   // "VR[3]", "pose"
  std::string there{};  // empty: it has none there
  std::string now{};    // empty: a machine that stands has none
  StartAction action = StartAction::kSet;

  bool operator==(const StartDifference&) const = default;
};

// One for each item that has another value, or is missing on one of the sides; in the order of
// `there`.
std::vector<StartDifference> DifferencesOf(const std::vector<StateItem>& there,
                                           const std::vector<StateItem>& now);

// What has cut the part until now: the run to the step, or one that was cut off before, or nothing.
struct PartSoFar {
  bool untouched = false;
  std::optional<SimTime> cut_until{};  // time of the run; none: to the step
};

// Where a run is to begin, and how it comes there.
struct StartQuestion {
  StepTarget target{};
  ApproachWay way = ApproachWay::kSafe;
  bool off_until_work_on = false;
  std::string machine_state{};  // of the machine as it stands now: Standing::Save
  double override_percent = 100.0;
  // Null: nobody knows it, and the way is not checked against it.
  PartOnTable* part = nullptr;
  PartSoFar part_so_far{};
};

// What a start at a step would do. Nothing of it is done.
struct StartPreview {
  StepReach reach{};  // its run has what is told of any run: stack, modal values, variables
  std::vector<StateItem> there{};              // all of it; empty: the step is unreachable
  std::vector<StartDifference> differences{};  // with what is done about each
  std::vector<ApproachMotion> approach{};
  std::vector<Error> refusals{};  // CellStepUnreachable, CellApproach, ...; empty: it may begin
  std::optional<StepTarget> clean_before{};  // the nearest clean steps, by the order of the run
  std::optional<StepTarget> clean_after{};
  SimTime run_time{0};          // when the step is reached
  bool part_checked = false;    // the way was looked at against the part
  double missing_cut_mm = 0.0;  // off_until_work_on: what would be cut before the beam is on again

  bool may_begin() const { return refusals.empty(); }
};

// `setup`: what the run to the step begins with, and its inputs. Errors: those of ReachStep and of
// MachineFamily::NewStanding.
Result<StartPreview> PreviewStart(const MachineFamily& family, const RunSetup& setup,
                                  const StartQuestion& question, const ReachLimits& limits);

}  // namespace rmlcell::machine
