#include "engine/optimo/control/optimo_family.h"

#include <array>
#include <vector>

#include "engine/core/units.h"
#include "engine/optimo/control/break_condition.h"
#include "engine/optimo/control/optimo_run.h"
#include "engine/optimo/control/optimo_standing.h"
#include "engine/optimo/control/optimo_tools.h"
#include "engine/optimo/control/process_watch.h"
#include "engine/optimo/control/run_needs.h"
#include "engine/optimo/editing/optimo_editing.h"
#include "engine/optimo/handbox/optimo_handbox.h"
#include "engine/optimo/handbox/steps.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/language/staleness.h"
#include "engine/optimo/offline/house_programs.h"
#include "engine/optimo/offline/project.h"
#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

constexpr std::array kOfMotion = {ErrorCode::kTargetOutOfTravel, ErrorCode::kSpeedHeldByAxis,
                                  ErrorCode::kFlyReversal, ErrorCode::kNoMotion};
constexpr std::array kBySpeed = {ErrorCode::kNoMotion};
constexpr std::array kNotGiven = {ErrorCode::kProgramMissing, ErrorCode::kFunctionMissing,
                                  ErrorCode::kCallNotExecutable};

constexpr machine::CheckCodes kCheck = {
    .of_motion = kOfMotion, .by_speed = kBySpeed, .not_given = kNotGiven, .work_offset = "SYSDEF"};

constexpr std::array<std::string_view, 2> kWaiting = {"WAIT", "DELAY"};

constexpr machine::FamilyInfo kInfo = {.id = "optimo",
                                       .title = "Amada OPTIMO 5-axis laser",
                                       .extensions = ".S .SI .CMP .O",
                                       .axes = "X Y Z A B",
                                       .editor_language = "optimo-rml",
                                       .has_executables = true,
                                       .schedules = 63,  // OPT-3.44
                                       .checked_by_running = true,
                                       .hold_in_remote = false,  // OPT-4.17
                                       .default_profile = "standard",
                                       .override_min_percent = 10.0,  // OPT-4.34
                                       .override_max_percent = 145.0,
                                       .override_step_percent = 15.0,
                                       .has_repeat = true,
                                       .jog_axes = "X Y Z A B C",  // OPT-4.20
                                       .jogs_in_manual = true,
                                       .zero_program = "ZERO\n",
                                       .home_program = 4,  // OPT-4.50
                                       .waiting = kWaiting,
                                       .steps_come_again = true,
                                       .has_dry_run = true,
                                       .has_breakpoints = true,
                                       .no_slot = ErrorCode::kProgramNumber,
                                       .empty_slot = ErrorCode::kProgramMissing,
                                       .in_use = ErrorCode::kProgramInUse,
                                       .no_schedule = ErrorCode::kScheduleRange,
                                       .travel_left = ErrorCode::kTargetOutOfTravel,
                                       .not_zeroed = ErrorCode::kNotZeroed,
                                       .emergency_stop = ErrorCode::kEmergencyStop,
                                       .given_twice = ErrorCode::kProjectDuplicate,
                                       .no_source = ErrorCode::kProjectSource,
                                       .check = kCheck};

constexpr std::array kCounts = {
    machine::FigureInfo{"lookahead_starved", "",
                        "knots that the planner had to decide before it could see enough"},
    machine::FigureInfo{"executables_made", "", "executables that the run had to make"},
};

std::span<const machine::FigureInfo> Figures() {
  static const auto figures = [] {
    std::vector<machine::FigureInfo> all(kCounts.begin(), kCounts.end());
    for (const machine::FigureInfo& info : ProcessWatch::FigureTable()) all.push_back(info);
    return all;
  }();
  return figures;
}

machine::StaleReason ReasonOf(StaleReason reason) {
  switch (reason) {
    case StaleReason::kObjectChanged:
      return machine::StaleReason::kObjectChanged;
    case StaleReason::kObjectMissing:
      return machine::StaleReason::kObjectMissing;
    case StaleReason::kFunctionChanged:
      return machine::StaleReason::kFunctionChanged;
    case StaleReason::kFunctionDeleted:
      return machine::StaleReason::kFunctionDeleted;
    case StaleReason::kDamaged:
      break;
  }
  return machine::StaleReason::kDamaged;
}

class Family final : public machine::MachineFamily {
 public:
  const machine::FamilyInfo& info() const override { return kInfo; }
  std::span<const machine::ParameterInfo> parameters() const override {
    return OptimoParameterTable();
  }
  std::span<const machine::MachineProfile> profiles() const override { return OptimoProfiles(); }
  Status CheckParameters(const machine::Parameters& parameters) const override {
    return CheckFit(parameters);
  }
  bool HasVariable(const machine::Parameters& /*parameters*/,
                   std::string_view name) const override {
    return ReadByName(DataArea(), name).has_value();
  }
  std::span<const machine::FigureInfo> figures() const override { return Figures(); }
  std::span<const machine::VerdictRule> verdict_rules() const override {
    return ProcessWatch::VerdictRules();
  }
  machine::MachineShape Shape(const machine::Parameters& parameters) const override {
    return ShapeOf(Resolve(parameters));
  }
  Result<std::unique_ptr<machine::Handbox>> NewHandbox(const machine::Parameters& parameters,
                                                       std::string_view saved) const override {
    const Result<HandboxModes> modes = OptimoHandbox::ReadModes(saved);
    if (!modes) return modes.error();
    return std::unique_ptr<machine::Handbox>(std::make_unique<OptimoHandbox>(parameters, *modes));
  }
  Result<std::string> UndoEdit(const machine::ProgramEdit& edit,
                               std::string_view object) const override {
    return UndoProgramEdit(edit, object);
  }

