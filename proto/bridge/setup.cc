#include "proto/bridge/setup.h"

#include <algorithm>
#include <cctype>

#include "engine/core/number_text.h"
#include "engine/families/families.h"
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

std::optional<machine::ProgramStep> StepOf(const v1::StepPlace& place, int main_program) {
  return machine::ProgramStep{.program = place.program() > 0 ? place.program() : main_program,
                              .step = place.step()};
}

// Translates one program into the setup. False: it has errors.
bool AddProgram(const SetupInput& input, const ProgramInput& program, machine::RunSetup& setup,
                SetupOutcome& outcome) {
  machine::StoredProgram stored{
      .name = program.name, .object = program.bytes, .executable = program.executable};
  if (program.is_source && !families::IsObjectFileName(program.file_name)) {
    machine::Translation translation = input.family->Translate(
        {.name = program.file_name, .bytes = *program.bytes}, setup.parameters,
        {.advice = program.slot == input.main_program, .source = true});
    for (Diagnostic& diagnostic : translation.diagnostics) {
      if (outcome.diagnostics.size() >= machine::kDiagnosticsMax) {
        ++outcome.diagnostics_dropped;
        continue;
      }
      diagnostic.program = program.slot;
      outcome.diagnostics.push_back(std::move(diagnostic));
    }
    outcome.diagnostics_dropped += translation.diagnostics_dropped;
    if (!translation.ok) return false;
    stored.object = std::make_shared<const std::string>(std::move(translation.object));
    stored.source = std::make_shared<const machine::SourceNotes>(std::move(translation.source));
  }
  setup.programs[program.slot] = std::move(stored);
  return true;
}

}  // namespace

Result<machine::Parameters> MakeParameters(const machine::MachineFamily& family,
                                           const std::string& profile,
                                           const std::map<std::string, std::string>& parameters) {
  machine::Parameters made(family.parameters());
  if (!profile.empty()) {
    const auto profiles = family.profiles();
    const auto found = std::ranges::find_if(
        profiles,
        [&](const machine::MachineProfile& candidate) { return candidate.id == profile; });
    if (found == profiles.end()) {
      std::string known;
      for (const machine::MachineProfile& candidate : profiles)
        known += " " + std::string(candidate.id);
      return Error{
          ErrorCode::kCellInvalidArgument, "no profile '" + profile + "'; there are" + known, {}};
    }
    if (const Status applied = made.Apply(*found); !applied) return applied.error();
  }
  for (const auto& [name, value] : parameters) {
    if (const Status set = made.Set(name, std::string_view(value)); !set) return set.error();
  }
  if (const Status fit = family.CheckParameters(made); !fit) return fit.error();
  return made;
}

machine::InputChange FromProto(const v1::ScriptedInput& input) {
  machine::InputChange change{
      .at = FromSeconds(input.at_s()), .index = input.index(), .value = input.value()};
  switch (input.kind()) {
    case v1::ScriptedInput::KIND_ANALOGUE_INPUT:
      change.kind = machine::InputKind::kAnalogue;
      break;
    case v1::ScriptedInput::KIND_DOOR:
      change.kind = machine::InputKind::kDoor;
      break;
    case v1::ScriptedInput::KIND_START:
      change.kind = machine::InputKind::kStart;
      break;
    case v1::ScriptedInput::KIND_HOLD:
      change.kind = machine::InputKind::kHold;
      break;
    case v1::ScriptedInput::KIND_STOP:
      change.kind = machine::InputKind::kStop;
      break;
    case v1::ScriptedInput::KIND_EMERGENCY_STOP:
      change.kind = machine::InputKind::kEmergencyStop;
      break;
    case v1::ScriptedInput::KIND_OVERRIDE:
      change.kind = machine::InputKind::kOverride;
      break;
    default:
      change.kind = machine::InputKind::kLogical;
  }
  return change;
}

machine::InputScript InputsOf(const v1::SimulationOptions& options) {
  machine::InputScript inputs;
  for (const v1::ScriptedInput& scripted : options.inputs()) inputs.push_back(FromProto(scripted));
  std::ranges::stable_sort(inputs, {}, &machine::InputChange::at);
  return inputs;
}

Result<SetupOutcome> MakeSetup(const SetupInput& input, const v1::SimulationOptions& options,
                               const v1::Budget& budget) {
  std::map<std::string, std::string> values = input.parameters;
  for (const auto& [name, value] : options.parameters()) values[name] = value;
  Result<machine::Parameters> parameters = MakeParameters(*input.family, input.profile, values);
  if (!parameters) return parameters.error();

  machine::RunSetup setup(std::move(*parameters));
  setup.deleted_programs = {input.deleted_programs.begin(), input.deleted_programs.end()};
  setup.main_program = input.main_program;
  setup.schedules = input.schedules;
  setup.machine_state = input.machine_state;
  setup.mode = FromProto(options.mode(), input.default_mode);
  setup.forecast = true;  // who moves a machine says otherwise
  if (options.override_percent() > 0.0) setup.override_percent = options.override_percent();
  if (options.has_breakpoint()) setup.breakpoint = StepOf(options.breakpoint(), input.main_program);
  if (options.has_simul()) setup.simul = StepOf(options.simul(), input.main_program);
  setup.inputs = InputsOf(options);
  if (budget.steps() > 0) setup.budget.steps = static_cast<std::uint64_t>(budget.steps());
  if (budget.virtual_time_s() > 0.0)
    setup.budget.virtual_time = FromSeconds(budget.virtual_time_s());

  SetupOutcome outcome;
  bool good = true;
  for (const ProgramInput& program : input.programs) {
    if (!AddProgram(input, program, setup, outcome)) good = false;
  }
  if (good) outcome.setup.emplace(std::move(setup));
  return outcome;
}

machine::RunSetup SetupForCheck(const SetupInput& input, machine::Parameters parameters,
                                const machine::Translation& main) {
  machine::RunSetup setup(std::move(parameters));
  setup.deleted_programs = {input.deleted_programs.begin(), input.deleted_programs.end()};
  setup.main_program = input.main_program;
  setup.schedules = input.schedules;
  setup.machine_state = input.machine_state;
  SetupOutcome ignored;
  for (const ProgramInput& program : input.programs) {
    if (program.slot != input.main_program) AddProgram(input, program, setup, ignored);
  }
  machine::StoredProgram stored{
      .name = {},
      .object = std::make_shared<const std::string>(main.object),
      .executable = nullptr,
      .source = std::make_shared<const machine::SourceNotes>(main.source)};
  setup.programs[input.main_program] = std::move(stored);
  return setup;
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
        return Error{ErrorCode::kCellInvalidArgument,
                     "variables: '" + name.substr(0, kShownNameMax) + "': write VR[0..9]",
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
