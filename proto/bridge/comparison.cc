#include "proto/bridge/comparison.h"

#include <algorithm>
#include <optional>

#include "engine/optimo/language/compiler.h"
#include "engine/optimo/offline/semantic_diff.h"
#include "engine/optimo/offline/translate.h"
#include "engine/simulation/families.h"
#include "engine/simulation/picture_difference.h"
#include "engine/simulation/trial_run.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

constexpr std::string_view kFamily = "optimo";

// The last part of a path.
std::string BaseName(const std::string& file_name) {
  return file_name.substr(file_name.find_last_of("/\\") + 1);
}

struct Side {
  optimo::Module module;
  std::optional<simulation::TrialRun> run;  // nothing when it could not begin
};

// The module of one program; nothing when it has errors.
Result<std::optional<optimo::Module>> ReadModule(const ComparedProgram& program,
                                                 std::vector<Diagnostic>& found,
                                                 std::uint64_t& dropped) {
  const machine::MachineFamily* named = simulation::FamilyOfFileName(program.file_name);
  if (named != nullptr && named->info().id != kFamily) {
    return Error{ErrorCode::kCellInvalidArgument,
                 program.file_name + " is a program for " + std::string(named->info().title) +
                     "; programs of the Amada OPTIMO can be compared",
                 {}};
  }
  const optimo::FileForm form = optimo::FormOfFile(program.file_name, *program.bytes);
  if (form == optimo::FileForm::kObject) {
    Result<optimo::Module> module = optimo::DecodeObject(*program.bytes);
    if (!module) return module.error();
    return std::optional(*std::move(module));
  }
  optimo::Compilation compiled =
      optimo::Compile(*program.bytes, program.file_name,
                      {.advice = false, .inch = form == optimo::FileForm::kInchSource});
  found = std::move(compiled.diagnostics);
  dropped = compiled.diagnostics_dropped;
  if (!compiled.ok) return std::optional<optimo::Module>();
  return std::optional(std::move(compiled.module));
}

// A run from a new machine; a program that calls others, or waits, does not end by itself.
Result<std::optional<simulation::TrialRun>> Run(const ComparedProgram& program,
                                                const ComparisonOptions& options) {
  const machine::MachineFamily* family = simulation::FindFamily(kFamily);
  const bool object =
      optimo::FormOfFile(program.file_name, *program.bytes) == optimo::FileForm::kObject;
  const SetupInput input{.family = family,
                         .programs = {{.slot = program.slot,
                                       .name = BaseName(program.file_name),
                                       .file_name = program.file_name,
                                       .bytes = program.bytes,
                                       .is_source = !object,
                                       .executable = nullptr}},
                         .main_program = program.slot};
  v1::SimulationOptions message;
  message.set_override_percent(100.0);
  v1::Budget budget;
  budget.set_steps(options.steps_max);
  Result<SetupOutcome> made = MakeSetup(input, message, budget);
  if (!made) return made.error();
  if (!made->setup) return std::optional<simulation::TrialRun>();
  simulation::SimulationOptions how;
  if (options.go_on)
    how.progress = [&options](const simulation::Progress&) { return options.go_on(); };
  Result<simulation::TrialRun> run =
      simulation::RunForComparison(*family, *std::move(made->setup), std::move(how));
  if (!run) return run.error();
  return std::optional(*std::move(run));
}

template <class Message>
void SetAspects(unsigned aspects, Message& message) {
  constexpr std::array kAspects = {std::pair(optimo::kAspectPath, v1::DIFF_ASPECT_PATH),
                                   std::pair(optimo::kAspectTime, v1::DIFF_ASPECT_TIME),
                                   std::pair(optimo::kAspectPower, v1::DIFF_ASPECT_POWER),
                                   std::pair(optimo::kAspectOutputs, v1::DIFF_ASPECT_OUTPUTS),
                                   std::pair(optimo::kAspectData, v1::DIFF_ASPECT_DATA),
                                   std::pair(optimo::kAspectFlow, v1::DIFF_ASPECT_FLOW)};
  for (const auto& [bit, aspect] : kAspects) {
    if ((aspects & bit) != 0) message.add_aspects(aspect);
  }
}

