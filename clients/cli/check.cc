#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "clients/cli/findings_text.h"
#include "clients/cli/fix.h"
#include "clients/cli/local.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/families/families.h"
#include "engine/simulation/run/rehearsal.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::cli {
namespace {

// One program of the command line, and what there is to say about it.
struct CheckedFile {
  std::string name;
  machine::Bytes text;
  const machine::MachineFamily* family = nullptr;
  std::optional<machine::Parameters> parameters;
  machine::Translation translation;
  simulation::MotionCheck motion;
  int slot = 0;  // in the program memory of the check; 0: none

  bool ok() const { return translation.ok && !motion.has_errors(); }
};

simulation::MemoryProgram InMemory(const CheckedFile& file) {
  return {.slot = file.slot,
          .name = file.name,
          .translation = std::make_shared<const machine::Translation>(file.translation)};
}

// The files of one family make one program memory, so that they can call each other: each in the
// slot of its name, the others in free ones. Those that find no room (a slot that is named twice)
// are left out.
void ChooseSlots(std::vector<CheckedFile*>& files) {
  std::map<int, const CheckedFile*> used;
  for (CheckedFile* file : files) {
    const std::optional<int> named = SlotFromName(file->name);
    if (named && used.emplace(*named, file).second) file->slot = *named;
  }
  int free_slot = kSlotMin;
  for (CheckedFile* file : files) {
    if (file->slot > 0 || SlotFromName(file->name)) continue;
    while (used.contains(free_slot)) ++free_slot;
    if (!IsSlot(free_slot)) break;
    used.emplace(free_slot, file);
    file->slot = free_slot;
  }
}

// Runs what was translated, and gives each finding to the file that it is in.
Status CheckMotions(std::vector<CheckedFile*>& files, const machine::InputScript& inputs,
                    bool advice) {
  ChooseSlots(files);
  std::map<int, CheckedFile*> by_slot;
  simulation::ProgramMemory memory{.family = files.front()->family};
  std::set<int> slots;
  for (CheckedFile* file : files) {
    if (file->slot == 0) continue;
    memory.programs.push_back(InMemory(*file));
    by_slot[file->slot] = file;
    slots.insert(file->slot);
  }
  const auto take = [&](const simulation::MotionCheck& check,
                        const std::map<int, CheckedFile*>& owners) {
    for (Diagnostic finding : check.findings) {
      const auto owner = owners.find(finding.program);
      if (owner == owners.end() || (!advice && !IsError(finding.severity))) continue;
      finding.file = owner->second->name;
      owner->second->motion.findings.push_back(std::move(finding));
    }
    for (const auto& [slot, why] : check.cut_short) {
      const auto owner = owners.find(slot);
      if (owner != owners.end()) owner->second->motion.cut_short[slot] = why;
    }
  };
  const machine::Parameters& parameters = *files.front()->parameters;
  const auto check = simulation::CheckMotionOf(memory, parameters, slots, inputs);
  if (!check) return check.error();
  take(*check, by_slot);
  for (CheckedFile* file : files) {
    if (file->slot > 0) continue;
    // Its slot is that of another file: it takes the place of that one.
    file->slot = SlotFromName(file->name).value_or(kSlotMin);
    simulation::ProgramMemory alone = memory;
    alone.programs.push_back(InMemory(*file));
    const auto own = simulation::CheckMotionOf(alone, parameters, {file->slot}, inputs);
    if (!own) return own.error();
    take(*own, {{file->slot, file}});
  }
  return {};
}

Status Translate(CheckedFile& file, const CheckOptions& options) {
  Result<std::string> text = bridge::ReadFile(file.name, kFileBytesMax);
  if (!text) return text.error();
  if (text->empty()) return Error{ErrorCode::kCellEmptyProgram, file.name, {}};
  file.text = std::make_shared<const std::string>(*std::move(text));
  file.translation =
      simulation::TranslateProgram(*file.family, *file.parameters,
                                   {.file_name = file.name, .bytes = file.text, .is_source = true},
                                   {.advice = !options.errors_only, .source = true});
  return {};
}

// The figures that people want of a check: those that the family gives a row, else all on one line.
std::string FigureText(const CheckedFile& file) {
  const std::string rows = FigureRows(*file.family, file.translation.figures);
  if (!rows.empty()) return rows;
  std::string line;
  for (const machine::Figure& figure : file.translation.figures) {
    if (figure.value == 0.0) continue;
    line += (line.empty() ? "" : ", ") + figure.name + " " + ShortestText(figure.value) +
            (figure.unit.empty() ? "" : " " + figure.unit);
  }
  return line.empty() ? line : "  " + line + "\n";
}

// What there is to say; the exit code.
int Show(const CheckedFile& file, const CheckOptions& options) {
  const machine::Translation& translation = file.translation;
  const v1::Findings found = bridge::FindingsOf(*file.family, translation, file.motion, file.slot);
  const int exit_code = file.ok() ? ExitOf(found.verdict(), options.strict) : int{kProgramErrors};
  if (options.json) {
    Print(Json(found));
    return exit_code;
  }
  PrintFindings(translation.diagnostics, translation.diagnostics_dropped, *file.text);
  PrintFindings(file.motion.findings, file.motion.findings_dropped, *file.text);
  const std::size_t findings = translation.diagnostics.size() + translation.diagnostics_dropped +
                               file.motion.findings.size() + file.motion.findings_dropped;
  std::string line = Visible(file.name) + ": " + VerdictText(found.verdict());
  if (findings > 0)
    line += ", " + std::to_string(findings) + (findings == 1 ? " finding" : " findings");
  Print(line);
  // Where it fails the reasons do not say how far it was looked at.
  if (!file.ok()) {
    for (const auto& [slot, why] : file.motion.cut_short) Print("  motion checked " + why);
  }
  for (const v1::VerdictReason& reason : found.reasons()) Print("  " + ReasonLine(reason));
  PrintRaw(FigureText(file));
  return exit_code;
}

}  // namespace

