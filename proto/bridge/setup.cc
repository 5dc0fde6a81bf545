#include "proto/bridge/setup.h"

#include <algorithm>
#include <cctype>

#include "engine/core/number_text.h"
#include "proto/bridge/inputs.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

constexpr std::size_t kVariablesMax = 1000;
constexpr std::size_t kShownNameMax = 80;

machine::Mode FromProto(v1::OperatingMode mode, machine::Mode standard) {
  switch (mode) {
    case v1::OPERATING_MODE_CYCLE:
      return machine::Mode::kCycle;
    case v1::OPERATING_MODE_SINGLE:
      return machine::Mode::kSingle;
    case v1::OPERATING_MODE_REPEAT:
      return machine::Mode::kRepeat;
    case v1::OPERATING_MODE_REMOTE:
      return machine::Mode::kRemote;
    default:
      return standard;
  }
}

machine::ProgramStep StepOf(const v1::StepPlace& place, int main_program) {
  return {.program = place.program() > 0 ? place.program() : main_program, .step = place.step()};
}

}  // namespace

machine::Breakpoint FromProto(const v1::Breakpoint& breakpoint, int main_program) {
  return {.at = StepOf(breakpoint.step(), main_program),
          .condition = breakpoint.condition(),
          .from_pass = static_cast<std::uint64_t>(std::max<std::int64_t>(1, breakpoint.passes()))};
}

Result<simulation::RunOptions> RunOptionsOf(const v1::SimulationOptions& options,
                                            const v1::Budget& budget, int main_program,
                                            machine::Mode default_mode) {
  Result<machine::InputScript> inputs = InputsOf(options);
  if (!inputs) return inputs.error();
  simulation::RunOptions run{
      .main_program = main_program,
      .parameters = {options.parameters().begin(), options.parameters().end()},
      .mode = FromProto(options.mode(), default_mode),
      .inputs = *std::move(inputs)};
  if (options.override_percent() > 0.0) run.override_percent = options.override_percent();
  for (const v1::Breakpoint& breakpoint : options.breakpoints())
    run.breakpoints.push_back(FromProto(breakpoint, main_program));
  // A plain one alone is that of the machine: where its state is kept it is kept with it.
  if (run.breakpoints.size() == 1 &&
      run.breakpoints.front() == machine::Breakpoint{.at = run.breakpoints.front().at}) {
    run.breakpoint = run.breakpoints.front().at;
    run.breakpoints.clear();
  }
  if (options.has_simul()) run.simul = StepOf(options.simul(), main_program);
  if (budget.steps() > 0) run.budget.steps = static_cast<std::uint64_t>(budget.steps());
  if (budget.virtual_time_ns() > 0) run.budget.virtual_time = SimTime(budget.virtual_time_ns());
  return run;
}

Result<std::vector<std::string>> ExpandVariables(const std::vector<std::string>& names) {
  std::vector<std::string> expanded;
  for (const std::string& name : names) {
    const std::size_t open = name.find('[');
    const std::size_t dots = name.find("..");
    if (dots == std::string::npos) {
      expanded.push_back(name);
    } else {
      const auto low = open == std::string::npos
                           ? std::nullopt
                           : ParseInteger(name.substr(open + 1, dots - open - 1));
      const auto high = name.ends_with(']')
                            ? ParseInteger(name.substr(dots + 2, name.size() - dots - 3))
                            : std::nullopt;
      if (!low || !high || *low < 0 || *low > *high || *high > 999) {
        return Error{
            ErrorCode::kCellInvalidArgument,
            "variables: '" + Told("name", name.substr(0, kShownNameMax)) + "': write VR[0..9]",
            {}};
      }
      for (long long i = *low; i <= *high; ++i) {
        expanded.push_back(name.substr(0, open + 1) + std::to_string(i) + "]");
      }
    }
    if (expanded.size() > kVariablesMax) {
      return Error{ErrorCode::kCellInvalidArgument, "variables: more than 1,000", {}};
    }
  }
  return expanded;
}

}  // namespace rmlcell::bridge