  machine::Translation Translate(const machine::SourceFile& file,
                                 const machine::Parameters& parameters,
                                 const machine::CheckOptions& options) const override {
    const OptimoParameters resolved = Resolve(parameters);
    return TranslateOptimo(file, options, static_cast<std::uint32_t>(resolved.object_limit),
                           ContourMachineOf(resolved));
  }

  const machine::Tools* tools() const override { return &OptimoTools(); }
  const machine::Editing* editing() const override { return &OptimoEditing(); }
  std::vector<machine::LanguageWord> words() const override { return OptimoWords(); }

  std::vector<Diagnostic> CheckSlot(int slot, std::string_view program) const override {
    return CheckProgramNumber(slot, program);
  }
  std::span<const machine::SpecialProgram> special_programs() const override {
    return HousePrograms();
  }

  std::vector<Diagnostic> CheckProcess(
      const machine::ProcessDefinition& definition) const override {
    return optimo::CheckProcess(definition);
  }

  machine::TransferPlan PlanTransfer(const machine::ProjectBundle& project,
                                     const machine::Parameters& parameters,
                                     const machine::TransferOptions& options) const override {
    const OptimoParameters resolved = Resolve(parameters);
    return optimo::PlanTransfer(project, options, static_cast<std::uint32_t>(resolved.object_limit),
                                ContourMachineOf(resolved));
  }

  Status CheckExecutable(std::string_view executable, int slot) const override {
    const Result<Executable> decoded = DecodeExecutable(executable);
    if (!decoded) return decoded.error();
    const int made_of = decoded->modules.front().slot;
    if (made_of == slot) return {};
    return Error{ErrorCode::kCellInvalidArgument,
                 "the executable is that of program " + Told("holds", made_of) + ", not of " +
                     Told("program", slot) + ": store it as " +
                     Told("executable", made_of + kExecutableOffset),
                 {}};
  }

  std::optional<machine::MemoryLimit> ProgramMemory(
      const machine::Parameters& parameters) const override {
    return machine::MemoryLimit{.bytes = static_cast<std::int64_t>(Resolve(parameters).cmos_bytes),
                                .full = ErrorCode::kCmosFull};
  }

  Status CheckNeeds(const std::map<int, machine::StoredProgram>& programs,
                    const std::vector<machine::LaserSchedule>& schedules,
                    const machine::Parameters& parameters, int main_slot) const override {
    return optimo::CheckNeeds(
        {.programs = programs, .schedules = schedules, .parameters = Resolve(parameters)},
        main_slot);
  }

  std::vector<machine::StaleExecutable> FindStaleExecutables(
      const std::map<int, machine::StoredProgram>& programs,
      const std::set<int>& deleted) const override {
    std::map<int, std::string_view> executables;
    for (const auto& [slot, program] : programs) {
      if (program.executable != nullptr) executables[slot] = *program.executable;
    }
    std::vector<machine::StaleExecutable> stale;
    for (const StaleExecutable& one :
         optimo::FindStaleExecutables(executables, {ObjectsOf(programs), deleted})) {
      machine::StaleExecutable& made = stale.emplace_back();
      made.slot = one.slot;
      for (const StalePart& part : one.parts) {
        made.parts.push_back(
            {part.slot, ReasonOf(part.reason), ReasonText(part.slot, part.reason)});
      }
    }
    return stale;
  }

  Result<std::unique_ptr<machine::Run>> NewRun(machine::RunSetup setup,
                                               machine::RunObserver& observer) const override {
    if (const Status fit = CheckFit(setup.parameters); !fit) return fit.error();
    if (!setup.machine_state.empty()) {
      if (const Result<MachineState> state = DecodeMachineState(setup.machine_state); !state)
        return state.error();
    }
    const OptimoParameters resolved = Resolve(setup.parameters);
    return std::unique_ptr<machine::Run>(
        std::make_unique<OptimoRun>(resolved, std::move(setup), observer));
  }

  Result<std::unique_ptr<machine::Standing>> NewStanding(
      const machine::Parameters& parameters, std::string_view machine_state) const override {
    if (const Status fit = CheckFit(parameters); !fit) return fit.error();
    const OptimoParameters resolved = Resolve(parameters);
    MachineState state = NewMachine(resolved);
    if (!machine_state.empty()) {
      Result<MachineState> kept = DecodeMachineState(machine_state);
      if (!kept) return kept.error();
      state = *std::move(kept);
    }
    return std::unique_ptr<machine::Standing>(
        std::make_unique<OptimoStanding>(resolved, std::move(state)));
  }

  Status CheckBreakpoint(const machine::Breakpoint& breakpoint) const override {
    if (!breakpoint.condition.empty()) {
      const Result<Condition> condition = ReadCondition(breakpoint.condition);
      if (!condition) return condition.error();
    }
    // That of streams, but for what they do not have.
    const bool counts =
        breakpoint.from_pass >= 1 && breakpoint.from_pass <= machine::kBreakpointPassMax;
    return machine::MachineFamily::CheckBreakpoint(
        {.at = breakpoint.at, .from_pass = counts ? 1 : breakpoint.from_pass});
  }

  Status CheckWrite(const machine::Parameters& parameters, std::string_view name,
                    double value) const override {
    const std::optional<Variable> variable = VariableNamed(name);
    if (!variable) return machine::MachineFamily::CheckWrite(parameters, name, value);
    const Result<float> number = Writable(*variable, value, Resolve(parameters));
    if (!number) return number.error();
    return {};
  }
};

}  // namespace

const machine::MachineFamily& OptimoFamily() {
  static const Family family;
  return family;
}

}  // namespace rmlcell::optimo
