#include "server/jobs/job_request.h"

#include <algorithm>
#include <set>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/setup.h"
#include "server/base/names.h"
#include "server/base/readable.h"
#include "server/records/file_family.h"
#include "server/records/program_place.h"
#include "storage/records.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kRequestIdMax = 64;
constexpr int kAwaitedJobsMax = 100;
constexpr int kLabelsMax = 16;
constexpr std::size_t kLabelMax = 63;
constexpr int kBreakpointsMax = 1000;
constexpr double kPaceMax = 1000.0;  // faster is not to be told from as fast as possible

// What the contract has and this version does not do: "" where the job asks for none of it.
std::string_view FieldOfLater(const v1::Job& job) {
  if (!job.continues().empty()) return "continues";
  return {};
}

Status CheckBudget(const v1::Budget& budget) {
  if (budget.steps() < 0) return InvalidArgument("job.budget.steps is below 0");
  if (budget.memory_bytes() < 0) return InvalidArgument("job.budget.memory_bytes is below 0");
  if (budget.output_bytes() < 0) return InvalidArgument("job.budget.output_bytes is below 0");
  if (budget.virtual_time_ns() < 0) return InvalidArgument("job.budget.virtual_time_ns is below 0");
  if (budget.processor_ns() < 0) return InvalidArgument("job.budget.processor_ns is below 0");
  return {};
}

// What google.protobuf.Timestamp allows.
Status CheckTime(const google::protobuf::Timestamp& time, const std::string& field) {
  constexpr std::int64_t kLeast_s = -62'135'596'800;
  constexpr std::int64_t kMost_s = 253'402'300'799;
  if (time.seconds() >= kLeast_s && time.seconds() <= kMost_s && time.nanos() >= 0 &&
      time.nanos() <= 999'999'999)
    return {};
  return InvalidArgument(field + " is no time of the years 1 to 9999");
}

Status CheckStepPlace(const v1::StepPlace& place, const std::string& field,
                      const machine::MachineFamily& family) {
  if (place.program() != 0) {
    if (const Status slot = CheckSlot(family, place.program(), field + ".program"); !slot)
      return slot.error();
  }
  if (place.step() < 1) return InvalidArgument(field + ".step is below 1");
  return {};
}

}  // namespace

std::string_view KindName(v1::JobKind kind) {
  switch (kind) {
    case v1::JOB_KIND_CHECK:
      return "CHECK";
    case v1::JOB_KIND_SIMULATE:
      return "SIMULATE";
    case v1::JOB_KIND_RUN:
      return "RUN";
    default:
      return "";
  }
}

Result<std::vector<std::int64_t>> AwaitedJobs(const v1::Job& job) {
  if (job.after_jobs_size() > kAwaitedJobsMax)
    return InvalidArgument("job.after_jobs has more than 100");
  std::vector<std::int64_t> jobs;
  for (const std::string& name : job.after_jobs()) {
    const Result<std::int64_t> id = ParseJobName(name);
    if (!id) return id.error();
    jobs.push_back(*id);
  }
  // What is to prove it is over before.
  const std::string& ticket = job.run().ticket();
  const auto proof = ParseJobName(ticket);
  if (!ticket.empty() && proof && std::ranges::find(jobs, *proof) == jobs.end())
    jobs.push_back(*proof);
  return jobs;
}

bool IsLabel(std::string_view text) {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.:/";
  return !text.empty() && text.size() <= kLabelMax &&
         text.find_first_not_of(kAllowed) == std::string_view::npos;
}

namespace {

// Where it begins, and what a person has seen to there. LIVE-6.03
Status CheckStep(const v1::RunOptions& run) {
  constexpr int kConfirmationsMax = 16;
  if (run.confirmations_size() > 0 && !run.has_step())
    return InvalidArgument("job.run.confirmations: they are asked for by a start at a step alone");
  if (!run.has_step() && (run.occurrence() != 0 || run.off_until_work_on()))
    return InvalidArgument("job.run.step: say where it begins");
  if (!run.has_step()) return {};
  if (run.occurrence() < 0) return InvalidArgument("job.run.occurrence counts from 1");
  if (run.step().step() < 1) return InvalidArgument("job.run.step.step: steps count from 1");
  if (run.step().program() < 0 || run.step().program() > 99)
    return InvalidArgument("job.run.step.program: 1 to 99, or 0 for the program itself");
  if (run.unzeroed())
    return InvalidArgument("job.run.unzeroed: what zeroes the axes begins at its first step");
  if (run.confirmations_size() > kConfirmationsMax)
    return InvalidArgument("job.run.confirmations has more than 16");
  const bool known = std::ranges::all_of(run.confirmations(), v1::Confirmation_IsValid);
  return known ? Status() : InvalidArgument("job.run.confirmations: one is none that there is");
}

// A RUN has what moves a machine and nothing else: its override and inputs are those of the
// machine.
Status CheckRun(const v1::Job& job) {
  if (job.kind() != v1::JOB_KIND_RUN)
    return job.has_run() ? InvalidArgument("job.run is for jobs of kind RUN") : Status();
  if (job.has_simulation())
    return InvalidArgument("job.simulation is not for jobs of kind RUN: set up the machine");
  if (job.has_budget()) return InvalidArgument("job.budget: no budget ends a moving machine");
  if (job.attempts_max() > 1) return InvalidArgument("job.attempts_max: a RUN is attempted once");
  if (!v1::ControlLease::OnLoss_IsValid(job.run().on_loss()))
    return InvalidArgument("job.run.on_loss is none that there is");
  if (!job.run().ticket().empty() && !ParseJobName(job.run().ticket()))
    return InvalidArgument("job.run.ticket: the simulation, such as jobs/17");
  return CheckStep(job.run());
}

Status CheckLabels(const v1::Job& job) {
  if (job.labels_size() > kLabelsMax) return InvalidArgument("job.labels has more than 16");
  std::set<std::string_view> labels;
  for (const std::string& label : job.labels()) {
    if (!IsLabel(label))
      return InvalidArgument("job.labels: '" + Readable(label) +
                             "' is none: 1 to 63 letters, digits, and - _ . : /");
    if (!labels.insert(label).second)
      return InvalidArgument("job.labels: '" + label + "' stands twice");
  }
  return {};
}

}  // namespace

