#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "clients/cli/findings_text.h"
#include "clients/cli/fix.h"
#include "clients/cli/local.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/simulation/run/joint_check.h"
#include "engine/simulation/run/rehearsal.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/setup.h"
#include "proto/bridge/spooled_bytes.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::cli {
namespace {

// One program of the command line, and what there is to say about it.
struct CheckedFile {
  std::string name;
  machine::Bytes text;
  std::optional<machine::Parameters> parameters;
  simulation::CheckedProgram check;
  std::optional<Error> refused;  // why there is nothing to check
};

// Runs what was translated: files of one family.
Status CheckMotions(const std::vector<CheckedFile*>& files, const machine::InputScript& inputs,
                    bool advice) {
  std::vector<simulation::JointProgram> programs;
  for (const CheckedFile* file : files) {
    programs.push_back({.program = {.slot = SlotFromName(file->name).value_or(0),
                                    .name = file->name,
                                    .bytes = file->text,
                                    .translation = std::make_shared<const machine::Translation>(
                                        file->check.translation)}});
  }
  const CheckedFile& any = *files.front();
  if (const Status checked =
          simulation::CheckTogether(*any.check.family, *any.parameters, programs, inputs);
      !checked)
    return checked.error();
  for (std::size_t n = 0; n < files.size(); ++n) {
    CheckedFile& file = *files[n];
    file.check.slot = programs[n].program.slot;
    file.check.motion = std::move(programs[n].motion);
    if (!advice) {
      std::erase_if(file.check.motion.findings,
                    [](const Diagnostic& finding) { return !IsError(finding.severity); });
    }
    for (Diagnostic& finding : file.check.motion.findings) finding.file = file.name;
  }
  return {};
}

// Of a text that is not stored: all that can be said of it, unless errors alone are wanted.
machine::Translation TranslateAs(const CheckedFile& file, const std::string& name,
                                 const machine::Bytes& text, const CheckOptions& options) {
  return simulation::TranslateProgram(*file.check.family, *file.parameters,
                                      {.file_name = name, .bytes = text, .is_source = true},
                                      {.advice = !options.errors_only, .source = true});
}

Status Translate(CheckedFile& file, const CheckOptions& options) {
  Result<machine::Bytes> text = bridge::ReadProgram(file.name, kFileBytesMax);
  if (!text) return text.error();
  if ((*text)->empty()) return Error{ErrorCode::kCellEmptyProgram, file.name, {}};
  file.text = *std::move(text);
  file.check.translation = TranslateAs(file, file.name, file.text, options);
  return {};
}

// The figures that people want of a check: those that the family gives a row, else all on one line.
std::string FigureText(const CheckedFile& file, Zero zero) {
  const std::string rows = FigureRows(*file.check.family, file.check.translation.figures, zero);
  if (!rows.empty()) return rows;
  std::string line;
  for (const machine::Figure& figure : file.check.translation.figures) {
    if (figure.value == 0.0) continue;
    line += (line.empty() ? "" : ", ") + figure.name + " " + ShortestText(figure.value) +
            (figure.unit.empty() ? "" : " " + figure.unit);
  }
  return line.empty() ? line : "  " + line + "\n";
}

// A file that is not there, or empty, keeps nobody from hearing of the others.
int ShowRefused(const CheckedFile& file, const CheckOptions& options) {
  Refuse(*file.refused);
  if (!options.json) return kProgramErrors;
  v1::Findings found = bridge::FindingsOf(false,
                                          {{.code = file.refused->code,
                                            .severity = Lookup(file.refused->code).severity,
                                            .detail = file.refused->detail,
                                            .file = file.name}},
                                          {}, {});
  found.set_file(bridge::Utf8(file.name));
  found.set_family(std::string(file.check.family->info().id));
  Print(Json(found));
  return kProgramErrors;
}

// What there is to say; the exit code.
int Show(CheckedFile& file, const CheckOptions& options) {
  if (file.refused) return ShowRefused(file, options);
  const machine::Judgement judgement = simulation::JudgeCheck(file.check);
  const machine::Translation& translation = file.check.translation;
  v1::Findings found = bridge::FindingsOf(file.check, judgement);
  found.set_file(bridge::Utf8(file.name));
  const int exit_code = ExitOf(found, options.strict);
  if (options.json) {
    PrintJson(found);
    return exit_code;
  }
  PrintFindings(translation.diagnostics, translation.diagnostics_dropped, *file.text);
  PrintFindings(file.check.motion.findings, file.check.motion.findings_dropped, *file.text);
  Print(Visible(file.name) + ": " + VerdictText(found.verdict()) + CountText(found));
  // Where it fails the reasons do not say how far it was looked at.
  if (!file.check.ok()) {
    for (const auto& [slot, why] : file.check.motion.cut_short)
      Print("  motion checked " + why.text);
  }
  for (const v1::VerdictReason& reason : found.reasons()) Print("  " + ReasonLine(reason));
  PrintRaw(MachineRows(*file.check.family, found));
  PrintRaw(FigureText(file, options.machine_coordinates ? Zero::kMachine : Zero::kWork));
  return exit_code;
}

// --fix: each by its tools, judged by the check that a check is.
int FixFiles(std::vector<CheckedFile>& files, const machine::InputScript& inputs,
             const CheckOptions& options) {
  int exit_code = kGood;
  for (CheckedFile& file : files) {
    if (file.check.family->tools() == nullptr) {
      return Refuse({ErrorCode::kCellUsage,
                     file.name + ": a stream of " + std::string(file.check.family->info().title) +
                         " has nothing to fix",
                     {}});
    }
    const Result<std::string> text = bridge::ReadFile(file.name, kFileBytesMax);
    if (!text) return Refuse(text.error());
    if (text->empty()) return Refuse({ErrorCode::kCellEmptyProgram, file.name, {}});
    const auto translate = [&](const machine::SourceFile& source) {
      const std::string bytes(source.bytes);
      return TranslateAs(file, std::string(source.name), machine::Bytes::Borrowed(bytes), options);
    };
    const auto judge = [&](const machine::Translation& left) -> Result<FixCheck::Left> {
      file.check.translation = left;
      if (left.ok && file.check.family->info().checked_by_running) {
        if (const Status ran = CheckMotions({&file}, inputs, !options.errors_only); !ran)
          return ran.error();
      }
      const machine::Judgement judgement = simulation::JudgeCheck(file.check);
      return FixCheck::Left{.check = file.check,
                            .found = bridge::FindingsOf(file.check, judgement)};
    };
    exit_code = std::max(exit_code, FixFile(file.name, *text, {translate, judge},
                                            {options.dry_run, options.json, options.strict}));
    if (exit_code > kProgramErrors) return exit_code;
  }
  return exit_code;
}

}  // namespace

