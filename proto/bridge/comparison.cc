#include "proto/bridge/comparison.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "engine/families/families.h"
#include "engine/simulation/picture/picture_difference.h"
#include "engine/simulation/run/trial_run.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

// The last part of a path.
std::string BaseName(const std::string& file_name) {
  return file_name.substr(file_name.find_last_of("/\\") + 1);
}

constexpr std::array<std::size_t, 2> kBoth = {0, 1};  // before and after

struct Side {
  std::string object;
  std::optional<simulation::TrialRun> run;  // nothing when it could not begin
};

// The family of both programs.
Result<const machine::MachineFamily*> FamilyOf(const std::array<ComparedProgram, 2>& programs) {
  Result<const machine::MachineFamily*> family =
      families::FamilyThatCompares(programs[0].file_name);
  if (!family) return family.error();
  const auto other = families::FamilyThatCompares(programs[1].file_name);
  if (!other) return other.error();
  if (*family == *other) return family;
  return Error{ErrorCode::kCellInvalidArgument,
               programs[0].file_name + " and " + programs[1].file_name +
                   " are programs for different machines",
               {}};
}

machine::FileForm FormOf(const machine::MachineFamily& family, const ComparedProgram& program) {
  // A stream is its own object.
  return program.is_object || family.tools() == nullptr
             ? machine::FileForm::kObject
             : family.tools()->FormOf(program.file_name, *program.bytes);
}

// The object of one program; nothing when it has errors.
std::optional<std::string> ObjectOf(const machine::MachineFamily& family,
                                    const ComparedProgram& program,
                                    const machine::Parameters& parameters,
                                    std::vector<Diagnostic>& found, UntoldFindings& dropped) {
  const machine::FileForm form = FormOf(family, program);
  if (form == machine::FileForm::kObject) return std::string(*program.bytes);
  machine::CompiledProgram compiled =
      family.tools()->Compile({.name = program.file_name, .bytes = *program.bytes}, parameters,
                              {.advice = false, .inch = form == machine::FileForm::kInchSource});
  found = std::move(compiled.diagnostics);
  dropped = compiled.diagnostics_dropped;
  if (!compiled.ok) return std::nullopt;
  return std::move(compiled.object);
}

// A run from a new machine; a program that calls others, or waits, does not end by itself.
Result<std::optional<simulation::TrialRun>> Run(const machine::MachineFamily& family,
                                                const ComparedProgram& program,
                                                const ComparisonOptions& options) {
  const bool object = FormOf(family, program) == machine::FileForm::kObject;
  const simulation::ProgramMemory memory{.family = &family,
                                         .profile = options.profile,
                                         .parameters = options.parameters,
                                         .programs = {{.slot = program.slot,
                                                       .name = BaseName(program.file_name),
                                                       .file_name = program.file_name,
                                                       .bytes = program.bytes,
                                                       .is_source = !object}}};
  simulation::RunOptions how_to_run{.main_program = program.slot};
  if (options.steps_max > 0)
    how_to_run.budget.steps = static_cast<std::uint64_t>(options.steps_max);
  Result<simulation::PreparedRun> made = simulation::PrepareRun(memory, how_to_run);
  if (!made) return made.error();
  if (!made->setup) return std::optional<simulation::TrialRun>();
  simulation::SimulationOptions how;
  if (options.go_on)
    how.progress = [&options](const simulation::Progress&) { return options.go_on(); };
  Result<simulation::TrialRun> run =
      simulation::RunForComparison(family, *std::move(made->setup), std::move(how));
  if (!run) return run.error();
  return std::optional(*std::move(run));
}

template <class Message>
void SetAspects(unsigned aspects, Message& message) {
  constexpr std::array kAspects = {std::pair(machine::kAspectPath, v1::DIFF_ASPECT_PATH),
                                   std::pair(machine::kAspectTime, v1::DIFF_ASPECT_TIME),
                                   std::pair(machine::kAspectPower, v1::DIFF_ASPECT_POWER),
                                   std::pair(machine::kAspectOutputs, v1::DIFF_ASPECT_OUTPUTS),
                                   std::pair(machine::kAspectData, v1::DIFF_ASPECT_DATA),
                                   std::pair(machine::kAspectFlow, v1::DIFF_ASPECT_FLOW)};
  for (const auto& [bit, aspect] : kAspects) {
    if ((aspects & bit) != 0) message.add_aspects(aspect);
  }
}

