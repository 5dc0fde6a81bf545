#include "engine/simulation/run/rehearsal.h"

#include <algorithm>
#include <utility>

#include "engine/core/keep_finding.h"
#include "engine/families/families.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/simulation/verdict/verdict.h"

namespace rmlcell::simulation {
namespace {

machine::StoredProgram Stored(const MemoryProgram& program) {
  return {.name = program.name, .object = program.bytes, .executable = program.executable};
}

// `stored` has the bytes that were translated.
void TakeTranslation(machine::Translation translation, machine::StoredProgram& stored) {
  if (!translation.as_it_came) stored.object = machine::Bytes::Of(std::move(translation.object));
  stored.source = std::make_shared<const machine::SourceNotes>(std::move(translation.source));
}

// Into the setup; translated first, where it is a source. False: it has errors.
bool AddProgram(const machine::MachineFamily& family, const MemoryProgram& program,
                machine::RunSetup& setup, PreparedRun& prepared) {
  machine::StoredProgram stored = Stored(program);
  if (program.translation != nullptr) {
    TakeTranslation(*program.translation, stored);
  } else if (program.is_source && !families::IsObjectFileName(program.file_name)) {
    const bool main = program.slot == setup.main_program;
    machine::Translation translation =
        TranslateProgram(family, setup.parameters, program, {.advice = main, .source = true});
    for (Diagnostic& diagnostic : translation.diagnostics) {
      diagnostic.program = program.slot;
      KeepFinding(std::move(diagnostic), machine::kDiagnosticsMax, prepared.diagnostics,
                  prepared.diagnostics_dropped);
    }
    translation.diagnostics_dropped.ForEachPlace(
        [&](Diagnostic& place) { place.program = program.slot; });
    prepared.diagnostics_dropped.Add(translation.diagnostics_dropped);
    if (!translation.ok) return false;
    TakeTranslation(std::move(translation), stored);
  }
  setup.programs[program.slot] = std::move(stored);
  return true;
}

machine::RunSetup SetupOf(const ProgramMemory& memory, machine::Parameters parameters) {
  machine::RunSetup setup(std::move(parameters));
  setup.deleted_programs = {memory.deleted_programs.begin(), memory.deleted_programs.end()};
  setup.schedules = memory.schedules;
  setup.machine_state = memory.machine_state;
  return setup;
}

}  // namespace

machine::MachineUsed MachineOf(const ProgramMemory& memory) {
  auto parameters = machine::MakeParameters(*memory.family, memory.profile, memory.parameters);
  if (!parameters) return {.profile = memory.profile, .named = !memory.profile.empty()};
  parameters->SetChangedBy(memory.parameters_of);
  parameters->SetOwn(memory.own);
  return parameters->Used();
}

Result<PreparedRun> PrepareRun(const ProgramMemory& memory, const RunOptions& options) {
  std::map<std::string, std::string> values = memory.parameters;
  for (const auto& [name, value] : options.parameters) values[name] = value;
  Result<machine::Parameters> parameters =
      machine::MakeParameters(*memory.family, memory.profile, values);
  if (!parameters) return parameters.error();
  std::string changed_by = memory.parameters_of;
  if (!options.parameters.empty())
    changed_by += (changed_by.empty() ? "" : " and ") + std::string("the request");
  parameters->SetChangedBy(std::move(changed_by));
  parameters->SetOwn(memory.own);
  machine::RunSetup setup = SetupOf(memory, *std::move(parameters));
  setup.main_program = options.main_program;
  setup.mode = options.mode;
  setup.forecast = true;  // who moves a machine says otherwise
  setup.override_percent = options.override_percent;
  setup.breakpoint = options.breakpoint;
  setup.breakpoints = options.breakpoints;
  setup.simul = options.simul;
  setup.inputs = options.inputs;
  setup.budget = options.budget;
  PreparedRun prepared;
  bool good = true;
  for (const MemoryProgram& program : memory.programs) {
    if (!AddProgram(*memory.family, program, setup, prepared)) good = false;
  }
  if (good) prepared.setup.emplace(std::move(setup));
  return prepared;
}

Status MakeExecutable(const machine::MachineFamily& family, machine::RunSetup& setup, int slot) {
  machine::RunSetup short_setup = setup;
  short_setup.main_program = slot;
  machine::RunObserver nobody;
  const Result<std::unique_ptr<machine::Run>> run = family.NewRun(std::move(short_setup), nobody);
  if (!run) return run.error();
  std::map<int, std::string> made = (*run)->made_executables();
  const auto found = made.find(slot);
  if (found == made.end()) {
    return Error{
        (*run)->outcome().code.value_or(family.info().empty_slot), (*run)->outcome().detail, {}};
  }
  setup.programs[slot].executable = machine::Bytes::Of(std::move(found->second));
  return {};
}

machine::Translation TranslateProgram(const machine::MachineFamily& family,
                                      const machine::Parameters& parameters,
                                      const MemoryProgram& program,
                                      const machine::CheckOptions& options) {
  machine::CheckOptions told = options;
  told.forced = told.forced || !program.is_source;  // that was said when it was stored
  return family.Translate({.name = program.file_name,
                           .bytes = *program.bytes,
                           .keeper = program.bytes.keeper(),
                           .is_object = !program.is_source},
                          parameters, told);
}

Result<CheckedProgram> CheckProgram(const ProgramMemory& memory,
                                    const machine::Parameters& parameters, int slot, bool advice,
                                    const machine::InputScript& inputs) {
  ProgramMemory ready = memory;
  const auto last =
      std::ranges::find(ready.programs.rbegin(), ready.programs.rend(), slot, &MemoryProgram::slot);
  if (last == ready.programs.rend()) {
    return Error{memory.family->info().empty_slot, "program " + Told("program", slot), {}};
  }
  MemoryProgram& program = *last;
  CheckedProgram check{.family = memory.family,
                       .machine = parameters.Used(),
                       .slot = slot,
                       .translation = TranslateProgram(*memory.family, parameters, program,
                                                       {.advice = advice, .source = true})};
  if (!check.translation.ok || !memory.family->info().checked_by_running) return check;
  program.translation = std::make_shared<const machine::Translation>(check.translation);
  program.executable = nullptr;  // of what it was before
  Result<MotionCheck> motion = CheckMotionOf(ready, parameters, {slot}, inputs);
  if (!motion) return motion.error();
  check.motion = *std::move(motion);
  return check;
}

Result<MotionCheck> CheckMotionOf(const ProgramMemory& memory,
                                  const machine::Parameters& parameters, const std::set<int>& slots,
                                  const machine::InputScript& inputs) {
  machine::RunSetup setup = SetupOf(memory, parameters);
  setup.inputs = inputs;
  PreparedRun ignored;
  MemoryGiven given = memory.given;
  for (const MemoryProgram& program : memory.programs) {
    if (!AddProgram(*memory.family, program, setup, ignored)) given = MemoryGiven::kInPart;
  }
  return CheckMotion(*memory.family, setup, slots, given);
}

namespace {

machine::Judgement JudgementOf(const CheckedProgram& check) {
  if (!check.translation.ok) return JudgeFindings(check.translation.diagnostics);
  const MotionCheck& motion = check.motion;
  machine::Judgement judgement = motion.has_errors()
                                     ? JudgeFindings(motion.findings)
                                     : JudgeFigures(*check.family, check.translation.figures);
  for (const machine::Reason& reason : motion.reasons) {
    // An error that is sure in one place, too, is told as that.
    if (std::ranges::find(judgement.reasons, reason.code, &machine::Reason::code) ==
        judgement.reasons.end())
      judgement.Add(reason);
  }
  if (motion.has_errors()) return judgement;
  for (const auto& [slot, why] : motion.cut_short) {
    // The error of a program that this one calls is told as that.
    if (std::ranges::find(judgement.reasons, why.cause, &machine::Reason::code) !=
        judgement.reasons.end())
      continue;
    judgement.Add({.code = why.cause,
                   .verdict = machine::Verdict::kDoubtful,
                   .said = "motion checked " + why.text});
  }
  return judgement;
}

}  // namespace

machine::Judgement JudgeCheck(CheckedProgram& check) {
  machine::Judgement judgement = JudgementOf(check);
  MarkJudged(judgement, check.translation.diagnostics);
  MarkJudged(judgement, check.translation.diagnostics_dropped);
  MarkJudged(judgement, check.motion.findings);
  MarkJudged(judgement, check.motion.findings_dropped);
  return judgement;
}

}  // namespace rmlcell::simulation