int Check(const CheckOptions& options) {
  const Result<bridge::MachineFile> machine = ReadMachine(options.machine);
  if (!machine) return Refuse(machine.error());
  std::vector<CheckedFile> files;
  double override_max = 0.0;  // of any of their machines: one script is for all
  for (const std::string& name : options.files) {
    const auto family = FamilyFor(machine->family, name);
    if (!family) return Refuse(family.error());
    std::map<std::string, std::string> changed = machine->parameters;
    if (const Status placed = PlaceWork(options.machine, **family, changed); !placed)
      return Refuse(placed.error());
    auto parameters = machine::MakeParameters(**family, machine->profile, changed);
    if (!parameters) return Refuse(parameters.error());
    parameters->SetChangedBy(ParametersOf(options.machine));
    parameters->SetOwn(OwnOf(options.machine, *machine));
    files.push_back({.name = name,
                     .parameters = *parameters,
                     .check = {.family = *family, .machine = parameters->Used()}});
    override_max = std::max(override_max, (*family)->info().override_max_percent);
  }
  machine::InputScript inputs;
  if (!options.inputs_file.empty()) {
    const Result<std::string> text = bridge::ReadFile(options.inputs_file, kFileBytesMax);
    if (!text) return Refuse(text.error());
    v1::SimulationOptions scripted;
    if (const Status parsed =
            bridge::ParseInputFile(*text, options.inputs_file, override_max, scripted);
        !parsed)
      return Refuse(parsed.error());
    Result<machine::InputScript> read = bridge::InputsOf(scripted);
    if (!read) return Refuse(read.error());
    inputs = *std::move(read);
  }
  if (options.fix) return FixFiles(files, inputs, options);
  int exit_code = kGood;
  std::map<const machine::MachineFamily*, std::vector<CheckedFile*>> to_run;
  const auto translate = [&](CheckedFile& file) -> Status {
    const Status translated = Translate(file, options);
    if (translated || files.size() == 1) return translated;
    file.refused = translated.error();
    return {};
  };
  for (CheckedFile& file : files) {
    if (!file.check.family->info().checked_by_running) continue;
    if (const Status translated = translate(file); !translated) return Refuse(translated.error());
    if (file.check.translation.ok) to_run[file.check.family].push_back(&file);
  }
  for (auto& [family, ready] : to_run) {
    if (const Status ran = CheckMotions(ready, inputs, !options.errors_only); !ran)
      return Refuse(ran.error());
  }
  for (CheckedFile& file : files) {
    if (!file.check.family->info().checked_by_running) {
      if (const Status translated = translate(file); !translated) return Refuse(translated.error());
    }
    exit_code = std::max(exit_code, Show(file, options));
    // A stream may be of hundreds of megabytes.
    file.text = {};
    file.check.translation = {};
  }
  return exit_code;
}

}  // namespace rmlcell::cli