v1::DiffProgramsResponse MessageOf(const machine::ProgramDiff& diff, std::size_t changes_max) {
  v1::DiffProgramsResponse message;
  message.set_equal(diff.equal());
  SetAspects(diff.aspects, message);
  const std::size_t kept = std::min(diff.steps.size(), changes_max);
  message.set_steps_dropped(static_cast<std::int64_t>(diff.steps.size() - kept));
  for (std::size_t i = 0; i < kept; ++i) {
    const machine::StepChange& change = diff.steps[i];
    v1::DiffProgramsResponse::StepChange& step = *message.add_steps();
    step.set_step_before(change.step_a);
    step.set_step_after(change.step_b);
    SetAspects(change.aspects, step);
    step.set_before(Utf8(change.before));
    step.set_after(Utf8(change.after));
    for (const std::string& what : change.what) step.add_what(Utf8(what));
    step.set_target_moved_mm(change.target_moved_mm);
  }
  for (const machine::FigureChange& change : diff.figures) {
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

// What the figures of a run leave out; empty: nothing.
std::string LeftOut(const simulation::TrialRun& run, const machine::FamilyInfo& info) {
  if (std::string note = NoteOf(run.outcome); !note.empty()) return note;
  const auto torn = std::ranges::find_if(
      run.reasons, [&](const machine::Reason& reason) { return info.torn == reason.code; });
  return torn == run.reasons.end() ? Detail() : torn->said;
}

std::string Picture(const machine::MachineFamily& family,
                    const std::array<ComparedProgram, 2>& programs,
                    const std::array<Side, 2>& sides, const machine::Parameters& parameters,
                    const ComparisonOptions& options) {
  std::vector<simulation::ComparedFigure> figures;
  const auto& before = sides[0].run->figures;
  const auto& after = sides[1].run->figures;
  std::ranges::transform(
      before, after, std::back_inserter(figures),
      [](const machine::Figure& one, const machine::Figure& other) {
        return simulation::ComparedFigure{one.name, one.unit, one.value, other.value};
      });
  const auto path = [&](std::size_t side) {
    return simulation::ComparedPath{.path = sides[side].run->path->sketch(),
                                    .title = BaseName(programs[side].file_name),
                                    .note = NoteOf(sides[side].run->outcome)};
  };
  const machine::MachineShape shape = family.Shape(parameters);
  const machine::MachineUsed used = parameters.Used();
  std::string machine = machine::MachineTitle(family, used.profile, used.named, used.own_name);
  if (const std::string changes = used.ChangesText(); !changes.empty())
    machine += "   ·   changed: " + changes;
  return simulation::PictureOfDifference(path(0), path(1), shape, figures, {},
                                         options.picture_elements_max, machine);
}

}  // namespace

Result<ComparisonOutcome> ComparePrograms(const ComparedProgram& before,
                                          const ComparedProgram& after,
                                          const ComparisonOptions& options) {
  const std::array<ComparedProgram, 2> programs = {before, after};
  std::array<Side, 2> sides;
  ComparisonOutcome outcome;
  outcome.ok = true;
  const Result<const machine::MachineFamily*> found = FamilyOf(programs);
  if (!found) return found.error();
  const machine::MachineFamily& family = **found;
  Result<machine::Parameters> parameters =
      machine::MakeParameters(family, options.profile, options.parameters);
  if (!parameters) return parameters.error();
  parameters->SetChangedBy(options.parameters_of);
  parameters->SetOwn(options.own);
  for (const std::size_t i : kBoth) {
    auto object =
        ObjectOf(family, programs[i], *parameters, outcome.diagnostics[i], outcome.dropped[i]);
    outcome.ok = outcome.ok && object;
    if (object) sides[i].object = *std::move(object);
  }
  if (!outcome.ok) return outcome;
  for (const std::size_t i : kBoth) {
    auto run = Run(family, programs[i], options);
    if (!run) return run.error();
    sides[i].run = *std::move(run);
  }
  const bool both_ran = std::ranges::all_of(sides, [](const Side& side) {
    return side.run && side.run->outcome.kind == machine::OutcomeKind::kCompleted;
  });
  const std::vector<machine::Figure> none;
  const Result<machine::ProgramDiff> diff = families::Diff(
      family, {.object = sides[0].object, .figures = both_ran ? sides[0].run->figures : none},
      {.object = sides[1].object, .figures = both_ran ? sides[1].run->figures : none}, *parameters);
  if (!diff) return diff.error();
  outcome.response = MessageOf(*diff, options.changes_max);
  outcome.response.set_compared_runs(both_ran);
  outcome.response.set_family(std::string(family.info().id));
  SetMachine(parameters->Used(), outcome.response);
  for (const std::size_t i : kBoth) {
    const std::string note = sides[i].run ? LeftOut(*sides[i].run, family.info()) : std::string();
    if (!note.empty()) {
      outcome.response.add_notes(Utf8(BaseName(programs[i].file_name) + ": " + note));
    }
  }
  if (options.picture && sides[0].run && sides[1].run) {
    outcome.response.set_picture_svg(Picture(family, programs, sides, *parameters, options));
  }
  return outcome;
}

}  // namespace rmlcell::bridge