v1::DiffProgramsResponse MessageOf(const optimo::ProgramDiff& diff, std::size_t changes_max) {
  v1::DiffProgramsResponse message;
  message.set_equal(diff.equal());
  SetAspects(diff.aspects, message);
  const std::size_t kept = std::min(diff.steps.size(), changes_max);
  message.set_steps_dropped(static_cast<std::int64_t>(diff.steps.size() - kept));
  for (std::size_t i = 0; i < kept; ++i) {
    const optimo::StepChange& change = diff.steps[i];
    v1::DiffProgramsResponse::StepChange& step = *message.add_steps();
    step.set_step_before(change.step_a);
    step.set_step_after(change.step_b);
    SetAspects(change.aspects, step);
    step.set_before(Utf8(change.before));
    step.set_after(Utf8(change.after));
    for (const std::string& what : change.what) step.add_what(Utf8(what));
    step.set_target_moved_mm(change.target_moved_mm);
  }
  for (const optimo::FigureChange& change : diff.figures) {
    v1::DiffProgramsResponse::FigureChange& figure = *message.add_figures();
    figure.set_name(change.name);
    figure.set_unit(change.unit);
    figure.set_before(change.before);
    figure.set_after(change.after);
  }
  return message;
}

// "stopped at 1/7, OPT-E348"; empty: it ran to its end.
std::string NoteOf(const machine::Outcome& outcome) {
  if (outcome.kind == machine::OutcomeKind::kCompleted) return {};
  std::string text(simulation::OutcomeText(outcome.kind));
  std::ranges::replace(text, '_', ' ');
  text += " at " + std::to_string(outcome.place.program) + '/' + std::to_string(outcome.place.step);
  if (outcome.code) text += ", " + CodeText(*outcome.code);
  return text;
}

std::string Picture(const std::array<ComparedProgram, 2>& programs,
                    const std::array<Side, 2>& sides, const ComparisonOptions& options) {
  std::vector<simulation::ComparedFigure> figures;
  const auto& before = sides[0].run->figures;
  const auto& after = sides[1].run->figures;
  for (std::size_t i = 0; i < before.size() && i < after.size(); ++i) {
    figures.push_back({before[i].name, before[i].unit, before[i].value, after[i].value});
  }
  const auto path = [&](std::size_t side) {
    return simulation::ComparedPath{.path = sides[side].run->path->sketch(),
                                    .title = BaseName(programs[side].file_name),
                                    .note = NoteOf(sides[side].run->outcome)};
  };
  const machine::MachineFamily* family = simulation::FindFamily(kFamily);
  const machine::MachineShape shape = family->Shape(machine::Parameters(family->parameters()));
  return simulation::PictureOfDifference(path(0), path(1), shape, figures, {},
                                         options.picture_elements_max);
}

}  // namespace

Result<ComparisonOutcome> ComparePrograms(const ComparedProgram& before,
                                          const ComparedProgram& after,
                                          const ComparisonOptions& options) {
  const std::array<ComparedProgram, 2> programs = {before, after};
  std::array<Side, 2> sides;
  ComparisonOutcome outcome;
  outcome.ok = true;
  for (std::size_t i = 0; i < 2; ++i) {
    auto module = ReadModule(programs[i], outcome.diagnostics[i], outcome.dropped[i]);
    if (!module) return module.error();
    if (*module) sides[i].module = **std::move(module);
    outcome.ok = outcome.ok && *module;
  }
  if (!outcome.ok) return outcome;
  for (std::size_t i = 0; i < 2; ++i) {
    auto run = Run(programs[i], options);
    if (!run) return run.error();
    sides[i].run = *std::move(run);
  }
  const bool both_ran = std::ranges::all_of(sides, [](const Side& side) {
    return side.run && side.run->outcome.kind == machine::OutcomeKind::kCompleted;
  });
  const std::vector<machine::Figure> none;
  const optimo::ProgramDiff diff =
      optimo::Diff(sides[0].module, sides[1].module, both_ran ? sides[0].run->figures : none,
                   both_ran ? sides[1].run->figures : none);
  outcome.response = MessageOf(diff, options.changes_max);
  outcome.response.set_compared_runs(both_ran);
  if (options.picture && sides[0].run && sides[1].run) {
    outcome.response.set_picture_svg(Picture(programs, sides, options));
  }
  return outcome;
}

}  // namespace rmlcell::bridge