Status CheckRequest(const v1::SubmitJobRequest& request) {
  const v1::Job& job = request.job();
  if (KindName(job.kind()).empty())
    return InvalidArgument("job.kind is missing: CHECK, SIMULATE or RUN");
  if (const Status good = CheckRun(job); !good) return good.error();
  if (job.priority() < storage::kPriorityMin || job.priority() > storage::kPriorityMax)
    return InvalidArgument("job.priority: allowed are -100 to 100");
  if (const Status time = CheckTime(job.not_before_time(), "job.not_before_time"); !time)
    return time.error();
  if (const std::string_view later = FieldOfLater(job); !later.empty())
    return Error{ErrorCode::kCellUnimplemented, "job." + std::string(later), {}};
  if (request.request_id().size() > kRequestIdMax)
    return InvalidArgument("request_id is longer than 64 characters");
  if (const Status good = CheckTitle(job.title(), "job.title"); !good) return good.error();
  if (const Status good = CheckLabels(job); !good) return good.error();
  if (job.attempts_max() < 0 || job.attempts_max() > 10)
    return InvalidArgument("job.attempts_max: allowed are 1 to 10");
  return CheckBudget(job.budget());
}

Status CheckSimulation(const v1::SimulationOptions& options, const machine::MachineFamily& family) {
  const double override_max = family.info().override_max_percent;
  if (options.override_percent() != 0.0) {
    const Status valid = bridge::CheckOverride(options.override_percent(), override_max);
    if (!valid) return InvalidArgument("job.simulation.override_percent: " + valid.error().detail);
  }
  if (!(options.toolpath_tolerance_mm() >= 0.0 && options.toolpath_tolerance_mm() <= 100.0)) {
    return InvalidArgument("job.simulation.toolpath_tolerance_mm: allowed are 0 to 100");
  }
  if (!(options.pace() >= 0.0 && options.pace() <= kPaceMax)) {
    return InvalidArgument("job.simulation.pace is " +
                           Told("pace", options.pace(), {}, ShortestText(options.pace())) +
                           ", allowed are 0 to 1000");
  }
  if (!v1::OperatingMode_IsValid(options.mode()))
    return InvalidArgument("job.simulation.mode is none that there is");
  if (options.mode() == v1::OPERATING_MODE_MANUAL) {
    return InvalidArgument(
        "job.simulation.mode is MANUAL, in which no program runs: use REMOTE, CYCLE, SINGLE or REPEAT");
  }
  if (options.breakpoints_size() > kBreakpointsMax)
    return InvalidArgument("job.simulation.breakpoints: at most 1,000");
  for (const v1::Breakpoint& breakpoint : options.breakpoints()) {
    if (const Status valid =
            CheckStepPlace(breakpoint.step(), "job.simulation.breakpoints.step", family);
        !valid)
      return valid.error();
    if (breakpoint.passes() < 0)
      return InvalidArgument("job.simulation.breakpoints.passes is below 0");
    if (const Status valid = family.CheckBreakpoint(bridge::FromProto(breakpoint, kSlotMin));
        !valid)
      return InvalidArgument("job.simulation.breakpoints: " + valid.error().detail);
  }
  if (options.has_simul()) {
    if (const Status valid = CheckStepPlace(options.simul(), "job.simulation.simul", family);
        !valid)
      return valid.error();
  }
  for (const v1::ScriptedInput& input : options.inputs()) {
    if (const auto valid = bridge::FromProto(input, override_max); !valid)
      return InvalidArgument("job.simulation.inputs: " + valid.error().detail);
  }
  for (const v1::SlotProgram& program : options.programs()) {
    if (const Status slot = CheckSlot(family, program.slot(), "job.simulation.programs.slot");
        !slot)
      return slot.error();
  }
  return {};
}

Status CheckVariables(const v1::SimulationOptions& options, const machine::MachineFamily& family,
                      const machine::Parameters& parameters) {
  const auto names =
      bridge::ExpandVariables({options.variables().begin(), options.variables().end()});
  if (!names) return InvalidArgument("job.simulation." + names.error().detail);
  for (const std::string& name : *names) {
    if (family.HasVariable(parameters, name)) continue;
    return InvalidArgument("job.simulation.variables: the machine has no variable " +
                           Told("variable", Readable(name)));
  }
  return {};
}

Status CheckBrought(const v1::Job& job, const std::string& file_name,
                    const machine::MachineFamily& family) {
  if (job.inline_slot() != 0) {
    if (const Status slot = CheckSlot(family, job.inline_slot(), "job.inline_slot"); !slot)
      return slot.error();
  }
  if (const Status named = CheckFileName(file_name, "the file name of the program"); !named)
    return named.error();
  const v1::MillTarget& target = job.simulation().milling().target();
  for (const std::string* of_target :
       {&target.file().file_name(), &target.inline_program().file_name()}) {
    if (const Status named = CheckFileName(*of_target, "the file name of the target"); !named)
      return named.error();
  }
  for (const v1::SlotProgram& program : job.simulation().programs()) {
    if (const Status named =
            CheckFileName(program.program().file_name(), "job.simulation.programs: a file name");
        !named)
      return named.error();
  }
  return CheckFileFamily(file_name, family);
}

}  // namespace rmlcell::server