int Check(const CheckOptions& options) {
  const Result<bridge::MachineFile> machine = ReadMachine(options.machine_file);
  if (!machine) return Refuse(machine.error());
  machine::InputScript inputs;
  if (!options.inputs_file.empty()) {
    const Result<std::string> text = bridge::ReadFile(options.inputs_file, kFileBytesMax);
    if (!text) return Refuse(text.error());
    v1::SimulationOptions scripted;
    const Status parsed =
        bridge::ParseInputFile(*text, options.inputs_file, families::OverrideMax(), scripted);
    if (!parsed) return Refuse(parsed.error());
    inputs = bridge::InputsOf(scripted);
  }
  std::vector<CheckedFile> files;
  for (const std::string& name : options.files) {
    const auto family = FamilyFor(options.family.empty() ? machine->family : options.family, name);
    if (!family) return Refuse(family.error());
    const std::string& profile = options.profile.empty() ? machine->profile : options.profile;
    auto parameters = machine::MakeParameters(**family, profile, machine->parameters);
    if (!parameters) return Refuse(parameters.error());
    files.push_back({.name = name, .family = *family, .parameters = *std::move(parameters)});
  }
  int exit_code = kGood;
  if (options.fix) {
    for (const CheckedFile& file : files) {
      if (!file.family->info().has_executables) {
        return Refuse({ErrorCode::kCellUsage,
                       file.name + ": a stream of " + std::string(file.family->info().title) +
                           " has nothing to fix",
                       {}});
      }
      const Result<std::string> text = bridge::ReadFile(file.name, kFileBytesMax);
      if (!text) return Refuse(text.error());
      if (text->empty()) return Refuse({ErrorCode::kCellEmptyProgram, file.name, {}});
      const auto check = [&](const machine::SourceFile& source) {
        return file.family->Translate(source, *file.parameters, {.advice = !options.errors_only});
      };
      exit_code =
          std::max(exit_code, FixFile(file.name, *text, check, {options.dry_run, options.json}));
      if (exit_code > kProgramErrors) return exit_code;
    }
    return exit_code;
  }
  std::map<const machine::MachineFamily*, std::vector<CheckedFile*>> to_run;
  for (CheckedFile& file : files) {
    if (!file.family->info().checked_by_running) continue;
    if (const Status translated = Translate(file, options); !translated)
      return Refuse(translated.error());
    if (file.translation.ok) to_run[file.family].push_back(&file);
  }
  for (auto& [family, ready] : to_run) {
    if (const Status ran = CheckMotions(ready, inputs, !options.errors_only); !ran)
      return Refuse(ran.error());
  }
  for (CheckedFile& file : files) {
    if (!file.family->info().checked_by_running) {
      if (const Status translated = Translate(file, options); !translated)
        return Refuse(translated.error());
    }
    exit_code = std::max(exit_code, Show(file, options));
    // A stream may be of hundreds of megabytes.
    file.text = {};
    file.translation = {};
  }
  return exit_code;
}

}  // namespace rmlcell::cli
